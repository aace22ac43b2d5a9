//! Recordings: the result of the readers for real and for awkward RINEX, and of the encoders for
//! the wire.
#![allow(missing_docs, clippy::inconsistent_digit_grouping)]

mod flaws;
mod made;
mod mutated;
mod quirks;
mod real;
mod refusals;
mod rtklib;
mod systems;
mod wire;

use std::path::PathBuf;

use raim::signal::encode::{Encoder, Selection};
use raim::signal::recording::Recording;
use rig::shared;

/// A reference recording: observations and navigation.
struct Files(&'static str, &'static str);

const ESBC: Files = Files(
    "data/esbc/ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz",
    "data/esbc/ESBC00DNK_R_20201770000_01D_MN.rnx.gz",
);
const STATIC1HZ: Files = Files("data/static1hz/base.obs.gz", "data/static1hz/base.nav.gz");
const TLSE: Files = Files(
    "data/tlse/TLSE00FRA_R_20240011200_15M_01S_MO.crx.gz",
    "data/tlse/BRDC00IGS_R_20240010000_01D_MN.rnx.gz",
);
const KMS3: Files = Files(
    "data/kms3/KMS300DNK_R_20221591000_01H_30S_MO.crx",
    "data/kms3/KMS300DNK_R_20221591000_01H_MN.rnx.gz",
);
const DGAR: Files = Files("data/dgar/dgar0100.24o.gz", "data/dgar/brdc0100.24n.gz");

impl Files {
    fn paths(&self) -> Option<(PathBuf, PathBuf)> {
        Some((shared::path_or_skip(self.0)?, shared::path_or_skip(self.1)?))
    }

    fn load(&self) -> Option<Recording> {
        let (observations, navigation) = self.paths()?;
        Some(Recording::load(&[observations], &[navigation]).unwrap())
    }
}

/// Reads a recording from texts, through files.
fn read(observations: &str, navigation: &str) -> anyhow::Result<Recording> {
    let folder = tempfile::tempdir()?;
    let paths = [folder.path().join("made.obs"), folder.path().join("made.nav")];
    std::fs::write(&paths[0], observations)?;
    std::fs::write(&paths[1], navigation)?;
    Recording::load(&paths[..1], &paths[1..])
}

/// Returns the lumps of a recording, one per epoch, as a receiver would send them.
fn lumps(recording: &Recording, selection: Selection) -> Vec<Vec<u8>> {
    let mut encoder = Encoder::new(&recording.ephemerides, selection);
    let lumps = recording.epochs.iter().map(|epoch| encoder.epoch(epoch).unwrap()).collect();
    assert_eq!(encoder.unsendable(), 0);
    lumps
}
