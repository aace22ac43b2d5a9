//! The documented interface of the two libraries, as calls that a proof can link.
//!
//! rustdoc writes what it documents as JSON. Each public function becomes a pointer that the image
//! passes out, so that the compiler translates it for any arguments:
//!
//! | documented | in the image |
//! |---|---|
//! | `fn push(&mut self, Observation) -> Result` of `Epoch<N>` | `Epoch::<48>::push as fn(_, _) -> _` |
//! | `fn fmt` of `impl Display for EpochError` | `<EpochError as Display>::fmt as fn(_, _) -> _` |
//! | `T: Real` | once with `f32`, once with `f64` |
//! | `W: Write`, and any other bound; `()` without one | `stand_in::Write`: a type of the bound's name in the image |
//! | `-> impl Iterator` | each of its elements |
//!
//! What the documentation hides promises nothing to anybody, and is proved where an image runs it.
//! Derived implementations and methods that a trait provides are left out.
//!
//! The format is that of the pinned compiler ([rustdoc JSON]).
//!
//! [rustdoc JSON]: https://doc.rust-lang.org/nightly/nightly-rustc/rustdoc_json_types/

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context as _, ensure};
use serde_json::Value;

use crate::image::{self, CompiledFor};

/// Where the documentation is written.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/interface");

/// The source that the image includes.
pub const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/interface/calls.rs");

/// A library, the features of the proof beside those at start, and the value of its constants.
const LIBRARIES: [(&str, &str, &str); 2] = [
    ("raim-core", "double-tables", "{ ::raim_firmware::correction::CAPACITY }"),
    ("raim-firmware", "", "64"),
];

/// Writes the source, unless it is there already.
///
/// # Errors
/// If a library has no documentation, or that names a type that is nowhere public.
pub fn write() -> anyhow::Result<()> {
    let source = source()?;
    if std::fs::read_to_string(FILE).ok().as_ref() != Some(&source) {
        std::fs::write(FILE, source).context(FILE)?;
    }
    Ok(())
}

/// Returns the source of a function that passes out every documented function.
fn source() -> anyhow::Result<String> {
    let mut found = Found::default();
    for (package, features, constant) in LIBRARIES {
        let library = Library { documentation: documentation(package, features)?, constant };
        library.visit(&library.documentation["root"], "", None, &mut found)?;
    }
    ensure!(found.calls.len() > 100, "rustdoc's format has changed: {} functions", found.calls.len());
    Ok(format!("pub fn reach_all() {{\n{}}}\n", found.calls.concat()))
}

/// Returns what rustdoc documents of a library on the chip.
fn documentation(package: &str, features: &str) -> anyhow::Result<Value> {
    const TARGET: &str = "thumbv7em-none-eabihf";
    let mut cargo = image::cargo();
    cargo.args(["rustdoc", "--quiet", "--lib", "--target", TARGET, "--package", package]);
    cargo.args(["--target-dir", FOLDER, "--profile", CompiledFor::Speed.profile(), "--features", features]);
    cargo.args(["--", "-Zunstable-options", "--output-format=json", "--cap-lints=allow"]);
    // JSON is unstable, and the compiler is pinned.
    ensure!(cargo.env("RUSTC_BOOTSTRAP", "1").status()?.success(), "{package} has no documentation");
    let name = package.replace('-', "_");
    let file = Path::new(FOLDER).join(TARGET).join("doc").join(name).with_extension("json");
    let text = std::fs::read(&file).with_context(|| file.display().to_string())?;
    Ok(serde_json::from_slice(&text)?)
}

/// What was found so far, of both libraries.
#[derive(Default)]
struct Found {
    calls: Vec<String>,
    /// Public path of a type, by its name.
    types: BTreeMap<String, String>,
}

/// Names of generic parameters, and the types and constants in their place.
type Arguments = Vec<(String, String)>;

struct Library {
    documentation: Value,
    constant: &'static str,
}

impl Library {
    fn item(&self, id: &Value) -> &Value {
        &self.documentation["index"][id.to_string()]
    }

    /// Collects what a public item contains, under its own name or that of a `use`.
    fn visit(&self, id: &Value, above: &str, name: Option<&str>, found: &mut Found) -> anyhow::Result<()> {
        let item = self.item(id);
        if item["visibility"] != "public" {
            return Ok(());
        }
        let path = format!("{above}::{}", name.unwrap_or(text(&item["name"])));
        for (kind, inner) in item["inner"].as_object().into_iter().flatten() {
            match kind.as_str() {
                "module" => list(&inner["items"]).try_for_each(|id| self.visit(id, &path, None, found))?,
                "use" => self.visit(&inner["id"], above, inner["name"].as_str(), found)?,
                "function" => self.call(&path, item, found),
                "struct" | "enum" => {
                    found.types.insert(text(&item["name"]).to_owned(), path.clone());
                    let mut implementations = list(&inner["impls"]).map(|id| self.item(id));
                    implementations.try_for_each(|item| self.implementation(item, &path, found))?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Collects the functions of an implementation, unless the compiler wrote it.
    fn implementation(&self, item: &Value, path: &str, found: &mut Found) -> anyhow::Result<()> {
        let of = &item["inner"]["impl"];
        let is_derived = item["attrs"].to_string().contains("automatically_derived");
        if is_derived || of["is_synthetic"] == true || !of["blanket_impl"].is_null() {
            return Ok(());
        }
        for arguments in self.arguments(&of["generics"]) {
            let mut owner = format!("{path}{}", given(&of["for"]["resolved_path"], &arguments, found)?);
            if !of["trait"].is_null() {
                let of = &of["trait"];
                owner = format!("<{owner} as {}{}>", self.path(&of["id"]), given(of, &arguments, found)?);
            }
            for item in list(&of["items"]).map(|id| self.item(id)) {
                if !of["trait"].is_null() || item["visibility"] == "public" {
                    self.call(&format!("{owner}::{}", text(&item["name"])), item, found);
                }
            }
        }
        Ok(())
    }

    /// Returns the path of a trait of any library.
    fn path(&self, id: &Value) -> String {
        let path: Vec<&str> = list(&self.documentation["paths"][id.to_string()]["path"]).map(text).collect();
        match path[..] {
            // What `core` has in private files is public in the module above.
            ["core", module, .., name] => format!("::core::{module}::{name}"),
            _ => format!("::{}", path.join("::")),
        }
    }

    /// Adds a function, for each choice of its own parameters. Other items are none.
    fn call(&self, path: &str, item: &Value, found: &mut Found) {
        let function = &item["inner"]["function"];
        if function.is_null() {
            return;
        }
        let (inputs, output) = (&function["sig"]["inputs"], &function["sig"]["output"]);
        for own in self.arguments(&function["generics"]) {
            // The type of the pointer names a parameter `impl Trait`, the path every other one.
            let (unnamed, named): (Arguments, Arguments) =
                own.into_iter().partition(|(name, _)| name.starts_with("impl "));
            let path = format!("{path}{}", bracketed(named.into_iter().map(|(_, argument)| argument)));
            let is_closure = !unnamed.is_empty() || !output["impl_trait"].is_null();
            let mut unnamed = unnamed.into_iter().map(|(_, argument)| argument);
            let kinds = list(inputs).map(|input| {
                let next = if input[1]["impl_trait"].is_null() { None } else { unnamed.next() };
                next.unwrap_or_else(|| "_".to_owned())
            });
            let kinds = joined(kinds);
            let taken = joined(list(inputs).enumerate().map(|(number, _)| format!("a{number}")));
            let called = match output["impl_trait"].is_null() {
                true if is_closure => format!("(|{taken}| {path}({taken}))"),
                true => path,
                false => format!("(|{taken}| crate::exhaust({path}({taken})))"),
            };
            let result = if output.is_null() || !output["impl_trait"].is_null() { "" } else { " -> _" };
            found.calls.push(format!("    ::core::hint::black_box({called} as fn({kinds}){result});\n"));
        }
    }

    /// Returns the choices of arguments for parameters: two if one of them is a precision.
    fn arguments(&self, generics: &Value) -> Vec<Arguments> {
        let mut choices = vec![Arguments::new()];
        for parameter in list(&generics["params"]) {
            let (name, kind) = (text(&parameter["name"]), &parameter["kind"]);
            let values = match bound(name, generics).as_deref() {
                _ if !kind["lifetime"].is_null() => continue,
                _ if !kind["const"].is_null() => vec![self.constant.to_owned()],
                Some("Real") => vec!["f32".to_owned(), "f64".to_owned()],
                Some(bound) => vec![format!("crate::stand_in::{bound}")],
                None => vec!["()".to_owned()],
            };
            let with = |value: String| {
                let add =
                    move |choice: &Arguments| [&choice[..], &[(name.to_owned(), value.clone())]].concat();
                choices.iter().map(add).collect::<Vec<_>>()
            };
            choices = values.into_iter().flat_map(with).collect();
        }
        choices
    }
}

/// Returns the name of the trait that bounds a parameter. That of a function has the number of
/// arguments behind it.
fn bound(name: &str, generics: &Value) -> Option<String> {
    let own = list(&generics["params"]).find(|parameter| parameter["name"] == name)?;
    let predicates = list(&generics["where_predicates"]).map(|predicate| &predicate["bound_predicate"]);
    let later = predicates.filter(|predicate| predicate["type"]["generic"] == name);
    let bounds = list(&own["kind"]["type"]["bounds"]).chain(later.flat_map(|later| list(&later["bounds"])));
    let of = bounds.map(|bound| &bound["trait_bound"]["trait"]).find(|of| of["path"].is_string())?;
    let takes = of["args"]["parenthesized"]["inputs"].as_array();
    Some(format!("{}{}", last(&of["path"]), takes.map_or(String::new(), |takes| takes.len().to_string())))
}

/// Returns the arguments of a type or a trait, with what stands for its parameters.
fn given(of: &Value, chosen: &Arguments, found: &Found) -> anyhow::Result<String> {
    let mut texts = Vec::new();
    for argument in list(&of["args"]["angle_bracketed"]["args"]) {
        let (kind, constant) = (&argument["type"], &argument["const"]["expr"]);
        if let Some((_, value)) =
            chosen.iter().find(|(name, _)| kind["generic"] == **name || constant == name)
        {
            texts.push(value.clone());
        } else if kind["resolved_path"].is_object() {
            let name = last(&kind["resolved_path"]["path"]);
            texts.push(found.types.get(name).with_context(|| format!("{name} is nowhere public"))?.clone());
        }
    }
    Ok(bracketed(texts.into_iter()))
}

/// Returns arguments as they stand behind a path.
fn bracketed(arguments: impl Iterator<Item = String>) -> String {
    let arguments = joined(arguments);
    if arguments.is_empty() { arguments } else { format!("::<{arguments}>") }
}

fn joined(texts: impl Iterator<Item = String>) -> String {
    texts.collect::<Vec<_>>().join(", ")
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// Returns the last name of a path.
fn last(path: &Value) -> &str {
    text(path).rsplit("::").next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::{Found, Library};

    /// The calls of a library with one public type that has one implementation.
    fn calls(implementation: &serde_json::Value, function: &serde_json::Value) -> Vec<String> {
        let public = |name: &str, inner| json!({"name": name, "visibility": "public", "inner": inner});
        let documentation = json!({
            "root": 0,
            "index": {
                "0": public("core", json!({"module": {"items": [1, 5]}})),
                "1": public("Epoch", json!({"struct": {"impls": [2, 4]}})),
                "2": {"attrs": [], "inner": {"impl": implementation}},
                "3": {"name": "push", "visibility": "public", "inner": {"function": function}},
                "4": {"attrs": ["#[automatically_derived]"], "inner": {"impl": implementation}},
                "5": {"name": "Hidden", "visibility": "crate", "inner": {"struct": {"impls": [2]}}},
            },
            "paths": {"9": {"path": ["core", "ops", "arith", "Add"]}},
        });
        let library = Library { documentation, constant: "7" };
        let mut found = Found::default();
        library.visit(&library.documentation["root"], "", None, &mut found).expect("a documentation");
        let call = |line: &String| {
            line.trim()
                .strip_prefix("::core::hint::black_box(")
                .and_then(|rest| rest.strip_suffix(");"))
                .map(str::to_owned)
        };
        found.calls.iter().filter_map(call).collect()
    }

    fn parameter(name: &str, bound: &str) -> serde_json::Value {
        json!({"name": name, "kind": {"type": {"bounds": [{"trait_bound": {"trait": {"path": bound}}}]}}})
    }

    #[test]
    fn parameters_have_what_stands_for_them() {
        let precision = json!({
            "generics": {"params": [
                {"name": "'a", "kind": {"lifetime": {}}}, parameter("T", "numeric::Real"),
                {"name": "N", "kind": {"const": {}}},
            ]},
            "for": {"resolved_path": {"args": {"angle_bracketed": {"args": [
                {"lifetime": "'a"}, {"type": {"generic": "T"}}, {"const": {"expr": "N"}},
            ]}}}},
            "items": [3],
        });
        let function = json!({
            "generics": {"params": [parameter("W", "Write")]},
            "sig": {"inputs": [["self", {}], ["host", {"generic": "W"}]], "output": {"primitive": "bool"}},
        });
        let call = |precision| {
            format!("::core::Epoch::<{precision}, 7>::push::<crate::stand_in::Write> as fn(_, _) -> _")
        };
        assert_eq!(calls(&precision, &function), [call("f32"), call("f64")]);
    }

    #[test]
    fn functions_of_traits_and_with_unnamed_types_are_called_by_what_they_are() {
        let add = json!({"trait": {"id": 9}, "items": [3]});
        let function = json!({
            "generics": {"params": [parameter("impl Iterator", "Iterator")]},
            "sig": {"inputs": [["self", {}], ["more", {"impl_trait": []}]], "output": null},
        });
        let want = "(|a0, a1| <::core::Epoch as ::core::ops::Add>::push(a0, a1)) as fn(_, crate::stand_in::Iterator)";
        assert_eq!(calls(&add, &function), [want]);
        let all = json!({"sig": {"inputs": [], "output": {"impl_trait": []}}});
        let want = "(|| crate::exhaust(<::core::Epoch as ::core::ops::Add>::push())) as fn()";
        assert_eq!(calls(&add, &all), [want]);
    }
}
