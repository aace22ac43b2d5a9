//! Group delays that the message in use does not carry.
//!
//! D1 carries the delays of B1I and B2I, but not those of `BeiDou`'s B1C and B2a. Some receivers
//! report B2b as B2I, and satellites of the third generation send the same delay for B2I as for
//! B1I.
//!
//! A receiver of the bands L1 and L5 pairs B1C with B2a, and combining multiplies their delays by
//! 2.3 and 1.3. The delays here are those of real satellites, derived from ranges of two stations
//! against B1I and B3I with the delays of D1 ([`DELAYS_M`]).
//!
//! ```text
//! ρ_b' = ρ_b + c τ_b        τ_B1C = TGD1 within 1.5 m, 0.6 m rms        τ_B2a, τ_B2b within 3.5 m, 1.4 m rms, whatever TGD1
//! ```

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "unsaid-delays",
    about: "BeiDou's third generation on B1C and B2a, and on B1I and B2b labelled B2I, with the group delays of 18 real satellites, which D1 does not contain",
    branch: Branch::Several,
    before: "9 of 12,689 beyond; of 19,200 epochs 5,261 alerts, 273 healthy satellites excluded",
    note: "",
    run,
};

/// `TGD1` as broadcast, and the delays of B1C, B2a and B2b against B3I, m. Ten satellites are from
/// `tlse`, eight from `kms3`; each is relative to the mean of its station, which is the receiver's
/// delay.
const DELAYS_M: [[f64; 4]; 18] = [
    [2.8, 1.5, 2.0, 2.1],
    [3.6, 2.3, 2.2, 2.1],
    [6.7, 5.7, 0.9, 0.7],
    [-1.4, -2.4, -1.1, -0.5],
    [-2.3, -2.2, 0.4, -0.2],
    [-2.0, -2.6, -1.4, -0.9],
    [-5.0, -5.1, -0.9, -0.7],
    [0.1, -1.7, -0.3, -0.2],
    [-1.0, -1.5, 0.2, -0.2],
    [5.5, 6.1, -2.0, -2.2],
    [-1.6, 0.4, -1.1, -1.1],
    [-0.2, 1.9, -1.3, -1.9],
    [-3.1, -1.2, -1.3, -1.3],
    [-1.0, 1.0, -1.0, -0.4],
    [-6.6, -4.0, 0.9, 0.9],
    [0.6, 2.9, -0.8, -1.5],
    [-7.2, -4.2, 2.9, 3.3],
    [-8.3, -5.1, -1.2, -1.4],
];

/// Signals that a receiver sends of each satellite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sent {
    /// B1C and B2a.
    Pairs,
    /// B1C alone.
    Singles,
    /// B1I, and B2b as B2I.
    Misnamed,
}

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for (sent, bands) in
        [(Sent::Pairs, "B1C and B2a"), (Sent::Singles, "B1C"), (Sent::Misnamed, "B1I and B2b as B2I")]
    {
        let seeds = 0..effort.pick(1200, 4800);
        let tally: Tally = seeds.map(|seed| attempt(seed, sent)).collect::<Result<_>>()?;
        figures.push(Figure::plain(format!("epochs of {bands}"), tally.epochs()));
        figures.push(Figure::plain("protected", tally.promised()));
        figures.push(Figure::at_most("beyond their level", tally.misleading(), 0.0));
        figures.push(Figure::at_most("healthy satellites left out", tally.left_out as f64, 0.0));
        figures.push(Figure::at_most("alerts", tally.alerts(), 0.0));
        figures.push(Figure::plain("largest error of them, m", tally.worst_m()));
    }
    Ok(figures)
}

fn attempt(seed: u64, sent: Sent) -> Result<Tally> {
    let simulation = Simulation {
        // Satellites of the third generation, which send both bands.
        satellites: Fleet::Beidou24.satellites(),
        // Without electrons the ranges on B1I and B3I equal those on B1C and B2a.
        electrons_tecu: 0.0,
        ..Simulation::above_xian(900.0 + 3600.0 * (seed % 24) as f64 + 150.0 * (seed / 24) as f64, 2, seed)
    };
    let frequency = if sent == Sent::Singles { Frequency::Single } else { Frequency::Dual };
    let mut sky = Sky::with(&simulation, "C", frequency)?;
    let delays = |number: u8| DELAYS_M[(usize::from(number) + seed as usize) % DELAYS_M.len()];
    for set in &mut sky.recording.ephemerides {
        let [tgd1_m, ..] = delays(set.satellite.number());
        if let Ephemeris::Beidou(message) = &mut set.message {
            message.tgd1_s = (tgd1_m / SPEED_OF_LIGHT_M_S) as f32;
            // Satellites of the third generation send it so.
            message.tgd2_s = message.tgd1_s;
        }
    }
    let bytes = sky.bytes(|_, epoch| {
        for raw in &mut epoch.satellites {
            let [tgd1_m, b1c_m, b2a_m, b2b_m] = delays(raw.satellite.number());
            for signal in &mut raw.signals {
                let (band, attribute, delay_m) = match (sent, signal.band) {
                    (Sent::Misnamed, 2) => (2, 'I', tgd1_m),
                    (Sent::Misnamed, _) => (7, 'I', b2b_m),
                    (_, 2) => (1, 'X', b1c_m),
                    _ => (5, 'X', b2a_m),
                };
                (signal.band, signal.attribute) = (band, attribute);
                signal.pseudorange_m += delay_m;
            }
        }
    })?;
    Victim::new(&[], 1.0)?.judge(&bytes, sky.truth)
}
