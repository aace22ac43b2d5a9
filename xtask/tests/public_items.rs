//! The items that the core promises to keep: at most 120 outside the feature `unstable`, and no
//! feature removes one.
//!
//! Rules of the count: an item is a module, type, trait, function or constant that a user can name,
//! or a public method or associated constant of such a type or trait. It counts once, where it is
//! defined. Implementations of foreign traits do not count. Neither do variants and fields, but the
//! comparison of features includes them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use syn::punctuated::Punctuated;
use syn::{Attribute, Fields, ImplItem, Item, Meta, Token, TraitItem, UseTree, Visibility};

/// Most items outside the feature `unstable`.
const MOST_ITEMS: usize = 120;

/// A module's path from the root of its crate.
type Module = Vec<String>;

/// A crate as it is compiled with some of its features.
struct Crate<'a> {
    modules: &'a BTreeMap<Module, syn::File>,
    features: &'a BTreeSet<&'a str>,
}

/// Public items and, beneath them, variants, fields and types of aliases.
#[derive(Debug, Default, PartialEq)]
struct Surface {
    items: BTreeSet<String>,
    details: BTreeSet<String>,
    /// Public methods and constants of every type, public or not, by its name.
    methods: BTreeMap<String, Vec<String>>,
}

impl Crate<'_> {
    fn surface(&self) -> Surface {
        let mut surface = Surface { methods: self.methods(), ..Surface::default() };
        self.walk(&[], &mut surface);
        surface
    }

    /// Returns true if all `cfg` attributes hold.
    fn is_active(&self, attributes: &[Attribute]) -> bool {
        let conditions = attributes.iter().filter(|attribute| attribute.path().is_ident("cfg"));
        conditions.map(|attribute| attribute.parse_args().expect("a condition")).all(|meta| self.holds(&meta))
    }

    /// Returns true if a condition holds on a target without `std` and outside of tests.
    fn holds(&self, condition: &Meta) -> bool {
        let parts = |list: &syn::MetaList| {
            let parts = list.parse_args_with(Punctuated::<Meta, Token![,]>::parse_terminated);
            parts.expect("conditions").iter().map(|part| self.holds(part)).collect::<Vec<_>>()
        };
        match condition {
            Meta::Path(_) => false,
            Meta::NameValue(pair) if pair.path.is_ident("feature") => {
                self.features.contains(text_of(&pair.value).trim_matches('"'))
            }
            Meta::NameValue(_) => true,
            Meta::List(list) if list.path.is_ident("not") => !parts(list)[0],
            Meta::List(list) if list.path.is_ident("any") => parts(list).contains(&true),
            Meta::List(list) => !parts(list).contains(&false),
        }
    }

    fn active_items(&self, module: &[String]) -> impl Iterator<Item = &Item> {
        let file = self.modules.get(module).unwrap_or_else(|| panic!("no module {module:?}"));
        file.items.iter().filter(|item| self.is_active(attributes_of(item)))
    }

    /// Adds what a public module holds.
    fn walk(&self, module: &[String], surface: &mut Surface) {
        for item in self.active_items(module) {
            match item {
                Item::Mod(child) if is_public(&child.vis) => {
                    let path = [module, &[child.ident.to_string()]].concat();
                    surface.items.insert(path.join("::"));
                    self.walk(&path, surface);
                }
                Item::Use(used) if is_public(&used.vis) => {
                    for path in leaves(&used.tree) {
                        self.define(module, &path, surface);
                    }
                }
                item => {
                    if let Some((name, visibility)) = named(item)
                        && is_public(visibility)
                    {
                        self.add(module, &name, item, surface);
                    }
                }
            }
        }
    }

    /// Adds the item that a path names, as written in a module.
    fn define(&self, from: &[String], path: &[String], surface: &mut Surface) {
        let (name, folders) = path.split_last().expect("a path");
        let mut at = match folders.first().map(String::as_str) {
            Some("crate") => Vec::new(),
            Some("self") | None => from.to_vec(),
            Some("super") => from[..from.len() - 1].to_vec(),
            Some(child) => [from, &[child.to_owned()]].concat(),
        };
        at.extend(folders.iter().skip(1).cloned());
        if !self.modules.contains_key(&at) {
            // An item of another crate.
            surface.items.insert(path.join("::"));
            return;
        }
        let own = |item: &&Item| named(item).is_some_and(|(own, _)| own == *name);
        if let Some(item) = self.active_items(&at).find(own) {
            return self.add(&at, name, item, surface);
        }
        let passed_on = self.active_items(&at).find_map(|item| match item {
            Item::Use(used) => leaves(&used.tree).into_iter().find(|path| path.last() == Some(name)),
            _ => None,
        });
        let origin = passed_on.unwrap_or_else(|| panic!("{} has no {name}", at.join("::")));
        self.define(&at, &origin, surface);
    }

    /// Adds an item with its methods, constants, variants and fields.
    fn add(&self, module: &[String], name: &str, item: &Item, surface: &mut Surface) {
        let path = [module, &[name.to_owned()]].concat().join("::");
        if !surface.items.insert(path.clone()) {
            return;
        }
        let mut detail = |text: String| surface.details.insert(format!("{path} {text}"));
        match item {
            Item::Type(alias) => {
                detail(format!("= {}", text_of(&alias.ty)));
            }
            Item::Struct(item) => {
                self.fields(&item.fields, true).into_iter().for_each(|field| {
                    detail(field);
                });
            }
            Item::Enum(item) => {
                for variant in item.variants.iter().filter(|variant| self.is_active(&variant.attrs)) {
                    let fields = self.fields(&variant.fields, false).join(", ");
                    detail(format!("{} {{ {fields} }}", variant.ident));
                }
            }
            Item::Trait(item) => {
                let own = item.items.iter().filter_map(named_in_trait);
                surface.items.extend(own.map(|name| format!("{path}::{name}")));
                return;
            }
            _ => return,
        }
        let methods = surface.methods.get(name).into_iter().flatten();
        surface.items.extend(methods.map(|method| format!("{path}::{method}")));
    }

    fn fields(&self, fields: &Fields, only_public: bool) -> Vec<String> {
        let shown = fields.iter().filter(|field| !only_public || is_public(&field.vis));
        let active = shown.filter(|field| self.is_active(&field.attrs));
        let text = |field: &syn::Field| {
            let name = field.ident.as_ref().map(|ident| format!("{ident}: ")).unwrap_or_default();
            format!("{name}{}", text_of(&field.ty))
        };
        active.map(text).collect()
    }

    /// Returns the names of all types' public methods and constants.
    fn methods(&self) -> BTreeMap<String, Vec<String>> {
        let mut methods = BTreeMap::<String, Vec<String>>::new();
        for item in self.modules.keys().flat_map(|module| self.active_items(module)) {
            if let Item::Impl(item) = item
                && item.trait_.is_none()
                && let syn::Type::Path(path) = &*item.self_ty
                && let Some(last) = path.path.segments.last()
            {
                let names = item.items.iter().filter_map(|item| self.public_method(item));
                methods.entry(last.ident.to_string()).or_default().extend(names);
            }
        }
        methods
    }

    fn public_method(&self, item: &ImplItem) -> Option<String> {
        let (attributes, visibility, name) = match item {
            ImplItem::Fn(function) => (&function.attrs, &function.vis, &function.sig.ident),
            ImplItem::Const(constant) => (&constant.attrs, &constant.vis, &constant.ident),
            _ => return None,
        };
        (is_public(visibility) && self.is_active(attributes)).then(|| name.to_string())
    }
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

fn text_of(tokens: &impl quote::ToTokens) -> String {
    tokens.to_token_stream().to_string()
}

fn attributes_of(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

fn named(item: &Item) -> Option<(String, &Visibility)> {
    let (ident, visibility) = match item {
        Item::Const(item) => (&item.ident, &item.vis),
        Item::Enum(item) => (&item.ident, &item.vis),
        Item::Fn(item) => (&item.sig.ident, &item.vis),
        Item::Static(item) => (&item.ident, &item.vis),
        Item::Struct(item) => (&item.ident, &item.vis),
        Item::Trait(item) => (&item.ident, &item.vis),
        Item::Type(item) => (&item.ident, &item.vis),
        _ => return None,
    };
    Some((ident.to_string(), visibility))
}

fn named_in_trait(item: &TraitItem) -> Option<String> {
    match item {
        TraitItem::Const(item) => Some(item.ident.to_string()),
        TraitItem::Fn(item) => Some(item.sig.ident.to_string()),
        TraitItem::Type(item) => Some(item.ident.to_string()),
        _ => None,
    }
}

/// Returns the paths that a `use` names.
fn leaves(tree: &UseTree) -> Vec<Vec<String>> {
    match tree {
        UseTree::Path(path) => {
            let first = path.ident.to_string();
            leaves(&path.tree).into_iter().map(|rest| [vec![first.clone()], rest].concat()).collect()
        }
        UseTree::Name(name) => vec![vec![name.ident.to_string()]],
        UseTree::Rename(name) => vec![vec![name.ident.to_string()]],
        UseTree::Glob(_) => panic!("the items of a glob cannot be counted"),
        UseTree::Group(group) => group.items.iter().flat_map(leaves).collect(),
    }
}

fn read(folder: &Path, path: &[String], modules: &mut BTreeMap<Module, syn::File>) {
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        let stem = entry.file_stem().expect("a name").to_string_lossy().into_owned();
        if entry.is_dir() {
            read(&entry, &[path, &[stem]].concat(), modules);
        } else {
            let text = fs::read_to_string(&entry).expect("text");
            let module = match stem.as_str() {
                "lib" | "mod" => path.to_vec(),
                _ => [path, std::slice::from_ref(&stem)].concat(),
            };
            modules.insert(module, syn::parse_file(&text).expect("a file that compiles"));
        }
    }
}

fn core() -> BTreeMap<Module, syn::File> {
    let mut modules = BTreeMap::new();
    read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../rai-core/src"), &[], &mut modules);
    modules
}

/// Returns the features of the core that are no mere sum of others, by its manifest.
fn features() -> Vec<String> {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("../rai-core/Cargo.toml");
    let text = fs::read_to_string(manifest).expect("the manifest of the core");
    let section = text.split("[features]").nth(1).and_then(|rest| rest.split("\n[").next());
    let lines = section.expect("features").lines().filter(|line| !line.starts_with('#'));
    let names = lines.filter_map(|line| line.split_once(" = ")).map(|(name, _)| name.to_owned());
    names.filter(|name| name != "default").collect()
}

#[test]
fn at_most_120_items_are_promised() {
    let (modules, features) = (core(), features());
    let stable = features.iter().map(String::as_str).filter(|&name| name != "unstable").collect();
    let items = Crate { modules: &modules, features: &stable }.surface().items;
    let list = items.iter().map(String::as_str).collect::<Vec<_>>().join("\n");
    println!("{} public items outside `unstable`:\n{list}", items.len());
    assert!(items.len() <= MOST_ITEMS, "{} items, must be at most {MOST_ITEMS}:\n{list}", items.len());
}

#[test]
fn no_feature_removes_or_changes_an_item() {
    let (modules, names) = (core(), features());
    assert!(names.len() >= 8, "{names:?}");
    let surface = |bits: usize| {
        let on = (0..names.len()).filter(|place| bits >> place & 1 == 1);
        let features = on.map(|place| names[place].as_str()).collect();
        Crate { modules: &modules, features: &features }.surface()
    };
    // Each feature is added to nothing, to each other one alone, and to all others together.
    let all = (1 << names.len()) - 1;
    for (place, name) in names.iter().enumerate() {
        let own = 1 << place;
        let alone = (0..names.len()).map(|other| 1 << other).filter(|&other| other != own);
        for others in alone.chain([0, all & !own]) {
            let (before, after) = (surface(others), surface(others | own));
            let lost: Vec<_> = before.items.difference(&after.items).collect();
            assert!(lost.is_empty(), "`{name}` removes {lost:?}");
            let lost: Vec<_> = before.details.difference(&after.details).collect();
            assert!(lost.is_empty(), "`{name}` changes {lost:?}");
        }
    }
}

#[cfg(test)]
mod made_up {
    use super::*;

    fn surface_of(features: &[&str]) -> Surface {
        let file = |module: &str, text: &str| {
            let path = module.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect();
            (path, syn::parse_file(text).expect("a file that compiles"))
        };
        let modules = BTreeMap::from([
            file(
                "",
                "pub mod a; #[cfg(feature = \"unstable\")] pub mod b; #[cfg(not(feature = \"unstable\"))] mod b;",
            ),
            file(
                "a",
                "pub use crate::b::B; pub struct A { pub x: u8, y: u8 } impl A { pub fn new() {} fn own() {} }
                 #[cfg(not(feature = \"short\"))] pub type Scalar = f64;
                 #[cfg(feature = \"short\")] pub type Scalar = f32;",
            ),
            file(
                "b",
                "mod c; pub use c::B; pub struct Hidden; #[cfg(test)] pub struct Test; pub(crate) fn inner() {}",
            ),
            file("b::c", "pub enum B { One, #[cfg(feature = \"more\")] Two(u8) } impl B { pub const C: u8 = 1; }"),
        ]);
        Crate { modules: &modules, features: &features.iter().copied().collect() }.surface()
    }

    #[test]
    fn item_of_a_private_module_counts_if_it_is_passed_on() {
        let want = ["a", "a::A", "a::A::new", "a::Scalar", "b::c::B", "b::c::B::C"];
        assert_eq!(surface_of(&[]).items, want.map(str::to_owned).into());
    }

    #[test]
    fn feature_shows_the_items_behind_it() {
        let (before, after) = (surface_of(&[]), surface_of(&["unstable"]));
        let more: Vec<_> = after.items.difference(&before.items).collect();
        assert_eq!(more, ["b", "b::Hidden"]);
    }

    #[test]
    fn feature_that_changes_a_type_is_found_and_one_that_adds_a_variant_is_not() {
        let (before, changed) = (surface_of(&[]).details, surface_of(&["short"]).details);
        assert_eq!(before.difference(&changed).collect::<Vec<_>>(), ["a::Scalar = f64"]);
        let more = surface_of(&["more"]).details;
        assert_eq!(before.difference(&more).count(), 0);
        assert_eq!(more.difference(&before).collect::<Vec<_>>(), ["b::c::B Two { u8 }"]);
    }
}
