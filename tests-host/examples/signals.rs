#![allow(missing_docs)]
use std::collections::BTreeMap;
use tests_host::recording::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let rec = Recording::load(&[a[1].clone().into()], &[a[2].clone().into()]).unwrap();
    let mut out: BTreeMap<String, usize> = BTreeMap::new();
    for e in &rec.epochs {
        for s in &e.satellites {
            let k = format!(
                "{} {}",
                s.satellite,
                s.signals.iter().map(|g| format!("{}{}", g.band, g.attribute)).collect::<Vec<_>>().join(" ")
            );
            *out.entry(k).or_default() += 1;
        }
    }
    for (k, n) in out {
        if n > 50 {
            println!("{k}: {n}")
        }
    }
}
