//! Limits, rates and counts that are constants of the code.

use raim_core::requirements::Requirements;
use rig::bench::time::INTERNAL_HZ;

use crate::Passages;

/// Returns the passages of this file.
pub(crate) fn all() -> Passages {
    [limits(), board(), arithmetic()].concat()
}

fn limits() -> Passages {
    let (npa, lpv) = (Requirements::non_precision_approach(), Requirements::lpv200());
    let val_m = lpv.val_m.expect("a vertical limit");
    vec![
        ("README.md", format!("(HAL {} m), or `LPV200` (HAL {} m, VAL {val_m} m)", npa.hal_m, lpv.hal_m)),
        ("README.md", format!("for the time to alert ({} s in `NPA`)", npa.time_to_alert_s)),
        (
            "README.md",
            format!("darker than the colour of {val_m} m, LPV-200 is unavailable there at least 1 % of"),
        ),
        (
            "README.md",
            format!("(in classic RAIM by default within {:.0} % of them)", 100.0 * npa.guard_fraction),
        ),
        ("LIMITS.md", format!("UTC is GPS time less {} s", raim_firmware::output::nmea::GPS_MINUS_UTC_S)),
        ("LIMITS.md", format!("{} m beside Hawaii", raim_firmware::output::geoid::LARGEST_ERROR_M)),
    ]
}

fn board() -> Passages {
    let rates = raim_firmware::bit_rate::RATES;
    let [slowest, fastest] = [rates.iter().min(), rates.iter().max()].map(|rate| rate.expect("a rate"));
    vec![
        ("README.md", format!("8N1, {slowest} to {fastest} baud")),
        ("README.md", format!("commands in, {} baud", rates[0])),
        ("README.md", format!("without it the module runs at {} MHz", INTERNAL_HZ / 1_000_000)),
    ]
}

fn arithmetic() -> Passages {
    let triples_of_twenty = 20 * 19 * 18 / 6;
    let thousands = format!("{},{:03}", triples_of_twenty / 1000, triples_of_twenty % 1000);
    vec![("DESIGN.md", format!("would take {thousands} solutions for three of twenty"))]
}
