//! Cycles of a Cortex-M4F on an STM32F405, as two bounds, from the addresses that the emulator
//! executed.
//!
//! ```text
//! core  = Σ table(instruction) + Σ reload(taken branch)
//! flash = core + 5 · misses                            5 wait states at 168 MHz, none up to 30 MHz
//! ```
//!
//! | symbol | at least | at most | source |
//! |---|---|---|---|
//! | an instruction | 1; 0 for an `IT` behind a narrow one | 1 | table 3-1 |
//! | load | 1 behind a load or store, else 2 | 1 behind a load that is no address of it, else 2 | §3.3.2 |
//! | load or store whose address the instruction before computed | – | 1 more | §3.3.2 |
//! | load of a literal | – | 1 more | §3.3.2 |
//! | store | 1 | 2 | §3.3.2 |
//! | `LDRD`, `LDM`, `PUSH`, of n words | 1 + n | 1 + n | table 3-1 |
//! | reload of the pipeline | 1 | 3 | table 3-1 |
//! | `MLA`, `MLS` | 1 | 2 | table 3-1 |
//! | division | 2 | 12 | table 3-1 |
//! | `VMLA`, `VFMA` and their like | 3 | 3 | table 7-1 |
//! | `VDIV`, `VSQRT` | 1, beside integer work | 14 | table 7-1 |
//! | float arithmetic before another float instruction | – | 1 more | §7.2.3 |
//! | an instruction in an `IT` block | 1 | as outside | it may be skipped |
//! | miss of a line that follows the line before | 0, prefetched | 5 | [RM0090] §3.5.2 |
//! | miss of another line | 5 | 5 | [RM0090] §3.5.2 |
//! | miss of a literal's line | 0 | 5 | [RM0090] §3.5.2 |
//!
//! The caches hold 64 lines of 128 bits for instructions and 8 for constants; each replaces the
//! line that was unused for longest ([`Cache`]).
//!
//! Assumes: statics, stack and data in RAM without wait states, no DMA and no interrupts. Words
//! that are not aligned, and constants read through a register, have no address in the log: neither
//! bound charges them. The bounds are therefore those of the model; only a chip has the time
//! itself. The measuring image has the code of the shipped one at other addresses, so that its
//! misses differ by a few per cent.
//!
//! References: Arm DDI 0439, *Cortex-M4 Technical Reference Manual*, for tables and sections
//! without a name; [RM0090].
//!
//! [RM0090]: crate#references

mod cache;
mod instruction;

use anyhow::{Context, Result};
use object::{Object, ObjectSection, SectionKind};

use cache::Cache;
use instruction::Instruction;

/// Wait states of the flash at 168 MHz and 2.7 V or more.
const WAIT_STATES: u64 = 5;
/// Lines of the instruction cache.
const CODE_LINES: usize = 64;
/// Lines of the cache of constants.
const CONSTANT_LINES: usize = 8;
/// Least and most cycles in which the pipeline fills again.
const RELOAD: Bounds = Bounds { least: 1, most: 3 };

/// Least and most cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bounds {
    /// Lower bound.
    pub least: u64,
    /// Upper bound.
    pub most: u64,
}

impl Bounds {
    const fn new(least: u64, most: u64) -> Self {
        Self { least, most }
    }

    fn add(&mut self, other: Self) {
        self.least += other.least;
        self.most += other.most;
    }
}

/// Cycles of a stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cycles {
    /// Number of instructions.
    pub instructions: u64,
    /// Cycles without wait states, as at 16 MHz.
    pub without_wait_states: Bounds,
    /// Cycles with the wait states of 168 MHz.
    pub with_wait_states: Bounds,
}

/// Code of an image by address.
pub struct Code(Vec<(u64, Vec<u8>)>);

impl Code {
    /// Reads the code of an image.
    ///
    /// # Errors
    /// If a section cannot be read.
    pub fn of(elf: &object::File<'_>) -> Result<Self> {
        let code = elf.sections().filter(|section| section.kind() == SectionKind::Text);
        let pieces = code.map(|section| Ok((section.address(), section.data()?.to_vec())));
        Ok(Self(pieces.collect::<Result<_>>()?))
    }

    fn half(&self, address: u64) -> Option<u16> {
        self.0.iter().find_map(|(start, bytes)| {
            let at = usize::try_from(address.checked_sub(*start)?).ok()?;
            Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
        })
    }

    fn instruction(&self, address: u64) -> Result<Instruction> {
        let first = self.half(address).with_context(|| format!("no code at {address:#x}"))?;
        Ok(Instruction::decode(first, self.half(address + 2).unwrap_or(0)))
    }
}

/// Processor and flash during a stage.
pub struct Model<'c> {
    code: &'c Code,
    known: std::collections::HashMap<u64, Instruction>,
    cycles: Cycles,
    waits: Bounds,
    instructions: Cache<CODE_LINES>,
    constants: Cache<CONSTANT_LINES>,
    last_line: Option<u64>,
    before: Option<(u64, Instruction)>,
    /// Instructions that remain in an `IT` block.
    conditional: u8,
}

impl<'c> Model<'c> {
    /// Returns a processor with empty caches.
    pub fn new(code: &'c Code) -> Self {
        Self {
            code,
            known: std::collections::HashMap::new(),
            cycles: Cycles::default(),
            waits: Bounds::default(),
            instructions: Cache::default(),
            constants: Cache::default(),
            last_line: None,
            before: None,
            conditional: 0,
        }
    }

    /// Executes the instruction at an address.
    ///
    /// # Errors
    /// If the image has no code there.
    pub fn execute(&mut self, address: u64) -> Result<()> {
        let instruction = match self.known.get(&address) {
            Some(known) => *known,
            None => *self.known.entry(address).or_insert(self.code.instruction(address)?),
        };
        let core = &mut self.cycles.without_wait_states;
        if let Some((from, before)) = self.before
            && from + u64::from(before.bytes) != address
        {
            core.add(RELOAD);
        }
        let mut cost = instruction.cost(self.before.map(|(_, before)| before).as_ref());
        if self.conditional > 0 {
            cost.least = 1;
        }
        core.add(cost);
        self.conditional = instruction.conditional.unwrap_or(self.conditional.saturating_sub(1));
        self.fetch(address, u64::from(instruction.bytes));
        if let Some(literal) = instruction.literal(address)
            && !self.constants.holds(literal >> 4)
        {
            self.waits.most += WAIT_STATES;
        }
        self.cycles.instructions += 1;
        self.before = Some((address, instruction));
        Ok(())
    }

    fn fetch(&mut self, address: u64, bytes: u64) {
        for line in (address >> 4)..=((address + bytes - 1) >> 4) {
            if self.last_line == Some(line) {
                continue;
            }
            let follows = self.last_line.is_some_and(|last| last + 1 == line);
            if !self.instructions.holds(line) {
                self.waits.add(Bounds::new(if follows { 0 } else { WAIT_STATES }, WAIT_STATES));
            }
            self.last_line = Some(line);
        }
    }

    /// Returns the cycles of everything that was executed.
    pub fn cycles(&self) -> Cycles {
        let mut cycles = self.cycles;
        cycles.with_wait_states = cycles.without_wait_states;
        cycles.with_wait_states.add(self.waits);
        cycles
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: u64 = 0x0800_0000;

    fn run(halves: &[u16], addresses: impl IntoIterator<Item = u64>) -> Cycles {
        let code = Code(vec![(START, halves.iter().flat_map(|half| half.to_le_bytes()).collect())]);
        let mut model = Model::new(&code);
        addresses.into_iter().for_each(|at| model.execute(START + at).expect("code"));
        model.cycles()
    }

    fn core(halves: &[u16], addresses: impl IntoIterator<Item = u64>) -> (u64, u64) {
        let Bounds { least, most } = run(halves, addresses).without_wait_states;
        (least, most)
    }

    /// The loop `subs r0, #1; bne` of `cortex_m::asm::delay` takes 3 cycles or 4 a round.
    #[test]
    fn delay_loop_takes_three_cycles_a_round_or_a_little_more() {
        let rounds = 1000;
        let (least, most) = core(&[0x3801, 0xD1FD], [0, 2].repeat(rounds));
        assert!((least, most) == (3 * 1000 - 1, 5 * 1000 - 3), "{least} to {most}");
    }

    /// Examples of the manual, §3.3.2, "normally" of so many cycles.
    #[test]
    fn pairs_of_loads_take_the_cycles_of_the_manual() {
        // ldr r0, [r1]; ldr r1, [r2]
        assert_eq!(core(&[0x6808, 0x6811], [0, 2]), (3, 3));
        // ldr r0, [r1, r5]; ldr r1, [r2]; ldr r2, [r3, #4]
        assert_eq!(core(&[0x5948, 0x6811, 0x685A], [0, 2, 4]), (4, 4));
        // ldr r1, [r0]; ldr r2, [r1]: the second needs the first.
        assert_eq!(core(&[0x6801, 0x680A], [0, 2]).1, 4);
        // adds r1, r1, r2; ldr r0, [r1]: the address is late by a cycle.
        assert_eq!(core(&[0x1889, 0x6808], [0, 2]), (3, 4));
    }

    #[test]
    fn instructions_take_the_cycles_of_the_tables() {
        // push {r4, r5, r6, lr}
        assert_eq!(core(&[0xB570], [0]), (5, 5));
        // ldmia.w r0!, {r3, r4, r5, r6}
        assert_eq!(core(&[0xE8B0, 0x0078], [0]), (5, 5));
        // ldrd r0, r1, [r2]
        assert_eq!(core(&[0xE9D2, 0x0100], [0]), (3, 3));
        // udiv r0, r1, r2
        assert_eq!(core(&[0xFBB1, 0xF0F2], [0]), (2, 12));
        // umull r0, r1, r2, r3
        assert_eq!(core(&[0xFBA2, 0x0103], [0]), (1, 1));
        // mla r0, r1, r2, r3
        assert_eq!(core(&[0xFB01, 0x3002], [0]), (1, 2));
        // vmul.f32 s0, s1, s2; vadd.f32 s0, s0, s1
        assert_eq!(core(&[0xEE20, 0x0A81, 0xEE30, 0x0A20], [0, 4]), (2, 3));
        // vfma.f32 s0, s1, s2
        assert_eq!(core(&[0xEEA0, 0x0A81], [0]), (3, 3));
        // vdiv.f32 s0, s1, s2; vsqrt.f32 s0, s0
        assert_eq!(core(&[0xEE80, 0x0A81], [0]), (1, 14));
        assert_eq!(core(&[0xEEB1, 0x0AC0], [0]), (1, 14));
        // vpush {s16, s17}
        assert_eq!(core(&[0xED2D, 0x8A02], [0]), (3, 3));
    }

    #[test]
    fn skipped_instruction_takes_a_cycle() {
        // it eq; ldreq r0, [r1]
        assert_eq!(core(&[0xBF08, 0x6808], [0, 2]), (2, 3));
    }

    #[test]
    fn straight_code_may_be_prefetched_and_a_jump_waits() {
        // 16 lines of nops, run twice: the second time they are in the cache.
        let straight: Vec<u64> = (0..128).map(|number| 2 * number).collect();
        let once = run(&[0xBF00; 128], straight.clone());
        assert_eq!(once.with_wait_states, Bounds::new(128 + 5, 128 + 16 * 5));
        let twice = run(&[0xBF00; 128], straight.repeat(2));
        assert_eq!(twice.with_wait_states, Bounds::new(256 + 1 + 5, 256 + 3 + 16 * 5));
    }

    #[test]
    fn loop_longer_than_the_cache_misses_each_line_every_round() {
        let each_line: Vec<u64> = (0..65).map(|line| 16 * line).collect();
        let three = run(&[0xBF00; 65 * 8], each_line.repeat(3));
        let waits = three.with_wait_states.most - three.without_wait_states.most;
        assert_eq!(waits, 3 * 65 * 5);
    }
}
