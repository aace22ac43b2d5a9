//! The five people, and the lines that each of them types.

/// Documents that tell people what to type.
#[cfg(test)]
const DOCUMENTS: [&str; 1] = [include_str!("../../../README.md")];

/// A person.
pub(super) struct Person {
    /// Name for the command line.
    pub(super) name: &'static str,
    /// Title of the person.
    pub(super) title: &'static str,
    /// Sentence on means and aim of the person.
    pub(super) aim: &'static str,
    /// True if the capture lies in the clone before the first line.
    pub(super) has_capture: bool,
    /// Lines, in this order.
    pub(super) lines: &'static [Line],
}

/// A line in the folder of the clone.
pub(super) struct Line {
    /// Text that the shell executes.
    pub(super) typed: &'static str,
    /// Passage of a document that it follows; empty for what people type without one.
    #[cfg_attr(not(test), expect(dead_code, reason = "a test compares it with the documents"))]
    pub(super) told: &'static str,
    /// Words that its output must contain.
    pub(super) shows: &'static [&'static str],
    /// True if it must be refused.
    pub(super) is_refused: bool,
}

impl Line {
    /// Returns the reason why a result is not what must happen.
    pub(super) fn judge(&self, code: Option<i32>, output: &str) -> Option<String> {
        if (code != Some(0)) != self.is_refused {
            let code = code.map_or_else(|| String::from("a signal"), |code| format!("exit code {code}"));
            return Some(format!("`{}` ended with {code}", self.typed));
        }
        let absent = self.shows.iter().find(|words| !output.contains(**words))?;
        Some(format!("`{}` did not print `{absent}`", self.typed))
    }
}

/// Returns a line that a document has.
const fn told(told: &'static str, typed: &'static str, shows: &'static [&'static str]) -> Line {
    Line { typed, told, shows, is_refused: false }
}

/// Returns a line that is in a document as it is typed.
const fn same(typed: &'static str, shows: &'static [&'static str]) -> Line {
    told(typed, typed, shows)
}

/// Returns a line that nobody needs to be told.
const fn own(typed: &'static str, shows: &'static [&'static str]) -> Line {
    told("", typed, shows)
}

/// Everybody.
pub(super) const PEOPLE: [Person; 5] = [NEWCOMER, ENGINEER, C_ENGINEER, RESEARCHER, INTEGRATOR];

const NEWCOMER: Person = Person {
    name: "newcomer",
    title: "A newcomer",
    aim: "Has nothing, and wants to see that it works.",
    has_capture: false,
    lines: &[
        told("cargo xtask demo", "cargo xtask demo --yes --headless", &["protected"]),
        told("cargo xtask test", "cargo xtask test --yes", &[" 0 failed"]),
        told("cargo xtask check", "cargo xtask check --yes", &[" 0 failed"]),
        told("--quick: format, lints and the unit tests", "cargo xtask test --yes --quick", &[" 0 failed"]),
        same("cargo xtask campaign tests-host/campaigns/lpv200.toml", &["availability"]),
    ],
};

const ENGINEER: Person = Person {
    name: "engineer",
    title: "An engineer with a capture",
    aim: "Has the bytes of a receiver's port, and wants to know what happened.",
    has_capture: true,
    lines: &[
        same("cargo xtask replay --sample", &["protected 60"]),
        told("cargo xtask replay capture.ubx", "cargo xtask replay capture.rtcm3", &["protected"]),
        told(
            "cargo xtask replay --sample --inject G06:+80@20..40 --report target/report",
            "cargo xtask replay --sample --inject G06:+80@20..40 --report target/report && ls target/report",
            &["EXCLUDED", "report.html"],
        ),
        told(
            "cargo xtask replay --sample --phase LPV200 --set MASK=5 --csv target/site.csv --satellites target/ranges.csv",
            "cargo xtask replay --sample --phase LPV200 --set MASK=5 --csv target/site.csv --satellites target/ranges.csv && \
             head -n 3 target/site.csv target/ranges.csv",
            &["hpl", "residual"],
        ),
        Line { typed: "cargo xtask replay README.md", told: "", shows: &["README.md"], is_refused: true },
        told(
            "--example stream",
            "cargo run -q -p raim-firmware --example stream < capture.rtcm3",
            &["PRAIS"],
        ),
    ],
};

const C_ENGINEER: Person = Person {
    name: "c-engineer",
    title: "A firmware engineer who writes C",
    aim: "Wants the module in a program in C.",
    has_capture: true,
    lines: &[
        same("cmake -S rai-firmware/capi -B build", &[]),
        same("cmake --build build", &[]),
        same("cmake --install build --prefix out", &["rai.h"]),
        told(
            "pkg-config --cflags --libs rai",
            "export PKG_CONFIG_PATH=out/lib/pkgconfig; \
             cc rai-firmware/capi/examples/c/receiver.c $(pkg-config --cflags --libs rai) -o receiver",
            &[],
        ),
        own("LD_LIBRARY_PATH=out/lib ./receiver < capture.rtcm3", &["PRAIS"]),
    ],
};

const RESEARCHER: Person = Person {
    name: "researcher",
    title: "A researcher",
    aim: "Wants the figures of the papers, and the module in numpy.",
    has_capture: true,
    lines: &[
        told("cargo xtask reproduce", "cargo xtask reproduce --quick --yes", &[]),
        own("python3 -m venv env", &[]),
        told(
            "pip install './rai-firmware/python[frames]'",
            "env/bin/pip install --quiet './rai-firmware/python[frames]'",
            &[],
        ),
        told(
            "raim.replay",
            "env/bin/python -c 'import raim; print(raim.replay(\"capture.rtcm3\").epochs.hpl_m.describe())'",
            &["count", "60.0"],
        ),
    ],
};

const INTEGRATOR: Person = Person {
    name: "integrator",
    title: "An owner of a Linux computer with a receiver",
    aim: "Has a receiver on a serial port (socat plays it from the sample), and wants gpsd to read positions that may be trusted.",
    has_capture: true,
    lines: &[
        same("cargo install --locked --path rai-firmware/cli", &["Installed package"]),
        told("--dry-run --receiver ublox9", "rai configure --dry-run --receiver ublox9", &["RXM_RAWX"]),
        told(
            "rai run --input serial:/dev/ttyUSB0@115200",
            "socat PTY,link=ttyUSB0,rawer SYSTEM:'sleep 4; for i in $(seq 0 99); do \
             dd bs=1500 count=1 skip=$i status=none if=capture.rtcm3; sleep 0.1; done' & \
             sleep 1; timeout 20 rai run --input serial:ttyUSB0@115200 --output udp://127.0.0.1:2950 --set OUTPUT=GSV,1 & \
             sleep 2; gpsd -n -N -S 2999 udp://127.0.0.1:2950 & sleep 1; timeout 20 gpspipe -w -n 30 localhost:2999; \
             kill %3; wait %2; true",
            &["\"class\":\"TPV\"", "\"mode\":3", "\"class\":\"SKY\""],
        ),
    ],
};

#[cfg(test)]
mod tests {
    use super::{DOCUMENTS, PEOPLE};

    #[test]
    fn documents_have_every_line_that_people_are_told_to_type() {
        for line in PEOPLE.iter().flat_map(|person| person.lines) {
            let is_there = DOCUMENTS.iter().any(|text| text.contains(line.told));
            assert!(is_there, "no document says `{}`, which `{}` follows", line.told, line.typed);
        }
    }

    #[test]
    fn a_line_that_fails_or_prints_something_else_ends_a_journey() {
        let line = super::own("true", &["done"]);
        assert_eq!(line.judge(Some(0), "all done"), None);
        assert!(line.judge(Some(1), "all done").is_some_and(|why| why.contains("exit code 1")));
        assert!(line.judge(Some(0), "").is_some_and(|why| why.contains("`done`")));
    }
}
