//! Settings that weaken the meaning of the pin.

use raim_firmware::settings::SEALED_BYTES;

use crate::attack::prelude::*;

pub(super) const TIME_TO_ALERT: Attack = Attack {
    name: "time-to-alert",
    about: "TTA,3600 in NPA, then a silent line; the pin must fall in time",
    branch: Branch::Settings,
    before: "pin high for 3,599 s",
    note: "`TTA,3600` is refused",
    run: time_to_alert,
};

pub(super) const RESTARTS: Attack = Attack {
    name: "restarts",
    about: "settings damaged in a restart, then restarts without damage, and PFF in a named phase; nothing may be promised under the settings at start",
    branch: Branch::Settings,
    before: "from the second restart on the pin was high under the settings at start (10 of 15 epochs); any restart after `PFF` lost all settings",
    note: "nothing is promised until `CONFIRM`; settings are kept",
    run: restarts,
};

pub(super) const NEVER: Attack = Attack {
    name: "never-faulty",
    about: "ISM states that satellites never fail, or once in 1e12, and one is wrong by 100 m to 300 km",
    branch: Branch::OneSatellite,
    before: "112 of 115 beyond, up to 38 km; no alert",
    note: "",
    run: never,
};

/// Longest time to alert of non-precision approach, s.
const LONGEST_S: f64 = 10.0;

fn time_to_alert(_: Effort) -> Result<Vec<Figure>> {
    let sky = Sky::quiet(5, 1)?;
    let mut victim = Victim::new(&["PHASE,NPA"], 1.0)?;
    let answer = victim.obey("TTA,3600")?;
    victim.judge(sky.unchanged()?, sky.truth)?;
    let was_promised = victim.is_promised();
    let mut high_s = 0.0;
    while victim.is_promised() && high_s < 3700.0 {
        let _ = victim.silence(1.0, sky.truth)?;
        high_s += 1.0;
    }
    Ok(vec![
        Figure::at_least("pin high before", f64::from(u8::from(was_promised)), 1.0),
        // The loop checks once a second, so one second more is allowed.
        Figure::at_most("pin high into the silence, s", high_s, LONGEST_S + 1.0),
        Figure::at_least("command refused", f64::from(u8::from(answer.contains(",ERR,"))), 1.0),
    ])
}

fn restarts(_: Effort) -> Result<Vec<Figure>> {
    let sky = Sky::quiet(5, 1)?;
    // The first settings differ from those at start only in choices that the phase leaves open; the
    // second ones in others.
    let mut figures = Vec::new();
    for (commands, what) in
        [(["PHASE,LPV200", "PFF,1e-9"], "a phase and its risk"), (["HAL,40", "VAL,35"], "limits")]
    {
        let mut sealed = [0; SEALED_BYTES];
        let mut victim = Victim::new(&commands, 1.0)?;
        let hash = victim.module.settings_hash()?;
        victim.module.seal(&mut sealed)?;
        victim.module.restart(&mut sealed)?;
        let kept = f64::from(u8::from(victim.module.settings_hash()? == hash));
        figures.push(Figure::at_least(format!("kept over a restart: {what}"), kept, 1.0));

        sealed[SEALED_BYTES - 1] ^= 1;
        let mut promised = 0;
        for _ in 0..3 {
            victim.module.restart(&mut sealed)?;
            for bytes in sky.unchanged()? {
                let _ = victim.receive(&bytes, sky.truth)?;
                promised += usize::from(victim.is_promised());
            }
        }
        figures.push(Figure::at_most(format!("promised by none of them: {what}"), promised as f64, 0.0));
        // An alert for unconfirmed settings must not hide the alert for the wrong position.
        victim.module.restart(&mut sealed)?;
        let mut alerts = 0;
        for bytes in wrong(&sky)? {
            alerts += victim
                .receive(&bytes, sky.truth)?
                .iter()
                .filter(|seen| seen.reported.state.state == 'A')
                .count();
        }
        figures.push(Figure::at_least(format!("alerts unconfirmed: {what}"), alerts as f64, 5.0));
        victim.module.restart(&mut sealed)?;
        victim.obey("CONFIRM")?;
        victim.judge(sky.unchanged()?, sky.truth)?;
        figures.push(Figure::at_least(
            "promised once confirmed",
            f64::from(u8::from(victim.is_promised())),
            1.0,
        ));
    }
    Ok(figures)
}

/// Returns epochs in which every range has its own error.
fn wrong(sky: &Sky) -> Result<Vec<Vec<u8>>> {
    sky.bytes(|_, epoch| {
        for (index, satellite) in epoch.satellites().into_iter().enumerate() {
            epoch.lengthen(satellite, (index * index * 97 % 3000) as f64);
        }
    })
}

/// Sizes of the faults that the settings rule out, m, drawn uniformly in their logarithm. Smaller
/// errors hide in the noise that the levels include.
const DENIED_M: std::ops::Range<f64> = 100.0..300_000.0;

fn never(effort: Effort) -> Result<Vec<Figure>> {
    /// Epochs of a run.
    const EPOCHS: u32 = 5;
    let (mut tally, mut healthy, mut warned) = (Tally::default(), Tally::default(), 0);
    for seed in 0..effort.pick(20, 400) {
        let mut chance = ChaCha8Rng::seed_from_u64(seed);
        let sky = Sky::of(&Simulation::above_xian(start_s(&mut chance), EPOCHS, seed), Frequency::Dual)?;
        let high: Vec<SatelliteId> = sky.recording.epochs[0]
            .satellites
            .iter()
            .filter(|raw| raw.signals.iter().all(|signal| signal.cn0_dbhz.is_some_and(|dbhz| dbhz > 40.0)))
            .map(|raw| raw.satellite)
            .collect();
        let size_m = size(DENIED_M, &mut chance);
        for fault in ["0,0", "1e-12,1e-12"] {
            let module = || -> Result<(Victim, usize)> {
                let mut victim = Victim::new(&["METHOD,SEPARATION"], 1.0)?;
                let mut warned = 0;
                for system in ["G,2.4,2.4", "C,6,4"] {
                    warned +=
                        usize::from(victim.obey(&format!("ISM,{system},0,{fault}"))?.contains(",WARN,"));
                }
                Ok((victim, warned))
            };
            let (mut victim, mut reference) = (module()?, module()?.0);
            warned += victim.1;
            let astray = *high.choose(&mut chance).unwrap_or(&sky.recording.epochs[0].satellites()[0]);
            for bytes in sky.bytes(|_, epoch| epoch.lengthen(astray, size_m))? {
                tally.add_all(&victim.0.receive(&bytes, sky.truth)?);
            }
            for bytes in sky.unchanged()? {
                healthy.add_all(&reference.receive(&bytes, sky.truth)?);
            }
        }
    }
    let mut figures = tally.figures(0.0);
    figures.push(Figure::at_least("alerts", tally.alerts(), tally.epochs()));
    figures.push(Figure::at_least("promised without a fault", healthy.promised(), healthy.epochs()));
    figures.push(Figure::at_least(
        "promises answered with a warning",
        warned as f64,
        f64::from(4 * effort.pick(20, 400)),
    ));
    Ok(figures)
}
