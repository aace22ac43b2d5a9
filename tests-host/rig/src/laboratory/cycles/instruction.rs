//! Thumb-2 instructions of a Cortex-M4F, as far as their cycles depend on them.
//!
//! Reference: [ARMv7-M] §A5 (encodings), §A6 (floating point).
//!
//! [ARMv7-M]: crate#references

use super::Bounds;

/// Work of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Work {
    /// One cycle.
    Simple,
    /// Two registers to or from the floating-point unit: two cycles.
    Double,
    /// `IT`.
    IfThen,
    /// `MLA`, `MLS`.
    Accumulate,
    /// Integer division.
    Divide,
    /// Table branch: a load and an addition.
    Table,
    /// Load, or store, of one word or less.
    Single(Memory),
    /// Load or store of several words.
    Multiple(u64),
    /// Floating-point arithmetic of one cycle.
    Float,
    /// Floating-point multiplication and addition.
    FloatAccumulate,
    /// Floating-point division or root.
    FloatDivide,
}

/// Direction of an access to memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Memory {
    Load,
    Store,
}

/// An instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Instruction {
    /// Length in bytes: 2 or 4.
    pub(super) bytes: u8,
    work: Work,
    /// Registers of the address, one bit each.
    address: u16,
    /// Core registers that it writes, one bit each, as far as they matter.
    writes: u16,
    /// True for an instruction of the floating-point unit.
    is_float: bool,
    /// Offset of a literal from the aligned program counter.
    literal: Option<i64>,
    /// Number of instructions in the block that an `IT` begins.
    pub(super) conditional: Option<u8>,
}

/// Number of the program counter among the registers.
const PC: u16 = 15;

const fn bit(register: u16) -> u16 {
    1 << (register & 15)
}

const fn field(half: u16, at: u16, bits: u16) -> u16 {
    (half >> at) & ((1 << bits) - 1)
}

impl Instruction {
    const fn of(bytes: u8, work: Work) -> Self {
        Self { bytes, work, address: 0, writes: 0, is_float: false, literal: None, conditional: None }
    }

    const fn writing(bytes: u8, work: Work, register: u16) -> Self {
        Self { writes: bit(register), ..Self::of(bytes, work) }
    }

    const fn access(bytes: u8, is_load: bool, register: u16, address: u16) -> Self {
        let writes = if is_load { bit(register) } else { 0 };
        let memory = if is_load { Memory::Load } else { Memory::Store };
        Self { address, writes, ..Self::of(bytes, Work::Single(memory)) }
    }

    /// Decodes an instruction; a narrow one is `first` alone.
    pub(super) fn decode(first: u16, second: u16) -> Self {
        if first >> 11 >= 0b11101 { wide(first, second) } else { narrow(first) }
    }

    /// Returns the address of the literal that it loads.
    pub(super) fn literal(&self, at: u64) -> Option<u64> {
        ((at + 4) & !3).checked_add_signed(self.literal?)
    }

    /// Returns its cycles behind another instruction, without a reload of the pipeline.
    pub(super) fn cost(&self, before: Option<&Self>) -> Bounds {
        let own = match self.work {
            Work::Simple | Work::Float => Bounds::new(1, 1),
            Work::Double => Bounds::new(2, 2),
            Work::IfThen => Bounds::new(u64::from(before.is_none_or(|before| before.bytes == 4)), 1),
            Work::Accumulate | Work::Single(Memory::Store) => Bounds::new(1, 2),
            Work::Divide => Bounds::new(2, 12),
            Work::Table => Bounds::new(2, 3),
            Work::Multiple(words) => Bounds::new(1 + words, 1 + words),
            Work::FloatAccumulate => Bounds::new(3, 3),
            Work::FloatDivide => Bounds::new(1, 14),
            Work::Single(Memory::Load) => self.load(before),
        };
        Bounds::new(own.least, own.most + self.stall(before))
    }

    fn load(&self, before: Option<&Self>) -> Bounds {
        let follows = before.is_some_and(|before| matches!(before.work, Work::Single(_)));
        let is_pipelined = before.is_some_and(|before| {
            before.work == Work::Single(Memory::Load) && before.writes & self.address == 0
        });
        let contends = u64::from(self.literal.is_some());
        Bounds::new(if follows { 1 } else { 2 }, if is_pipelined { 1 } else { 2 } + contends)
    }

    /// Returns the cycles for which it may wait for the result of the instruction before.
    fn stall(&self, before: Option<&Self>) -> u64 {
        let Some(before) = before else { return 0 };
        let computes = !matches!(before.work, Work::Single(_) | Work::Multiple(_));
        let address = computes && before.writes & self.address != 0;
        let float =
            self.is_float && matches!(before.work, Work::Float | Work::FloatAccumulate | Work::FloatDivide);
        u64::from(address) + u64::from(float)
    }
}

fn narrow(half: u16) -> Instruction {
    let (low, third, upper) = (field(half, 0, 3), field(half, 3, 3), field(half, 8, 3));
    match half >> 11 {
        // Shifts, additions; comparisons write nothing, which only lengthens the upper bound.
        0b00000..=0b00011 => Instruction::writing(2, Work::Simple, low),
        0b00100..=0b00111 | 0b10100 | 0b10101 => Instruction::writing(2, Work::Simple, upper),
        0b01000 if field(half, 10, 1) == 0 => Instruction::writing(2, Work::Simple, low),
        0b01000 => Instruction::writing(2, Work::Simple, low | field(half, 7, 1) << 3),
        0b01001 => {
            let literal = Some(4 * i64::from(field(half, 0, 8)));
            Instruction { literal, ..Instruction::access(2, true, upper, 0) }
        }
        // Bits 9 to 11: three stores and a signed load before the loads.
        0b01010 | 0b01011 => {
            let address = bit(third) | bit(field(half, 6, 3));
            Instruction::access(2, field(half, 9, 3) >= 3, low, address)
        }
        0b01100..=0b10001 => Instruction::access(2, field(half, 11, 1) == 1, low, bit(third)),
        0b10010 | 0b10011 => Instruction::access(2, field(half, 11, 1) == 1, upper, bit(13)),
        0b10110 | 0b10111 => miscellaneous(half),
        0b11000 | 0b11001 => multiple(2, field(half, 0, 8), upper),
        _ => Instruction::of(2, Work::Simple),
    }
}

fn miscellaneous(half: u16) -> Instruction {
    let is_stack = field(half, 9, 2) == 0b10;
    if is_stack {
        return multiple(2, field(half, 0, 9), 13);
    }
    if half >> 8 == 0xBF && field(half, 0, 4) != 0 {
        let length = 4 - field(half, 0, 4).trailing_zeros() as u8;
        return Instruction { conditional: Some(length), ..Instruction::of(2, Work::IfThen) };
    }
    // The stack pointer's additions, and extensions.
    let to = if half >> 8 == 0xB0 { 13 } else { field(half, 0, 3) };
    Instruction::writing(2, Work::Simple, to)
}

fn multiple(bytes: u8, registers: u16, base: u16) -> Instruction {
    let words = u64::from(registers.count_ones());
    Instruction { address: bit(base), ..Instruction::of(bytes, Work::Multiple(words)) }
}

fn wide(first: u16, second: u16) -> Instruction {
    match first >> 8 {
        0xE8 | 0xE9 => accesses_of_many(first, second),
        0xEC | 0xED => float_accesses(first, second),
        0xEE => float_arithmetic(first, second),
        0xF8 | 0xF9 => accesses_of_one(first, second),
        0xFB => multiplication(first, second),
        // Branches and the like write no register.
        0xF0..=0xF7 if second >> 15 == 1 => Instruction::of(4, Work::Simple),
        _ => Instruction::writing(4, Work::Simple, field(second, 8, 4)),
    }
}

fn accesses_of_many(first: u16, second: u16) -> Instruction {
    let base = field(first, 0, 4);
    if field(first, 6, 1) == 0 {
        return multiple(4, second, base);
    }
    let is_indexed = field(first, 8, 1) == 1 || field(first, 5, 1) == 1;
    match (is_indexed, field(first, 4, 8)) {
        (true, _) => Instruction { address: bit(base), ..Instruction::of(4, Work::Multiple(2)) },
        (false, 0x8D) if field(second, 5, 3) == 0 => Instruction::of(4, Work::Table),
        (false, _) => Instruction::access(4, field(first, 4, 1) == 1, field(second, 12, 4), bit(base)),
    }
}

fn accesses_of_one(first: u16, second: u16) -> Instruction {
    let (base, to) = (field(first, 0, 4), field(second, 12, 4));
    let is_load = field(first, 4, 1) == 1;
    let by_register = field(first, 7, 1) == 0 && field(second, 6, 6) == 0 && base != PC;
    let index = if by_register { bit(field(second, 0, 4)) } else { 0 };
    let access = Instruction::access(4, is_load, to, bit(base) | index);
    if base != PC || !is_load {
        return access;
    }
    let offset = i64::from(field(second, 0, 12));
    let literal = Some(if field(first, 7, 1) == 1 { offset } else { -offset });
    Instruction { literal, address: 0, ..access }
}

fn multiplication(first: u16, second: u16) -> Instruction {
    let (kind, to) = (field(first, 4, 4), field(second, 8, 4));
    let work = match kind {
        0b0000 if field(second, 12, 4) != 15 => Work::Accumulate,
        0b1001 | 0b1011 => Work::Divide,
        _ => Work::Simple,
    };
    let long = if kind >= 0b1000 { bit(field(second, 12, 4)) } else { 0 };
    let multiplied = Instruction::writing(4, work, to);
    Instruction { writes: multiplied.writes | long, ..multiplied }
}

fn float_accesses(first: u16, second: u16) -> Instruction {
    let base = field(first, 0, 4);
    let words = u64::from(field(second, 0, 8));
    let is_single = field(first, 8, 1) == 1 && field(first, 5, 1) == 0;
    let accessed = match (first & 0xFFE0 == 0xEC40, is_single, field(second, 8, 1)) {
        (true, ..) => Instruction::of(4, Work::Double),
        (false, false, _) => multiple(4, 0, base).with(Work::Multiple(words)),
        (false, true, 1) => multiple(4, 0, base).with(Work::Multiple(2)),
        // The register that it loads is no core register.
        (false, true, _) => {
            let access = Instruction::access(4, field(first, 4, 1) == 1, 0, bit(base));
            Instruction { writes: 0, ..access }
        }
    };
    let offset = 4 * words.cast_signed();
    let is_literal = is_single && base == PC && field(first, 4, 1) == 1;
    let literal = is_literal.then_some(if field(first, 7, 1) == 1 { offset } else { -offset });
    Instruction { is_float: true, literal, ..accessed }
}

fn float_arithmetic(first: u16, second: u16) -> Instruction {
    let work = if field(second, 4, 1) == 1 {
        Work::Simple
    } else {
        match (first & 0b1011_0000, first & 0b1111, field(second, 6, 2)) {
            (0b0000_0000 | 0b0001_0000 | 0b1001_0000 | 0b1010_0000, ..) => Work::FloatAccumulate,
            (0b1000_0000, ..) | (0b1011_0000, 0b0001, 0b11) => Work::FloatDivide,
            _ => Work::Float,
        }
    };
    // A transfer to a core register may be the address of the next access.
    let writes = if work == Work::Simple { bit(field(second, 12, 4)) } else { 0 };
    Instruction { is_float: true, writes, ..Instruction::of(4, work) }
}

impl Instruction {
    const fn with(self, work: Work) -> Self {
        Self { work, ..self }
    }
}
