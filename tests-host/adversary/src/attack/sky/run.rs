//! A module's life under an attack, second by second.

use anyhow::ensure;
use raim::signal::encode::ubx::{Encoder, IonosphereAndUtc};
use raim::signal::osnma::Page;

use super::Means;
use super::scenes::{ATTACKED, JAMMED, Pages, Scene};
use super::signals::{LENGTH, Skies, gst_s};
use super::table::Cell;
use crate::attack::prelude::*;

/// Bound of the time that a module is told, s.
const BOUND_S: u32 = 5;

/// 1980-01-06 in UNIX time, and GPS time minus UTC, s.
const GPS_EPOCH_UNIX_S: f64 = 315_964_800.0;
const LEAP_S: f64 = 18.0;

/// Passes of the module's loop in a second.
const PASSES: u32 = 10;

/// What a module said in a second.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Reported {
    is_promised: bool,
    is_misleading: bool,
    reason: String,
    /// Satellites with false words.
    false_: u8,
}

/// What a module said, second by second; `None` without an epoch.
pub(super) struct Course {
    is_poisoned: bool,
    reported: Vec<Option<Reported>>,
    first_four_s: Option<u32>,
}

/// Runs a module under an attack.
pub(super) fn course(skies: &Skies, scene: &Scene, means: Means) -> Result<Course> {
    let attack: Vec<Page> = match scene.pages {
        Pages::Genuine => skies.pages.clone(),
        Pages::Forged(lie) => skies.forged(lie)?,
        Pages::Poisoned => skies.poisoned(),
        Pages::OfAttacker => skies.of_attacker.clone(),
    };
    let before = if scene.pages == Pages::Poisoned { &attack } else { &skies.pages };
    let commands = commands(skies, scene, means);
    let commands: Vec<&str> = commands.iter().map(String::as_str).collect();
    let mut victim = Victim::new(&commands, 1.0 / f64::from(PASSES))?;
    // The sets of Galileo come with its pages.
    let mut others = skies.ephemerides().to_vec();
    others.retain(|set| set.satellite.constellation() != Constellation::Galileo);
    let utc =
        IonosphereAndUtc { klobuchar: KLOBUCHAR, leap_s: (LEAP_S as i8, LEAP_S as i8), change: (1929, 7) };
    let selection = Selection::new("GEC", Frequency::Dual)?;
    let mut encoder = Encoder::new(&others, selection, Some(utc)).as_receiver();
    let is_poisoned = scene.pages == Pages::Poisoned;
    let mut course = Course { is_poisoned, reported: Vec::new(), first_four_s: None };
    for second in 0..LENGTH {
        let mut bytes = Vec::new();
        if let Some(epoch) = scene.epoch(skies, second, means.has_rates) {
            let pages = if second < ATTACKED { before } else { &attack };
            bytes.extend(frames(pages, epoch.time));
            bytes.extend(encoder.epoch(&epoch)?);
        }
        let mut reported = None;
        for _ in 0..PASSES {
            let seen = victim.receive(&std::mem::take(&mut bytes), skies.truth)?;
            if let Some(seen) = seen.iter().rfind(|seen| seen.reported.state.has_epoch()) {
                reported = Some((seen.is_promised, seen.is_misleading(), seen.reported.state.reason.clone()));
            }
        }
        let summary = victim.module.authentication();
        if summary.is_some_and(|summary| summary.proved >= 4) {
            course.first_four_s.get_or_insert(second);
        }
        let false_ = summary.map_or(0, |summary| summary.false_);
        course.reported.push(reported.map(|(is_promised, is_misleading, reason)| Reported {
            is_promised,
            is_misleading,
            reason,
            false_,
        }));
    }
    ensure!(
        scene.is_cold || !means.has_key || course.first_four_s.is_some_and(|s| s < JAMMED),
        "nothing was proved"
    );
    Ok(course)
}

/// Ionosphere of a quiet day, as GPS broadcasts it.
const KLOBUCHAR: [f64; 8] = [1e-8, 0.0, -6e-8, 0.0, 9e4, 0.0, -2e5, 0.0];

fn commands(skies: &Skies, scene: &Scene, means: Means) -> Vec<String> {
    let mut commands: Vec<String> = scene.settings.iter().map(|&setting| setting.to_owned()).collect();
    if means.has_key {
        let digits: String =
            skies.key().iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().concat();
        commands.extend([format!("KEY,1,{digits}"), "AUTH,PREFER".to_owned()]);
    }
    if means.has_time {
        let first_s = skies.here(0, 0, false).time.to_ms() as f64 * 1e-3;
        commands.push(format!("TRUST,{:.1},{BOUND_S}", first_s + GPS_EPOCH_UNIX_S - LEAP_S));
    }
    commands
}

/// Returns the pages that end within the second before an epoch.
fn frames(pages: &[Page], time: GpsTime) -> Vec<u8> {
    let now_s = gst_s(time);
    let from = pages.partition_point(|page| page.end_s() < now_s);
    let to = pages.partition_point(|page| page.end_s() <= now_s);
    pages[from..to].iter().filter_map(Page::frame).flatten().collect()
}

impl Course {
    /// Returns what the attack led to, beside the genuine sky.
    pub(super) fn beside(&self, genuine: &Self) -> Cell {
        let from = ATTACKED as usize;
        let both = self.reported[from..].iter().zip(&genuine.reported[from..]);
        let differs = |(reported, genuine): (&Option<Reported>, &Option<Reported>)| match (reported, genuine)
        {
            (Some(reported), Some(genuine)) if reported.false_ > genuine.false_ => Some("FALSE".to_owned()),
            (Some(reported), Some(genuine)) if reported.reason != genuine.reason => {
                Some(reported.reason.clone())
            }
            // The module is silent but for the fall of its pin.
            (None, Some(_)) => Some("STALE".to_owned()),
            _ => None,
        };
        let seen = (1..).zip(both).find_map(|(second, both)| Some((second, differs(both)?)));
        let during = || self.reported[from..].iter().flatten();
        let second_of = |is_it: fn(&Reported) -> bool| {
            self.reported[from..]
                .iter()
                .position(|reported| reported.as_ref().is_some_and(is_it))
                .map(|index| index as u32 + 1)
        };
        Cell {
            decided_s: second_of(|reported| reported.is_promised && reported.reason == "SYSTEM"),
            seen_s: seen.as_ref().map(|(second, _)| *second),
            by: seen.map(|(_, by)| by).unwrap_or_default(),
            promised: during().filter(|reported| reported.is_promised).count(),
            beyond: during().filter(|reported| reported.is_misleading).count(),
            last_beyond_s: self.reported[from..]
                .iter()
                .rposition(|reported| reported.as_ref().is_some_and(|reported| reported.is_misleading))
                .map(|index| index as u32 + 1),
            first_four_s: self.first_four_s.zip(genuine.first_four_s).filter(|_| self.is_poisoned),
        }
    }
}
