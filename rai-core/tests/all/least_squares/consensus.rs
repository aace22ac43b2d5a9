//! Range consensus compared with a second implementation: dense least squares, brute force, no
//! algebra shared with the core.

use nalgebra::{DVector, Matrix4, Vector3, Vector4};
use proptest::prelude::*;
use raim_core::internals::integrity::raim::isolation::ransac::{
    ConsensusLimits, MAX_WORK, NoConsensus, Selection, consensus, refine,
};
use raim_core::internals::least_squares::equations::{LinearEpoch, MAX_ROWS};
use raim_core::satellite::Constellation;

use crate::solved::solved;

use super::oracle::{self, Dense, Range};

type Epoch = LinearEpoch<f64, MAX_ROWS>;

fn epoch(ranges: &[Range]) -> Epoch {
    let mut epoch = Epoch::new();
    for range in ranges {
        let line_of_sight = Vector3::from(range.line_of_sight);
        epoch.satellite(range.constellation, line_of_sight, range.residual_m, range.sigma_m).unwrap();
    }
    epoch
}

/// Returns mostly good ranges, some faulty by metres to kilometres.
fn any_range() -> impl Strategy<Value = Range> {
    any_range_of(0usize..3)
}

fn any_range_of(constellation: impl Strategy<Value = usize>) -> impl Strategy<Value = Range> {
    let fault_m = prop_oneof![8 => Just(0.0), 1 => -60.0..60.0, 1 => -3000.0..3000.0];
    (0.0..std::f64::consts::TAU, 0.08f64..1.0, constellation, -2.5f64..2.5, 1.0f64..4.0, fault_m).prop_map(
        |(azimuth, up, constellation, noise, sigma_m, fault_m)| {
            let level = (1.0 - up * up).sqrt();
            Range {
                line_of_sight: [level * azimuth.sin(), level * azimuth.cos(), up],
                constellation: Constellation::ALL[constellation],
                residual_m: noise * sigma_m + fault_m,
                sigma_m,
            }
        },
    )
}

fn row(range: &Range) -> Vector4<f64> {
    let [east, north, up] = range.line_of_sight;
    Vector4::new(-east, -north, -up, 1.0)
}

/// Returns `tr (Σ h hᵀ)⁻¹` of some ranges, with one common clock.
fn gdop_squared(ranges: &[Range], members: &[usize]) -> f64 {
    let normal = members
        .iter()
        .map(|&index| row(&ranges[index]))
        .fold(Matrix4::zeros(), |sum, h| sum + h * h.transpose());
    normal.try_inverse().map_or(f64::INFINITY, |inverse| inverse.trace())
}

/// Deals as documented, every decision by trying all.
fn deal(ranges: &[Range]) -> Vec<Vec<usize>> {
    let occurs = |clock: &Constellation| ranges.iter().any(|range| range.constellation == *clock);
    let clocks: Vec<Constellation> = Constellation::ALL.into_iter().filter(occurs).collect();
    let mut free: Vec<usize> = (0..ranges.len()).collect();
    let mut subsets: Vec<Vec<usize>> = Vec::new();
    for _ in 0..ranges.len() / (3 + clocks.len()) {
        let corners = largest_tetrahedron(ranges, &free);
        free.retain(|index| !corners.contains(index));
        subsets.push(corners);
    }
    let take = |subset: &mut Vec<usize>, free: &mut Vec<usize>, wanted: &dyn Fn(usize) -> bool| {
        let gain = |index: usize| {
            gdop_squared(ranges, subset) - gdop_squared(ranges, &[&subset[..], &[index]].concat())
        };
        let best =
            free.iter().copied().filter(|&index| wanted(index)).max_by(|&a, &b| gain(a).total_cmp(&gain(b)));
        if let Some(best) = best {
            free.retain(|&index| index != best);
            subset.push(best);
        }
    };
    for subset in &mut subsets {
        for &clock in &clocks {
            if !subset.iter().any(|&index| ranges[index].constellation == clock) {
                take(subset, &mut free, &|index| ranges[index].constellation == clock);
            }
        }
    }
    while !free.is_empty() && !subsets.is_empty() {
        let smallest = (0..subsets.len()).min_by_key(|&number| subsets[number].len()).unwrap();
        take(&mut subsets[smallest], &mut free, &|_| true);
    }
    subsets
}

fn largest_tetrahedron(ranges: &[Range], free: &[usize]) -> Vec<usize> {
    let corner = |index: usize| Vector3::from(ranges[free[index]].line_of_sight);
    let (mut best, mut largest) = (Vec::new(), 0.0);
    for a in 0..free.len() {
        for b in a + 1..free.len() {
            for c in b + 1..free.len() {
                let normal = (corner(b) - corner(a)).cross(&(corner(c) - corner(a)));
                for d in c + 1..free.len() {
                    let volume = normal.dot(&(corner(d) - corner(a))).abs();
                    if volume > largest {
                        (best, largest) = (vec![free[a], free[b], free[c], free[d]], volume);
                    }
                }
            }
        }
    }
    best
}

fn of(ranges: &[Range], members: &[usize]) -> Vec<Range> {
    members.iter().map(|&index| ranges[index]).collect()
}

fn clocks_of(ranges: &[Range]) -> Vec<Constellation> {
    let mut clocks: Vec<_> = ranges.iter().map(|range| range.constellation).collect();
    clocks.sort_unstable();
    clocks.dedup();
    clocks
}

/// Returns the prediction of a range from a solution: residual, and the variance that the solution
/// adds to it. The clock is left out if the solution has none of that constellation.
fn predict(range: &Range, solution: &Dense, clocks: &[Constellation]) -> (f64, f64) {
    let [east, north, up] = range.line_of_sight;
    let of_clock = clocks.iter().map(|clock| f64::from(u8::from(*clock == range.constellation)));
    let design = DVector::from_iterator(3 + clocks.len(), [-east, -north, -up].into_iter().chain(of_clock));
    (range.residual_m - design.dot(&solution.unknowns_m), (&solution.covariance_m2 * &design).dot(&design))
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let last = values.len() - 1;
    f64::midpoint(values[last / 2], values[last.div_ceil(2)])
}

/// Returns `z²` of the ranges outside a subset, by index.
fn deviations(ranges: &[Range], members: &[usize]) -> Option<Vec<(usize, f64)>> {
    let inside = of(ranges, members);
    let (solution, clocks) = (oracle::solve(&inside)?, clocks_of(&inside));
    let mean_sigma_m = inside.iter().map(|range| range.sigma_m).sum::<f64>() / inside.len() as f64;
    let spread_m2: f64 = (0..3).map(|axis| solution.covariance_m2[(axis, axis)]).sum();
    // A PDOP of 1,000.
    if spread_m2 > 1e6 * mean_sigma_m * mean_sigma_m {
        return None;
    }
    let residual = |range: &Range| predict(range, &solution, &clocks).0;
    let level = |clock: Constellation| {
        if clocks.contains(&clock) {
            return 0.0;
        }
        median(ranges.iter().filter(|range| range.constellation == clock).map(residual).collect())
    };
    let outside = (0..ranges.len()).filter(|index| !members.contains(index));
    let squared = |index: usize| {
        let range = &ranges[index];
        let (residual_m, variance_m2) = predict(range, &solution, &clocks);
        (residual_m - level(range.constellation)).powi(2) / (range.sigma_m * range.sigma_m + variance_m2)
    };
    Some(outside.map(|index| (index, squared(index))).collect())
}

/// Returns the accepted subset and the rows that disagree with it; `None` if no subset is accepted.
fn vote(ranges: &[Range], subsets: &[Vec<usize>], bound: f64) -> Option<(usize, Vec<usize>)> {
    let most = 3.min(subsets.len() - 1);
    let votes = subsets.iter().enumerate().filter_map(|(number, members)| {
        let deviations = deviations(ranges, members)?;
        let against: Vec<usize> =
            deviations.iter().filter(|(_, z)| *z >= bound).map(|(index, _)| *index).collect();
        let misfit: f64 = deviations.iter().map(|(_, z)| z.min(bound)).sum();
        (against.len() <= most).then_some((against.len(), misfit, number, against))
    });
    let best = votes.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)))?;
    Some((best.2, best.3))
}

/// Returns true if a decision is so near its bound that rounding may decide it.
fn is_close(ranges: &[Range], subsets: &[Vec<usize>], bound: f64) -> bool {
    let all = subsets.iter().filter_map(|members| deviations(ranges, members)).flatten();
    all.into_iter().any(|(_, z)| (z / bound - 1.0).abs() < 1e-6)
}

fn members(selection: &Selection) -> Vec<Vec<usize>> {
    let of_subset = |subset| (0..selection.rows()).filter(|&row| selection.contains(subset, row)).collect();
    (0..selection.subsets()).map(of_subset).collect()
}

fn sorted(mut subsets: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    for subset in &mut subsets {
        subset.sort_unstable();
    }
    subsets
}

/// Compares the vote on an epoch with that of dense solutions; false with too few subsets or if
/// rounding may decide.
fn check_vote(ranges: &[Range]) -> bool {
    let (epoch, limits) = (epoch(ranges), ConsensusLimits::published().unwrap());
    let selection: Selection = Selection::choose(epoch.rows(), MAX_WORK);
    let bound = limits.consensus.w_test::<f64>(ranges.len()).unwrap().powi(2);
    let subsets = members(&selection);
    if subsets.len() < 2 || is_close(ranges, &subsets, bound) {
        return false;
    }
    let have = consensus(epoch.rows(), &selection, &limits).map(|found| (found.subset, found.rows.to_vec()));
    assert_eq!(have, vote(ranges, &subsets, bound).ok_or(NoConsensus::NoInlier));
    true
}

proptest! {
    // All fours of forty satellites take a while.
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn forty_satellites_are_dealt_as_by_trying_all(ranges in prop::collection::vec(any_range(), 36..=40)) {
        let selection: Selection = Selection::choose(epoch(&ranges).rows(), MAX_WORK);
        prop_assert!(!selection.cut(), "{} looked at", selection.work());
        prop_assert_eq!(members(&selection), sorted(deal(&ranges)));
    }

    #[test]
    fn satellites_near_four_directions_are_dealt_as_by_trying_all(
        spread in 1e-4f64..0.3,
        ranges in prop::collection::vec(any_range(), 20..=24),
    ) {
        let corners = [(0.0, 0.1), (2.1, 0.1), (4.2, 0.1), (1.0, 0.99)];
        let mut ranges = ranges;
        for (range, (azimuth, up)) in ranges.iter_mut().zip(corners.into_iter().cycle()) {
            let level = f64::sqrt(1.0 - up * up);
            let [east, north, height] = range.line_of_sight;
            let near = Vector3::new(
                level * f64::sin(azimuth) + spread * east,
                level * f64::cos(azimuth) + spread * north,
                up + spread * height,
            );
            range.line_of_sight = near.normalize().into();
        }
        let selection: Selection = Selection::choose(epoch(&ranges).rows(), MAX_WORK);
        prop_assert!(!selection.cut());
        prop_assert_eq!(members(&selection), sorted(deal(&ranges)));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]

    #[test]
    fn satellites_are_dealt_as_by_trying_all(ranges in prop::collection::vec(any_range(), 5..22)) {
        let selection: Selection = Selection::choose(epoch(&ranges).rows(), MAX_WORK);
        prop_assert_eq!(members(&selection), sorted(deal(&ranges)));
    }

    #[test]
    fn rows_that_take_no_part_change_no_subset(
        ranges in prop::collection::vec(any_range(), 10..20),
        left_out in 0usize..10,
    ) {
        let mut kept = ranges.clone();
        kept.remove(left_out);
        let mut epoch = epoch(&ranges);
        epoch.leave_out(left_out);
        let have = members(&Selection::choose(epoch.rows(), MAX_WORK));
        let shifted = |index: usize| if index < left_out { index } else { index + 1 };
        let want: Vec<Vec<usize>> =
            deal(&kept).into_iter().map(|subset| subset.into_iter().map(shifted).collect()).collect();
        prop_assert_eq!(have, sorted(want));
    }

    #[test]
    fn the_vote_is_that_of_dense_solutions(ranges in prop::collection::vec(any_range(), 10..26)) {
        prop_assume!(check_vote(&ranges));
    }

    #[test]
    fn a_constellation_that_a_subset_lacks_is_judged_from_its_median(
        few in prop::collection::vec(any_range_of(1usize..2), 2..4),
        most in prop::collection::vec(any_range_of(0usize..1), 17..21),
        first_is_off_m in prop_oneof![Just(0.0), Just(150.0), Just(-900.0)],
    ) {
        // More subsets than the few can be dealt to; all of them are judged from where the first
        // one stands.
        let mut ranges = [few, most].concat();
        ranges[0].residual_m += first_is_off_m;
        prop_assume!(check_vote(&ranges));
    }

    #[test]
    fn the_refinement_is_that_of_dense_solutions(ranges in prop::collection::vec(any_range(), 14..26)) {
        let (epoch, limits) = (epoch(&ranges), ConsensusLimits::published().unwrap());
        let selection: Selection = Selection::choose(epoch.rows(), MAX_WORK);
        let found = consensus(epoch.rows(), &selection, &limits);
        prop_assume!(found.is_ok());
        let found = found.unwrap();
        let snapshot = solved(epoch);
        prop_assume!(snapshot.is_ok());
        let have = refine(snapshot.unwrap().equations(), &selection, &found, &limits);
        let want = refined(&ranges, &found.rows, selection.subsets(), &limits);
        prop_assume!(want.is_some());
        prop_assert_eq!((have.rows.to_vec(), have.passed), want.unwrap());
    }
}

/// Leaves the worst out until the rest passes, then takes back those that agree; `None` if rounding
/// may decide.
fn refined(
    ranges: &[Range],
    named: &[usize],
    subsets: usize,
    limits: &ConsensusLimits<'_>,
) -> Option<(Vec<usize>, bool)> {
    let mut out = named.to_vec();
    let most = 3.min(subsets - 1).max(out.len());
    let kept =
        |out: &[usize]| -> Vec<usize> { (0..ranges.len()).filter(|index| !out.contains(index)).collect() };
    loop {
        let members = kept(&out);
        let Some(solution) = oracle::solve(&of(ranges, &members)) else { return Some((out, false)) };
        let threshold: Option<f64> = limits.refinement.tau1(solution.dof);
        if threshold.is_some_and(|threshold| (solution.sse / threshold - 1.0).abs() < 1e-6) {
            return None;
        }
        if threshold.is_some_and(|threshold| solution.sse < threshold) {
            break;
        }
        if out.len() >= most || solution.dof < 2 {
            return Some((out, false));
        }
        out.push(members[worst(ranges, &members, &solution)?]);
    }
    let members = kept(&out);
    let inside = of(ranges, &members);
    let (solution, clocks) = (oracle::solve(&inside)?, clocks_of(&inside));
    let bound = limits.consensus.w_test::<f64>(ranges.len())?.powi(2);
    let disagrees = |index: &usize| {
        let range = &ranges[*index];
        let (residual_m, variance_m2) = predict(range, &solution, &clocks);
        let squared = residual_m * residual_m / (range.sigma_m * range.sigma_m + variance_m2);
        !clocks.contains(&range.constellation) || squared >= bound
    };
    out.retain(disagrees);
    Some((out, true))
}

/// Returns the index of the largest w-test among ranges that can be tested; `None` if two are as
/// large.
fn worst(ranges: &[Range], members: &[usize], solution: &Dense) -> Option<usize> {
    let squared = |row: usize| {
        let redundancy = solution.projection[(row, row)];
        let normalised = solution.residuals_m[row] / ranges[members[row]].sigma_m;
        if redundancy > 1e-7 { normalised * normalised / redundancy } else { 0.0 }
    };
    let mut order: Vec<usize> = (0..members.len()).collect();
    order.sort_by(|&a, &b| squared(b).total_cmp(&squared(a)));
    (squared(order[1]) < squared(order[0]) * (1.0 - 1e-6)).then_some(order[0])
}

/// Returns eight satellites, twice the same four directions turned by a little.
fn two_alike(first: [f64; 4], second: [f64; 4]) -> Vec<Range> {
    let directions = [(0.0, 0.2), (2.1, 0.25), (4.2, 0.3), (1.0, 0.98)];
    let range = |turned: f64| {
        move |((azimuth, up), residual_m): ((f64, f64), f64)| {
            let level = f64::sqrt(1.0 - up * up);
            let azimuth: f64 = azimuth + turned;
            let line_of_sight = [level * azimuth.sin(), level * azimuth.cos(), up];
            Range { line_of_sight, constellation: Constellation::Gps, residual_m, sigma_m: 2.0 }
        }
    };
    let of = |residuals: [f64; 4], turned| {
        directions.into_iter().zip(residuals).map(range(turned)).collect::<Vec<_>>()
    };
    [of(first, 0.0), of(second, 0.4)].concat()
}

#[test]
fn who_is_contradicted_less_is_accepted() {
    // A fault in the first subset of two: the second, which has one against it, is the inlier.
    let ranges = two_alike([0.0, 0.0, 400.0, 0.0], [0.0; 4]);
    let (epoch, limits) = (epoch(&ranges), ConsensusLimits::published().unwrap());
    let selection: Selection = Selection::choose(epoch.rows(), MAX_WORK);
    let home = (0..2).find(|&subset| selection.contains(subset, 2)).unwrap();
    let have = consensus(epoch.rows(), &selection, &limits).unwrap();
    assert_eq!((have.subset, have.rows.to_vec()), (1 - home, vec![2]));
}

fn towards(direction: Vector3<f64>, residual_m: f64) -> Range {
    let line_of_sight = direction.normalize().into();
    Range { line_of_sight, constellation: Constellation::Gps, residual_m, sigma_m: 3.0 }
}

/// Returns four well spread ranges, the first of them faulty, and four halfway up, `apart` from
/// each other.
fn four_and_a_cluster(apart: f64) -> Vec<Range> {
    let spread = [(0.9, 0.0, 0.3), (-0.5, 0.8, 0.2), (-0.5, -0.8, 0.2), (0.0, 0.0, 1.0)];
    let around = [(1.0, 0.0), (-0.5, 0.9), (-0.5, -0.9), (0.1, 0.2)];
    let four = spread.iter().enumerate().map(|(index, &(east, north, up))| {
        towards(Vector3::new(east, north, up), if index == 0 { 300.0 } else { 0.0 })
    });
    let cluster = around
        .iter()
        .map(|&(east, north)| towards(Vector3::new(0.5 + apart * east, 0.5 + apart * north, 0.7), 0.0));
    four.chain(cluster).collect()
}

/// Returns the PDOP of the cluster.
fn pdop_of_the_cluster(ranges: &[Range]) -> f64 {
    let solution = oracle::solve(&ranges[4..]).unwrap();
    (0..3).map(|axis| solution.covariance_m2[(axis, axis)] / 9.0).sum::<f64>().sqrt()
}

#[test]
fn a_position_that_is_hardly_determined_has_no_vote() {
    let limits = ConsensusLimits::published().unwrap();
    for (pdops, want) in [(850.0..999.0, Ok((1, Vec::new()))), (1001.0..1150.0, Err(NoConsensus::NoInlier))] {
        let skies = (100..400_u16).map(|step| four_and_a_cluster(10.0 / f64::from(step)));
        let ranges = skies.into_iter().find(|ranges| pdops.contains(&pdop_of_the_cluster(ranges))).unwrap();
        let epoch = epoch(&ranges);
        let selection: Selection = Selection::choose(epoch.rows(), MAX_WORK);
        assert_eq!(members(&selection), [[0, 1, 2, 3], [4, 5, 6, 7]]);
        // The first one spoils the spread ones; the cluster, if it may vote, agrees with all.
        let have =
            consensus(epoch.rows(), &selection, &limits).map(|found| (found.subset, found.rows.to_vec()));
        assert_eq!(have, want);
    }
}
