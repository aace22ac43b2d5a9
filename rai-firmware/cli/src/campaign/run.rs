//! All cells of a campaign, or a share of them, from the beginning or from an interrupted run.

use std::fs::{File, OpenOptions};
use std::io::{Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail, ensure};
use raim_core::monitor::Method;
use raim_firmware::settings::{Configuration, Order};

use super::cell::{Bench, Judge};
use super::errors::ErrorModel;
use super::place::{self, Place};
use super::sky::{Heaven, Sky};
use super::spec::{FaultSpec, Spec};
use super::table::{Identity, Table};
use crate::in_order;

/// A share of the cells: those whose number leaves the remainder `index` when divided by `of`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// Index of the share, from 0.
    pub index: usize,
    /// Number of shares.
    pub of: usize,
}

impl Share {
    /// All cells.
    pub const ALL: Self = Self { index: 0, of: 1 };

    /// Parses `k/n`, `k` from 1.
    ///
    /// # Errors
    /// If the text is not such a share; the error shows the form.
    pub fn parse(text: &str) -> Result<Self> {
        let numbers = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((k, n)) if (1..=n).contains(&k) && n <= 100_000 => Ok(Self { index: k - 1, of: n }),
            _ => bail!("`{text}` is not a share: write k/n with k from 1 to n, such as 3/16"),
        }
    }

    /// Returns the file name of the share's table.
    pub fn file_name(self, name: &str) -> String {
        match self {
            Self::ALL => format!("{name}.csv"),
            Self { index, of } => format!("{name}.{}-of-{of}.csv", index + 1),
        }
    }
}

/// A campaign with everything that it needs.
pub struct Campaign {
    spec: Spec,
    skies: Vec<Vec<(f64, Heaven)>>,
    places: Vec<Place>,
    judges: Vec<Judge>,
    /// Number of threads that compute cells: at first, as many as this computer runs at once.
    pub threads: usize,
    /// Identity of the tables.
    pub identity: Identity,
}

impl Campaign {
    /// Reads a specification and the files that it names, relative to its folder.
    ///
    /// # Errors
    /// If something in it is wrong; the error names the place and the expected form.
    pub fn load(path: &Path) -> Result<Self> {
        let spec = Spec::read(path)?;
        let folder = path.parent().unwrap_or_else(|| Path::new("."));
        Self::of(spec, folder).with_context(|| path.display().to_string())
    }

    /// Prepares a checked specification. Files are relative to the folder.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn of(spec: Spec, folder: &Path) -> Result<Self> {
        let places = place::all(&spec.places, folder)?;
        let judges = judges(&spec)?;
        let instants = instants(&spec, &places);
        let located = |sky: Sky| {
            in_order::all(instants.len(), &|index| {
                let t_s = instants.get(index).copied().unwrap_or_default();
                (t_s, sky.at(t_s))
            })
        };
        let skies: Vec<Vec<(f64, Heaven)>> =
            spec.skies.iter().map(|sky| Ok(located(Sky::load(sky, folder)?))).collect::<Result<_>>()?;
        let identity = Identity {
            name: spec.name.clone(),
            seed: spec.seed,
            noise: spec.noise,
            settings: spec.words(),
            hash: fingerprint(&spec, &skies, &places),
            cells: skies.len() * spec.masks_deg.len() * spec.errors.len() * places.len(),
            rows: spec.faults.len() * judges.len(),
        };
        Ok(Self { spec, skies, places, judges, threads: in_order::threads(), identity })
    }

    /// Computes a share into a folder and returns the table's path. `progress` receives the number
    /// of finished cells, and of all cells.
    ///
    /// # Errors
    /// If a table exists although nothing is to be resumed, the table belongs to another campaign,
    /// or it cannot be written.
    pub fn work(
        &self,
        folder: &Path,
        share: Share,
        resume: bool,
        mut progress: impl FnMut(usize, usize),
    ) -> Result<PathBuf> {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
        let path = folder.join(share.file_name(&self.identity.name));
        let cells: Vec<usize> = (share.index..self.identity.cells).step_by(share.of).collect();
        let (mut file, mut done) = self.begin(&path, &cells, resume)?;
        progress(done, cells.len());
        let left = cells.get(done..).unwrap_or_default();
        self.compute(left, &mut |text| {
            file.write_all(text.as_bytes()).with_context(|| format!("cannot write {}", path.display()))?;
            done += 1;
            progress(done, cells.len());
            Ok(())
        })?;
        Ok(path)
    }

    /// Returns a share as text, without a file.
    pub fn text(&self, share: Share) -> String {
        let cells: Vec<usize> = (share.index..self.identity.cells).step_by(share.of).collect();
        let mut text = self.identity.heading();
        // Keeping a text cannot fail.
        let _ = self.compute(&cells, &mut |rows| {
            text += &rows;
            Ok(())
        });
        text
    }

    /// Computes cells, and passes their rows on in order.
    fn compute(&self, cells: &[usize], take: &mut dyn FnMut(String) -> Result<()>) -> Result<()> {
        let rows = |index: usize| cells.get(index).map_or_else(String::new, |&cell| self.rows(cell));
        in_order::compute(cells.len(), self.threads, &rows, take)
    }

    /// Opens a table after its last complete cell; returns the number of complete cells.
    fn begin(&self, path: &Path, cells: &[usize], resume: bool) -> Result<(File, usize)> {
        let shown = path.display();
        if !path.exists() {
            let mut file = File::create(path).with_context(|| format!("cannot write {shown}"))?;
            file.write_all(self.identity.heading().as_bytes())?;
            return Ok((file, 0));
        }
        ensure!(resume, "{shown} already exists: continue with --resume, or name another folder with --out");
        let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {shown}"))?;
        let heading = self.identity.heading();
        // A run that was interrupted within its heading has no cells.
        if heading.starts_with(&text) {
            let mut file = File::create(path)?;
            file.write_all(heading.as_bytes())?;
            return Ok((file, 0));
        }
        let table = Table::read(&text).with_context(|| shown.to_string())?;
        ensure!(
            table.identity == self.identity,
            "{shown} is of another specification: name another folder with --out"
        );
        let done: Vec<usize> = table.cells().collect();
        ensure!(cells.starts_with(&done), "{shown} does not have the cells of this share in their order");
        let mut file = OpenOptions::new().write(true).open(path)?;
        file.set_len(table.whole_bytes as u64)?;
        file.seek(SeekFrom::End(0))?;
        Ok((file, done.len()))
    }

    /// Computes the rows of a cell, each with its line end.
    fn rows(&self, cell: usize) -> String {
        let (rest, place) = (cell / self.places.len(), cell % self.places.len());
        let (rest, errors) = (rest / self.spec.errors.len(), rest % self.spec.errors.len());
        let (sky, mask) = (rest / self.spec.masks_deg.len(), rest % self.spec.masks_deg.len());
        let (site, mask_deg) = (&self.places[place], self.spec.masks_deg[mask]);
        let bench = Bench {
            instants: &self.skies[sky],
            place: site,
            mask_deg,
            model: ErrorModel::of(&self.spec.errors[errors]),
            noise: self.spec.noise,
            // The noise is the same under every sky, mask and error model.
            seed: self.spec.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ place as u64,
        };
        let statistics = bench.judge(&self.spec.faults, &self.judges);
        let cases =
            self.spec.faults.iter().flat_map(|fault| self.judges.iter().map(move |judge| (fault, judge)));
        let row = |((fault, judge), of_judge): (_, super::statistics::CellStatistics)| {
            let (fault, judge): (&FaultSpec, &Judge) = (fault, judge);
            let Place { name, latitude_deg, longitude_deg, height_m, .. } = site;
            format!(
                "{cell},{},{mask_deg},{},{},{},{name},{latitude_deg},{longitude_deg},{height_m},{}\n",
                self.spec.skies[sky].name,
                self.spec.errors[errors].name,
                fault.name(),
                judge.words.join(","),
                of_judge.cells()
            )
        };
        cases.zip(statistics).map(row).collect()
    }
}

/// Returns the instants of the specification, or those of the track, s.
fn instants(spec: &Spec, places: &[Place]) -> Vec<f64> {
    let of_track: Vec<f64> = places.iter().filter_map(|place| place.time_s).collect();
    if of_track.is_empty() {
        let times = &spec.times;
        return (0..times.count).map(|index| times.start_s + f64::from(index) * times.step_s).collect();
    }
    let mut instants = of_track;
    instants.sort_by(f64::total_cmp);
    instants.dedup();
    instants
}

/// Returns all combinations of methods, policies and levels, configured by commands.
fn judges(spec: &Spec) -> Result<Vec<Judge>> {
    let judgement = &spec.judgement;
    let common = judgement
        .set
        .iter()
        .try_fold(Configuration::at_start(), |configuration, line| commanded(&configuration, line))
        .context("judgement.set")?;
    let mut judges: Vec<Judge> = Vec::new();
    for method in &judgement.methods {
        let configuration = commanded(&common, &format!("METHOD,{method}")).context("judgement.methods")?;
        for policy in &judgement.policies {
            let configuration =
                commanded(&configuration, &format!("POLICY,{policy}")).context("judgement.policies")?;
            for levels in &judgement.levels {
                let configuration =
                    commanded(&configuration, &format!("LEVELS,{levels}")).context("judgement.levels")?;
                let is_separation = configuration.method == Method::Araim;
                let word = |word: &String| if is_separation { "-".to_owned() } else { word.clone() };
                let words = [method.clone(), word(policy), word(levels)];
                if judges.iter().all(|judge| judge.words != words) {
                    judges.push(Judge::new(words, configuration)?);
                }
            }
        }
    }
    Ok(judges)
}

/// Applies a command of the module, `KEY,value`, to a configuration.
fn commanded(configuration: &Configuration, line: &str) -> Result<Configuration> {
    let mut fields = line.split(',');
    let key = fields.next().unwrap_or("");
    ensure!(
        Order::read(key, std::iter::empty()).is_none(),
        "`{line}` sets nothing: write a key and its value, as PHASE,LPV200"
    );
    configuration.with(key, fields).map_err(|refusal| {
        anyhow::anyhow!(
            "the module refuses `{line}` ({refusal:?}): write a setting as in its command, PHASE,LPV200"
        )
    })
}

/// Returns the FNV-1a hash of everything that a row depends on.
fn fingerprint(spec: &Spec, skies: &[Vec<(f64, Heaven)>], places: &[Place]) -> u64 {
    let mut hash = 0xCBF2_9CE4_8422_2325_u64;
    let mut take = |bytes: &[u8]| {
        for byte in bytes {
            hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3);
        }
    };
    take(format!("{spec:?}{places:?}").as_bytes());
    for (t_s, heaven) in skies.iter().flatten() {
        take(&t_s.to_le_bytes());
        for (satellite, position) in heaven {
            take(format!("{satellite}").as_bytes());
            for metres in [position.x_m, position.y_m, position.z_m] {
                take(&metres.to_le_bytes());
            }
        }
    }
    hash
}
