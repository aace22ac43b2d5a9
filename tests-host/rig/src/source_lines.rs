//! Source lines of an image's instructions, by DWARF.

use std::borrow::Cow;

use addr2line::Context;
use addr2line::gimli::{Dwarf, EndianSlice, LittleEndian};
use anyhow::Result;
use object::{Object, ObjectSection};

/// Folders of what runs on a chip.
const OWN: [&str; 2] = ["rai-core/", "rai-firmware/"];

/// A source line at an instruction, with its function.
pub(crate) struct Frame {
    pub(crate) file: String,
    pub(crate) line: u32,
    pub(crate) function: String,
}

impl Frame {
    /// Returns the path from the root of the repository, if the file belongs to the product.
    pub(crate) fn own_file(&self) -> Option<&str> {
        OWN.iter().find_map(|folder| self.file.find(folder)).and_then(|start| self.file.get(start..))
    }
}

/// Source lines of an image.
pub(crate) struct Lines<'a>(Context<EndianSlice<'a, LittleEndian>>);

impl<'a> Lines<'a> {
    /// Reads the debug information of an ELF file.
    ///
    /// # Errors
    /// If it is malformed.
    pub(crate) fn of(elf: &object::File<'a>) -> Result<Self> {
        let load = |id: addr2line::gimli::SectionId| -> Result<_, addr2line::gimli::Error> {
            let section = elf.section_by_name(id.name());
            let bytes = section.and_then(|section| section.data().ok()).unwrap_or_default();
            Ok(EndianSlice::new(bytes, LittleEndian))
        };
        Ok(Self(Context::from_dwarf(Dwarf::load(load)?)?))
    }

    /// Returns the functions inlined at an instruction, innermost first.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub(crate) fn at(&self, address: u64) -> Result<Vec<Frame>> {
        let mut frames = self.0.find_frames(address).skip_all_loads()?;
        let mut found = Vec::new();
        while let Some(frame) = frames.next()? {
            let location = frame.location;
            let name = frame.function.as_ref().and_then(|function| function.demangle().ok());
            found.push(Frame {
                file: location.as_ref().and_then(|at| at.file).unwrap_or_default().to_owned(),
                line: location.and_then(|at| at.line).unwrap_or_default(),
                function: name.map_or_else(|| "?".to_owned(), Cow::into_owned),
            });
        }
        Ok(found)
    }
}
