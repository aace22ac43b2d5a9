//! The evidence as a page and as text.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use adversary::attack::Outcome;
use raim::page::html::Page;

use crate::configuration::Part;
use crate::fault_tree::{Cause, HAZARD, of_branch};
use crate::not_shown::NOT_SHOWN;
use crate::requirement::{REQUIREMENTS, Standing};

/// Figures of one run.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// Parts of the configuration.
    pub configuration: Vec<Part>,
    /// Outcome of the tests at the edge of availability.
    pub fde: experiments::Outcome,
    /// Outcomes of the attacks.
    pub attacks: Vec<Outcome>,
}

const TRACE: [&str; 5] = ["requirement", "source", "standing", "implemented in", "tested by"];

impl Evidence {
    /// Returns true if every attack is held and every rate is within its requirement.
    pub fn is_held(&self) -> bool {
        self.attacks.iter().all(Outcome::is_held) && self.fde.failures().next().is_none()
    }

    /// Returns the page.
    pub fn page(&self) -> Page {
        let mut page = Page::new(
            "Evidence",
            &format!(
                "Requirements, faults, configuration and open points of RAI {}. Every figure on this page was \
                 measured when it was made.",
                env!("CARGO_PKG_VERSION")
            ),
        );
        page.figures(&self.counts());
        page.heading("Requirements and their tests");
        page.paragraph(
            "The standards are described in our words, because their texts are not public. The page is no means of \
             compliance.",
        );
        page.table_with_notes(&TRACE, &trace());
        self.add_rates(&mut page);
        self.add_fault_tree(&mut page);
        page.heading("Configuration index");
        page.paragraph("Modules with equal indices return equal verdicts for equal bytes.");
        let part = |part: &Part| vec![part.name.clone(), part.value.clone(), part.command.clone()];
        let rows: Vec<_> = self.configuration.iter().map(part).collect();
        page.table(&["part", "version or SHA-256", "printed by"], &rows);
        page.heading("Not shown");
        let rows: Vec<_> =
            NOT_SHOWN.iter().map(|(what, why)| vec![(*what).to_owned(), (*why).to_owned()]).collect();
        page.table(&["subject", "reason"], &rows);
        page
    }

    /// Returns the numbers at the top of the page.
    fn counts(&self) -> Vec<(String, String)> {
        let standing = |word: &str| REQUIREMENTS.iter().filter(|row| row.standing.word() == word).count();
        let held = self.attacks.iter().filter(|attack| attack.is_held()).count();
        vec![
            ("requirements met".into(), format!("{} of {}", standing("met"), REQUIREMENTS.len())),
            ("partly".into(), standing("partly").to_string()),
            ("not met".into(), standing("not met").to_string()),
            ("attacks held".into(), format!("{held} of {}", self.attacks.len())),
            ("rates out of bounds".into(), self.fde.failures().count().to_string()),
        ]
    }

    fn add_rates(&self, page: &mut Page) {
        page.heading(&self.fde.title);
        page.paragraph(&self.fde.setup);
        for section in &self.fde.sections {
            page.subheading(&section.title);
            let rows: Vec<_> = section
                .rows
                .iter()
                .map(|row| {
                    let holds = row
                        .acceptance
                        .as_ref()
                        .map_or("", |acceptance| if acceptance.holds { "holds" } else { "FAILS" });
                    let cells =
                        [row.quantity.clone(), row.ours.text(), row.ours.interval_text(), holds.to_owned()];
                    (cells.to_vec(), row.reason.clone())
                })
                .collect();
            page.table_with_notes(&["rate over its requirement", "mean", "95 % confidence", "held"], &rows);
        }
    }

    fn add_fault_tree(&self, page: &mut Page) {
        page.heading("Fault tree");
        page.paragraph(
            "Every gate is an OR: each cause alone is tried, and none of them may end in the hazard. The figures are \
             those of the attacks in their quick form.",
        );
        let outcomes: BTreeMap<_, _> = self.attacks.iter().map(|outcome| (outcome.name, outcome)).collect();
        let Cause::AnyOf(hazard, branches) = HAZARD else { return };
        page.paragraph(&format!("Hazard: {hazard}."));
        for branch in branches {
            let mut rows = Vec::new();
            leaves(branch, "", &outcomes, &mut rows);
            page.subheading(if let Cause::AnyOf(title, _) = branch { title } else { "" });
            page.table_with_notes(&["cause", "shown by", "result"], &rows);
        }
    }

    /// Returns the evidence as text for a terminal.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for (name, value) in self.counts() {
            let _ = writeln!(text, "{name:<24}{value}");
        }
        let _ = writeln!(text, "\n{}", self.fde);
        for row in REQUIREMENTS.iter().filter(|row| row.standing != Standing::Met) {
            let _ =
                writeln!(text, "{:<8}{}\n        {}", row.standing.word(), row.text, row.standing.reason());
        }
        for outcome in self.attacks.iter().filter(|outcome| !outcome.is_held()) {
            let _ = writeln!(text, "NOT HELD  {}: {}", outcome.name, outcome.words());
        }
        text
    }
}

fn trace() -> Vec<(Vec<String>, String)> {
    let row = |row: &crate::requirement::Requirement| {
        let cells = [row.text, row.source, row.standing.word(), row.module, row.command];
        (cells.map(str::to_owned).to_vec(), row.standing.reason().to_owned())
    };
    REQUIREMENTS.iter().map(row).collect()
}

/// Adds the leaves below a cause, each with the gates above it.
fn leaves(
    cause: &Cause,
    above: &str,
    outcomes: &BTreeMap<&str, &Outcome>,
    rows: &mut Vec<(Vec<String>, String)>,
) {
    let of = |words: &str| {
        if above.is_empty() { words.to_owned() } else { format!("{above}: {words}") }
    };
    match cause {
        Cause::AnyOf(_, causes) => {
            for cause in *causes {
                let below = if let Cause::AnyOf(inner, _) = cause { *inner } else { above };
                leaves(cause, below, outcomes, rows);
            }
        }
        Cause::Attacks(branch) => {
            for name in of_branch(*branch) {
                let outcome = outcomes.get(name);
                let about = outcome.map_or("", |outcome| outcome.about);
                let held =
                    outcome.map_or("not run", |outcome| if outcome.is_held() { "held" } else { "NOT HELD" });
                let words = outcome.map_or_else(String::new, |outcome| outcome.words());
                rows.push((vec![of(about), format!("cargo xtask attack {name}"), held.into()], words));
            }
        }
        Cause::Test(about, command) => {
            rows.push((vec![of(about), (*command).into(), "in its own run".into()], String::new()));
        }
        Cause::Open(about) => {
            rows.push((vec![of(about), String::new(), "NOT SHOWN".into()], String::new()));
        }
    }
}
