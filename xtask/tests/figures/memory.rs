//! The second board, memory, and the libraries for C.

use rig::image::{Chip, Named};

use crate::Passages;
use crate::budgets::Budgets;

/// Returns the passages of this file.
pub(crate) fn all(budgets: &Budgets) -> Passages {
    [second_board(budgets), memory(budgets), libraries(budgets)].concat()
}

/// Returns the rows of the table that compares the boards.
fn second_board(budgets: &Budgets) -> Passages {
    let both = |row: &str, names: &[&str]| {
        let of_board = |board: &str| {
            names
                .iter()
                .map(|name| budgets.rounded(&format!("{name}{board}")))
                .collect::<Vec<_>>()
                .join(" / ")
        };
        ("results/cost.md", format!("{row} | {} | {} |", of_board(""), of_board(", Cortex-M7")))
    };
    let fix = [
        "fix and integrity, from 1 km, 20 satellites, f32",
        "fix and integrity, from 1 km, one fault, 20 satellites, f32",
        "fix and integrity, from 1 km, two faults, 20 satellites, f32",
    ];
    vec![
        both("| RTCM of one epoch", &["RTCM of one epoch, two MSM7, 20 satellites"]),
        both("| orbits and clocks", &["orbits and clocks, 20 satellites"]),
        both("| atmosphere, sigmas", &["atmosphere and sigmas, 20 satellites"]),
        both("`f32`: no fault / one / two excluded", &fix),
        both("| the same in `f64`, no fault", &["fix and integrity, from 1 km, 20 satellites, f64"]),
        both("| sentences", &["sentences, 20 satellites"]),
        both("| whole epoch", &["whole epoch, bytes in to bytes out, 20 satellites"]),
    ]
}

fn memory(budgets: &Budgets) -> Passages {
    let of = |image: &str, quantity: &str| budgets.bytes(&format!("image `{image}`: {quantity}, bytes"));
    let whole = Named::of("whole").expect("an image");
    let fast = Named::of("fast").expect("an image");
    let Chip { flash_kib, ram_kib, .. } = smallest_carrier(whole);
    let kib = |bytes: u64| format!("{:.0} KiB", bytes as f64 / 1024.0);
    let stack = format!("{:.1} KiB", of("whole", "stack high water") as f64 / 1024.0);
    let library = budgets.bytes("C library, monitor, classic, 16 satellites: flash, bytes");
    let small = Named::of("small").expect("an image");
    let smaller = smallest_carrier(small);
    let small_ram = of("small", "static RAM") + small.stack_bytes;
    vec![
        (
            "RESULTS.md",
            format!(
                "a chip with {flash_kib} KiB of flash and {ram_kib} KiB of RAM, compiled for size, {} satellites | {}, {} and {stack} of stack",
                whole.satellites,
                kib(of("whole", "flash")),
                kib(of("whole", "static RAM"))
            ),
        ),
        ("RESULTS.md", format!("library for C on a Cortex-M4F | {} of flash", kib(library))),
        (
            "results/cost.md",
            format!("Its statics and stack take {:.1} KiB of RAM", small_ram as f64 / 1024.0),
        ),
        (
            "results/cost.md",
            format!("and leave {} KiB of flash to other code", smaller.flash_kib - small.flash_kib),
        ),
        (
            "results/cost.md",
            format!(
                "leave {} KiB of flash and {} KiB of RAM of a chip with 256 and 64 KiB",
                256 - whole.flash_kib,
                64 - whole.ram_kib
            ),
        ),
        ("LIMITS.md", format!("has room for {} satellites instead of {}", whole.satellites, fast.satellites)),
        (
            "LIMITS.md",
            format!(
                "chips with {} KiB of flash and {} KiB of RAM, reads RTCM 3 alone",
                smaller.flash_kib, smaller.ram_kib
            ),
        ),
        ("LIMITS.md", format!("needs {} of flash and {} of RAM", kib(of("small", "flash")), kib(small_ram))),
    ]
}

/// Returns the chip with the least memory among those that carry an image.
fn smallest_carrier(image: &Named) -> Chip {
    let carriers = image.carriers().concat();
    carriers.into_iter().min_by_key(|chip| (chip.flash_kib, chip.ram_kib)).expect("a chip")
}

/// Returns the rows of the table of the libraries for C.
fn libraries(budgets: &Budgets) -> Passages {
    let kib = |build: &str| {
        let bytes = budgets.bytes(&format!("C library, {build}: flash, bytes"));
        format!("{:.0}", bytes as f64 / 1024.0)
    };
    let rows = [
        ("thresholds of the phases of flight", "monitor, classic, 48 satellites"),
        ("which has no floating-point hardware", "monitor, classic, 48 satellites, Cortex-M0+"),
        ("with all tables and the papers' searches", "monitor, all tables and searches, 48 satellites"),
        ("with ARAIM as well", "monitor, all and ARAIM, 48 satellites"),
        ("RTCM and classic RAIM", "receiver, RTCM and classic, 48 satellites"),
    ];
    let everything = ["receiver, 48 satellites", "receiver, 16 satellites"].map(kib);
    let [most, least] = everything;
    let last = format!("| `rai_receiver_*`, everything | {most} KiB | {least} KiB with room for 16 |");
    let rows = rows.map(|(row, build)| format!("{row} | {} KiB |", kib(build)));
    rows.into_iter().chain([last]).map(|row| ("results/cost.md", row)).collect()
}
