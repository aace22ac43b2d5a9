//! Bill of materials: every package that `rai` and the firmware contain, as `CycloneDX` 1.5.
//!
//! Packages that only tests or builds need are not part of it. Build scripts and procedural macros
//! are, because they run on the machine that builds.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use serde_json::{Value, json};

use super::VERSION;
use xtask::cargo::command;

/// Packages that are shipped.
const SHIPPED: [&str; 2] = ["raim", "rai-capi"];

/// Writes the bill of materials, and returns its path.
///
/// # Errors
/// If cargo does not describe the packages.
pub(super) fn write(out: &Path) -> Result<PathBuf> {
    let path = out.join(format!("rai-{VERSION}.cdx.json"));
    fs::write(&path, text()?)?;
    Ok(path)
}

/// Returns the bill of materials.
///
/// # Errors
/// If cargo does not describe the packages.
pub(super) fn text() -> Result<String> {
    let output =
        command(&["metadata", "--format-version", "1", "--locked", "--features", "raim/tls"]).output()?;
    ensure!(output.status.success(), "`cargo metadata` failed:\n{}", String::from_utf8_lossy(&output.stderr));
    let bill = bill(&serde_json::from_slice(&output.stdout)?)?;
    Ok(serde_json::to_string_pretty(&bill)? + "\n")
}

fn bill(metadata: &Value) -> Result<Value> {
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let packages: BTreeMap<String, Value> =
        list(&metadata["packages"]).into_iter().map(|package| (text(&package["id"]), package)).collect();
    let needs: BTreeMap<String, BTreeSet<String>> = list(&metadata["resolve"]["nodes"])
        .iter()
        .map(|node| (text(&node["id"]), shipped_needs(node)))
        .collect();
    let mut found = BTreeSet::new();
    let is_shipped = |package: &Value| SHIPPED.contains(&package["name"].as_str().unwrap_or_default());
    let mut open: Vec<_> =
        packages.iter().filter(|(_, package)| is_shipped(package)).map(|(id, _)| id.clone()).collect();
    while let Some(id) = open.pop() {
        if found.insert(id.clone()) {
            open.extend(needs.get(&id).into_iter().flatten().cloned());
        }
    }
    ensure!(!found.is_empty(), "cargo names none of the packages that are shipped");
    let component = |id: &String| packages.get(id).map(component).context("a package without description");
    let dependency = |id: &String| {
        let on = needs.get(id).into_iter().flatten();
        let on: Vec<_> = on.filter_map(|id| packages.get(id)).map(reference).collect();
        packages.get(id).map(|package| json!({ "ref": reference(package), "dependsOn": on }))
    };
    Ok(json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": { "component": {
            "type": "application", "name": "rai", "version": VERSION, "bom-ref": "rai",
            "licenses": [{ "expression": "MIT OR Apache-2.0" }],
        } },
        "components": found.iter().map(component).collect::<Result<Vec<_>>>()?,
        "dependencies": found.iter().filter_map(dependency).collect::<Vec<_>>(),
    }))
}

/// Returns the packages that a package needs to run or to be built, without those of its tests.
fn shipped_needs(node: &Value) -> BTreeSet<String> {
    let needed = |dependency: &&Value| {
        let kinds = dependency["dep_kinds"].as_array();
        kinds.is_some_and(|kinds| kinds.iter().any(|kind| kind["kind"] != "dev"))
    };
    let all = node["deps"].as_array().into_iter().flatten().filter(needed);
    all.filter_map(|dependency| dependency["pkg"].as_str()).map(str::to_owned).collect()
}

/// Returns the name of a package in the bill, the address that a package has in the registry.
fn reference(package: &Value) -> String {
    let part = |key: &str| package[key].as_str().unwrap_or_default();
    format!("pkg:cargo/{}@{}", part("name"), part("version"))
}

fn component(package: &Value) -> Value {
    let reference = reference(package);
    let mut component = json!({
        "type": "library",
        "name": package["name"],
        "version": package["version"],
        "bom-ref": reference,
    });
    // Our own packages are in no registry, where somebody else may take their names.
    if package["source"].is_string() {
        component["purl"] = json!(reference);
    }
    if let Some(licence) = package["license"].as_str() {
        // Older packages separate alternatives by a slash.
        component["licenses"] = json!([{ "expression": licence.replace('/', " OR ") }]);
    }
    component
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bill_lists_what_is_shipped_and_nothing_of_the_tests() {
        let folder = tempfile::tempdir().unwrap();
        let path = write(folder.path()).unwrap();
        let bill: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
        let components = bill["components"].as_array().unwrap();
        let names: BTreeSet<_> =
            components.iter().filter_map(|component| component["name"].as_str()).collect();
        let ours = ["raim", "raim-core", "raim-firmware", "raim-root", "raim-single"];
        assert!(ours.iter().chain(&["nalgebra", "clap"]).all(|name| names.contains(name)), "{names:?}");
        assert!(!names.contains("tests-host") && !names.contains("proptest"), "{names:?}");
        let lock = fs::read_to_string(xtask::cargo::root().join("Cargo.lock")).unwrap();
        let mut references = BTreeSet::new();
        for component in components {
            let [name, version] = ["name", "version"].map(|key| component[key].as_str().unwrap());
            assert!(
                lock.contains(&format!("name = \"{name}\"\nversion = \"{version}\"")),
                "{name} {version}"
            );
            assert!(component["licenses"].is_array(), "{name} has no licence");
            assert!(references.insert(component["bom-ref"].as_str().unwrap()), "{name} {version} twice");
        }
        for dependency in bill["dependencies"].as_array().unwrap() {
            let on = dependency["dependsOn"].as_array().unwrap().iter().filter_map(Value::as_str);
            assert!(
                on.chain(dependency["ref"].as_str()).all(|name| references.contains(name)),
                "{dependency}"
            );
        }
    }
}
