//! The firmware image: its build, and a check against the memory of the chip.
//!
//! | quantity | field | unit |
//! |---|---|---|
//! | code, constants and the initial values of the statics | `flash_bytes` | bytes |
//! | statics, cleared or not | `static_ram_bytes` | bytes |
//! | RAM left for the stack | `stack_bytes` | bytes |
//!
//! The emulator has memory beyond the end of the chip's RAM, so an image that runs there proves
//! nothing; [`Image::check`] proves it.
//!
//! References: [ARMv7-M] §B1.5.3 (vector table), [DS8626] §4 (memory map).
//!
//! [ARMv7-M]: crate#references
//! [DS8626]: crate#references

mod chips;
mod named;

use std::fmt;
use std::ops::Range;
use std::path::Path;

use anyhow::{Context, ensure};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind};

pub use chips::Chip;
pub use emulated::image::{CompiledFor, build, build_for, build_laboratory, build_rai, build_small_module};
pub(crate) use emulated::image::{SECOND_BOARD_FLAGS, apart, cargo, executable};
pub use named::{NAMED, Named};

/// Largest size of the statics: the receiver (63 KiB), the ports' rings (8 KiB), and little more.
///
/// The receiver has 15 KiB for an epoch's satellites, equations and solution, and for ARAIM's
/// memory of each row and term, which are here and not on the stack. It has 12 KiB for the longest
/// frame and an epoch's raw ranges, 10 KiB for ephemerides, 6 KiB for navigation bits, 1 KiB for
/// what CNAV says, and 12 KiB for what OSNMA waits for.
pub const STATIC_RAM_BUDGET_BYTES: u64 = 76 * 1024;
/// Smallest size of the stack; the high-water mark that the image logs is far below.
pub const STACK_BUDGET_BYTES: u64 = 48 * 1024;

/// Memory of an image, and its start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Bytes that go to flash.
    pub flash_bytes: u64,
    /// Bytes of RAM that statics occupy.
    pub static_ram_bytes: u64,
    /// Bytes of RAM between the statics and the initial stack pointer.
    pub stack_bytes: u64,
    /// First word of the vector table.
    pub initial_stack_pointer: u64,
    /// Second word of the vector table.
    pub reset_vector: u64,
    flash_extents: Vec<Range<u64>>,
    ram_extents: Vec<Range<u64>>,
}

impl Image {
    /// Reads an image's segments, sections and vector table.
    ///
    /// # Errors
    /// If the file cannot be read, is not an ELF file for this processor or has no vector table.
    pub fn open(path: &Path) -> anyhow::Result<Self> {
        let bytes = std::fs::read(path).with_context(|| format!("{} cannot be read", path.display()))?;
        Self::parse(&bytes).with_context(|| format!("{} is not a firmware image", path.display()))
    }

    fn parse(bytes: &[u8]) -> anyhow::Result<Self> {
        let elf = object::File::parse(bytes)?;
        ensure!(
            elf.architecture() == object::Architecture::Arm,
            "built for {:?}, not for Arm",
            elf.architecture()
        );
        let (initial_stack_pointer, reset_vector) = vectors(&elf)?;
        let ram_extents = extents_in(&elf, |address| (0x2000_0000..0x4000_0000).contains(&address));
        let statics_end = ram_extents.iter().map(|extent| extent.end).max().unwrap_or(0x2000_0000);
        let flash_extents = load_extents(bytes)?;
        Ok(Self {
            flash_bytes: flash_extents.iter().map(|extent| extent.end - extent.start).sum(),
            static_ram_bytes: ram_extents.iter().map(|extent| extent.end - extent.start).sum(),
            stack_bytes: initial_stack_pointer.saturating_sub(statics_end),
            initial_stack_pointer,
            reset_vector,
            flash_extents,
            ram_extents,
        })
    }

    /// Returns the findings against the image on `chip`; none if it fits and would start.
    pub fn check(&self, chip: &Chip) -> Vec<String> {
        let mut findings = Vec::new();
        let mut require = |holds: bool, finding: String| {
            if !holds {
                findings.push(finding);
            }
        };
        for extent in &self.flash_extents {
            require(
                within(extent, &chip.flash()),
                format!("{extent:#x?} is outside the flash of {}", chip.name),
            );
        }
        for extent in &self.ram_extents {
            require(within(extent, &chip.ram()), format!("{extent:#x?} is outside the RAM of {}", chip.name));
        }
        let stack = self.initial_stack_pointer;
        require(
            stack > chip.ram().start && stack <= chip.ram().end && stack.is_multiple_of(8),
            format!("initial stack pointer {stack:#010x} is not an aligned address in RAM"),
        );
        let reset = self.reset_vector;
        require(
            reset & 1 == 1,
            format!("reset vector {reset:#010x} lacks the Thumb bit: the core would fault"),
        );
        require(
            chip.flash().contains(&(reset & !1)),
            format!("reset vector {reset:#010x} is outside the flash"),
        );
        let (ram, budget) = (self.static_ram_bytes, STATIC_RAM_BUDGET_BYTES);
        require(ram <= budget, format!("statics take {ram} bytes of RAM, more than the budget of {budget}"));
        let (stack, budget) = (self.stack_bytes, STACK_BUDGET_BYTES);
        require(stack >= budget, format!("{stack} bytes are left for the stack, less than {budget}"));
        findings
    }
}

impl fmt::Display for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "flash          {:>8} bytes", self.flash_bytes)?;
        writeln!(f, "static RAM     {:>8} bytes of {STATIC_RAM_BUDGET_BYTES}", self.static_ram_bytes)?;
        writeln!(f, "left for stack {:>8} bytes, at least {STACK_BUDGET_BYTES}", self.stack_bytes)?;
        write!(
            f,
            "stack pointer {:#010x}, reset vector {:#010x}",
            self.initial_stack_pointer, self.reset_vector
        )
    }
}

fn within(inner: &Range<u64>, outer: &Range<u64>) -> bool {
    inner.start >= outer.start && inner.end <= outer.end
}

fn vectors(elf: &object::File<'_>) -> anyhow::Result<(u64, u64)> {
    let table = elf.section_by_name(".vector_table").context("the vector table is missing")?.data()?;
    let word = |offset: usize| -> anyhow::Result<u64> {
        let bytes = table.get(offset..offset + 4).context("the vector table is incomplete")?;
        Ok(u64::from(u32::from_le_bytes(bytes.try_into()?)))
    };
    Ok((word(0)?, word(4)?))
}

fn extents_in(elf: &object::File<'_>, inside: impl Fn(u64) -> bool) -> Vec<Range<u64>> {
    elf.sections()
        .filter(|section| section.size() > 0 && inside(section.address()) && is_allocated(section))
        .map(|section| section.address()..section.address() + section.size())
        .collect()
}

fn is_allocated<'a>(section: &impl ObjectSection<'a>) -> bool {
    let allocated = u64::from(object::elf::SHF_ALLOC);
    matches!(section.flags(), SectionFlags::Elf { sh_flags } if sh_flags & allocated != 0)
        && section.kind() != SectionKind::Metadata
}

/// Returns the physical addresses of the segments with content, to which the loader writes.
fn load_extents(bytes: &[u8]) -> anyhow::Result<Vec<Range<u64>>> {
    use object::read::elf::{FileHeader, ProgramHeader};
    let header = object::elf::FileHeader32::<object::Endianness>::parse(bytes)?;
    let endian = header.endian()?;
    let segments = header.program_headers(endian, bytes)?;
    Ok(segments
        .iter()
        .filter(|segment| segment.p_type(endian) == object::elf::PT_LOAD && segment.p_filesz(endian) > 0)
        .map(|segment| {
            let start = u64::from(segment.p_paddr(endian));
            start..start + u64::from(segment.p_filesz(endian))
        })
        .collect())
}

/// Returns the address of a symbol of the image, for a debugger.
///
/// # Errors
/// If the image cannot be read or has no such symbol.
pub fn symbol(path: &Path, name: &str) -> anyhow::Result<u64> {
    let bytes = std::fs::read(path)?;
    let elf = object::File::parse(&*bytes)?;
    let found = elf.symbols().find(|symbol| symbol.name() == Ok(name));
    Ok(found.with_context(|| format!("{} has no symbol `{name}`", path.display()))?.address())
}

#[cfg(test)]
#[allow(clippy::single_range_in_vec_init)] // An image has several extents; the one here just has one.
mod tests {
    use super::*;

    fn fitting() -> Image {
        Image {
            flash_bytes: 0x8000,
            static_ram_bytes: 0x4000,
            stack_bytes: 0x1_C000,
            initial_stack_pointer: 0x2002_0000,
            reset_vector: 0x0800_0401,
            flash_extents: vec![0x0800_0000..0x0800_8000],
            ram_extents: vec![0x2000_0000..0x2000_4000],
        }
    }

    fn findings(image: &Image) -> Vec<String> {
        image.check(&Chip::named("STM32F405RGTx").expect("a known chip"))
    }

    #[test]
    fn image_that_fits_has_no_findings() {
        assert_eq!(findings(&fitting()), Vec::<String>::new());
    }

    #[test]
    fn each_flaw_is_named() {
        let good = fitting();
        let flaws = [
            (Image { flash_extents: vec![0x0800_0000..0x0810_0001], ..good.clone() }, "outside the flash"),
            (Image { ram_extents: vec![0x2001_0000..0x2002_0004], ..good.clone() }, "outside the RAM"),
            (Image { initial_stack_pointer: 0x2002_0008, ..good.clone() }, "initial stack pointer"),
            (Image { initial_stack_pointer: 0x2001_FFFC, ..good.clone() }, "initial stack pointer"),
            (Image { reset_vector: 0x0800_0400, ..good.clone() }, "Thumb bit"),
            (Image { reset_vector: 0x2000_0401, ..good.clone() }, "outside the flash"),
            (Image { static_ram_bytes: STATIC_RAM_BUDGET_BYTES + 1, ..good.clone() }, "budget"),
            (Image { stack_bytes: STACK_BUDGET_BYTES - 1, ..good }, "left for the stack"),
        ];
        for (image, want) in flaws {
            let have = findings(&image);
            assert_eq!(have.len(), 1, "{have:?}");
            assert!(have[0].contains(want), "have {have:?}, want {want}");
        }
    }

    #[test]
    fn file_that_is_no_image_is_refused_by_name() {
        let error = Image::open(Path::new(file!()).file_name().map(Path::new).expect("a name"));
        assert!(error.is_err());
        let have = Image::parse(b"$GNGNS,not an ELF file").expect_err("text").to_string();
        assert!(!have.is_empty());
    }
}
