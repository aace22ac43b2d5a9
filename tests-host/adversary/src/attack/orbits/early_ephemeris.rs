//! Ephemerides that are received hours early, and ephemerides of crowds of absent satellites.
//!
//! Merged broadcast files hold sets whose reference time is hours after the epoch at which they
//! arrive. Such a set is accurate around its reference time and tens of metres wrong before it. The
//! sets that follow are accurate at once. A store that ranks sets by reference time would keep the
//! early one.

use anyhow::bail;
use raim::signal::sky::broadcast::{drifting, ephemeris};
use rtcm_rs::msg::{Msg1019T, Msg1042T, Msg1046T};
use rtcm_rs::{Message, MessageBuilder};

use crate::attack::prelude::*;

pub(super) const EARLY: Attack = Attack {
    name: "early-ephemeris",
    about: "five ephemerides up to 3.9 h early come first; two hours before their time they are 60 m wrong",
    branch: Branch::Orbits,
    before: "5 alerts, 135 exclusions",
    note: "",
    run: early,
};

pub(super) const ABSENT: Attack = Attack {
    name: "absent-satellites",
    about: "96 valid ephemerides of absent satellites, two days early, before the first real one",
    branch: Branch::Orbits,
    before: "no epoch protected",
    note: "",
    run: absent,
};

pub(super) const CROWD: Attack = Attack {
    name: "crowd",
    about: "ephemerides of a hundred absent satellites, repeated between those of the satellites in view",
    branch: Branch::Orbits,
    before: "no epoch protected",
    note: "",
    run: crowd,
};

/// Start of the sky, s, and time between its epochs, s.
const START_S: f64 = 7200.0;
const STEP_S: f64 = 30.0;

/// Reference times of the early sets, s after the beginning, on the full 16 s of their message.
const AHEAD_S: [f64; 5] = [14_032.0, 12_000.0, 10_000.0, 8_000.0, 13_600.0];

/// Settings for epochs far apart, with limits so wide that none is exceeded.
const SETTINGS: &[&str] = &["PHASE,ENROUTE", "TTA,60"];

/// Smallest share of the satellites in view that the positions must use, beside a crowd.
const KEPT: f64 = 0.97;

/// The same share if two sets of a satellite contradict each other. Such a satellite waits for a
/// third set, for an hour at most.
const DISPUTED: f64 = 0.85;

/// Error of an early set, m, and the time before its reference time at which it has that error, s.
const WRONG_M: f64 = 60.0;
const BEFORE_S: f64 = 7200.0;

fn sky(epochs: u32) -> Result<(Simulation, Sky)> {
    let simulation = Simulation { step_s: STEP_S, ..Simulation::above_xian(START_S, epochs, 5) };
    let sky = Sky::of(&simulation, Frequency::Dual)?;
    Ok((simulation, sky))
}

fn early(effort: Effort) -> Result<Vec<Figure>> {
    let (simulation, sky) = sky(effort.pick(240, 470))?;
    let of_gps = simulation.sights_at(0).into_iter().map(|sight| sight.satellite);
    let chosen: Vec<SatelliteId> =
        of_gps.filter(|satellite| satellite.constellation() == Constellation::Gps).take(5).collect();
    let mut first = Vec::new();
    for (satellite, ahead_s) in chosen.iter().zip(AHEAD_S) {
        let Some(satellite) = simulation.satellites.iter().find(|known| known.id == *satellite) else {
            continue;
        };
        if let Some(set) = ephemeris(satellite, simulation.origin, START_S + ahead_s, 77) {
            first.extend(frame(&drifting(set, WRONG_M, BEFORE_S))?);
        }
    }
    let mut victim = Victim::new(SETTINGS, STEP_S)?;
    let _ = victim.receive(&first, sky.truth)?;
    figures_of(&mut victim, &sky, DISPUTED, &[])
}

fn absent(_: Effort) -> Result<Vec<Figure>> {
    let (simulation, sky) = sky(10)?;
    let mut victim = Victim::new(SETTINGS, STEP_S)?;
    let in_view: Vec<SatelliteId> = sky.recording.epochs[0].satellites();
    let strangers = strangers(&simulation, START_S + 172_800.0, |satellite| !in_view.contains(&satellite))?;
    victim.judge(strangers.iter().take(96), sky.truth)?;
    figures_of(&mut victim, &sky, KEPT, &[])
}

fn crowd(effort: Effort) -> Result<Vec<Figure>> {
    let (simulation, sky) = sky(effort.pick(20, 240))?;
    let mut victim = Victim::new(SETTINGS, STEP_S)?;
    // Satellites that rise later are left out: a false orbit under their name would be disputed, as
    // in the attack before.
    let is_ever_seen =
        |satellite| sky.recording.epochs.iter().any(|epoch| epoch.satellites().contains(&satellite));
    let strangers = strangers(&simulation, START_S, |satellite| !is_ever_seen(satellite))?;
    figures_of(&mut victim, &sky, KEPT, &strangers.concat())
}

/// Sends the sky, each epoch after the bytes of `between`. The positions must use at least `share` of
/// the satellites.
fn figures_of(victim: &mut Victim, sky: &Sky, share: f64, between: &[u8]) -> Result<Vec<Figure>> {
    let bytes = sky.unchanged()?;
    let wanted = Victim::new(SETTINGS, STEP_S)?.judge(&bytes, sky.truth)?.used;
    let tally = victim.judge(bytes.iter().map(|bytes| [between, bytes].concat()), sky.truth)?;
    let mut figures = tally.figures(0.0);
    figures.push(Figure::at_most("alerts", tally.alerts(), 0.0));
    figures.push(Figure::at_most("satellites left out", tally.left_out as f64, 0.0));
    let wanted = (f64::from(wanted) * share).round();
    figures.push(Figure::at_least("satellites used, all epochs added", tally.used.into(), wanted));
    Ok(figures)
}

/// Returns ephemerides of absent satellites of three systems, each on the orbit of a satellite in
/// the sky.
pub(in crate::attack) fn strangers(
    simulation: &Simulation,
    at_s: f64,
    is_wanted: impl Fn(SatelliteId) -> bool,
) -> Result<Vec<Vec<u8>>> {
    let model = simulation.satellites.first().and_then(|known| ephemeris(known, simulation.origin, at_s, 9));
    let Some(TimedEphemeris { message: Ephemeris::Gps(model), toe, sent, .. }) = model else {
        bail!("the sky must have a GPS satellite");
    };
    let names = [(Constellation::Beidou, 63), (Constellation::Galileo, 36), (Constellation::Gps, 32)];
    let satellites = names.into_iter().flat_map(|(constellation, highest)| {
        (1..=highest).filter_map(move |number| SatelliteId::new(constellation, number))
    });
    satellites
        .filter(|satellite| is_wanted(*satellite))
        .map(|satellite| {
            let message = renamed(&model, satellite, toe.week);
            frame(&TimedEphemeris { satellite, toe, sent, message })
        })
        .collect()
}

/// Returns the orbit of a GPS satellite under the name of another satellite.
fn renamed(model: &Msg1019T, satellite: SatelliteId, week: u16) -> Ephemeris {
    let number = satellite.number();
    match satellite.constellation() {
        Constellation::Galileo => Ephemeris::GalileoInav(Msg1046T {
            gal_satellite_id: number,
            gal_week_number: week - raim_firmware::time::GALILEO_WEEK_OFFSET,
            iodnav: 9,
            sisa_e1_e5b_index: 107,
            toc_s: model.toc_s as _,
            toe_s: model.toe_s as _,
            sqrt_a_sqrt_m: model.sqrt_a_sqrt_m,
            eccentricity: model.eccentricity as _,
            m0_sc: model.m0_sc,
            omega0_sc: model.omega0_sc,
            omegadot_sc_s: model.omegadot_sc_s as _,
            i0_sc: model.i0_sc,
            omega_sc: model.omega_sc,
            ..Msg1046T::default()
        }),
        Constellation::Beidou => Ephemeris::Beidou(Msg1042T {
            bds_satellite_id: number,
            bds_week_number: week - raim_firmware::time::BEIDOU_WEEK_OFFSET,
            toc_s: model.toc_s as _,
            toe_s: model.toe_s as _,
            sqrt_a_sqrt_m: model.sqrt_a_sqrt_m,
            eccentricity: model.eccentricity as _,
            m0_sc: model.m0_sc,
            omega0_sc: model.omega0_sc,
            omegadot_sc_s: model.omegadot_sc_s as _,
            i0_sc: model.i0_sc,
            omega_sc: model.omega_sc,
            ..Msg1042T::default()
        }),
        _ => Ephemeris::Gps(Msg1019T { gps_satellite_id: number, ..model.clone() }),
    }
}

/// Encodes a set.
pub(in crate::attack) fn frame(set: &TimedEphemeris) -> Result<Vec<u8>> {
    let message = match &set.message {
        Ephemeris::Gps(message) => Message::Msg1019(message.clone()),
        Ephemeris::Beidou(message) => Message::Msg1042(message.clone()),
        Ephemeris::GalileoFnav(message) => Message::Msg1045(message.clone()),
        Ephemeris::GalileoInav(message) => Message::Msg1046(message.clone()),
        Ephemeris::Glonass(message) => Message::Msg1020(message.clone()),
        Ephemeris::Qzss(message) => Message::Msg1044(message.clone()),
    };
    let mut builder = MessageBuilder::new();
    let built = builder.build_message(&message).map_err(|error| anyhow::anyhow!("{error:?}"))?;
    Ok(built.to_vec())
}
