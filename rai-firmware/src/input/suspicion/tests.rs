use super::*;

fn nav_status(spoofing: Suspicion) -> SelfReport {
    let reporter = Reporter::Navigation;
    SelfReport::Interference(Jamming { reporter, jamming: None, spoofing: Some(spoofing) })
}

fn sec_sig(jamming: Suspicion, spoofing: Suspicion) -> SelfReport {
    let reporter = Reporter::Detector;
    SelfReport::Interference(Jamming { reporter, jamming: Some(jamming), spoofing: Some(spoofing) })
}

/// [UBX-F9] NAV-STATUS has no field of jamming, and so cannot renew its state.
///
/// [UBX-F9]: crate#references
#[test]
fn message_without_jamming_does_not_renew_its_state() {
    let mut reported = Suspicions::NONE;
    reported.receive(&sec_sig(Suspicion::Sure, Suspicion::None), 0);
    for second in 1..=10 {
        reported.receive(&nav_status(Suspicion::None), 1000 * second);
        let want = if second <= 3 { Suspicion::Sure } else { Suspicion::Unknown };
        assert_eq!(reported.jamming, want, "{second} s");
        assert_eq!(reported.spoofing, Suspicion::None, "renewed by its own message, {second} s");
    }
}

#[test]
fn one_reporter_does_not_cancel_another() {
    let mut reported = Suspicions::NONE;
    reported.receive(&sec_sig(Suspicion::None, Suspicion::Suspected), 0);
    for ms in [100, 1000, 3000] {
        reported.receive(&nav_status(Suspicion::None), ms);
        assert_eq!(reported.spoofing, Suspicion::Suspected, "{ms} ms");
    }
    reported.receive(&nav_status(Suspicion::None), 3001);
    assert_eq!(reported.spoofing, Suspicion::None);
}

#[test]
fn certainty_is_distrusted_until_ten_seconds_after_it() {
    let mut reported = Suspicions::NONE;
    for second in 0..=2 {
        reported.receive(&sec_sig(Suspicion::None, Suspicion::Sure), 1000 * second);
        assert!(reported.is_sure(), "{second} s");
    }
    for second in 3..=30 {
        reported.receive(&sec_sig(Suspicion::None, Suspicion::None), 1000 * second);
        assert_eq!(reported.is_sure(), second <= 13, "{second} s");
    }
}

#[test]
fn receiver_that_reports_seldom_can_end_a_certainty() {
    for apart_s in [1, 5, 10, 30] {
        let mut reported = Suspicions::NONE;
        let mut receive = |state: Suspicion, second: u64| {
            if second.is_multiple_of(apart_s) {
                reported.receive(&nav_status(state), 1000 * second);
            }
            reported.age(1000 * second);
            reported.is_sure()
        };
        assert!((0..=60).all(|second| receive(Suspicion::Sure, second)), "every {apart_s} s");
        let first = (61..200).find(|&second| !receive(Suspicion::None, second)).unwrap();
        assert!((71..=61 + 3 * apart_s.max(10)).contains(&first), "every {apart_s} s: {first} s");
    }
}

#[test]
fn silence_after_a_denial_ends_no_certainty() {
    let mut reported = Suspicions::NONE;
    for second in 0..=5 {
        reported.receive(&nav_status(Suspicion::Sure), 1000 * second);
    }
    reported.receive(&nav_status(Suspicion::None), 9000);
    for second in 10..=600 {
        reported.age(1000 * second);
        assert!(reported.is_sure(), "{second} s");
    }
}

#[test]
fn certainty_of_an_instant_ends_with_its_denial() {
    let mut reported = Suspicions::NONE;
    reported.receive(&sec_sig(Suspicion::None, Suspicion::Sure), 0);
    assert!(reported.is_sure());
    reported.receive(&sec_sig(Suspicion::None, Suspicion::None), 900);
    assert!(!reported.is_sure());
}

#[test]
fn silence_makes_the_state_unknown_and_denies_nothing() {
    let mut reported = Suspicions::NONE;
    reported.receive(&sec_sig(Suspicion::Suspected, Suspicion::Sure), 0);
    for second in 1..=60 {
        reported.age(1000 * second);
        let is_fresh = second <= 3;
        assert_eq!(reported.spoofing == Suspicion::Sure, is_fresh, "{second} s");
        assert_eq!(reported.jamming == Suspicion::Unknown, !is_fresh, "{second} s");
        assert!(reported.is_sure(), "{second} s");
    }
}

#[test]
fn suspicion_counts_beside_a_sign_of_the_last_ten_seconds_alone() {
    let mut reported = Suspicions::NONE;
    reported.receive(&sec_sig(Suspicion::None, Suspicion::Suspected), 20_000);
    assert!(!reported.is_sure() && !reported.confirms(None, 20_000));
    assert!(reported.confirms(Some(10_000), 20_000) && !reported.confirms(Some(9_999), 20_000));
    reported.receive(&sec_sig(Suspicion::None, Suspicion::None), 20_000);
    assert!(!reported.confirms(Some(20_000), 20_000));
}

/// A receiver in a clean sky suspects spoofing without a break.
#[test]
fn suspicion_that_began_long_before_a_sign_does_not_count() {
    let mut reported = Suspicions::NONE;
    for second in 0..=3600 {
        let now_ms = 1000 * second;
        reported.receive(&sec_sig(Suspicion::None, Suspicion::Suspected), now_ms);
        reported.age(now_ms);
        assert_eq!(reported.confirms(Some(now_ms), now_ms), second <= 60, "{second} s");
    }
}

#[test]
fn suspicion_begins_anew_after_a_denial_or_a_silence() {
    for is_denied in [true, false] {
        let mut reported = Suspicions::NONE;
        reported.receive(&nav_status(Suspicion::Suspected), 0);
        if is_denied {
            reported.receive(&nav_status(Suspicion::None), 60_000);
        }
        reported.age(60_000);
        reported.receive(&nav_status(Suspicion::Suspected), 61_000);
        assert!(reported.confirms(Some(119_000), 119_000));
        reported.receive(&nav_status(Suspicion::Suspected), 119_000);
        assert!(!reported.confirms(Some(122_000), 122_000), "a minute after its onset");
    }
}

#[test]
fn suspicion_that_follows_a_sign_counts_until_ten_seconds_after_the_sign() {
    let mut reported = Suspicions::NONE;
    reported.receive(&nav_status(Suspicion::None), 0);
    for second in 20..=60 {
        reported.receive(&nav_status(Suspicion::Suspected), 1000 * second);
        assert_eq!(reported.confirms(Some(15_000), 1000 * second), second <= 25, "{second} s");
    }
}

#[test]
fn logged_event_is_a_suspicion_for_ten_seconds_and_never_a_certainty() {
    let mut reported = Suspicions::NONE;
    reported.receive(&SelfReport::Log(LoggedEvents { jamming_s: None, spoofing_s: Some(4) }), 30_000);
    for (second, want) in [(30, Suspicion::Suspected), (36, Suspicion::Suspected), (37, Suspicion::Unknown)] {
        reported.age(1000 * second);
        assert_eq!((reported.spoofing, reported.jamming), (want, Suspicion::Unknown), "{second} s");
        assert!(!reported.is_sure());
    }
}

#[test]
fn authentication_and_levels_are_as_old_as_their_message() {
    let levels = ReceiverLevels { frame: 1, axes_mm: [1000, 2000, 3000], risk: (1, -7) };
    let mut reported = Suspicions::NONE;
    reported.receive(&SelfReport::Authentication(5), 0);
    reported.receive(&SelfReport::Levels(Some(levels)), 1000);
    assert_eq!((reported.authenticated(), reported.levels()), (Some(5), Some(levels)));
    reported.age(3001);
    assert_eq!((reported.authenticated(), reported.levels()), (None, Some(levels)));
    reported.receive(&SelfReport::Levels(None), 3500);
    assert_eq!(reported.levels(), None);
}
