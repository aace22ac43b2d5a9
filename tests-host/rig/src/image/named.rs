//! Named images: the sets of features that are built, measured, proved, replayed and documented.
//!
//! [`NAMED`] is the only list of them. From a row follow the build (`cargo xtask image`), the check
//! of its memory, the chips that carry it (`cargo xtask flash --dry-run`), its figures in
//! `tests-host/budgets.txt`, the proof that it does not panic, the replay that compares it with the
//! host, and its row in `results/cost.md`.
//!
//! | quantity | field | unit |
//! |---|---|---|
//! | largest flash | `flash_kib` | KiB |
//! | largest sum of statics and stack | `ram_kib` | KiB |
//! | part of that sum for the stack | `stack_bytes` | bytes |
//! | room of an epoch | `satellites` | satellites |
//!
//! A limit is below the memory of the smallest chip that is meant, so that a boot loader and stored
//! settings find room. The stack that was ever in use ([`crate::bench::memory`]) must be within
//! `stack_bytes`.

use std::fmt;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};

use super::chips::{Chip, OTHERS, SUPPORTED};
use super::{Image, build};
use emulated::image::{CompiledFor, apart, built, cargo};

/// An image that has a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Named {
    /// Name in commands, figures and documents.
    pub name: &'static str,
    /// Content, for a reader.
    pub content: &'static str,
    /// Features of `raim-firmware` beside the board, separated by commas.
    features: &'static str,
    /// Goal of the optimisation.
    pub compiled_for: CompiledFor,
    /// Most satellites of an epoch.
    pub satellites: usize,
    /// Bytes that are reserved for the stack.
    pub stack_bytes: u64,
    /// Largest flash, KiB.
    pub flash_kib: u64,
    /// Largest RAM with the stack, KiB.
    pub ram_kib: u64,
}

/// All named images; the first is the shipped one, `cargo image`.
pub const NAMED: [Named; 4] = [
    Named {
        name: "fast",
        content: "everything",
        features: "whole,gsv,sbf,cnav,osnma,both-kinds,satellites-48",
        compiled_for: CompiledFor::Speed,
        satellites: 48,
        stack_bytes: 10 * 1024,
        flash_kib: 352,
        ram_kib: 96,
    },
    Named {
        name: "whole",
        content: "everything except `GSV`, SBF, CNAV and OSNMA",
        features: "whole,satellites-32",
        compiled_for: CompiledFor::Size,
        satellites: 32,
        stack_bytes: 37 * 256,
        flash_kib: 236,
        ram_kib: 60,
    },
    Named {
        name: "signed",
        content: "`whole` with SBF and OSNMA",
        features: "whole,sbf,osnma,satellites-32",
        compiled_for: CompiledFor::Size,
        satellites: 32,
        stack_bytes: 37 * 256,
        flash_kib: 272,
        ram_kib: 76,
    },
    Named {
        name: "small",
        content: "RTCM 3, classic RAIM, thresholds of the phases of flight, RMC and GGA; no log",
        features: "",
        compiled_for: CompiledFor::Size,
        satellites: 16,
        stack_bytes: 6 * 1024,
        flash_kib: 116,
        ram_kib: 32,
    },
];

impl Named {
    /// Returns the image of that name.
    ///
    /// # Errors
    /// If the name is unknown; the message lists the known ones.
    pub fn of(name: &str) -> anyhow::Result<&'static Self> {
        if let Some(found) = NAMED.iter().find(|named| named.name == name) {
            return Ok(found);
        }
        let names: Vec<&str> = NAMED.iter().map(|named| named.name).collect();
        bail!("image `{name}` is not one of {}", names.join(", "));
    }

    /// Returns true if the image has every part, so that it sends every sentence, and a log.
    pub fn is_whole(&self) -> bool {
        self.features.split(',').any(|feature| feature == "whole")
    }

    /// Builds the image with a log, which shows its pin, its stack and its cost, and returns its
    /// path. An image that has one is built as it is.
    ///
    /// # Errors
    /// As [`Self::build`].
    pub fn build_with_log(&self) -> anyhow::Result<PathBuf> {
        if self.is_whole() {
            return self.build();
        }
        self.build_in(&format!("{}-log", self.name), &format!("{},log", self.features))
    }

    /// Builds the image and returns its path.
    ///
    /// All but the shipped image have folders of their own, because they have one file name.
    ///
    /// # Errors
    /// If cargo cannot be run or the build fails; cargo has then printed the reason.
    pub fn build(&self) -> anyhow::Result<PathBuf> {
        if *self == NAMED[0] {
            return build();
        }
        self.build_in(self.name, self.features)
    }

    /// Builds an image with these features in a folder of its own.
    fn build_in(&self, folder: &str, features: &str) -> anyhow::Result<PathBuf> {
        let mut cargo = cargo();
        let features: Vec<String> = features
            .split(',')
            .filter(|name| !name.is_empty())
            .map(|name| format!("raim-firmware/{name}"))
            .collect();
        cargo.arg(self.compiled_for.command()).args([
            "--no-default-features",
            "--features",
            &features.join(","),
        ]);
        built(apart(&mut cargo, &Path::new("target/images").join(folder)))
            .with_context(|| format!("image `{}`", self.name))
    }

    /// Returns the RAM that the image needs with its stack, bytes.
    pub const fn ram_bytes(&self, image: &Image) -> u64 {
        image.static_ram_bytes + self.stack_bytes
    }

    /// Returns the limits that a build of it exceeds.
    pub fn findings(&self, image: &Image) -> Vec<String> {
        let ram_bytes = self.ram_bytes(image);
        let limits =
            [("flash", image.flash_bytes, self.flash_kib), ("RAM with the stack", ram_bytes, self.ram_kib)];
        let exceeded = limits.into_iter().filter(|(_, bytes, most_kib)| *bytes > most_kib * 1024);
        let finding = |(memory, bytes, most_kib)| {
            format!("image `{}` takes {bytes} bytes of {memory}, more than {most_kib} KiB", self.name)
        };
        exceeded.map(finding).collect()
    }

    /// Returns the chips whose memory holds any build within the limits: the supported ones, then
    /// those without a board.
    pub fn carriers(&self) -> [Vec<Chip>; 2] {
        let holds = |chip: &&Chip| chip.holds(self.flash_kib * 1024, self.ram_kib * 1024);
        [&SUPPORTED[..], &OTHERS[..]].map(|chips| chips.iter().filter(holds).copied().collect())
    }
}

impl fmt::Display for Named {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, content, compiled_for, satellites, flash_kib, ram_kib, .. } = self;
        writeln!(formatter, "{name}: {content}; {satellites} satellites; {compiled_for}")?;
        writeln!(formatter, "  at most {flash_kib} KiB of flash, {ram_kib} KiB of RAM with the stack")?;
        let [supported, others] = self.carriers();
        for (words, chips) in [("board and memory", supported), ("memory, but no board", others)] {
            let chips: Vec<String> = chips.iter().map(ToString::to_string).collect();
            writeln!(formatter, "  {words}: {}", chips.join(", "))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_name_is_refused_with_the_known_ones() {
        assert_eq!(Named::of("whole").expect("a name").satellites, 32);
        let error = Named::of("tiny").expect_err("no name").to_string();
        assert!(NAMED.iter().all(|named| error.contains(named.name)), "{error}");
    }

    #[test]
    fn limits_are_exceeded_by_one_byte_and_the_stack_counts() {
        let named = Named { flash_kib: 100, ram_kib: 40, stack_bytes: 8 * 1024, ..NAMED[0] };
        let image = |flash_bytes, static_ram_bytes| Image {
            flash_bytes,
            static_ram_bytes,
            stack_bytes: 0,
            initial_stack_pointer: 0,
            reset_vector: 0,
            flash_extents: Vec::new(),
            ram_extents: Vec::new(),
        };
        let (flash, statics) = (100 * 1024, 32 * 1024);
        assert_eq!(named.findings(&image(flash, statics)), Vec::<String>::new());
        for (flash, statics, want) in [(flash + 1, statics, "flash"), (flash, statics + 1, "RAM")] {
            let have = named.findings(&image(flash, statics));
            assert!(matches!(&have[..], [one] if one.contains(want)), "{have:?}");
        }
    }

    #[test]
    fn every_image_has_a_name_of_its_own_and_a_chip_with_a_board() {
        let names: std::collections::BTreeSet<_> = NAMED.iter().map(|named| named.name).collect();
        assert_eq!(names.len(), NAMED.len());
        for named in NAMED {
            let [supported, _] = named.carriers();
            assert!(!supported.is_empty(), "{named}");
        }
    }
}
