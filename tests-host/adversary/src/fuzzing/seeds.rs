//! Seeds of fuzzing: a simulated sky as RTCM and as UBX, its navigation bits, the commands of the
//! interface, and noise.

use raim::signal::encode::{Encoder, Frequency, Selection, ubx};
use raim::signal::measurement::TimedEphemeris;
use raim::signal::recording::Recording;
use raim::signal::sky::raw::Simulation;
use rand::{RngCore, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::broadcasts;
use super::navigation_bits::MESSAGES;

/// Station coordinates, message 1005: the example of [RTCM-10403.3] 4.1.
///
/// [RTCM-10403.3]: raim#references
pub(super) const STATION: [u8; 25] = [
    0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98, 0x0E, 0xDE, 0xEF, 0x34, 0xB4, 0xBD, 0x62, 0xAC,
    0x09, 0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98,
];

/// One command of each kind.
const COMMANDS: &str = "\
$PRAIC,PHASE,LPV200*\n$PRAIC,PHASE,ENROUTE*\n$PRAIC,PHASE,CUSTOM*\n$PRAIC,HAL,40.5*\n$PRAIC,VAL,35*\n$PRAIC,VAL,OFF*\n\
$PRAIC,PFA,1e-5*\n$PRAIC,PMD,1e-4*\n$PRAIC,TTA,6*\n$PRAIC,MASK,5*\n$PRAIC,POLICY,TOP*\n$PRAIC,METHOD,RANSAC*\n\
$PRAIC,METHOD,HYBRID*\n$PRAIC,CLOCKAID,ON*\n\
$PRAIC,IONO,1.1e-8,7.4e-9,-5.9e-8,0,96256,16384,-65536,-196608*\n$PRAIC,STATS*\n$PRAIC,SELFTEST*\n$PRAIC,RESET*\n";

/// A receiver above some of the simulated satellites.
#[derive(Clone, Copy, Debug)]
pub struct Sky {
    /// RINEX letters of the systems that it sends, out of `GC`.
    pub systems: &'static str,
    /// Number of signals.
    pub frequency: Frequency,
    /// Number of satellites in view, of both systems.
    pub satellites: usize,
    /// Number of epochs, one per second.
    pub epochs: u32,
}

impl Sky {
    /// Ten satellites for two epochs: enough for protection.
    pub const TEN: Self = Self { systems: "GC", frequency: Frequency::Dual, satellites: 10, epochs: 2 };

    /// Returns RTCM: one lump per epoch, ephemerides in the first.
    pub fn lumps(self) -> Vec<Vec<u8>> {
        let recording = self.recording();
        let mut encoder = Encoder::new(&recording.ephemerides, self.selection());
        recording.epochs.iter().map(|epoch| encoder.epoch(epoch).expect("numbers that fit")).collect()
    }

    /// Returns the same as UBX.
    fn lumps_of_ubx(self) -> Vec<Vec<u8>> {
        let recording = self.recording();
        let mut encoder = ubx::Encoder::new(&recording.ephemerides, self.selection(), Some(SAID));
        recording.epochs.iter().map(|epoch| encoder.epoch(epoch).expect("numbers that fit")).collect()
    }

    fn selection(self) -> Selection {
        Selection::new(self.systems, self.frequency).expect("systems that are known")
    }

    fn recording(self) -> Recording {
        let mut simulation = Simulation::above_xian(3600.0, self.epochs, 11);
        let seen = simulation.sights_at(0);
        let spread = |index| seen.get(index * seen.len() / self.satellites);
        let kept: Vec<_> = (0..self.satellites).filter_map(spread).collect();
        simulation.satellites.retain(|satellite| kept.iter().any(|sight| sight.satellite == satellite.id));
        simulation.record()
    }
}

/// Ionosphere coefficients in round numbers, and the last leap second, as satellites send them.
const SAID: ubx::IonosphereAndUtc = ubx::IonosphereAndUtc {
    klobuchar: [1.12e-8, 1.49e-8, -5.96e-8, -1.19e-7, 8.19e4, 9.83e4, -6.55e4, -5.24e5],
    leap_s: (17, 18),
    change: (1929, 7),
};

/// Returns the seeds of a target, by its name.
pub fn of(target: &str) -> Vec<Vec<u8>> {
    match target {
        "stream" => {
            skies().map(|sky| streamed(&sky.lumps())).chain([streamed(&[STATION.to_vec()])]).collect()
        }
        "ubx" => skies()
            .map(|sky| streamed(&sky.lumps_of_ubx()))
            .chain([streamed(&broadcasts::of_each().map(|broadcast| pages(&broadcast)))])
            .chain([streamed(&SECURITY.map(|(kind, payload)| ubx::frame(kind, payload)))])
            .collect(),
        "navigation_bits" => navigation_bits().collect(),
        "command" => COMMANDS.split_inclusive('\n').chain([COMMANDS]).map(commanded).collect(),
        _ => (0..40).map(|seed| noise(seed, 200 + 20 * seed as usize)).collect(),
    }
}

/// SEC-SIG of both versions and NAV-STATUS, with jamming and spoofing detected.
const SECURITY: [([u8; 2], &[u8]); 3] = [
    ([0x27, 0x09], &[1, 0, 0, 0, 0b111, 0, 0, 0, 0b0101, 0, 0, 0]),
    ([0x27, 0x09], &[2, 0b0010_1111, 0, 0]),
    ([0x01, 0x03], &[0, 0, 0, 0, 3, 0xDD, 0, 0b1_0000, 0, 0, 0, 0, 0, 0, 0, 0]),
];

fn pages(broadcast: &TimedEphemeris) -> Vec<u8> {
    ubx::pages(broadcast, broadcasts::NOON).expect("numbers that fit")
}

/// Returns the sets of each message, alone and one after another, as the words of the frames that
/// the target reads.
fn navigation_bits() -> impl Iterator<Item = Vec<u8>> {
    /// Size of header, fields before the words, and checksums.
    const AROUND: usize = 6 + 8 + 2;
    let sets: Vec<Vec<u8>> = broadcasts::of_each()
        .iter()
        .enumerate()
        .map(|(index, broadcast)| {
            let length = 4 * MESSAGES[index].0.words();
            let opening = [index as u8, broadcast.satellite.number() - 1];
            let bytes = pages(broadcast);
            let frames = bytes.chunks(AROUND + length);
            frames.flat_map(|frame| [&opening[..], &frame[14..14 + length]].concat()).collect()
        })
        .collect();
    let all = sets.concat();
    sets.into_iter().chain([all])
}

/// Returns each system alone and both, one signal and two, from a lone satellite to more than a fix
/// needs.
fn skies() -> impl Iterator<Item = Sky> {
    let few = [(1, 1), (4, 2), (8, 2), (12, 1), (16, 3)];
    let selections = ["G", "C", "GC"]
        .into_iter()
        .flat_map(|systems| [Frequency::Single, Frequency::Dual].map(|frequency| (systems, frequency)));
    selections.flat_map(move |(systems, frequency)| {
        few.map(|(satellites, epochs)| Sky { systems, frequency, satellites, epochs })
    })
}

/// Frames receive their CRC, and a second passes after every chunk.
fn streamed(lumps: &[Vec<u8>]) -> Vec<u8> {
    [&[0, 60], lumps.concat().as_slice()].concat()
}

fn commanded(lines: &str) -> Vec<u8> {
    [&[0], lines.as_bytes()].concat()
}

fn noise(seed: u64, length: usize) -> Vec<u8> {
    let mut bytes = vec![0; length];
    ChaCha8Rng::seed_from_u64(seed).fill_bytes(&mut bytes);
    bytes
}
