//! Live view of the module on a terminal.
//!
//! On a terminal one block of lines is redrawn in place. Lines are cut to the terminal's width,
//! because a wrapped line would spoil the redrawing. Elsewhere, and headless, a line is written
//! every five epochs and whenever the verdict or the exclusions change.

use std::io::{self, Write};

use raim::page::{Moment, Verdict};

use super::Plan;

/// Form of the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// A block that is redrawn, with colours, on a terminal of this many columns.
    Block(usize),
    /// Plain lines.
    Lines,
}

/// Number of epochs of a curve, so that a line stays within 80 columns.
const CURVE_EPOCHS: usize = 26;

/// Epochs between plain lines.
const EVERY: usize = 5;

/// Lines of the block.
const BLOCK_LINES: usize = 5;

/// A live view.
pub struct Live<W> {
    plan: Plan,
    view: View,
    out: W,
    is_drawn: bool,
}

impl<W: Write> Live<W> {
    /// Returns a view that writes to `out`.
    pub const fn new(plan: Plan, view: View, out: W) -> Self {
        Self { plan, view, out, is_drawn: false }
    }

    /// Shows the last of the moments.
    ///
    /// # Errors
    /// If writing to `out` fails.
    pub fn show(&mut self, moments: &[Moment]) -> io::Result<()> {
        match self.view {
            View::Block(columns) => self.block(moments, columns),
            View::Lines => self.line(moments),
        }
    }

    fn line(&mut self, moments: &[Moment]) -> io::Result<()> {
        let Some((now, before)) = moments.split_last() else { return Ok(()) };
        let changed =
            before.last().is_none_or(|last| last.verdict != now.verdict || last.excluded != now.excluded);
        if !changed && !before.len().is_multiple_of(EVERY) {
            return Ok(());
        }
        writeln!(
            self.out,
            "{:>4.0} s  {:<11} {:<10} pin {:<4}  statistic {:>6} of {:<6} error {:>6} m  HPL {:>6} m  {}",
            now.time_s,
            now.verdict.word(),
            now.reason,
            level(now),
            number(now.statistic, 2),
            number(now.threshold, 2),
            number(now.horizontal_error_m, 1),
            number(now.hpl_m, 1),
            left_out(now),
        )
    }

    fn block(&mut self, moments: &[Moment], columns: usize) -> io::Result<()> {
        let Some(now) = moments.last() else { return Ok(()) };
        if self.is_drawn {
            write!(self.out, "\x1b[{BLOCK_LINES}A")?;
        }
        self.is_drawn = true;
        let recent = &moments[moments.len().saturating_sub(CURVE_EPOCHS)..];
        let bias_m = self.plan.fault().bias_m(now.time_s);
        let lines = [
            format!(
                "{:>4.0} s  {}{:<11}\x1b[0m {:<10} pin {}{:<4}\x1b[0m  {} satellites used",
                now.time_s,
                colour(now.verdict),
                now.verdict.word().to_uppercase(),
                now.reason,
                if now.pin_is_high == Some(true) { "\x1b[1;32m" } else { "\x1b[1;31m" },
                level(now),
                now.used,
            ),
            format!(
                "statistic  {} {} of {}",
                curve(recent, |moment| moment.statistic, |moment| moment.threshold),
                number(now.statistic, 2),
                number(now.threshold, 2),
            ),
            format!(
                "error      {} {} m, HPL {} m, limit {} m",
                curve(recent, |moment| moment.horizontal_error_m, |moment| moment.hpl_m),
                number(now.horizontal_error_m, 1),
                number(now.hpl_m, 1),
                number(now.hal_m, 0),
            ),
            format!("fault      {} {bias_m:+.0} m", self.plan.satellite),
            format!("verdict    {}", left_out(now)),
        ];
        for line in lines {
            // The colour is reset, even if the line is cut inside it.
            let line = format!("  {line}");
            writeln!(self.out, "\x1b[2K{}\x1b[0m", console::truncate_str(&line, columns, ""))?;
        }
        self.out.flush()
    }
}

const fn colour(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Protected => "\x1b[1;32m",
        Verdict::Alert => "\x1b[1;31m",
        Verdict::Unavailable => "\x1b[1;33m",
    }
}

const fn level(moment: &Moment) -> &'static str {
    match moment.pin_is_high {
        Some(true) => "high",
        Some(false) => "low",
        None => "?",
    }
}

fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
}

fn left_out(moment: &Moment) -> String {
    let names: Vec<String> = moment.excluded.iter().map(ToString::to_string).collect();
    match (names.as_slice(), moment.verdict) {
        ([], Verdict::Alert) => "something is wrong: do not use the position".to_owned(),
        ([], Verdict::Unavailable) => "nothing can be promised yet".to_owned(),
        ([], Verdict::Protected) => "the satellites agree".to_owned(),
        (names, _) => format!("{} left out", names.join(" ")),
    }
}

/// Draws a curve in one line: each value as a share of its bound, full height at the bound.
fn curve(
    moments: &[Moment],
    value: impl Fn(&Moment) -> Option<f64>,
    bound: impl Fn(&Moment) -> Option<f64>,
) -> String {
    const STEPS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let step = |moment: &Moment| match (value(moment), bound(moment)) {
        (Some(value), Some(bound)) if bound > 0.0 => {
            let share = (value / bound).clamp(0.0, 1.0);
            STEPS[((share * 8.0) as usize).min(7)]
        }
        _ => ' ',
    };
    let drawn: String = moments.iter().map(step).collect();
    format!("{drawn:<CURVE_EPOCHS$}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use raim::signal::fault::satellite;

    #[test]
    fn no_line_of_the_block_is_wider_than_the_terminal() {
        let moment = Moment {
            time_s: 70.0,
            verdict: Verdict::Protected,
            reason: "EXCLUDED".to_owned(),
            statistic: Some(0.5),
            threshold: Some(2.0),
            hpl_m: Some(13.0),
            vpl_m: Some(20.0),
            hal_m: Some(556.0),
            val_m: None,
            horizontal_error_m: Some(1.0),
            vertical_error_m: Some(1.0),
            pin_is_high: Some(true),
            used: 14,
            excluded: vec![satellite("G15").unwrap(); 6],
        };
        for columns in [20, 40, 60, 80] {
            let mut shown = Vec::new();
            let plan = Plan { satellite: satellite("G15").unwrap(), bias_m: -200.0, seed: 1 };
            let mut live = Live::new(plan, View::Block(columns), &mut shown);
            live.show(&vec![moment.clone(); 60]).unwrap();
            live.show(&vec![moment.clone(); 61]).unwrap();
            let shown = String::from_utf8(shown).unwrap();
            let widths: Vec<usize> = shown.lines().map(console::measure_text_width).collect();
            assert_eq!(widths.len(), 2 * BLOCK_LINES);
            assert!(widths.iter().all(|width| *width <= columns), "{columns}: {widths:?}");
        }
    }
}
