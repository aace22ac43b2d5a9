//! The reference recordings, counted by another program.

use std::path::Path;

use raim::signal::recording::Recording;
use raim::signal::sample;

use super::{DGAR, ESBC, KMS3, STATIC1HZ, TLSE};

/// Epochs; satellites and pseudoranges of some systems; and the sum of the pseudoranges in mm.
#[derive(Debug, PartialEq)]
struct Content {
    epochs: usize,
    satellites: usize,
    pseudoranges: usize,
    sum_mm: i64,
}

fn content(recording: &Recording, letters: &str) -> Content {
    let satellites = || recording.epochs.iter().flat_map(|epoch| &epoch.satellites);
    let used = || satellites().filter(|of| letters.contains(of.satellite.name().0));
    let signals = || used().flat_map(|satellite| &satellite.signals);
    Content {
        epochs: recording.epochs.len(),
        satellites: used().count(),
        pseudoranges: signals().count(),
        sum_mm: signals().map(|signal| (signal.pseudorange_m * 1000.0).round() as i64).sum(),
    }
}

#[test]
fn real_recordings_hold_what_an_independent_reader_counts() {
    // Counted by a script over the plain text of the reference implementation of crx2rnx (4.1.0).
    let want = [
        (
            ESBC,
            Content {
                epochs: 2880,
                satellites: 91_093,
                pseudoranges: 309_887,
                sum_mm: 7_963_399_453_651_985,
            },
        ),
        (
            STATIC1HZ,
            Content { epochs: 301, satellites: 13_740, pseudoranges: 37_016, sum_mm: 1_077_847_447_197_544 },
        ),
        (
            TLSE,
            Content { epochs: 900, satellites: 28_105, pseudoranges: 113_529, sum_mm: 2_902_666_146_184_980 },
        ),
        (KMS3, Content { epochs: 19, satellites: 616, pseudoranges: 2709, sum_mm: 71_140_231_178_837 }),
        (
            DGAR,
            Content {
                epochs: 2880,
                satellites: 58_208,
                pseudoranges: 253_521,
                sum_mm: 6_166_681_397_682_689,
            },
        ),
    ];
    for (files, want) in want {
        let start = std::time::Instant::now();
        let Some(recording) = files.load() else { continue };
        println!("{} read in {:.1?}, {} ephemerides", files.0, start.elapsed(), recording.ephemerides.len());
        assert_eq!(content(&recording, "GCE"), want, "{}", files.0);
    }
}

#[test]
fn qzss_is_what_an_independent_reader_counts() {
    let Some(recording) = STATIC1HZ.load() else { return };
    let want = Content { epochs: 301, satellites: 602, pseudoranges: 1806, sum_mm: 66_968_456_470_208 };
    assert_eq!(content(&recording, "J"), want);
}

#[test]
fn the_sample_is_fetched_and_read() {
    let cache = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let sample = match sample::fetch(cache) {
        Ok(sample) => sample,
        Err(reason) => return rig::skip::say(&format!("pip and the package index: {reason:#}")),
    };
    let recording = Recording::load(&[sample.observations], &[sample.navigation]).unwrap();
    let want = Content { epochs: 60, satellites: 1142, pseudoranges: 4742, sum_mm: 112_875_132_293_802 };
    assert_eq!(content(&recording, "GCE"), want);
    let want = Content { epochs: 60, satellites: 240, pseudoranges: 720, sum_mm: 26_939_431_687_420 };
    assert_eq!(content(&recording, "J"), want);
    let header = recording.approximate_position.unwrap();
    assert!(header.distance_m(sample.truth) < 10.0, "{header:?}");
}
