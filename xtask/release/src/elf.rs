//! Processor of a program of Linux, and its needs: a loader, and libraries.
//!
//! | part of the file | offset | content |
//! |---|---|---|
//! | header | 18 | processor: 62 x86-64, 183 `AArch64` |
//! | | 32, 54, 56 | place, size and number of the program headers |
//! | program header | 0 | kind: 2 dynamic section, 3 loader |
//! | | 8, 32 | place and size |
//! | dynamic entry | 0 | tag: 1 for a library that is needed |
//!
//! Reference: the System V ABI, chapters 4 and 5, for 64 bits with the low byte first.

const LOADER: u32 = 3;
const DYNAMIC: u32 = 2;
const NEEDED: u64 = 1;

/// Returns what the program needs, in words; `None` if it is no ELF file of 64 bits with the low
/// byte first.
pub(super) fn wants(program: &[u8]) -> Option<Vec<&'static str>> {
    let is_known = program.starts_with(b"\x7fELF\x02\x01");
    let [place, size, count] =
        [number::<8>(program, 32)?, number::<2>(program, 54)?, number::<2>(program, 56)?];
    let mut wants = Vec::new();
    for header in (0..count).map(|index| (place + index * size) as usize) {
        let kind = number::<4>(program, header)? as u32;
        let (begin, bytes) = (number::<8>(program, header + 8)?, number::<8>(program, header + 32)?);
        if kind == LOADER {
            wants.push("a loader");
        }
        let tags = (begin..begin + bytes).step_by(16).map(|entry| number::<8>(program, entry as usize));
        if kind == DYNAMIC && tags.flatten().take_while(|tag| *tag != 0).any(|tag| tag == NEEDED) {
            wants.push("a library");
        }
    }
    is_known.then_some(wants)
}

/// Returns the number of the processor; `None` if the file is too short.
pub(super) fn machine(program: &[u8]) -> Option<u64> {
    number::<2>(program, 18)
}

/// Returns a number of `N` bytes, the low byte first.
fn number<const N: usize>(program: &[u8], at: usize) -> Option<u64> {
    let bytes = program.get(at..)?.first_chunk::<N>()?;
    Some(bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
}

#[cfg(test)]
mod tests {
    use super::{machine, wants};

    /// This test is a program of its own, which the compiler links with the libraries of the
    /// system.
    #[cfg(all(
        target_os = "linux",
        target_env = "gnu",
        any(target_arch = "x86_64", target_arch = "aarch64")
    ))]
    #[test]
    fn program_of_this_system_wants_its_loader_and_libraries() {
        let own = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        assert_eq!(wants(&own), Some(["a loader", "a library"].to_vec()));
        let want = if cfg!(target_arch = "aarch64") { 183 } else { 62 };
        assert_eq!(machine(&own), Some(want));
    }

    #[test]
    fn file_that_is_no_program_is_refused() {
        assert_eq!(wants(b"#!/bin/sh\n"), None);
        assert_eq!(wants(&[0; 64]), None);
        assert_eq!(machine(b"\x7fELF"), None);
    }
}
