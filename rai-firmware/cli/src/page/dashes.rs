//! Dashes of a line, in pixels.
//!
//! The chart library turns each dash by the sine and the cosine of the system, whose last bit differs
//! between systems, so that the same report would differ by a pixel. These dashes are parts of the
//! line itself: a quotient of lengths, whose result IEEE 754 defines.

/// Place in pixels.
type Place = (i32, i32);

/// Returns the dashes of a line through these places, each as a line of its own. A dash and a gap have
/// these lengths, in pixels.
pub(super) fn dashes(line: &[Place], dash: f64, gap: f64) -> Vec<Vec<Place>> {
    let mut all = vec![line.first().copied().into_iter().collect::<Vec<Place>>()];
    let (mut is_drawn, mut left) = (true, dash);
    for (from, to) in line.iter().zip(line.iter().skip(1)) {
        let length = libm::hypot(f64::from(to.0 - from.0), f64::from(to.1 - from.1));
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let at = between(*from, *to, done / length);
            if let Some(open) = all.last_mut().filter(|_| is_drawn) {
                open.push(at);
            } else {
                all.push(vec![at]);
            }
            is_drawn = !is_drawn;
            left = if is_drawn { dash } else { gap };
        }
        left -= length - done;
        if let Some(open) = all.last_mut().filter(|_| is_drawn) {
            open.push(*to);
        }
    }
    all.retain(|one| one.len() > 1);
    all
}

/// Returns the place at a share of the way.
fn between(from: Place, to: Place, share: f64) -> Place {
    let part = |from: i32, to: i32| from + (f64::from(to - from) * share).round() as i32;
    (part(from.0, to.0), part(from.1, to.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_and_gaps_alternate_around_corners() {
        assert_eq!(
            dashes(&[(0, 0), (30, 0)], 7.0, 5.0),
            [[(0, 0), (7, 0)], [(12, 0), (19, 0)], [(24, 0), (30, 0)]]
        );
        // The second dash begins 2 pixels before the corner and ends 5 behind it.
        let have = dashes(&[(0, 0), (14, 0), (14, 6)], 7.0, 5.0);
        assert_eq!(have, [vec![(0, 0), (7, 0)], vec![(12, 0), (14, 0), (14, 5)]]);
        // 3, 4, 5: a dash of 5 pixels on a slope.
        assert_eq!(dashes(&[(0, 0), (6, 8)], 5.0, 5.0), [[(0, 0), (3, 4)]]);
        for short in [&[][..], &[(3, 3)]] {
            assert_eq!(dashes(short, 7.0, 5.0), [[(0, 0); 0]; 0]);
        }
    }
}
