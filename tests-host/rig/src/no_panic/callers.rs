//! Callers of the panic handler: up the call graph of a linked image, to the source lines of the
//! calls.
//!
//! The linker resolves the graph: each relocation that it keeps (`--emit-relocs`) shows which
//! instruction refers to which function. The lines come from DWARF, with the functions inlined at
//! the instruction. The innermost frame of this product is the offender. If the whole function
//! belongs to the standard library or a dependency, its callers are examined instead.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use anyhow::ensure;
use object::{Object, ObjectSection, ObjectSymbol, RelocationTarget, SymbolKind};

use crate::source_lines::{Frame, Lines};

/// A line of the product's source from which a panic is reachable.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Offence {
    /// Source file, from the root of the repository.
    pub file: String,
    /// Line in the file.
    pub line: u32,
    /// Function that contains the line.
    pub function: String,
    /// Functions that it calls on the way to the panic, innermost first.
    pub through: Vec<String>,
}

impl fmt::Display for Offence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{} in {}", self.file, self.line, self.function)?;
        for callee in self.through.iter().rev() {
            write!(f, " → {callee}")?;
        }
        Ok(())
    }
}

/// A reference to a function: its instruction, and the function that contains it.
#[derive(Clone, Copy)]
struct Reference {
    at: u64,
    within: u64,
}

/// Returns the lines from which the panic handler of an image is reachable: none if the image has
/// no handler.
///
/// # Errors
/// If the file is not an image with relocations and debug information.
pub fn of_panics(image: &[u8]) -> anyhow::Result<Vec<Offence>> {
    let elf = object::File::parse(image)?;
    let functions = functions(&elf);
    let handler = functions.iter().find(|(_, name)| name.ends_with("rust_begin_unwind"));
    let references = references(&elf, &functions);
    ensure!(!references.is_empty(), "the image keeps no relocations");
    // The linker drops a handler that nothing reaches. The image with a reachable panic shows that
    // the name is still the right one.
    let Some((&handler, _)) = handler else { return Ok(Vec::new()) };
    let lines = Lines::of(&elf)?;

    let mut offences = BTreeSet::new();
    let mut seen = BTreeSet::from([handler]);
    let mut open = vec![(handler, Vec::new())];
    while let Some((callee, through)) = open.pop() {
        for reference in references.get(&callee).into_iter().flatten() {
            match offence(lines.at(reference.at)?, &through) {
                Ok(offence) => {
                    offences.insert(offence);
                }
                Err(through) if seen.insert(reference.within) => open.push((reference.within, through)),
                Err(_) => {}
            }
        }
    }
    Ok(offences.into_iter().collect())
}

/// Returns the offence at an instruction, or the extended path if no frame belongs to the product.
fn offence(frames: Vec<Frame>, through: &[String]) -> Result<Offence, Vec<String>> {
    let mut through = through.to_vec();
    for frame in frames {
        if let Some(file) = frame.own_file() {
            return Ok(Offence { file: file.into(), line: frame.line, function: frame.function, through });
        }
        through.push(frame.function);
    }
    Err(through)
}

/// Returns every function by its address.
fn functions(elf: &object::File<'_>) -> BTreeMap<u64, String> {
    let functions = elf.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0);
    functions.map(|symbol| (code(symbol.address()), symbol.name().unwrap_or_default().to_owned())).collect()
}

/// Returns the references to every function.
fn references(elf: &object::File<'_>, functions: &BTreeMap<u64, String>) -> BTreeMap<u64, Vec<Reference>> {
    let mut references: BTreeMap<u64, Vec<Reference>> = BTreeMap::new();
    for (at, relocation) in elf
        .sections()
        .filter(|section| section.kind() == object::SectionKind::Text)
        .flat_map(|section| section.relocations())
    {
        let RelocationTarget::Symbol(index) = relocation.target() else { continue };
        let Ok(symbol) = elf.symbol_by_index(index) else { continue };
        let target = code(symbol.address());
        let within = functions.range(..=at).next_back().map(|(&address, _)| address);
        if let Some(within) = within.filter(|_| functions.contains_key(&target)) {
            references.entry(target).or_default().push(Reference { at, within });
        }
    }
    references
}

/// Returns the address of a function without the Thumb bit.
fn code(address: u64) -> u64 {
    address & !1
}
