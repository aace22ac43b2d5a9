//! A fast receiver with a forecast clock. It moves farther between two epochs than corrections
//! hold, so that every epoch is corrected and judged more than once, and is learned from once.
//!
//! The wanted values are arithmetic: `dof = n − 3 − C`, and one more if the forecast of a clock
//! takes a row.

use raim::replay::{self, Pace, Window};
use raim::sentence::epochs;
use raim::signal::encode::{Frequency, Selection};
use raim::signal::recording::Recording;
use raim::signal::sky::Site;
use raim::signal::sky::raw::Simulation;
use raim_core::frame::Enu;

/// Speed of an airliner, m/s.
const SPEED_M_S: f64 = 250.0;

/// Time between epochs, s: 1250 m.
const STEP_S: f64 = 5.0;

/// Number of epochs: more than the twelve that a clock forecast needs.
const EPOCHS: u32 = 30;

/// Returns GPS as an airliner above Xi'an records it, eastward.
fn flight() -> Recording {
    let still = Simulation { step_s: STEP_S, ..Simulation::above_xian(7200.0, EPOCHS, 3) };
    let at = |epoch: u32| {
        let east = SPEED_M_S * STEP_S * f64::from(epoch);
        let moved = still.site.frame.unrotate(Enu { east, north: 0.0, up: 0.0 });
        Simulation { site: Site::at(still.site.position + moved), ..still.clone() }
    };
    // The clock follows from the seed, so it continues from epoch to epoch whatever the site is.
    let epochs = (0..EPOCHS).filter_map(|epoch| at(epoch).record().epochs.into_iter().nth(epoch as usize));
    Recording { epochs: epochs.collect(), ..still.record() }
}

#[test]
fn receiver_at_250_m_s_gets_a_forecast_once_twelve_epochs_are_learned() {
    let selection = Selection::new("G", Frequency::Dual).expect("a system");
    let lumps = replay::encode(&flight(), &selection, &[], &Window::ALL).expect("a recording");
    let reported = replay::on_host(&lumps, &["CLOCKAID,ON".to_owned()], Pace::Recorded, |_| {})
        .expect("the host judges");
    let outputs = epochs(&reported.sentences()).expect("sentences");
    assert_eq!(outputs.len(), EPOCHS as usize);
    for (number, output) in outputs.iter().enumerate() {
        let alone = output.state.used - 4;
        let want = if number < 12 { alone } else { alone + 1 };
        let have = output.state.dof;
        assert_eq!(have, Some(want), "epoch {number}: {:?}", output.state);
    }
}
