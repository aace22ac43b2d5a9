//! False beginnings of frames before the epochs of a line that never falls silent for long: the pin
//! is as early as without them.

use raim::signal::encode::{Encoder, Frequency, Selection, ubx};
use raim::signal::sky::raw::Simulation;
use rig::paced::{Costs, Lines, run};

const FULL_HZ: u64 = 168_000_000;
/// Cost of an epoch, cycles.
const EPOCH: u64 = 2_200_000;
/// Longest time from an epoch's last byte to the pin, ms, as without false beginnings.
const BOUND_MS: f64 = 20.0;

/// Number of epochs before the measurement, in which orbits come.
const QUIET: usize = 3;

/// Returns the beginning of an RTCM frame with a payload of this length.
fn rtcm(length: u16) -> Vec<u8> {
    [&[0xD3][..], &length.to_be_bytes()].concat()
}

/// Returns the beginning of a UBX frame.
fn ubx_of(message: [u8; 2], length: u16) -> Vec<u8> {
    [&[0xB5, 0x62][..], &message, &length.to_le_bytes()].concat()
}

/// Returns the beginning of an RXM-RAWX whose number of measurements also explains its length.
fn rawx_of(many: u8) -> Vec<u8> {
    let mut bytes = ubx_of([0x02, 0x15], 16 + 32 * u16::from(many));
    bytes.extend([0; 11]);
    bytes.push(many);
    bytes
}

/// Returns the same of a NAV-SIG and its number of signals.
fn nav_sig_of(many: u8) -> Vec<u8> {
    let mut bytes = ubx_of([0x01, 0x43], 8 + 16 * u16::from(many));
    bytes.extend([0, 0, 0, 0, 0, many]);
    bytes
}

/// Returns false beginnings of every protocol, with lengths over the whole range of each.
fn beginnings() -> Vec<Vec<u8>> {
    let mut all: Vec<Vec<u8>> = (0..=1023).step_by(93).map(rtcm).collect();
    all.extend((0..=1023).step_by(93).map(|length| ubx_of([0x01, 0x07], length)));
    all.extend((0..=255).step_by(15).map(|many| ubx_of([0x02, 0x15], 16 + 32 * many)));
    all.extend((0..=255).step_by(15).map(rawx_of));
    all.extend((0..=255).step_by(51).map(nav_sig_of));
    // Many in a row, and one inside another.
    all.extend([rtcm(1023).repeat(20), ubx_of([0x02, 0x15], 16 + 32 * 255).repeat(20)]);
    all.push([rawx_of(255), rtcm(1023), ubx_of([0x01, 0x07], 1000)].concat().repeat(4));
    all
}

/// Returns the same epochs in either format.
fn lumps() -> [(&'static str, Vec<Vec<u8>>); 2] {
    let recording = Simulation::above_xian(3600.0, 9, 11).record();
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    let mut by_rtcm = Encoder::new(&recording.ephemerides, selection.clone());
    let mut by_ubx = ubx::Encoder::new(&recording.ephemerides, selection, None);
    [
        ("RTCM", recording.epochs.iter().map(|epoch| by_rtcm.epoch(epoch).unwrap()).collect()),
        ("UBX", recording.epochs.iter().map(|epoch| by_ubx.epoch(epoch).unwrap()).collect()),
    ]
}

#[test]
fn a_false_beginning_before_each_epoch_delays_no_pin() {
    for (format, lumps) in lumps() {
        for beginning in beginnings() {
            let before = |(index, lump): (usize, &Vec<u8>)| {
                let false_bytes: &[u8] = if index < QUIET { &[] } else { &beginning };
                [false_bytes, lump].concat()
            };
            let spoilt: Vec<Vec<u8>> = lumps.iter().enumerate().map(before).collect();
            for rate_hz in [1, 2, 5, 10, 20] {
                let lines = Lines {
                    gnss_baud: 460_800,
                    host_baud: 115_200,
                    period_ns: 1_000_000_000 / rate_hz,
                    flood: &[],
                    host_reads: true,
                };
                let have = run(&spoilt, QUIET, lines, Costs::measured(FULL_HZ, EPOCH));
                let case =
                    format!("{format} at {rate_hz} Hz, {:02X?}", &beginning[..beginning.len().min(24)]);
                assert_eq!(have.lateness_ns.len(), lumps.len() - QUIET, "{case}: {:?}", have.counters);
                assert!(have.latest_ms() <= BOUND_MS, "{case}: {:.1} ms late", have.latest_ms());
                assert_eq!(
                    have.counter("epochs_protected") as usize,
                    lumps.len(),
                    "{case}: {:?}",
                    have.counters
                );
            }
        }
    }
}

/// The line is noisy once, and the pin falls as early as without noise.
#[test]
fn a_false_beginning_before_a_fault_delays_no_alarm() {
    for (format, lumps) in lumps() {
        let spoilt: Vec<Vec<u8>> = lumps
            .iter()
            .enumerate()
            .map(|(index, lump)| {
                let false_bytes = if index == 5 { ubx_of([0x02, 0x15], 16 + 32 * 255) } else { Vec::new() };
                [false_bytes, lump.clone()].concat()
            })
            .collect();
        for rate_hz in 1..=20 {
            let lines = Lines {
                gnss_baud: 460_800,
                host_baud: 115_200,
                period_ns: 1_000_000_000 / rate_hz,
                flood: &[],
                host_reads: true,
            };
            let have = run(&spoilt, QUIET, lines, Costs::measured(FULL_HZ, EPOCH));
            assert_eq!(have.lateness_ns.len(), lumps.len() - QUIET, "{format} at {rate_hz} Hz");
            assert!(have.latest_ms() <= BOUND_MS, "{format} at {rate_hz} Hz: {:.1} ms", have.latest_ms());
        }
    }
}
