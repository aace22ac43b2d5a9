//! NIC: the navigation integrity category of ADS-B that a horizontal protection level is good for.
//!
//! The category stands for a radius of containment that the level must stay below. The radius is
//! one of 1e-7 an hour in a transponder; what it is here follows from the probabilities that are
//! set, which `PRAIQ` says.
//!
//! | NIC | 11 | 10 | 9 | 8 | 7 | 6 | 5 | 4 | 3 | 2 | 1 |
//! |---|---|---|---|---|---|---|---|---|---|---|---|
//! | below, m | 7.5 | 25 | 75 | 185.2 | 370.4 | 1111.2 | 1852 | 3704 | 7408 | 14816 | 37040 |
//!
//! References: [DO-260B] and [ICAO-9871], which give the same limits.
//!
//! [DO-260B]: crate#references
//! [ICAO-9871]: crate#references

/// Radius of containment in m and its category, the smallest first.
const CATEGORIES: [(f32, u8); 11] = [
    (7.5, 11),
    (25.0, 10),
    (75.0, 9),
    (185.2, 8),
    (370.4, 7),
    (1111.2, 6),
    (1852.0, 5),
    (3704.0, 4),
    (7408.0, 3),
    (14_816.0, 2),
    (37_040.0, 1),
];

/// The category of a level, m; 0 without a level, or beyond all of them.
pub fn category(hpl_m: Option<f64>) -> u8 {
    // Rounded up a little, so that single precision never finds a better one.
    let Some(hpl_m) = hpl_m.map(|level| level as f32 * (1.0 + f32::EPSILON)) else { return 0 };
    CATEGORIES.iter().find(|(radius_m, _)| hpl_m < *radius_m).map_or(0, |(_, nic)| *nic)
}

#[cfg(test)]
mod tests {
    use super::category;

    #[test]
    fn a_level_below_a_radius_has_its_category() {
        let cases = [
            (7.4, 11),
            (7.5, 10),
            (24.9, 10),
            (25.0, 9),
            (75.0, 8),
            (185.2, 7),
            (370.4, 6),
            (1111.2, 5),
            (1852.0, 4),
            (3704.0, 3),
            (7408.0, 2),
            (14_816.0, 1),
            (37_039.0, 1),
            (37_040.0, 0),
            (f64::INFINITY, 0),
            (f64::NAN, 0),
        ];
        for (hpl_m, want) in cases {
            assert_eq!(category(Some(hpl_m)), want, "{hpl_m} m");
        }
        assert_eq!(category(None), 0);
    }
}
