//! The epochs of several observation files in the order of time.

use std::path::PathBuf;

use anyhow::{Result, anyhow};
use raim_core::frame::Ecef;
use raim_firmware::time::GpsTime;

use super::observations::Observations;
use super::one_receiver::OneReceiver;
use crate::signal::measurement::MeasuredEpoch;
use crate::signal::skipped::Skipped;

/// Epochs of several observation files, merged in time and read one at a time; no time comes twice.
///
/// If epochs have the same time, the first file's is kept. The last item is an error if a file
/// cannot be read to its end, if more than a tenth of its lines was lost, or if two files are of two
/// receivers.
pub struct Epochs {
    names: Vec<PathBuf>,
    files: Vec<InOrder>,
    receiver: OneReceiver,
    last: Option<GpsTime>,
    has_failed: bool,
}

impl Epochs {
    /// Opens the files and reads their headers.
    ///
    /// # Errors
    /// As for [`Observations::open`], for the first file that fails.
    pub fn open(paths: &[PathBuf]) -> Result<Self> {
        let files = paths.iter().map(|path| Observations::open(path).map(InOrder::new));
        let files = files.collect::<Result<_>>()?;
        Ok(Self {
            names: paths.to_vec(),
            files,
            receiver: OneReceiver::default(),
            last: None,
            has_failed: false,
        })
    }

    /// Returns the antenna's position in the first header that has one; in some files it is wrong
    /// by hundreds of metres.
    pub fn approximate_position(&self) -> Option<Ecef> {
        self.files.iter().find_map(|file| file.observations.approximate_position())
    }

    /// Returns the records skipped so far.
    pub fn skipped(&self) -> Skipped {
        let mut skipped = Skipped::default();
        self.files.iter().for_each(|file| skipped.add(&file.observations.skipped()));
        skipped
    }

    /// Returns an epoch of a file if all files can be of one receiver.
    fn of_one(&mut self, file: usize, epoch: MeasuredEpoch) -> Result<MeasuredEpoch> {
        if self.files.len() == 1 {
            return Ok(epoch);
        }
        let Some(other) = self.receiver.other(file, &epoch) else { return Ok(epoch) };
        let name =
            |index: usize| self.names.get(index).map(|path| path.display().to_string()).unwrap_or_default();
        Err(anyhow!(
            "{} and {} are recordings of two receivers at the same time: give one of the two",
            name(file.min(other)),
            name(file.max(other))
        ))
    }
}

impl Iterator for Epochs {
    type Item = Result<MeasuredEpoch>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.has_failed {
            let times = self.files.iter_mut().enumerate().filter_map(|(index, file)| {
                // An error comes before every epoch.
                file.peek().map(|next| (next.as_ref().ok().map(|epoch| epoch.time), index))
            });
            let (time, index) = times.min()?;
            let next = self.files.get_mut(index)?.next()?;
            let next = next.and_then(|epoch| self.of_one(index, epoch));
            self.has_failed = next.is_err();
            if self.has_failed || self.last < time {
                self.last = time;
                return Some(next);
            }
        }
        None
    }
}

/// Epochs of one file in the order of time.
///
/// If the second of two neighbours is not later, one of them has a wrong date. It is the first one
/// if the second is later than the epoch before both, or if there is none before; otherwise it is
/// the second.
struct InOrder {
    observations: Observations,
    last: Option<GpsTime>,
    held: Option<(MeasuredEpoch, u64)>,
    ahead: Option<Result<MeasuredEpoch>>,
    failed: Option<anyhow::Error>,
}

impl InOrder {
    fn new(observations: Observations) -> Self {
        Self { observations, last: None, held: None, ahead: None, failed: None }
    }

    fn peek(&mut self) -> Option<&Result<MeasuredEpoch>> {
        if self.ahead.is_none() {
            self.ahead = self.find();
        }
        self.ahead.as_ref()
    }

    fn find(&mut self) -> Option<Result<MeasuredEpoch>> {
        loop {
            let Some(next) = self.observations.next() else { break };
            let line = self.observations.line();
            let next = match next {
                Ok(next) => next,
                Err(error) => {
                    self.failed = Some(error);
                    break;
                }
            };
            let Some((held, held_line)) = self.held.take() else {
                self.held = Some((next, line));
                continue;
            };
            if next.time > held.time {
                self.held = Some((next, line));
                return Some(Ok(self.release(held)));
            }
            let is_held_wrong = next.time < held.time && self.last.is_none_or(|last| next.time > last);
            let (kept, dropped) = if is_held_wrong {
                ((next, line), (held, held_line))
            } else {
                ((held, held_line), (next, line))
            };
            self.observations.discard(dropped.1, &dropped.0);
            self.held = Some(kept);
        }
        match self.held.take() {
            Some((held, _)) => Some(Ok(self.release(held))),
            None => self.failed.take().map(Err),
        }
    }

    fn release(&mut self, epoch: MeasuredEpoch) -> MeasuredEpoch {
        self.last = Some(epoch.time);
        epoch
    }
}

impl Iterator for InOrder {
    type Item = Result<MeasuredEpoch>;

    fn next(&mut self) -> Option<Self::Item> {
        self.peek();
        self.ahead.take()
    }
}
