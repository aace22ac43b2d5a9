//! Seeds of fuzzing: a simulated sky as RTCM, as UBX and as SBF, its navigation bits, the commands of the
//! interface, and noise.

use raim::signal::encode::{Encoder, Frequency, Selection, sbf, ubx};
use raim::signal::measurement::TimedEphemeris;
use raim::signal::recording::Recording;
use raim::signal::sky::raw::Simulation;
use rand::rngs::ChaCha8Rng;
use rand::{Rng, SeedableRng};

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

    /// Returns the same as SBF.
    fn lumps_of_sbf(self) -> Vec<Vec<u8>> {
        let times = self.recording().epochs.into_iter().map(|epoch| epoch.time);
        self.lumps_of_ubx().iter().zip(times).map(|(lump, time)| sbf::of_ubx(lump, time)).collect()
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
        "sbf" => skies()
            .map(|sky| streamed(&sky.lumps_of_sbf()))
            .chain([streamed(&broadcasts::of_each().map(|one| sbf::of_ubx(&pages(&one), broadcasts::NOON)))])
            .chain([streamed(&decoded()), streamed(&reports())])
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

/// Returns decoded ephemerides of GPS, `BeiDou`, Galileo and GLONASS, in round numbers.
fn decoded() -> [Vec<u8>; 4] {
    let week = broadcasts::NOON.week % 1024;
    let body = |length: usize, doubles: &[(usize, f64)], words: &[(usize, u32)]| {
        let mut body = vec![0; length - 14];
        for &(at, double) in doubles {
            body[at - 14..at - 6].copy_from_slice(&double.to_le_bytes());
        }
        for &(at, word) in words {
            body[at - 14..at - 10].copy_from_slice(&word.to_le_bytes());
        }
        body
    };
    let toe = broadcasts::NOON.tow_ms / 1000;
    let weeks = |week: u16| u32::from(week) << 16 | u32::from(week);
    let kepler = |sqrt_a| [(80, sqrt_a), (68, 0.01), (108, 0.305)];
    let mut gps = body(140, &kepler(5153.6), &[(32, toe), (88, toe), (136, weeks(week))]);
    gps[0] = 7;
    let of_beidou = weeks(broadcasts::NOON.week - 1356);
    let mut beidou = body(140, &kepler(5282.6), &[(32, toe), (88, toe), (136, of_beidou)]);
    beidou[0] = 141 + 20;
    let mut galileo = body(
        152,
        &[(16, 5440.6), (32, 0.001), (40, 0.31)],
        &[(100, toe), (104, toe), (124, weeks(broadcasts::NOON.week)), (128, 0x11 << 16), (132, 107 << 16)],
    );
    (galileo[0], galileo[1]) = (75, 2);
    let mut glonass = body(100, &[(16, 25_508.0)], &[(76, toe), (80, week.into()), (94, 250)]);
    // Kilometres a second along the axis behind that of the position.
    glonass[30..34].copy_from_slice(&3.95_f32.to_le_bytes());
    glonass[0] = 40;
    [(5891, gps), (4081, beidou), (4002, galileo), (4004, glonass)]
        .map(|(number, body)| sbf::block(number, broadcasts::NOON, &body))
}

/// Returns each of the receiver's reports, with interference, and the blocks of ionosphere and UTC.
fn reports() -> [Vec<u8>; 6] {
    let bodies: [(u16, &[u8]); 6] = [
        (4092, &[1, 8, 0b01, 0, 0, 0, 0, 0, 0, 0, 0, 0, 8, 0]),
        (
            4245,
            &[
                6, 0, 0, 0, 0, 0, 15, 0, 0, 0, 0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
                0, 0, 0, 0, 0, 0, 0,
            ],
        ),
        (4001, &[9, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x60, 0x40, 0, 0, 0xA0, 0x40]),
        (4011, &[0, 0, 0, 0, 0xF0, 0x40, 0, 0, 0x44, 0x41]),
        (
            5893,
            &[
                29, 0, 0, 0, 0x0C, 0x33, 0, 0, 0x80, 0x32, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 6, 0x48, 0, 0, 0x80,
                0x46, 0, 0, 0, 0, 0, 0, 0, 0,
            ],
        ),
        (5894, &[29, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 56, 18, 137, 7, 18]),
    ];
    bodies.map(|(number, body)| sbf::block(number, broadcasts::NOON, body))
}

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
