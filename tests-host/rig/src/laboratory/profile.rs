//! Profile of a stage: every instruction that the emulated core executes, by function.
//!
//! ```text
//! measuring image ──one instruction a block──► program counters ──DWARF──► innermost function of ours
//!                                                       └──symbols──► runtime: soft floats, memory, libm
//! ```
//!
//! The cost of a function is that of its own instructions and of the runtime's work on its behalf.
//! Soft-float routines, copies of memory and the elementary functions of `libm` count for the
//! function of ours that was executed last before them. The debug information separates inlined
//! functions, so that a stage which the compiler made into one function is still shown in its
//! parts.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | own | [`Share::own`] | instructions in the function's own lines |
//! | behalf | [`Share::behalf`] | instructions of the runtime for it |
//! | calls | [`Share::calls`] | calls of the runtime |
//!
//! Reference: [ARMv7-M] for branches. The emulator's `exec` log names the first instruction of each
//! block, and `-singlestep` makes every instruction a block.
//!
//! [ARMv7-M]: crate#references

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap};
use std::fmt;
use std::io::{BufRead, BufReader};
use std::path::Path;

use anyhow::Result;
use object::{Object, ObjectSymbol, SymbolKind};

use crate::source_lines::Lines;

/// Largest number of functions in the list.
const LISTED: usize = 40;

/// Cost of one function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// Instructions of its own.
    pub own: u64,
    /// Instructions of the runtime on its behalf.
    pub behalf: u64,
    /// Calls of the runtime.
    pub calls: u64,
}

/// Instructions of one stage, by function.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    /// Costs by function of the product.
    pub functions: BTreeMap<String, Share>,
    /// Instructions and calls of each routine of the runtime.
    pub runtime: BTreeMap<String, (u64, u64)>,
}

impl Profile {
    /// Returns the number of all instructions.
    pub fn total(&self) -> u64 {
        self.functions.values().map(|share| share.own + share.behalf).sum()
    }

    /// Reads the instructions between the first and the last of the stopwatch's `number`th use,
    /// counted from 0.
    ///
    /// # Errors
    /// If the image has no stopwatch, or the stage was never reached.
    pub fn read(image: &Path, log: impl std::io::Read, number: usize) -> Result<Self> {
        let bytes = std::fs::read(image)?;
        let elf = object::File::parse(bytes.as_slice())?;
        let mut reader = Reader { profile: Self::default(), known: HashMap::new(), last: String::new() };
        let map = Map::of(&elf)?;
        executed(&map, log, number, |address| reader.take(&map, address))?;
        anyhow::ensure!(!reader.profile.functions.is_empty(), "the stage was never reached");
        Ok(reader.profile)
    }
}

/// Passes on each address between the first and the last instruction of the stopwatch's `number`th
/// use, counted from 0.
///
/// # Errors
/// If the log cannot be read, or `take` fails.
pub(super) fn executed(
    map: &Map<'_>,
    log: impl std::io::Read,
    number: usize,
    mut take: impl FnMut(u64) -> Result<()>,
) -> Result<()> {
    let mut window = Window::new(number);
    for line in BufReader::new(log).split(b'\n') {
        let line = line?;
        let Some(address) = program_counter(&line) else { continue };
        match window.moves(map, address) {
            Place::Before => {}
            Place::Inside => take(address)?,
            Place::Behind => break,
        }
    }
    Ok(())
}

/// Returns the address in a line `Trace 0: … [cs/pc/flags/…]` of the log.
fn program_counter(line: &[u8]) -> Option<u64> {
    let line = std::str::from_utf8(line).ok()?.strip_prefix("Trace")?;
    let (_, bracket) = line.split_once('[')?;
    u64::from_str_radix(bracket.split('/').nth(1)?, 16).ok()
}

/// Functions of an image, by address.
pub(super) struct Map<'a> {
    /// End address and name, by start address.
    functions: BTreeMap<u64, (u64, String)>,
    lines: Lines<'a>,
}

impl<'a> Map<'a> {
    pub(super) fn of(elf: &object::File<'a>) -> Result<Self> {
        let mut functions = BTreeMap::new();
        for symbol in elf.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0) {
            let (address, name) = (symbol.address() & !1, symbol.name().unwrap_or_default());
            let name = format!("{:#}", addr2line::demangle_auto(name.into(), None));
            functions.insert(address, (address + symbol.size(), name));
        }
        Ok(Self { functions, lines: Lines::of(elf)? })
    }

    /// Returns address and name of the function that contains an instruction.
    fn function(&self, address: u64) -> Option<(u64, &str)> {
        let (&start, (end, name)) = self.functions.range(..=address).next_back()?;
        (address < *end).then_some((start, name.as_str()))
    }

    /// Returns the innermost function of the product that was inlined at an instruction; `None` if
    /// all of it is the runtime's.
    fn own_function(&self, address: u64) -> Result<Option<String>> {
        let frames = self.lines.at(address)?;
        let own = frames.into_iter().find(|frame| frame.own_file().is_some()).map(|frame| frame.function);
        // A function's first and last instructions may have no line.
        let symbol = || self.function(address).map(|(_, name)| name.to_owned());
        Ok(own.or_else(|| symbol().filter(|name| name.contains("rai_"))))
    }
}

/// Place of an instruction relative to the stage.
enum Place {
    Before,
    Inside,
    Behind,
}

/// Range from the entry of the stopwatch to its return.
struct Window {
    uses_left: usize,
    /// Function that called the stopwatch, once it has been entered.
    caller: Option<u64>,
    last: Option<u64>,
}

impl Window {
    fn new(number: usize) -> Self {
        // The stopwatch first measures its own cost.
        Self { uses_left: number + 1, caller: None, last: None }
    }

    fn moves(&mut self, map: &Map<'_>, address: u64) -> Place {
        // Routines in assembly have symbols without a size.
        let Some((start, name)) = map.function(address) else { return self.place() };
        let is_entry = address == start && name.contains("Stopwatch::time");
        if self.caller.is_none() && is_entry {
            self.caller = self.last;
        } else if self.caller == Some(start) {
            self.caller = None;
            if self.uses_left == 0 {
                return Place::Behind;
            }
            self.uses_left -= 1;
        }
        self.last = Some(start);
        self.place()
    }

    fn place(&self) -> Place {
        if self.caller.is_some() && self.uses_left == 0 { Place::Inside } else { Place::Before }
    }
}

/// A profile under construction.
struct Reader {
    profile: Profile,
    /// Innermost function of ours at an instruction, if there is one.
    known: HashMap<u64, Option<String>>,
    /// Function of ours that was executed last.
    last: String,
}

impl Reader {
    fn take(&mut self, map: &Map<'_>, address: u64) -> Result<()> {
        if let Entry::Vacant(unknown) = self.known.entry(address) {
            unknown.insert(map.own_function(address)?);
        }
        match self.known.get(&address).cloned().flatten() {
            Some(function) => {
                self.profile.functions.entry(function.clone()).or_default().own += 1;
                self.last = function;
            }
            None => self.take_runtime(map, address),
        }
        Ok(())
    }

    fn take_runtime(&mut self, map: &Map<'_>, address: u64) {
        let (start, symbol) = map.function(address).unwrap_or((0, "assembly"));
        let calls = u64::from(address == start);
        let (instructions, entered) = self.profile.runtime.entry(symbol.to_owned()).or_default();
        (*instructions, *entered) = (*instructions + 1, *entered + calls);
        let share = self.profile.functions.entry(self.last.clone()).or_default();
        (share.behalf, share.calls) = (share.behalf + 1, share.calls + calls);
    }
}

impl fmt::Display for Profile {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut functions: Vec<_> = self.functions.iter().collect();
        functions.sort_by_key(|(_, share)| std::cmp::Reverse(share.own + share.behalf));
        writeln!(formatter, "{:>9} {:>9} {:>9} {:>6}  function", "together", "own", "runtime", "calls")?;
        for (name, Share { own, behalf, calls }) in functions.iter().take(LISTED) {
            writeln!(formatter, "{:>9} {own:>9} {behalf:>9} {calls:>6}  {name}", own + behalf)?;
        }
        let mut runtime: Vec<_> = self.runtime.iter().collect();
        runtime.sort_by_key(|(_, (instructions, _))| std::cmp::Reverse(*instructions));
        writeln!(formatter, "\n{:>9} {:>6} {:>6}  of the runtime", "together", "calls", "each")?;
        for (name, (instructions, calls)) in runtime.iter().take(LISTED) {
            writeln!(
                formatter,
                "{instructions:>9} {calls:>6} {:>6}  {name}",
                instructions / (*calls).max(1)
            )?;
        }
        writeln!(formatter, "\n{:>9}  instructions", self.total())
    }
}
