//! A file's text, whatever it is wrapped in.
//!
//! Wrapping is told by content, not by name: gzip by its magic bytes, compact RINEX by the label of its first line.

use std::io::Read as _;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use flate2::read::MultiGzDecoder;

use super::hatanaka;

/// RINEX text of a file: plain, gzip, compact, or compact in gzip.
///
/// Bytes outside ASCII (names in comments) become `?`, so that every column stays where it was.
pub(super) fn open(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).context("cannot be read")?;
    let text: String =
        unpack(bytes)?.into_iter().map(|byte| if byte.is_ascii() { byte.into() } else { '?' }).collect();
    ensure!(!text.trim().is_empty(), "is empty");
    let first = text.lines().next().unwrap_or("");
    if first.get(60..).is_some_and(|label| label.trim_end() == hatanaka::MARK) {
        return hatanaka::decompress(&text);
    }
    Ok(text)
}

fn unpack(bytes: Vec<u8>) -> Result<Vec<u8>> {
    match bytes.as_slice() {
        [0x1f, 0x8b, ..] => {
            let mut unpacked = Vec::with_capacity(bytes.len() * 6);
            MultiGzDecoder::new(bytes.as_slice()).read_to_end(&mut unpacked).context("is damaged gzip")?;
            Ok(unpacked)
        }
        [0x1f, 0x9d, ..] => bail!("is packed by `compress`: unpack it with `gzip -d`"),
        [b'P', b'K', 3, 4, ..] => bail!("is a zip archive: unpack it first"),
        _ => Ok(bytes),
    }
}
