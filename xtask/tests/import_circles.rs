//! No two modules import each other, directly or indirectly.
//!
//! Rules of the count: a module is a file. It imports the names in paths that begin with `crate`,
//! `super` or `self`, in a `use` or in code; documentation and `#[cfg(test)]` do not count. A name
//! re-exported by `pub use` counts for its origin. Within each folder a module represents
//! everything below it, and a circle is a set of modules of which each reaches every other one (a
//! strongly connected component). A child and its parent may name each other's declarations.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use syn::visit::{self, Visit};

/// A module's path from the root of its crate.
type Module = Vec<String>;

/// Paths and re-exports of one file.
#[derive(Default)]
struct File {
    /// Paths as written, resolved later.
    named: Vec<Vec<String>>,
    /// Re-exported names, and their paths of origin.
    passed_on: BTreeMap<String, Vec<String>>,
}

impl File {
    fn read(text: &str) -> Self {
        let mut file = Self::default();
        file.visit_file(&syn::parse_file(text).expect("a file that compiles"));
        file
    }

    fn tree(&mut self, tree: &syn::UseTree, before: &[String], passes_on: bool) {
        let deeper = |name: &syn::Ident| [before, &[name.to_string()]].concat();
        let mut leaf = |path: Vec<String>, name: String| {
            if passes_on {
                self.passed_on.insert(name, path.clone());
            }
            self.named.push(path);
        };
        match tree {
            syn::UseTree::Path(path) => self.tree(&path.tree, &deeper(&path.ident), passes_on),
            syn::UseTree::Name(name) if name.ident == "self" => leaf(before.to_vec(), String::new()),
            syn::UseTree::Name(name) => leaf(deeper(&name.ident), name.ident.to_string()),
            syn::UseTree::Rename(name) => leaf(deeper(&name.ident), name.rename.to_string()),
            syn::UseTree::Glob(_) => leaf(before.to_vec(), String::new()),
            syn::UseTree::Group(group) => {
                for tree in &group.items {
                    self.tree(tree, before, passes_on);
                }
            }
        }
    }
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    let says_test = |attribute: &syn::Attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"))
    };
    attributes.iter().any(says_test)
}

impl<'a> Visit<'a> for File {
    fn visit_item_mod(&mut self, module: &'a syn::ItemMod) {
        if !is_test(&module.attrs) {
            visit::visit_item_mod(self, module);
        }
    }

    fn visit_item_use(&mut self, item: &'a syn::ItemUse) {
        if !is_test(&item.attrs) {
            self.tree(&item.tree, &[], !matches!(item.vis, syn::Visibility::Inherited));
        }
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        self.named.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }
}

/// All modules of a crate, by path.
struct Crate(BTreeMap<Module, File>);

impl Crate {
    fn read(source: &Path) -> Self {
        let mut modules = BTreeMap::new();
        collect(source, &[], &mut modules);
        Self(modules)
    }

    /// Returns the deepest module of a path written in `from`; `None` if the path leaves the crate.
    fn resolve(&self, from: &[String], path: &[String], depth: usize) -> Option<Module> {
        let (first, mut rest) = path.split_first()?;
        let mut at = match first.as_str() {
            "crate" => Vec::new(),
            "self" => from.to_vec(),
            "super" => from.split_last()?.1.to_vec(),
            // A child by its bare name, which `pub use` may write.
            child => {
                let module = [from, &[child.to_owned()]].concat();
                self.0.contains_key(&module).then_some(module)?
            }
        };
        while let Some((segment, tail)) = rest.split_first() {
            let deeper = [at.as_slice(), std::slice::from_ref(segment)].concat();
            if segment == "super" {
                at.pop()?;
            } else if self.0.contains_key(&deeper) {
                at = deeper;
            } else if let Some(origin) = self.0.get(&at).and_then(|file| file.passed_on.get(segment)) {
                // A re-exported name belongs to its origin; the depth bounds an endless chain.
                return if depth == 0 { None } else { self.resolve(&at, origin, depth - 1).or(Some(at)) };
            } else {
                break;
            }
            rest = tail;
        }
        Some(at)
    }

    /// Returns the imports between modules that do not contain each other.
    fn imports(&self) -> BTreeSet<(Module, Module)> {
        let of = |(from, file): (&Module, &File)| {
            let targets: Vec<_> = file.named.iter().filter_map(|path| self.resolve(from, path, 8)).collect();
            targets.into_iter().map(|to| (from.clone(), to)).collect::<Vec<_>>()
        };
        self.0
            .iter()
            .flat_map(of)
            .filter(|(from, to)| !from.starts_with(to) && !to.starts_with(from))
            .collect()
    }

    fn circles(&self) -> Vec<String> {
        let mut siblings: BTreeMap<Module, BTreeSet<(String, String)>> = BTreeMap::new();
        for (from, to) in self.imports() {
            let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
            let pair = (from[common].clone(), to[common].clone());
            siblings.entry(from[..common].to_vec()).or_default().insert(pair);
        }
        let of = |(folder, edges): (&Module, &BTreeSet<(String, String)>)| {
            let place = folder.join("::");
            components(edges)
                .into_iter()
                .map(move |names| format!("{place}: {}", names.join(" – ")))
                .collect()
        };
        siblings.iter().flat_map(|entry| -> Vec<String> { of(entry) }).collect()
    }
}

/// Returns the sets of several modules in which each reaches every other one.
fn components(edges: &BTreeSet<(String, String)>) -> BTreeSet<Vec<String>> {
    let reached = |start: &String| {
        let (mut reached, mut open) = (BTreeSet::new(), vec![start.clone()]);
        while let Some(at) = open.pop() {
            for (_, to) in edges.iter().filter(|(from, _)| *from == at) {
                if reached.insert(to.clone()) {
                    open.push(to.clone());
                }
            }
        }
        reached
    };
    let nodes: BTreeSet<&String> = edges.iter().map(|(from, _)| from).collect();
    let reach: BTreeMap<&String, BTreeSet<String>> =
        nodes.iter().map(|node| (*node, reached(node))).collect();
    let circle = |node: &&String| {
        let mutual = |other: &&&String| reach[*node].contains(**other) && reach[**other].contains(*node);
        nodes.iter().filter(mutual).map(|name| (*name).clone()).collect::<Vec<_>>()
    };
    nodes.iter().map(circle).filter(|circle| circle.len() > 1).collect()
}

fn collect(folder: &Path, path: &[String], modules: &mut BTreeMap<Module, File>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    entries.sort();
    for entry in entries {
        let stem = entry.file_stem().expect("a name").to_string_lossy().into_owned();
        if entry.is_dir() {
            // Other programs in the same folder are separate crates.
            if stem != "bin" || !path.is_empty() {
                collect(&entry, &[path, &[stem]].concat(), modules);
            }
        } else if entry.extension().is_some_and(|kind| kind == "rs") {
            let module = match stem.as_str() {
                "lib" | "main" if path.is_empty() => Vec::new(),
                "mod" => path.to_vec(),
                _ => [path, std::slice::from_ref(&stem)].concat(),
            };
            let file = File::read(&fs::read_to_string(&entry).expect("text"));
            if !(stem == "main" && folder.join("lib.rs").exists()) {
                modules.insert(module, file);
            }
        }
    }
}

/// Returns the folders of all packages, which the workspace's manifest lists.
fn members() -> Vec<String> {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.toml");
    let text = fs::read_to_string(manifest).expect("the manifest of the workspace");
    let list = text.split("members = [").nth(1).and_then(|rest| rest.split(']').next());
    list.expect("members").split('"').skip(1).step_by(2).map(str::to_owned).collect()
}

fn circles_of(folder: &str) -> Vec<String> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder).join("src");
    Crate::read(&source).circles()
}

#[test]
fn no_module_of_any_crate_imports_in_a_circle() {
    let folders = members();
    let found: Vec<String> = folders
        .iter()
        .flat_map(|folder| circles_of(folder).into_iter().map(move |c| format!("{folder} {c}")))
        .collect();
    assert!(folders.len() >= 10, "{folders:?}");
    println!("{} circles in {} crates", found.len(), folders.len());
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn a_circle_by_way_of_a_name_that_is_passed_on_is_found() {
    let file = |module: &str, text: &str| {
        (module.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect(), File::read(text))
    };
    let made = Crate(BTreeMap::from([
        file("", "pub mod a; pub mod b; pub mod c; pub use self::b::B;"),
        file("a", "use crate::B; use crate::c::C; pub struct A;"),
        file("b", "pub struct B(super::a::A);"),
        file("c", "mod d; pub struct C; #[cfg(test)] mod tests { use crate::a::A; }"),
        file("c::d", "use super::C;"),
    ]));
    assert_eq!(made.circles(), [": a – b"]);
}
