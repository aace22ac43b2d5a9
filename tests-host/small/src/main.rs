//! The module with the parts of the image `small`: requests come on standard input, answers go to
//! standard output.

use std::io;

use anyhow::{Context as _, Result};
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::settings::SEALED_BYTES;
use small_module::{Answer, Kind, Request};

fn main() -> Result<()> {
    let (mut input, mut output) = (io::stdin().lock(), io::stdout().lock());
    let mut receiver = started()?;
    while let Some(request) = Request::read(&mut input)? {
        let bytes = obey(&mut receiver, &request)?;
        Answer { is_promised: receiver.pin().high, bytes }.write(&mut output)?;
    }
    Ok(())
}

/// Returns a module that has received nothing.
fn started() -> Result<Receiver<MemoryPin>> {
    Receiver::new(MemoryPin::default(), Boot::on_host("small")).context("the module cannot start")
}

/// Carries out a request and returns the bytes of the answer.
fn obey(receiver: &mut Receiver<MemoryPin>, Request { kind, now_ms, bytes }: &Request) -> Result<Vec<u8>> {
    let mut reported = Vec::new();
    match kind {
        Kind::Command => receiver.command(bytes, &mut reported),
        Kind::Gnss => {
            receiver.gnss(bytes, *now_ms, &mut reported);
        }
        Kind::Tick => {
            receiver.tick(*now_ms, &mut reported);
        }
        Kind::Seal => reported.extend(sealed(receiver, bytes)?),
        Kind::Restart => {
            *receiver = started()?;
            receiver.restore(&memory(bytes)?, false);
            reported.extend(sealed(receiver, bytes)?);
        }
        Kind::Hash => reported.extend(receiver.configuration().hash().to_le_bytes()),
        Kind::Counter => {
            let name = std::str::from_utf8(bytes)?;
            let found = receiver.statistics().find(|(counter, _)| *counter == name);
            reported.extend(found.map_or(0, |(_, count)| count).to_le_bytes());
        }
    }
    Ok(reported)
}

fn memory(bytes: &[u8]) -> Result<[u8; SEALED_BYTES]> {
    bytes.try_into().context("the memory of the settings has another length")
}

/// Returns the memory with the settings in it.
fn sealed(receiver: &mut Receiver<MemoryPin>, bytes: &[u8]) -> Result<[u8; SEALED_BYTES]> {
    let mut memory = memory(bytes)?;
    receiver.seal(&mut memory);
    Ok(memory)
}
