//! Settings that make the pin mean less than it seems to.

use anyhow::Result;
use rai_firmware::config::SEALED_BYTES;

use super::forgery::Sky;
use super::victim::Victim;
use super::{Attack, Effort, Figure};
use crate::fault::Measured as _;

/// A time to alert of an hour.
pub(super) const TIME_TO_ALERT: Attack = Attack {
    name: "time-to-alert",
    about: "TTA,3600 in NPA, then a silent line: how long does the pin stay high?",
    run: time_to_alert,
};

/// Restarts, the first of which has lost the settings.
pub(super) const RESTARTS: Attack = Attack {
    name: "restarts",
    about: "settings damaged in a restart, then restarts that damage nothing: are those at start promised by?",
    run: restarts,
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

fn restarts(_: Effort) -> Result<Vec<Figure>> {
    let sky = Sky::quiet(5, 1)?;
    // Nothing but what the phase leaves to choose differs from the start, then what does not.
    let mut figures = Vec::new();
    for (commands, what) in
        [(["PHASE,LPV200", "PFF,1e-9"], "a phase and its risk"), (["HAL,40", "VAL,35"], "limits")]
    {
        let mut sealed = [0; SEALED_BYTES];
        let mut victim = Victim::new(&commands, 1.0)?;
        let hash = victim.settings_hash();
        victim.restart(&mut sealed)?;
        let kept = f64::from(u8::from(victim.settings_hash() == hash));
        figures.push(Figure::at_least(format!("kept over a restart: {what}"), kept, 1.0));

        sealed[SEALED_BYTES - 1] ^= 1;
        let mut promised = 0;
        for _ in 0..3 {
            victim.restart_from(&mut sealed)?;
            for bytes in sky.bytes(|_, _| {})? {
                let _ = victim.hear(&bytes, sky.truth)?;
                promised += usize::from(victim.is_promised());
            }
        }
        figures.push(Figure::at_most(format!("promised by none of them: {what}"), promised as f64, 0.0));
        // That nobody has confirmed them must not hide that the position is wrong.
        victim.restart_from(&mut sealed)?;
        let mut alerts = 0;
        for bytes in wrong(&sky)? {
            alerts +=
                victim.hear(&bytes, sky.truth)?.iter().filter(|seen| seen.said.state.state == 'A').count();
        }
        figures.push(Figure::at_least(format!("alerts unconfirmed: {what}"), alerts as f64, 5.0));
        victim.restart_from(&mut sealed)?;
        victim.obey("CONFIRM")?;
        for bytes in sky.bytes(|_, _| {})? {
            let _ = victim.hear(&bytes, sky.truth)?;
        }
        figures.push(Figure::at_least(
            "promised once confirmed",
            f64::from(u8::from(victim.is_promised())),
            1.0,
        ));
    }
    Ok(figures)
}

/// Every range of the epochs wrong by a number of its own.
fn wrong(sky: &Sky) -> Result<Vec<Vec<u8>>> {
    sky.bytes(|_, epoch| {
        for (index, satellite) in epoch.satellites().into_iter().enumerate() {
            epoch.lengthen(satellite, (index * index * 97 % 3000) as f64);
        }
    })
}
