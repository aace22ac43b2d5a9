//! Isolation in parity space compared with dense solutions without each set: the rows identified,
//! and the number of sets.

use nalgebra::Vector3;
use proptest::prelude::*;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::isolation::exclusion::Unidentified;
use raim_core::internals::integrity::raim::isolation::parity::{
    MAX_SETS, ParityFinding, SearchLimits, correlation_threshold, grouping, hybrid, hybrid_without_grouping,
    sequential, simultaneous,
};
use raim_core::internals::least_squares::Snapshot;
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::internals::numeric::probability::Probability;
use raim_core::satellite::Constellation;

use crate::solved::solved;

use super::oracle::{self, Range};

/// Rows identified, or the reason why there are none, and the number of sets compared.
type Answer = (Result<Vec<usize>, Unidentified>, usize);

/// An epoch, its thresholds, and answers by trying all sets.
struct Dense<'d> {
    ranges: &'d [Range],
    thresholds: Thresholds<'static>,
    most: usize,
    alpha: Probability,
}

fn probability(tail: f64) -> Probability {
    Probability::new(tail).unwrap()
}

fn any_range() -> impl Strategy<Value = Range> {
    let fault_m = prop_oneof![6 => Just(0.0), 1 => -40.0..40.0, 1 => -300.0..300.0];
    (0.0..std::f64::consts::TAU, 0.08f64..1.0, -2.0f64..2.0, 1.0f64..4.0, fault_m).prop_map(
        |(azimuth, up, noise, sigma_m, fault_m)| {
            let level = (1.0 - up * up).sqrt();
            Range {
                line_of_sight: [level * azimuth.sin(), level * azimuth.cos(), up],
                constellation: Constellation::Gps,
                residual_m: noise * sigma_m + fault_m,
                sigma_m,
            }
        },
    )
}

impl Dense<'_> {
    /// Returns SSE over its threshold without a set; `None` if the set is refused, infinite if
    /// nothing is left to test.
    fn ratio_without(&self, set: &[usize]) -> Option<f64> {
        let solution = oracle::solve_without(self.ranges, set)?;
        Some(self.thresholds.tau1::<f64>(solution.dof).map_or(f64::INFINITY, |tau1| solution.sse / tau1))
    }

    fn sse_without(&self, set: &[usize]) -> Option<f64> {
        oracle::solve_without(self.ranges, set).map(|solution| solution.sse)
    }

    fn passes(&self, set: &[usize]) -> bool {
        self.ratio_without(set).is_some_and(|ratio| ratio < 1.0)
    }

    fn sequential(&self) -> Answer {
        let (mut set, mut sets) = (Vec::new(), 0);
        for _ in 0..self.most {
            sets += self.ranges.len();
            let free = (0..self.ranges.len()).filter(|index| !set.contains(index));
            let without =
                |index: usize| self.sse_without(&[&set[..], &[index]].concat()).unwrap_or(f64::INFINITY);
            let Some(worst) = free.min_by(|&a, &b| without(a).total_cmp(&without(b))) else { break };
            if without(worst).is_infinite() {
                break;
            }
            set.push(worst);
            if self.passes(&set) {
                return (Ok(sorted(set)), sets);
            }
        }
        (Err(Unidentified::NoSet), sets)
    }

    /// Returns the rows with `|ρ_i| ≥ ρ_T`. Here `ρ_i² = w_i²/SSE`, and `w_i²` is the decrease of
    /// SSE without the row.
    fn simultaneous(&self) -> Vec<usize> {
        let full = oracle::solve(self.ranges).unwrap();
        let Some(threshold) = correlation_threshold::<f64>(self.alpha, full.dof) else { return Vec::new() };
        let falls = |index: &usize| {
            let fall = full.sse - self.sse_without(&[*index]).unwrap_or(full.sse);
            fall >= threshold * threshold * full.sse
        };
        (0..self.ranges.len()).filter(falls).collect()
    }

    fn hybrid_without_grouping(&self) -> Answer {
        let set = self.simultaneous();
        if set.is_empty() || set.len() > self.most || self.sse_without(&set).is_none() {
            return self.sequential();
        }
        let smaller =
            |spared: &usize| set.iter().copied().filter(|index| index != spared).collect::<Vec<_>>();
        let sets = 1 + set.len();
        if self.passes(&set) && !set.iter().any(|spared| self.passes(&smaller(spared))) {
            return (Ok(set), sets);
        }
        let (named, more) = self.sequential();
        (named, sets + more)
    }

    fn grouping(&self) -> Answer {
        let dof = oracle::solve(self.ranges).unwrap().dof;
        let mut looked_at = 0;
        for size in 1..=self.most.min(dof - 1) {
            let sets = all_of_size(self.ranges.len(), size);
            looked_at += sets.len();
            let without = |set: &Vec<usize>| self.sse_without(set).unwrap_or(f64::INFINITY);
            let best = sets.into_iter().min_by(|a, b| without(a).total_cmp(&without(b))).unwrap();
            if self.passes(&best) {
                return (Ok(best), looked_at);
            }
        }
        (Err(Unidentified::NoSet), looked_at)
    }

    fn hybrid(&self) -> Answer {
        let (named, sets) = self.hybrid_without_grouping();
        if named.is_ok() {
            return (named, sets);
        }
        let (named, more) = self.grouping();
        (named, sets + more)
    }
}

fn sorted(mut set: Vec<usize>) -> Vec<usize> {
    set.sort_unstable();
    set
}

fn all_of_size(count: usize, size: usize) -> Vec<Vec<usize>> {
    if size == 0 {
        return vec![Vec::new()];
    }
    let extended = |set: Vec<usize>| {
        let from = set.last().map_or(0, |last| last + 1);
        (from..count).map(move |next| [&set[..], &[next]].concat())
    };
    all_of_size(count, size - 1).into_iter().flat_map(extended).collect()
}

fn answer(finding: &ParityFinding<f64>) -> Answer {
    let indices = |removal: &raim_core::internals::least_squares::downdate::ExclusionSet<f64>| {
        sorted(removal.rows().iter().map(|row| row.index).collect())
    };
    (finding.set.as_ref().map(indices).map_err(|why| *why), finding.sets)
}

fn snapshot(ranges: &[Range]) -> Option<Snapshot<'static, f64>> {
    let mut epoch = LinearEpoch::new();
    for range in ranges {
        let line_of_sight = Vector3::from(range.line_of_sight);
        epoch.satellite(range.constellation, line_of_sight, range.residual_m, range.sigma_m).unwrap();
    }
    solved(epoch).ok()
}

/// Returns true if rounding may decide the test of some set, or if a set is hardly determined.
fn is_close(dense: &Dense<'_>) -> bool {
    let sets = (0..=3).flat_map(|size| all_of_size(dense.ranges.len(), size));
    sets.into_iter().any(|set| {
        let near = |ratio: f64| (ratio - 1.0).abs() < 1e-6;
        let hardly = oracle::solve_without(dense.ranges, &set).is_some_and(|solution| solution.hdop > 1e4);
        hardly || dense.ratio_without(&set).is_some_and(near)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn sets_are_those_of_dense_solutions(
        ranges in prop::collection::vec(any_range(), 6..11),
        most in 1usize..=3,
        alpha in prop::sample::select(vec![0.01, 0.2, 1e-4]),
    ) {
        let solved = snapshot(&ranges);
        prop_assume!(solved.is_some());
        let snapshot = solved.unwrap();
        let thresholds = Thresholds::from_tables(probability(5e-3), probability(1e-3)).unwrap();
        let alpha = probability(alpha);
        let dense = Dense { ranges: &ranges, thresholds, most, alpha };
        prop_assume!(!is_close(&dense) && !dense.passes(&[]));
        let limits = SearchLimits { rows: most, sets: MAX_SETS, alpha };
        prop_assert_eq!(simultaneous(&snapshot, &thresholds, &limits).to_vec(), dense.simultaneous());
        prop_assert_eq!(answer(&sequential(&snapshot, &thresholds, &limits)), dense.sequential(), "sequential");
        let have = answer(&hybrid_without_grouping(&snapshot, &thresholds, &limits));
        prop_assert_eq!(have, dense.hybrid_without_grouping(), "hybrid without grouping");
        prop_assert_eq!(answer(&grouping(&snapshot, &thresholds, &limits)), dense.grouping(), "grouping");
        prop_assert_eq!(answer(&hybrid(&snapshot, &thresholds, &limits)), dense.hybrid(), "hybrid");
    }
}
