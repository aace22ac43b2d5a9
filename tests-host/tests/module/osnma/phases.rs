//! What the system announces: the end and the revocation of a chain, a new key, its revocation, an
//! alert.

use super::*;

/// First subframe: the root key of the second chain is then an hour and more old, too.
const START: u32 = ROOT + 125;

/// Hears a system to an end, and returns each state once, in order.
fn states(bench: &mut Bench, system: &System, end: u32) -> Vec<State> {
    let mut states = Vec::new();
    for page in system.pages(START..START + end) {
        bench.receive(&page);
        let summary = bench.summary();
        assert_eq!(summary.proved > 0, summary.oldest_proof_s.is_some(), "a proof has an age");
        if states.last() != Some(&summary.state) {
            states.push(summary.state);
        }
    }
    assert_eq!(bench.wrong(), 0, "{:?}", bench.osnma.tally());
    assert!(!bench.summary().is_alarm && bench.summary().false_ == 0);
    states
}

fn with_tree(system: &System) -> Bench {
    let mut bench = Bench::new(system.public());
    bench.keys.root = Some(system.tree_root());
    bench
}

#[test]
fn next_chain_is_followed_when_it_comes_into_force() {
    let mut system = System::new(20);
    system.then(START + 8, Phase::chain_ends);
    system.then(START + 16, Phase::next_chain);
    let mut bench = Bench::new(system.public());
    assert_eq!(states(&mut bench, &system, 30), [State::Waiting, State::Running]);
    assert_eq!((bench.summary().key_and_chain, bench.summary().proved), (Some((1, 1)), 6));
    assert!(bench.count("osnma_slow_right") > 20, "{:?}", bench.osnma.tally());
}

#[test]
fn revoked_chain_proves_nothing_until_the_next_is_in_force() {
    let mut system = System::new(21);
    system.then(START + 8, Phase::chain_revoked);
    system.then(START + 16, Phase::chain_replaced);
    let mut bench = Bench::new(system.public());
    let want = [State::Waiting, State::Running, State::DontUse, State::Running];
    assert_eq!(states(&mut bench, &system, 26), want);
    assert_eq!((bench.summary().key_and_chain, bench.summary().proved), (Some((1, 1)), 6));
}

#[test]
fn next_key_is_believed_if_the_tree_proves_it() {
    let mut system = System::new(22);
    system.then(START + 6, Phase::key_comes);
    system.then(START + 40, Phase::key_follows);
    for (has_tree, want) in [(true, Some((2, 0))), (false, Some((1, 0)))] {
        let mut bench = if has_tree { with_tree(&system) } else { Bench::new(system.public()) };
        assert_eq!(states(&mut bench, &system, 60), [State::Waiting, State::Running]);
        assert_eq!((bench.summary().key_and_chain, bench.summary().proved), (want, 6));
        assert_eq!(bench.count("osnma_renewals"), u32::from(has_tree));
    }
}

#[test]
fn revoked_key_is_believed_no_more() {
    let mut system = System::new(23);
    system.then(START + 6, Phase::key_revoked);
    system.then(START + 50, Phase::key_replaced);
    let mut bench = with_tree(&system);
    let want = [State::Waiting, State::Running, State::DontUse, State::Running];
    assert_eq!(states(&mut bench, &system, 66), want);
    assert_eq!((bench.summary().key_and_chain, bench.summary().proved), (Some((2, 1)), 6));
    // What the former key signs, whoever sends it.
    let former = System::new(23);
    bench.hear_all(&former.pages(START + 66..START + 76));
    assert_eq!(bench.summary().key_and_chain, Some((2, 1)));
}

#[test]
fn alert_ends_all_until_the_owner_gives_a_key() {
    let mut system = System::new(24);
    system.then(START + 6, Phase::alert);
    // By the header alone, and by the message of the tree alone.
    for has_tree in [false, true] {
        let mut bench = if has_tree { with_tree(&system) } else { Bench::new(system.public()) };
        if has_tree {
            bench.keys.key = None;
        }
        let states = states(&mut bench, &system, 40);
        assert_eq!(states.last(), Some(&State::Stopped), "{states:?}");
        bench.hear_all(&System::new(24).pages(START + 40..START + 50));
        assert_eq!((bench.summary().state, bench.summary().proved), (State::Stopped, 0));
        bench.osnma.forget_keys();
        bench.keys.key = Some((1, system.public()));
        bench.hear_all(&System::new(24).pages(START + 50..START + 60));
        assert_eq!((bench.summary().state, bench.summary().proved), (State::Running, 6));
    }
}

/// A satellite that sends the root key from before a revocation again, which is signed as well.
#[test]
fn older_root_key_does_not_lift_a_revocation() {
    let before = System::new(25);
    let mut system = System::new(25);
    system.then(START + 8, Phase::chain_revoked);
    let mut bench = Bench::new(system.public());
    states(&mut bench, &system, 16);
    assert_eq!(bench.summary().state, State::DontUse);
    let genuine = system.pages(START + 16..START + 32);
    for (page, old) in genuine.iter().zip(before.pages(START + 16..START + 32)) {
        bench.receive(if page.satellite < 12 { &old } else { page });
        assert_eq!((bench.summary().state, bench.summary().proved), (State::DontUse, 0));
    }
    assert!(bench.count("osnma_roots_right") >= 2, "{:?}", bench.osnma.tally());
}
