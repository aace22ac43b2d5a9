//! NIC: the navigation integrity category of ADS-B for a horizontal protection level.
//!
//! Each category has a radius of containment, and the level must be below it. A transponder's
//! radius is defined for a risk of 1e-7 an hour. Here the risk follows from the probabilities that
//! `PRAIQ` reports.
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

/// Returns the category of a level in m; 0 without a level, for NaN, and for a level beyond all
/// radii.
pub fn category(hpl_m: Option<f64>) -> u8 {
    // Rounded up slightly, so that single precision never returns a better category.
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
