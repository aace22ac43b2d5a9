//! Lines of a file, plain or packed.
//!
//! Content determines the packing, not the name: gzip by its magic bytes, compact RINEX by the
//! label of its first line.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use anyhow::{Context, Result, bail};
use flate2::bufread::MultiGzDecoder;

use super::hatanaka::{self, Compact};
use super::text::{Lines, Plain, Source, label};

/// First bytes of packed files, the program that made them, and the command that unpacks them.
const PACKED: [(&[u8], &str, &str); 8] = [
    (b"BZh", "bzip2", "bunzip2 -k"),
    (b"PK\x03\x04", "zip", "unzip"),
    (b"\x1f\x9d", "compress", "gzip -dk"),
    (b"\xfd7zXZ\0", "xz", "xz -dk"),
    (b"\x28\xb5\x2f\xfd", "zstd", "zstd -d"),
    (b"7z\xbc\xaf\x27\x1c", "7-Zip", "7z x"),
    (b"\x04\x22\x4d\x18", "lz4", "lz4 -d"),
    (b"Rar!", "RAR", "unrar x"),
];

/// First bytes of gzip, which is read directly.
const GZIP: &[u8] = &[0x1f, 0x8b];

/// Returns the program that packed the bytes and the command that unpacks them; `None` for plain
/// bytes and gzip.
pub fn packed_by(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    PACKED
        .iter()
        .find(|(beginning, ..)| bytes.starts_with(beginning))
        .map(|(_, packer, command)| (*packer, *command))
}

/// Opens the RINEX text of a file: plain, gzip, compact, or compact in gzip.
pub(super) fn open(path: &Path) -> Result<Lines> {
    let file = File::open(path).context("cannot be read")?;
    lines(BufReader::with_capacity(1 << 16, file), &path.display().to_string())
}

/// Opens the RINEX text of bytes; `name` stands in the command that unpacks them.
pub(super) fn lines(mut input: impl BufRead + Send + 'static, name: &str) -> Result<Lines> {
    let beginning = input.fill_buf().context("cannot be read")?;
    if let Some((packer, command)) = packed_by(beginning) {
        bail!("is packed by {packer}: unpack it first, `{command} {name}`");
    }
    if beginning.starts_with(GZIP) {
        let unpacked = BufReader::with_capacity(1 << 16, MultiGzDecoder::new(input));
        return plain(Plain::new(unpacked, "is damaged gzip"));
    }
    plain(Plain::new(input, "cannot be read"))
}

fn plain<R: BufRead + Send + 'static>(mut source: Plain<R>) -> Result<Lines> {
    let mut first = String::new();
    let number = loop {
        let number = source.read(&mut first)?.context("is empty")?;
        if !first.trim().is_empty() {
            break number;
        }
    };
    if label(&first) != hatanaka::MARK {
        return Ok(Lines::new(Box::new(source), first, number));
    }
    let mut compact = Compact::new(Box::new(source), &first)?;
    let mut line = String::new();
    let number = compact.read(&mut line)?.context("END OF HEADER is missing")?;
    Ok(Lines::new(Box::new(compact), line, number))
}
