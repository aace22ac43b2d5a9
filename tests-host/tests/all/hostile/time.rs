//! Leaps of time, and the roll-over of the week.

use super::module::{Module, Sky};

#[test]
fn an_epoch_that_goes_back_is_dropped_whole_and_changes_nothing() {
    let sky = Sky::quiet(8);
    let mut module = Module::after(&sky, 6);
    for earlier in [5, 4, 2] {
        module.note();
        let reported = module.receive(&sky.lumps[earlier]);
        assert!(reported.is_empty(), "{reported:?}");
        assert_eq!(module.grown("epochs_backwards"), 1);
    }
    module.recovers(&sky.lumps[6]);
    module.recovers(&sky.lumps[7]);
}

#[test]
fn a_pass_goes_on_over_the_roll_over_of_the_week() {
    // Midnight of the sky's first day is a day after the week began.
    const UNTIL_ROLL_OVER_S: f64 = 6.0 * 86_400.0;
    let sky = Sky::from(UNTIL_ROLL_OVER_S - 5.0, 10);
    let mut module = Module::new(&sky);
    // UTC is 18 s behind.
    let first_s = 86_400.0 - 18.0 - 5.0;
    for (lump, want_s) in sky.lumps.iter().zip((0..).map(|elapsed| first_s + f64::from(elapsed))) {
        let reported = module.receive(lump);
        let [only] = reported.as_slice() else { panic!("one epoch is one answer: {reported:?}") };
        assert!(only.state.is_protected() && only.excluded.is_empty(), "{only:?}");
        assert_eq!(only.state.time_s, Some(want_s));
    }
    for counter in ["epochs_backwards", "time_restarts", "week_corrections", "ephemeris_stale"] {
        assert_eq!(module.grown(counter), 0, "{counter}");
    }
}
