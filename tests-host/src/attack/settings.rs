//! Settings that make the pin mean less than it seems to.

use anyhow::Result;

use super::forgery::Sky;
use super::victim::Victim;
use super::{Attack, Effort, Figure};

/// A time to alert of an hour.
pub(super) const TIME_TO_ALERT: Attack = Attack {
    name: "time-to-alert",
    about: "TTA,3600 in NPA, then a silent line: how long does the pin stay high?",
    run: time_to_alert,
};

/// Longest time to alert of non-precision approach, s.
const LONGEST_S: f64 = 10.0;

fn time_to_alert(_: Effort) -> Result<Vec<Figure>> {
    let sky = Sky::quiet(5, 1)?;
    let mut victim = Victim::new(&["PHASE,NPA"], 1.0)?;
    let answer = victim.obey("TTA,3600")?;
    for bytes in sky.bytes(|_, _| {})? {
        let _ = victim.hear(&bytes, sky.truth)?;
    }
    let was_promised = victim.is_promised();
    let mut high_s = 0.0;
    while victim.is_promised() && high_s < 3700.0 {
        let _ = victim.silence(1.0, sky.truth)?;
        high_s += 1.0;
    }
    Ok(vec![
        Figure::at_least("pin high before", f64::from(u8::from(was_promised)), 1.0),
        // A second of grace: that is how often it is looked.
        Figure::at_most("pin high into the silence, s", high_s, LONGEST_S + 1.0),
        Figure::at_least("command refused", f64::from(u8::from(answer.contains(",ERR,"))), 1.0),
    ])
}
