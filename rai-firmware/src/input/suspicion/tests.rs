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
    let mut said = Suspicions::NONE;
    said.hear(&sec_sig(Suspicion::Sure, Suspicion::None), 0);
    for second in 1..=10 {
        said.hear(&nav_status(Suspicion::None), 1000 * second);
        let want = if second <= 3 { Suspicion::Sure } else { Suspicion::Unknown };
        assert_eq!(said.jamming, want, "{second} s");
        assert_eq!(said.spoofing, Suspicion::None, "renewed by its own message, {second} s");
    }
}

#[test]
fn one_reporter_does_not_cancel_another() {
    let mut said = Suspicions::NONE;
    said.hear(&sec_sig(Suspicion::None, Suspicion::Suspected), 0);
    for ms in [100, 1000, 3000] {
        said.hear(&nav_status(Suspicion::None), ms);
        assert_eq!(said.spoofing, Suspicion::Suspected, "{ms} ms");
    }
    said.hear(&nav_status(Suspicion::None), 3001);
    assert_eq!(said.spoofing, Suspicion::None);
}

#[test]
fn certainty_is_distrusted_until_ten_seconds_after_it() {
    let mut said = Suspicions::NONE;
    for second in 0..=2 {
        said.hear(&sec_sig(Suspicion::None, Suspicion::Sure), 1000 * second);
        assert!(said.is_sure(), "{second} s");
    }
    for second in 3..=30 {
        said.hear(&sec_sig(Suspicion::None, Suspicion::None), 1000 * second);
        assert_eq!(said.is_sure(), second <= 13, "{second} s");
    }
}

#[test]
fn receiver_that_reports_seldom_can_end_a_certainty() {
    for apart_s in [1, 5, 10, 30] {
        let mut said = Suspicions::NONE;
        let mut hear = |state: Suspicion, second: u64| {
            if second.is_multiple_of(apart_s) {
                said.hear(&nav_status(state), 1000 * second);
            }
            said.age(1000 * second);
            said.is_sure()
        };
        assert!((0..=60).all(|second| hear(Suspicion::Sure, second)), "every {apart_s} s");
        let first = (61..200).find(|&second| !hear(Suspicion::None, second)).unwrap();
        assert!((71..=61 + 3 * apart_s.max(10)).contains(&first), "every {apart_s} s: {first} s");
    }
}

#[test]
fn silence_after_a_denial_ends_no_certainty() {
    let mut said = Suspicions::NONE;
    for second in 0..=5 {
        said.hear(&nav_status(Suspicion::Sure), 1000 * second);
    }
    said.hear(&nav_status(Suspicion::None), 9000);
    for second in 10..=600 {
        said.age(1000 * second);
        assert!(said.is_sure(), "{second} s");
    }
}

#[test]
fn certainty_of_an_instant_ends_with_its_denial() {
    let mut said = Suspicions::NONE;
    said.hear(&sec_sig(Suspicion::None, Suspicion::Sure), 0);
    assert!(said.is_sure());
    said.hear(&sec_sig(Suspicion::None, Suspicion::None), 900);
    assert!(!said.is_sure());
}

#[test]
fn silence_makes_the_state_unknown_and_denies_nothing() {
    let mut said = Suspicions::NONE;
    said.hear(&sec_sig(Suspicion::Suspected, Suspicion::Sure), 0);
    for second in 1..=60 {
        said.age(1000 * second);
        let is_fresh = second <= 3;
        assert_eq!(said.spoofing == Suspicion::Sure, is_fresh, "{second} s");
        assert_eq!(said.jamming == Suspicion::Unknown, !is_fresh, "{second} s");
        assert!(said.is_sure(), "{second} s");
    }
}

#[test]
fn suspicion_counts_beside_a_sign_of_the_last_ten_seconds_alone() {
    let mut said = Suspicions::NONE;
    said.hear(&sec_sig(Suspicion::None, Suspicion::Suspected), 20_000);
    assert!(!said.is_sure() && !said.confirms(None, 20_000));
    assert!(said.confirms(Some(10_000), 20_000) && !said.confirms(Some(9_999), 20_000));
    said.hear(&sec_sig(Suspicion::None, Suspicion::None), 20_000);
    assert!(!said.confirms(Some(20_000), 20_000));
}

/// A receiver in a clean sky suspects spoofing without a break.
#[test]
fn suspicion_that_began_long_before_a_sign_does_not_count() {
    let mut said = Suspicions::NONE;
    for second in 0..=3600 {
        let now_ms = 1000 * second;
        said.hear(&sec_sig(Suspicion::None, Suspicion::Suspected), now_ms);
        said.age(now_ms);
        assert_eq!(said.confirms(Some(now_ms), now_ms), second <= 60, "{second} s");
    }
}

#[test]
fn suspicion_begins_anew_after_a_denial_or_a_silence() {
    for is_denied in [true, false] {
        let mut said = Suspicions::NONE;
        said.hear(&nav_status(Suspicion::Suspected), 0);
        if is_denied {
            said.hear(&nav_status(Suspicion::None), 60_000);
        }
        said.age(60_000);
        said.hear(&nav_status(Suspicion::Suspected), 61_000);
        assert!(said.confirms(Some(119_000), 119_000));
        said.hear(&nav_status(Suspicion::Suspected), 119_000);
        assert!(!said.confirms(Some(122_000), 122_000), "a minute after its onset");
    }
}

#[test]
fn suspicion_that_follows_a_sign_counts_until_ten_seconds_after_the_sign() {
    let mut said = Suspicions::NONE;
    said.hear(&nav_status(Suspicion::None), 0);
    for second in 20..=60 {
        said.hear(&nav_status(Suspicion::Suspected), 1000 * second);
        assert_eq!(said.confirms(Some(15_000), 1000 * second), second <= 25, "{second} s");
    }
}

#[test]
fn logged_event_is_a_suspicion_for_ten_seconds_and_never_a_certainty() {
    let mut said = Suspicions::NONE;
    said.hear(&SelfReport::Log(LoggedEvents { jamming_s: None, spoofing_s: Some(4) }), 30_000);
    for (second, want) in [(30, Suspicion::Suspected), (36, Suspicion::Suspected), (37, Suspicion::Unknown)] {
        said.age(1000 * second);
        assert_eq!((said.spoofing, said.jamming), (want, Suspicion::Unknown), "{second} s");
        assert!(!said.is_sure());
    }
}

#[test]
fn authentication_and_levels_are_as_old_as_their_message() {
    let levels = ReceiverLevels { frame: 1, axes_mm: [1000, 2000, 3000], risk: (1, -7) };
    let mut said = Suspicions::NONE;
    said.hear(&SelfReport::Authentication(5), 0);
    said.hear(&SelfReport::Levels(Some(levels)), 1000);
    assert_eq!((said.authenticated(), said.levels()), (Some(5), Some(levels)));
    said.age(3001);
    assert_eq!((said.authenticated(), said.levels()), (None, Some(levels)));
    said.hear(&SelfReport::Levels(None), 3500);
    assert_eq!(said.levels(), None);
}
