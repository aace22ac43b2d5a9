//! `cargo xtask attack --small`: all attacks on the module with the parts of the image `small`.

use std::time::Instant;

use adversary::attack::module::attack_small;
use adversary::attack::small::{Finding, attempt, write};
use adversary::attack::{Attack, Effort, attacks as all};
use anyhow::{Context as _, ensure};

/// Runs the attacks and prints what they did.
pub(crate) fn run(attacks: &[&Attack], effort: Effort, is_recorded: bool) -> anyhow::Result<()> {
    ensure!(
        !is_recorded || attacks.len() == all().len(),
        "only all attacks can be recorded: leave out the names, or `--record`"
    );
    attack_small(rig::image::build_small_module()?);
    let mut findings = Vec::new();
    for attack in attacks {
        let start = Instant::now();
        let finding = attempt(attack, effort).with_context(|| format!("attack {}", attack.name))?;
        println!("{:<8}  {:<22} {}", word(&finding), attack.name, words(&finding));
        eprintln!("          {:.1} s", start.elapsed().as_secs_f64());
        findings.push((attack.name, finding));
    }
    if is_recorded {
        eprintln!("recorded: {}", write(&findings)?.display());
    }
    Ok(())
}

fn word(finding: &Finding) -> &'static str {
    match finding {
        Finding::NoOpportunity(_) => "-",
        _ if finding.is_held() => "held",
        Finding::Epochs { .. } => "misled",
    }
}

fn words(finding: &Finding) -> String {
    match finding {
        Finding::Epochs { protected, beyond, largest_m: [horizontal_m, vertical_m] } => format!(
            "{beyond} of {protected} protected epochs beyond a level; largest error {horizontal_m:.1} m \
             horizontal, {vertical_m:.1} m vertical"
        ),
        Finding::NoOpportunity(reason) => (*reason).to_owned(),
    }
}
