//! Output of the command `replay`, epoch by epoch: rows of epochs and of satellites, sentences, the
//! stream, a report.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::Path;

use super::page::About;
use super::progress::Progress;
use super::truth::Far;
use super::{Moment, Report, Reported, Rows, RunningSummary, Summary, Truth};
use crate::satellites;
use crate::signal::fault::Fault;
use crate::signal::lump::Lump;
use anyhow::{Context, Result};

/// Outputs of the epochs.
pub(super) struct Sink<'a> {
    truth: Option<&'a Truth>,
    far: Option<Far>,
    summary: RunningSummary,
    bar: Progress,
    rows: Option<(&'a Path, Rows<BufWriter<File>>)>,
    sentences: Option<Copy<'a>>,
    stream: Option<Copy<'a>>,
    satellites: Option<(&'a Path, BufWriter<File>)>,
    report: Option<(&'a Path, Report)>,
}

/// Files that the user has requested.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wanted<'a> {
    pub(super) rows: Option<&'a Path>,
    pub(super) sentences: Option<&'a Path>,
    pub(super) stream: Option<&'a Path>,
    pub(super) satellites: Option<&'a Path>,
    pub(super) report: Option<&'a Path>,
}

impl Wanted<'_> {
    /// Returns true if an output needs the module's view of the epochs.
    pub(super) fn needs_view(&self) -> bool {
        self.satellites.is_some() || self.report.is_some()
    }
}

impl<'a> Sink<'a> {
    /// Creates the requested files. The progress bar shows `place`, in which the module runs.
    pub(super) fn open(
        wanted: Wanted<'a>,
        truth: Option<&'a Truth>,
        faults: &[Fault],
        place: &'static str,
    ) -> Result<Self> {
        let rows = wanted.rows.map(|path| {
            let rows = create(path).and_then(|file| Ok(Rows::begin(file)?));
            rows.map(|rows| (path, rows)).with_context(|| cannot_write(path))
        });
        let satellites = wanted.satellites.map(|path| {
            let heading =
                |mut file: BufWriter<File>| writeln!(file, "{}", satellites::HEADING).map(|()| file);
            let file = create(path).and_then(|file| Ok(heading(file)?));
            file.map(|file| (path, file)).with_context(|| cannot_write(path))
        });
        Ok(Self {
            truth,
            far: None,
            summary: RunningSummary::new(faults, truth.is_some()),
            bar: Progress::of(place),
            rows: rows.transpose()?,
            sentences: wanted.sentences.map(Copy::open).transpose()?,
            stream: wanted.stream.map(Copy::open).transpose()?,
            satellites: satellites.transpose()?,
            report: wanted.report.map(|folder| (folder, Report::default())),
        })
    }

    /// Takes an epoch; returns its lump.
    pub(super) fn take(&mut self, played: Result<Option<(Lump, Reported)>>) -> Result<Option<Lump>> {
        let Some((lump, reported)) = played? else { return Ok(None) };
        let moment = Moment::of(&lump, &reported, self.truth);
        self.summary.count(&moment);
        if let Some(view) = reported.view() {
            self.summary.look(view, moment.elapsed_s);
        }
        let position = moment.output.as_ref().and_then(|output| output.position);
        if let (Some(position), Some(error)) = (position, moment.error) {
            let distance_m = libm::hypot(error.horizontal(), error.up);
            self.far = Some(Far::nearer(self.far, position.to_ecef(), distance_m));
        }
        if let Some((path, rows)) = &mut self.rows {
            rows.write(&moment).with_context(|| cannot_write(path))?;
        }
        if let Some(copy) = &mut self.sentences {
            copy.write(reported.of_epoch.as_bytes())?;
            copy.write(reported.of_silence.as_bytes())?;
        }
        if let Some(copy) = &mut self.stream {
            copy.write(&lump.bytes)?;
        }
        if let Some(((path, file), view)) = self.satellites.as_mut().zip(reported.view()) {
            let time = view.time.unwrap_or(lump.time);
            let mut rows = view.satellites.iter().map(|account| satellites::row(account, time));
            rows.try_for_each(|row| writeln!(file, "{row}")).with_context(|| cannot_write(path))?;
        }
        if let Some((_, report)) = &mut self.report {
            report.push(&moment, &reported);
        }
        self.bar.advance();
        Ok(Some(lump))
    }

    /// Returns the summary of the epochs so far.
    pub(super) fn summary(&self) -> Summary {
        self.summary.summary()
    }

    /// Returns the nearest position if all are far from the truth.
    pub(super) fn far_from_truth(&self) -> Option<Far> {
        self.far.filter(Far::is_elsewhere)
    }

    /// Completes the files.
    pub(super) fn end(self, faults: &[Fault], summary: &Summary, about: &About) -> Result<()> {
        self.bar.end();
        if let Some((path, rows)) = self.rows {
            rows.end().with_context(|| cannot_write(path))?;
        }
        for copy in [self.sentences, self.stream].into_iter().flatten() {
            copy.end()?;
        }
        if let Some((path, mut file)) = self.satellites {
            file.flush().with_context(|| cannot_write(path))?;
        }
        if let Some((folder, report)) = self.report {
            let path = report.write(folder, faults, summary, about)?;
            eprintln!("report: {}", path.display());
        }
        Ok(())
    }
}

/// File that grows with the replay.
struct Copy<'a> {
    path: &'a Path,
    file: BufWriter<File>,
}

impl<'a> Copy<'a> {
    fn open(path: &'a Path) -> Result<Self> {
        Ok(Self { path, file: create(path).with_context(|| cannot_write(path))? })
    }

    fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.file.write_all(bytes).with_context(|| cannot_write(self.path))
    }

    fn end(mut self) -> Result<()> {
        // A buffer that is only dropped would not report a full disk.
        self.file.flush().with_context(|| cannot_write(self.path))
    }
}

fn create(path: &Path) -> Result<BufWriter<File>> {
    Ok(BufWriter::new(File::create(path)?))
}

fn cannot_write(path: &Path) -> String {
    format!("cannot write {}", path.display())
}
