//! Signals out of service, if one of two messages says so and the other does not.
//!
//! The sky has about eight Galileo satellites and no others. I/NAV calls E1 and E5b healthy. F/NAV
//! says that E5a is out of service, and gives no accuracy for it. The ranges on E5a are wrong and
//! agree on a place beside the true one. A module that combines E1 and E5a by the health of I/NAV
//! computes that place.
//!
//! ```text
//! ρ_E5a' = ρ_E5a − LOS · d
//! ```

use anyhow::anyhow;
use raim::signal::sky::Satellite;
use raim::signal::sky::orbit::Orbit;
use rtcm_rs::msg::Msg1045T;
use rtcm_rs::{Message, MessageBuilder};

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "health",
    about: "Galileo's E5a out of service by F/NAV, healthy I/NAV, ranges on E5a that agree on a place 40 m away",
    branch: Branch::Orbits,
    before: "79 m off under an HPL of 22 m, with eight such",
    note: "E5a is not used",
    run,
};

/// Offset of the place on which the E5a ranges agree from the true place, m.
const AWAY: Enu = Enu { east: 30.0, north: 25.0, up: -10.0 };

/// Semi-major axis, m, and inclination, degrees, of the Walker constellation 24/3/1
/// ([Galileo-OS-SIS-ICD] §4).
///
/// [Galileo-OS-SIS-ICD]: raim#references
const AXIS_M: f64 = 29_600_318.0;
const INCLINATION_DEG: f64 = 56.0;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let epochs = effort.pick(60, 600);
    let simulation = Simulation { satellites: fleet(), ..Simulation::above_xian(3600.0, epochs, 4) };
    let mut recording = simulation.record();
    let truth = simulation.site.position;
    // F/NAV of each satellite, with the orbit of its I/NAV.
    let out_of_service: Vec<u8> = recording
        .ephemerides
        .iter()
        .filter_map(|set| match &set.message {
            Ephemeris::GalileoInav(message) => Some(Message::Msg1045(Msg1045T {
                gal_satellite_id: message.gal_satellite_id,
                gal_week_number: message.gal_week_number,
                iodnav: message.iodnav,
                // 255 means that no accuracy is given.
                sisa_e1_e5a_index: 255,
                toc_s: message.toc_s,
                af1_s_s: message.af1_s_s,
                af0_s: message.af0_s,
                delta_n_sc_s: message.delta_n_sc_s,
                m0_sc: message.m0_sc,
                eccentricity: message.eccentricity,
                sqrt_a_sqrt_m: message.sqrt_a_sqrt_m,
                toe_s: message.toe_s,
                omega0_sc: message.omega0_sc,
                i0_sc: message.i0_sc,
                omega_sc: message.omega_sc,
                omegadot_sc_s: message.omegadot_sc_s,
                // 1 means out of service.
                e5a_sig_health_ind: 1,
                ..Msg1045T::default()
            })),
            _ => None,
        })
        .map(|message| {
            let mut builder = MessageBuilder::new();
            builder.build_message(&message).map(<[u8]>::to_vec).map_err(|error| anyhow!("{error:?}"))
        })
        .collect::<Result<Vec<_>>>()?
        .concat();
    for (index, epoch) in recording.epochs.iter_mut().enumerate() {
        forge(epoch, &simulation.sights_at(index as u32));
    }
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new("E", Frequency::Dual)?);
    let (mut victim, mut tally) = (Victim::new(&[], 1.0)?, Tally::default());
    for epoch in &recording.epochs {
        // I/NAV comes first, then F/NAV, then the ranges: in this order the module knows everything
        // in time.
        let bytes = [out_of_service.clone(), encoder.epoch(epoch)?].concat();
        tally.add_all(&victim.receive(&bytes, truth)?);
    }
    Ok(tally.figures(0.0))
}

/// Moves the ranges on E5a.
fn forge(epoch: &mut MeasuredEpoch, sights: &[Sight]) {
    for raw in &mut epoch.satellites {
        let Some(sight) = sights.iter().find(|sight| sight.satellite == raw.satellite) else { continue };
        let los = sight.line_of_sight;
        let along_m = los.east * AWAY.east + los.north * AWAY.north + los.up * AWAY.up;
        for signal in raw.signals.iter_mut().filter(|signal| signal.band == 5) {
            signal.pseudorange_m -= along_m;
        }
    }
}

/// Returns the 24 satellites of the Galileo reference constellation.
fn fleet() -> Vec<Satellite> {
    let slot = |index: u8| {
        let (plane, place) = (f64::from(index / 8), f64::from(index % 8));
        let orbit = Orbit::circular(
            AXIS_M,
            INCLINATION_DEG.to_radians(),
            (120.0 * plane).to_radians(),
            (45.0 * place + 15.0 * plane).to_radians(),
        );
        SatelliteId::new(Constellation::Galileo, index + 1).map(|id| Satellite { id, orbit })
    };
    (0..24).filter_map(slot).collect()
}
