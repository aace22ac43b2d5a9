//! Instructions and times on the target.

use rig::bench::time::FULL_HZ;

use crate::Passages;
use crate::budgets::Budgets;

/// Returns the passages of this file.
pub(crate) fn all(budgets: &Budgets) -> Passages {
    [cost(budgets), stages(budgets), times(budgets), methods(budgets)].concat()
}

fn cost(budgets: &Budgets) -> Passages {
    const USUAL: &str = "whole epoch, bytes in to bytes out, 20 satellites";
    const WORST: &str = "worst-case epoch of a stream";
    let mhz = FULL_HZ / 1_000_000;
    let (usual, worst) = (budgets.millions(USUAL), budgets.millions(WORST));
    let (usual_ms, worst_ms) = (budgets.times_ms(USUAL), budgets.times_ms(WORST));
    let fix = budgets.millions("fix and integrity, from 1 km, 20 satellites, f32");
    vec![
        (
            "README.md",
            format!(
                "A whole epoch of 20 satellites costs {usual} million instructions on a Cortex-M4F, \
                 {usual_ms} at {mhz} MHz"
            ),
        ),
        (
            "RESULTS.md",
            format!(
                "A whole epoch of 20 satellites on the chip | {usual} M instructions, {usual_ms} at {mhz} MHz"
            ),
        ),
        ("RESULTS.md", format!("fix and integrity of it {fix} M |")),
        ("RESULTS.md", format!("no fault | {fix} / 2.0")),
        (
            "RESULTS.md",
            format!("that a search found, 40 satellites | {worst} M instructions, {worst_ms}; the pin"),
        ),
    ]
}

/// Returns the rows of the table of stages, without the goals.
fn stages(budgets: &Budgets) -> Passages {
    let of = |name: &str| budgets.rounded(name);
    let test = |count: u8| of(&format!("snapshot and tests, {count} satellites, two constellations, f32"));
    let of_twenty = |what: &str| of(&format!("{what}, 20 satellites, two constellations, f32"));
    let of_forty = |what: &str| of(&format!("{what}, 40 satellites, two constellations, f32"));
    let (kept, new) = ("RANSAC, selection kept", "RANSAC, new selection");
    let araim = |sky: &str| {
        let [without, with] =
            ["no biases", "biases"].map(|biases| of(&format!("ARAIM, {sky}, {biases}, f32")));
        format!("{without} / {with}")
    };
    let fix = |what: &str| of(&format!("fix and integrity, from {what}20 satellites, f32"));
    let rows = [
        format!("w-tests, slopes, HPL, VPL | {} (40 satellites: {}) |", test(20), test(40)),
        format!("one excluded and tested again | {} |", of_twenty("the same, one left out and tested again")),
        format!(
            "all pairs / all triples | {} / {} |",
            of_twenty("grouping, all pairs"),
            of_twenty("grouping, all triples")
        ),
        format!(
            "selection kept / new | {} / {} (40 satellites: {} / {}) |",
            of_twenty(kept),
            of_twenty(new),
            of_forty(kept),
            of_forty(new)
        ),
        format!("without / with nominal biases | {} |", araim("20 satellites of 2 constellations")),
        format!("30 of 3 (375 modes) | {} |", araim("30 satellites of 3 constellations")),
        format!("40 of 4 (770 modes) | {} |", araim("40 satellites of 4 constellations")),
        format!("update and forecast | {} |", of("clock aiding, update and forecast")),
        format!(
            "| T_OP / T2 for a new geometry | {} / {} |",
            of("T_OP for a new geometry"),
            of("T2 for a new geometry")
        ),
        format!("ranges compared with those before | {} |", of("RTCM of one epoch, two MSM7, 20 satellites")),
        format!("places and bands compared | {} |", of("orbits and clocks, 20 satellites")),
        format!("| atmosphere, sigmas | {} |", of("atmosphere and sigmas, 20 satellites")),
        format!(
            "no fault / one / two excluded | {} / {} / {} |",
            fix("1 km, "),
            fix("1 km, one fault, "),
            fix("1 km, two faults, ")
        ),
        format!("the same from the last position | {} |", fix("the last position, ")),
        format!("including `RMC`, `GGA` and `VTG` | {} |", of("sentences, 20 satellites")),
        format!("RXM-RAWX of 40 signals | {} |", of("UBX of one epoch, RAWX of 40 signals, 20 satellites")),
        format!(
            "**whole epoch by UBX**, the same 20 satellites | **{} M** |",
            budgets.millions("whole epoch by UBX, bytes in to bytes out, 20 satellites")
        ),
        format!(
            "the same as the first of a stream | {} M / {} M |",
            budgets.millions("worst-case epoch of a stream"),
            budgets.millions("worst-case first epoch")
        ),
        format!(
            "deepest stack, KiB | {:.0} / {:.1} / {:.1} |",
            budgets.kib("image `fast`: flash, bytes"),
            budgets.kib("image `fast`: static RAM, bytes"),
            budgets.kib("image `fast`: stack high water, bytes")
        ),
    ];
    rows.map(|row| ("results/cost.md", row)).into()
}

/// Returns the rows of the table of times.
fn times(budgets: &Budgets) -> Passages {
    [
        ("| 20 satellites", "whole epoch, bytes in to bytes out, 20 satellites"),
        ("| worst-case epoch of a stream", "worst-case epoch of a stream"),
        ("the pin is low before it", "worst-case first epoch"),
    ]
    .map(|(row, name)| {
        let ratios = budgets.cycles(name, FULL_HZ).map(|cycles| cycles / budgets.bytes(name) as f64);
        let (full, internal) = (budgets.times_ms(name), budgets.times_without_crystal_ms(name));
        let [least, most] = ratios;
        let millions = budgets.millions(name);
        ("results/cost.md", format!("{row} | {millions} M | {least:.2} to {most:.2} | {full} | {internal} |"))
    })
    .into()
}

/// Returns the costs of the methods of isolation.
fn methods(budgets: &Budgets) -> Passages {
    let judged =
        |faulty: u8| budgets.bytes(&format!("epoch judged by BAARDA, faulty {faulty} of 20 satellites, f32"));
    let excluding = (judged(1) - judged(0)) as f64 / 1e6;
    let of_sky = |what: &str, count: u8| {
        budgets.millions(&format!("{what}, {count} satellites, two constellations, f32"))
    };
    let triples = [20, 40].map(|count| of_sky("grouping, all triples", count));
    let (new, kept) = (of_sky("RANSAC, new selection", 40), of_sky("RANSAC, selection kept", 40));
    let [without_rates, araim] = [
        budgets.millions("whole epoch without range rates, bytes in to bytes out, 20 satellites"),
        budgets.rounded("ARAIM, 20 satellites of 2 constellations, no biases, f32"),
    ];
    vec![
        (
            "results/integrity.md",
            format!("excluding one of 20 satellites costs {excluding:.2} M instructions"),
        ),
        (
            "results/integrity.md",
            format!(
                "All triples of 20 satellites cost {} M instructions, of 40 satellites {} M",
                triples[0], triples[1]
            ),
        ),
        (
            "results/integrity.md",
            format!("A new set of 40 satellites costs {new} M instructions, the same set again {kept} M"),
        ),
        ("results/cost.md", format!("({without_rates} M from a receiver without Doppler frequencies)")),
        ("results/cost.md", format!("Of the {araim} instructions with 22 modes")),
        ("results/adversary.md", format!("| {} figures |", budgets.count())),
    ]
}
