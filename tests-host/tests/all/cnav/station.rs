//! A day of a station with frames of its own satellites.
//!
//! The ranges are of 2020 and the frames of 2025, because delays hardly change while a satellite
//! lives. G14 and G23 were replaced meanwhile and are left out.

use std::collections::{BTreeMap, BTreeSet};

use raim::signal::encode::ubx::{self, CnavMessage};
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::measurement::{Ephemeris, MeasuredEpoch, MeasuredSatellite, TimedEphemeris};
use raim::signal::recording::Recording;
use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::SPEED_OF_LIGHT_M_S;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::correction::{CAPACITY, Site, Sky, Tally, ionosphere_free, locate};
use raim_firmware::ephemeris::Store;
use raim_firmware::input::{Event, Input};
use raim_firmware::pin::MemoryPin;
use raim_firmware::raw::Band;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::settings::Systems;
use raim_firmware::time::GpsTime;
use rig::stations::ESBC;

use super::{delays, gps, heard, unpacked};

type Delays = BTreeMap<SatelliteId, [i16; 5]>;

/// Interval between the frames of a satellite, s.
const REPEATED_S: f64 = 120.0;

/// Returns what satellites sent in 2025 that flew in 2020: an hour of L2C and L5 and a walk.
fn recorded_delays() -> Option<Delays> {
    let text = unpacked("data/cnav/046r_gpscnav.txt.gz")?;
    let mut all = Delays::new();
    for line in std::str::from_utf8(&text).unwrap().lines() {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let digits = fields[5];
        let word = |at: usize| u32::from_str_radix(&digits[8 * at..8 * at + 8], 16).unwrap();
        let words: Vec<u32> = (0..10).map(word).collect();
        all.extend(delays(&heard(&ubx::subframe(gps(fields[2].parse().unwrap()), 6, &words)).0));
    }
    all.extend(delays(&heard(&unpacked("data/real/x20p_walk.ubx.gz")?).0));
    all.retain(|satellite, _| ![14, 23].contains(&satellite.number()));
    Some(all)
}

/// Returns the day with these bands of GPS, without P(Y).
fn with_bands(recording: &Recording, bands: &[u8]) -> Vec<MeasuredEpoch> {
    let kept = |satellite: &MeasuredSatellite| {
        let mut satellite = satellite.clone();
        if satellite.satellite.constellation() == Constellation::Gps {
            satellite.signals.retain(|signal| bands.contains(&signal.band) && signal.attribute != 'W');
        }
        satellite
    };
    let epoch = |epoch: &MeasuredEpoch| {
        let mut satellites: Vec<MeasuredSatellite> = epoch.satellites.iter().map(kept).collect();
        satellites.retain(|satellite| !satellite.signals.is_empty() && !satellite.satellite.is_qzss());
        MeasuredEpoch { time: epoch.time, satellites }
    };
    recording.epochs.iter().map(epoch).collect()
}

/// Returns the day as UBX, a lump of bytes for each epoch; with the frames of the satellites in view.
///
/// The encoder sends two bands of a satellite. A third one goes into the same RXM-RAWX.
fn lumps(recording: &Recording, systems: &str, bands: &[u8], told: Option<&Delays>) -> Vec<Vec<u8>> {
    let selection = Selection::new(systems, Frequency::Dual).unwrap();
    let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection, None);
    let mut sent: BTreeMap<SatelliteId, f64> = BTreeMap::new();
    let mut lump = |epoch: &MeasuredEpoch| {
        let mut bytes = Vec::new();
        for (satellite, steps) in told.into_iter().flatten() {
            let is_seen = epoch.satellites.iter().any(|seen| seen.satellite == *satellite);
            let now_s = epoch.time.to_s();
            if is_seen && sent.get(satellite).is_none_or(|then_s| now_s - then_s >= REPEATED_S) {
                sent.insert(*satellite, now_s);
                // As all satellites say: L1 and L2 in service, L5 not.
                for message in [CnavMessage::Health([false, false, true]), CnavMessage::Delays(*steps)] {
                    let words = ubx::cnav_words(*satellite, message, false, epoch.time).unwrap();
                    bytes.extend(ubx::subframe(*satellite, 3, &words));
                }
            }
        }
        bytes.extend(third_bands(encoder.epoch(epoch).unwrap(), epoch));
        bytes
    };
    with_bands(recording, bands).iter().map(&mut lump).collect()
}

/// Adds L5 of GPS to the ranges of a lump that has L1 and L2.
fn third_bands(mut lump: Vec<u8>, epoch: &MeasuredEpoch) -> Vec<u8> {
    let rawx = lump.windows(4).rposition(|bytes| bytes == [0xB5, 0x62, 0x02, 0x15]).unwrap();
    let mut payload = lump[rawx + 6..lump.len() - 2].to_vec();
    let mut measurements: Vec<Vec<u8>> = payload.split_off(16).chunks(32).map(<[u8]>::to_vec).collect();
    for satellite in &epoch.satellites {
        let is_l2 = |one: &&Vec<u8>| one[20..23] == [0, satellite.satellite.number(), 3];
        let l5 = satellite.signals.iter().find(|signal| (signal.band, signal.attribute) == (5, 'Q'));
        if satellite.satellite.constellation() != Constellation::Gps {
            continue;
        }
        if let Some((l5, mut copy)) = l5.zip(measurements.iter().find(is_l2).cloned()) {
            copy[..8].copy_from_slice(&l5.pseudorange_m.to_le_bytes());
            let doppler_hz = l5.doppler_hz.map_or(f32::NAN, |doppler_hz| doppler_hz as f32);
            copy[16..20].copy_from_slice(&doppler_hz.to_le_bytes());
            copy[22] = 7;
            copy[26] = l5.cn0_dbhz.map_or(0, |cn0_dbhz| cn0_dbhz.round() as u8);
            let place = measurements.iter().rposition(|one| one[20..22] == copy[20..22]).unwrap();
            measurements.insert(place + 1, copy);
        }
    }
    payload[11] = measurements.len() as u8;
    payload.extend(measurements.concat());
    lump.truncate(rawx);
    lump.extend(ubx::frame([0x02, 0x15], &payload));
    lump
}

/// Residuals of an epoch at the antenna, m.
type Residuals = BTreeMap<SatelliteId, f64>;

/// Returns the residuals of these satellites in each epoch, of pairs of bands alone.
fn residuals_m(lumps: &[Vec<u8>], is_one: impl Fn(SatelliteId) -> bool) -> Vec<(GpsTime, Residuals)> {
    let (mut input, mut store, mut now) = (Input::new(), Store::new(), None);
    let (mut sky, mut tally, mut epochs) = (Sky::new(), Tally::default(), Vec::new());
    for lump in lumps {
        input.feed(lump, 0, |event| match event {
            Event::Ephemeris(ephemeris) => drop(store.insert(ephemeris, now)),
            Event::Cnav(frame) => store.hear_cnav(&frame, 0),
            Event::Epoch(raw, _) => {
                now = Some(raw.time);
                let mut raw = raw.clone();
                raw.satellites.retain(|one| is_one(one.satellite) && one.signals.len() == 2);
                locate(&raw, &store, 28.0, Systems::AT_START, &mut tally, &mut sky);
                let mut epoch = Epoch::<CAPACITY>::new(0.0);
                let site = Site::new(ESBC.truth, raw.time, 10_f64.to_radians(), None);
                site.correct(&sky, &mut tally, &mut epoch);
                let residual = |seen: &Observation| {
                    (seen.satellite, seen.range_m - seen.position.distance_m(ESBC.truth))
                };
                epochs.push((raw.time, epoch.observations().iter().map(residual).collect()));
            }
            _ => {}
        });
    }
    epochs
}

/// Returns the mean over the day of each satellite's residual less its residual by P(Y), to which its
/// clock refers, m; less the mean of all. Orbit, clock and air cancel, and its delays remain.
fn mean_residuals_m(
    lumps: &[Vec<u8>],
    by_p_m: &BTreeMap<u64, Residuals>,
    of: &BTreeSet<SatelliteId>,
) -> Residuals {
    let mut sums: BTreeMap<SatelliteId, (f64, f64)> = BTreeMap::new();
    for (time, residuals) in residuals_m(lumps, |satellite| of.contains(&satellite)) {
        let Some(by_p_m) = by_p_m.get(&time.to_ms()) else { continue };
        for (satellite, residual_m) in residuals {
            if let Some(by_p_m) = by_p_m.get(&satellite) {
                let (sum_m, count) = sums.entry(satellite).or_default();
                (*sum_m, *count) = (*sum_m + residual_m - by_p_m, *count + 1.0);
            }
        }
    }
    let mean_m = sums.values().map(|(sum_m, count)| sum_m / count).sum::<f64>() / sums.len() as f64;
    sums.iter().map(|(one, (sum_m, count))| (*one, sum_m / count - mean_m)).collect()
}

/// Returns the residuals of L1 and L2 by P(Y), by time.
fn by_p_m(recording: &Recording) -> BTreeMap<u64, Residuals> {
    let selection = Selection::new("G", Frequency::Dual).unwrap();
    let mut encoder = Encoder::new(&recording.ephemerides, selection);
    let lumps: Vec<Vec<u8>> = recording.epochs.iter().map(|epoch| encoder.epoch(epoch).unwrap()).collect();
    residuals_m(&lumps, |_| true).into_iter().map(|(time, residuals)| (time.to_ms(), residuals)).collect()
}

fn rms<'v>(values: impl Iterator<Item = &'v f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    f64::sqrt(sum / count)
}

#[test]
fn the_residuals_of_l1_and_l5_at_the_antenna_fall_below_half_a_metre() {
    let (Some(mut recording), Some(told)) = (ESBC.load(), recorded_delays()) else { return };
    // Every third epoch is enough for a mean.
    recording.epochs = recording.epochs.into_iter().step_by(3).collect();
    let by_p_m = by_p_m(&recording);
    for (name, bands, most_m, least_gain) in [("L1/L5", [1, 5], 0.5, 3.0), ("L1/L2C", [1, 2], 0.5, 1.0)] {
        let of: BTreeSet<SatelliteId> =
            told.iter().filter(|(_, steps)| bands[1] == 2 || steps[3] != 0).map(|(one, _)| *one).collect();
        let before = mean_residuals_m(&lumps(&recording, "G", &bands, None), &by_p_m, &of);
        let after = mean_residuals_m(&lumps(&recording, "G", &bands, Some(&told)), &by_p_m, &of);
        for (satellite, before_m) in &before {
            println!("{name} {satellite}: {before_m:5.2} → {:5.2} m", after[satellite]);
        }
        let [before_m, after_m] = [rms(before.values()), rms(after.values())];
        println!("{name}: {before_m:.2} → {after_m:.2} m rms of {} satellites", after.len());
        assert_eq!(before.len(), after.len());
        assert!(after_m < most_m && before_m > least_gain * after_m, "{name}: {before_m} → {after_m}");
    }
}

/// Result of a day.
#[derive(Debug)]
struct Day {
    /// Median of the horizontal protection level, m.
    median_hpl_m: f64,
    epochs: usize,
    is_protected: usize,
    /// Number of satellites that were excluded, over all epochs.
    excluded: usize,
    misleading: usize,
    /// Number of epochs that report an unhealthy L5 in use.
    unhealthy: usize,
    /// State, position, levels and satellites of each epoch.
    reported: Vec<String>,
}

fn day(lumps: &[Vec<u8>], setup: &[(&str, &str)]) -> Day {
    let mut receiver = Receiver::new(MemoryPin::default(), Boot::on_host("cnav")).unwrap();
    for (key, values) in setup {
        receiver.set(key, Some(values), &mut Vec::new()).unwrap();
    }
    let (mut levels_m, mut reported) = (Vec::new(), Vec::new());
    let (mut is_protected, mut excluded, mut misleading, mut unhealthy) = (0, 0, 0, 0);
    for (epoch, lump) in (0_u64..).zip(lumps) {
        let mut sentences = Vec::new();
        receiver.gnss(lump, 30_000 * epoch, &mut sentences);
        let Some(report) = receiver.last_report() else { continue };
        let sentences = String::from_utf8(sentences).unwrap();
        unhealthy += usize::from(sentences.contains("$PRAIE"));
        excluded += report.excluded.len();
        if let (Some(levels), Some(solution)) = (report.protection, &report.solution) {
            levels_m.push(levels.hpl_m);
            if receiver.pin().high {
                is_protected += 1;
                let error_m = solution.position.distance_m(ESBC.truth);
                misleading += usize::from(error_m > levels.hpl_m.hypot(levels.vpl_m));
            }
        }
        reported.extend(
            sentences
                .lines()
                .filter(|line| line.starts_with("$GNGGA") || line.starts_with("$PRAIS"))
                .map(without_tracked),
        );
    }
    levels_m.sort_by(f64::total_cmp);
    let median_hpl_m = levels_m[levels_m.len() / 2];
    Day { median_hpl_m, epochs: lumps.len(), is_protected, excluded, misleading, unhealthy, reported }
}

/// Returns a sentence without its checksum; `PRAIS` without the number of satellites that the receiver
/// tracks, of which some send L5 alone.
fn without_tracked(line: &str) -> String {
    let body = line.split('*').next().unwrap();
    let kept = body.split(',').enumerate().filter(|(index, _)| *index != 4 || !line.starts_with("$PRAIS"));
    kept.map(|(_, field)| field).collect::<Vec<_>>().join(",")
}

fn say(name: &str, day: &Day) {
    let Day { median_hpl_m, epochs, is_protected, excluded, misleading, unhealthy, .. } = day;
    println!(
        "{name}: median HPL {median_hpl_m:.2} m, {is_protected} of {epochs} protected, {excluded} excluded, \
         {misleading} misleading, {unhealthy} epochs with an unhealthy L5"
    );
}

/// Returns the delays of all satellites with L5: recorded, or those that the day itself shows beside
/// P(Y), on L5 alone.
fn all_delays(recording: &Recording, told: &Delays) -> Delays {
    const STEP_S: f64 = 1.0 / (1_u64 << 35) as f64;
    let any: BTreeSet<SatelliteId> = (1..=32).map(gps).collect();
    let by_lnav_m = mean_residuals_m(&lumps(recording, "G", &[1, 5], None), &by_p_m(recording), &any);
    let group_delay_s = |satellite| {
        let set = |one: &TimedEphemeris| match &one.message {
            Ephemeris::Gps(message) if one.satellite == satellite => Some(f64::from(message.tgd_s)),
            _ => None,
        };
        recording.ephemerides.iter().find_map(set).unwrap()
    };
    let mut all = told.clone();
    for (satellite, residual_m) in by_lnav_m {
        // Factor of L5 in the combination; that of L2 makes the delay of L2 that LNAV has.
        let (_, factor) = ionosphere_free(Band::L1, Band::L5);
        let squared = (Band::L1.frequency_hz() / Band::L2.frequency_hz()).powi(2);
        let group_s = group_delay_s(satellite);
        let of_l5_s = -residual_m / factor / SPEED_OF_LIGHT_M_S;
        let delays_s = [group_s, 0.0, (1.0 - squared) * group_s, of_l5_s, of_l5_s];
        all.entry(satellite).or_insert(delays_s.map(|delay_s| (delay_s / STEP_S).round() as i16));
    }
    all
}

mod at_length {
    use super::*;

    /// An X20P measures L1, L2C and L5, receivers of two bands L1 and L5. Seven of the 14 satellites with L5
    /// have recorded delays. With them alone, the levels of L1 and L5 under `FREQ,AUTO` hardly change.
    #[test]
    fn levels_fall_under_tracked_and_no_l5_is_used_under_healthy() {
        let (Some(recording), Some(told)) = (ESBC.load(), recorded_delays()) else { return };
        let ionosphere = recording.klobuchar.unwrap().map(|value| format!("{value:e}")).join(",");
        let all = all_delays(&recording, &told);
        for bands in [&[1, 5][..], &[1, 2, 5]] {
            let of_bands = |bands: &[u8], told| lumps(&recording, "GCE", bands, told);
            let streams = [None, Some(&told), Some(&all)].map(|told| of_bands(bands, told));
            // Under HEALTHY L5 might as well not have come.
            let others: Vec<u8> = bands.iter().copied().filter(|band| *band != 5).collect();
            let without_l5 = of_bands(&others, Some(&told));
            for frequencies in ["DUAL", "AUTO"] {
                let name = format!("bands {bands:?}, FREQ,{frequencies}");
                let of = |lumps: &[Vec<u8>], l5: &str| {
                    day(lumps, &[("FREQ", frequencies), ("IONO", &ionosphere), ("L5", l5)])
                };
                let [before, tracked, with_all] = streams.each_ref().map(|lumps| of(lumps, "TRACKED"));
                let healthy = of(&streams[1], "HEALTHY");
                say(&format!("{name}, without frames"), &before);
                say(&format!("{name}, TRACKED, recorded delays"), &tracked);
                say(&format!("{name}, TRACKED, delays of all satellites"), &with_all);
                say(&format!("{name}, HEALTHY"), &healthy);
                for day in [&before, &tracked, &with_all, &healthy] {
                    assert_eq!((day.excluded, day.misleading), (0, 0), "{name}");
                }
                // Beside L2C the delays that were not recorded, those of L5, hardly matter.
                if (bands, frequencies) != (&[1, 2, 5], "AUTO") {
                    assert!(with_all.median_hpl_m < before.median_hpl_m, "{name}");
                }
                if (bands, frequencies) != (&[1, 5], "AUTO") {
                    assert!(tracked.median_hpl_m < before.median_hpl_m, "{name}");
                }
                assert_eq!((before.unhealthy, healthy.unhealthy), (0, 0), "{name}");
                if (bands, frequencies) == (&[1, 5], "DUAL") {
                    assert!(tracked.unhealthy > tracked.epochs / 2, "{name}: {}", tracked.unhealthy);
                }
                let bare = of(&without_l5, "HEALTHY");
                let differs = bare.reported.iter().zip(&healthy.reported).find(|(one, other)| one != other);
                assert!(bare.reported == healthy.reported, "{name}: {differs:?}");
            }
        }
    }
}
