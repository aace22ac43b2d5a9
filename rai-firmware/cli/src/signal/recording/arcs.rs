//! Coded lines of a satellite in compact RINEX to its RINEX lines.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `m` | `Arc::order` | — |
//! | `Δ⁰…Δᵐ` | `Arc::differences` | 0.001 of the observation's unit |
//!
//! How an arc is coded stands in [`hatanaka`](super::hatanaka).

use std::fmt::Write as _;

/// Highest order of differences the format allows.
const ORDER_LIMIT: usize = 9;

/// The running arcs of one satellite.
#[derive(Clone, Default)]
pub(super) struct Satellite {
    arcs: Vec<Option<Arc>>,
    flags: String,
}

/// One observation's differences in time.
#[derive(Clone, Debug)]
struct Arc {
    order: usize,
    /// Number of differences known by now.
    known: usize,
    differences: [i64; ORDER_LIMIT + 1],
}

impl Arc {
    fn begin(order: usize, value: i64) -> Self {
        let mut differences = [0; ORDER_LIMIT + 1];
        differences[0] = value;
        Self { order, known: 0, differences }
    }

    /// Takes the newest difference and integrates it up to the value.
    fn extend(&mut self, difference: i64) {
        self.known = (self.known + 1).min(self.order);
        self.differences[self.known] = difference;
        for order in (0..self.known).rev() {
            self.differences[order] = self.differences[order].wrapping_add(self.differences[order + 1]);
        }
    }
}

/// Effect of a word on an arc.
enum Step {
    End,
    Begin(Arc),
    Extend(i64),
}

impl Step {
    /// The step of a word; `None` for a word that is no step.
    fn of(word: &str) -> Option<Self> {
        if word.is_empty() {
            return Some(Self::End);
        }
        let Some((order, value)) = word.split_once('&') else { return integer(word).map(Self::Extend) };
        let order = order.parse().ok().filter(|order| *order <= ORDER_LIMIT)?;
        Some(Self::Begin(Arc::begin(order, integer(value)?)))
    }
}

impl Satellite {
    /// Takes one coded line: as many observations as there are kinds, then the differences of their
    /// flags.
    ///
    /// Returns the number of flaws. A word that cannot be read ends all arcs, because the words
    /// after it may have moved; a difference without an arc, which is what damage leaves behind, is
    /// no observation.
    pub(super) fn update(&mut self, line: &str, kinds: usize) -> usize {
        self.arcs.resize(kinds, None);
        let mut rest = line;
        let mut steps = Vec::with_capacity(kinds);
        for _ in 0..kinds {
            let (word, tail) = rest.split_once(' ').unwrap_or((rest, ""));
            steps.push(Step::of(word));
            rest = tail;
        }
        let are_flags =
            rest.len() <= 2 * kinds && rest.chars().all(|flag| matches!(flag, '0'..='9' | ' ' | '&'));
        let Some(steps) = steps.into_iter().collect::<Option<Vec<Step>>>().filter(|_| are_flags) else {
            self.arcs.fill(None);
            self.flags.clear();
            return 1;
        };
        let mut flaws = 0;
        for (arc, step) in self.arcs.iter_mut().zip(steps) {
            match (step, arc.as_mut()) {
                (Step::End, _) => *arc = None,
                (Step::Begin(begun), _) => *arc = Some(begun),
                (Step::Extend(difference), Some(arc)) => arc.extend(difference),
                (Step::Extend(_), None) => flaws += 1,
            }
        }
        update(&mut self.flags, rest);
        flaws
    }

    /// Returns true if there is a pseudorange among the observations of these kinds.
    pub(super) fn has_range(&self, kinds: &[String]) -> bool {
        self.arcs.iter().zip(kinds).any(|(arc, kind)| arc.is_some() && kind.starts_with(['C', 'P']))
    }

    /// Appends the RINEX lines of the satellite, of at most so many observations each. Where all
    /// are in one line, it begins with the satellite's name.
    pub(super) fn write(
        &self,
        name: &str,
        per_line: Option<usize>,
        number: u64,
        output: &mut Vec<(u64, String)>,
    ) {
        let name = if per_line.is_none() { name } else { "" };
        let per_line = per_line.unwrap_or(self.arcs.len()).max(1);
        let mut line = String::with_capacity(name.len() + 16 * per_line.min(self.arcs.len()));
        line.push_str(name);
        for (index, arc) in self.arcs.iter().enumerate() {
            if index > 0 && index % per_line == 0 {
                output.push((number, std::mem::take(&mut line)));
            }
            let flags = self.flags.get(2 * index..).unwrap_or("");
            let flags = flags.get(..2).unwrap_or(flags);
            match arc {
                Some(arc) => {
                    let value = arc.differences[0];
                    let (sign, size) = (if value < 0 { "-" } else { "" }, value.unsigned_abs());
                    let number = format!("{sign}{}.{:03}", size / 1000, size % 1000);
                    let _ = write!(line, "{number:>14}{flags:<2}");
                }
                None => line.push_str("                "),
            }
        }
        output.push((number, line));
    }
}

/// Returns the number that a word codes.
pub(super) fn integer(word: &str) -> Option<i64> {
    word.parse().ok()
}

/// Applies character differences.
pub(super) fn update(text: &mut String, differences: &str) {
    let old = std::mem::take(text);
    let mut old = old.chars();
    for difference in differences.chars() {
        let kept = old.next().unwrap_or(' ');
        text.push(match difference {
            ' ' => kept,
            '&' => ' ',
            new => new,
        });
    }
    text.extend(old);
}
