//! Processor of a program of Linux, and its needs: a loader, and libraries.

use object::elf::{DT_NEEDED, FileHeader64, PT_INTERP};
use object::read::elf::{Dyn as _, FileHeader as _, ProgramHeader as _};
use object::{Endianness, Result};

/// What a program of 64 bits needs to run.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Needs {
    /// Number of the processor.
    pub(super) machine: u16,
    /// Parts of the system, in words; none for a static program.
    pub(super) parts: Vec<&'static str>,
}

/// Returns what a program needs.
///
/// # Errors
/// If it is no ELF file of 64 bits.
pub(super) fn needs(program: &[u8]) -> Result<Needs> {
    let header = FileHeader64::<Endianness>::parse(program)?;
    let endian = header.endian()?;
    let mut parts = Vec::new();
    for segment in header.program_headers(endian, program)? {
        if segment.p_type(endian) == PT_INTERP {
            parts.push("a loader");
        }
        let entries = segment.dynamic(endian, program)?.unwrap_or_default();
        if entries.iter().any(|entry| entry.tag32(endian) == Some(DT_NEEDED)) {
            parts.push("a library");
        }
    }
    Ok(Needs { machine: header.e_machine(endian), parts })
}

#[cfg(test)]
mod tests {
    use super::needs;

    /// This test is a program of its own, which the compiler links with the libraries of the
    /// system.
    #[cfg(all(
        target_os = "linux",
        target_env = "gnu",
        any(target_arch = "x86_64", target_arch = "aarch64")
    ))]
    #[test]
    fn program_of_this_system_wants_its_loader_and_libraries() {
        let own = needs(&std::fs::read(std::env::current_exe().unwrap()).unwrap()).unwrap();
        assert_eq!(own.parts, ["a loader", "a library"]);
        assert_eq!(own.machine, if cfg!(target_arch = "aarch64") { 183 } else { 62 });
    }

    #[test]
    fn file_that_is_no_program_is_refused() {
        for wrong in [&b"#!/bin/sh\n"[..], &[0; 64], b"\x7fELF"] {
            assert!(needs(wrong).is_err());
        }
    }
}
