//! The module in process.

use anyhow::{Context, Result, ensure};
use rai_firmware::receiver::{Boot, Receiver};

use super::Lump;
use crate::pin::Pin;

/// Bodies of the commands that configure the module before the first epoch, without `$PRAIC,` and checksum.
pub type Setup = [String];

/// A command as it goes over the wire.
pub(super) fn command(body: &str) -> String {
    let body = format!("PRAIC,{body}");
    format!("${body}*{:02X}\r\n", body.bytes().fold(0u8, |sum, byte| sum ^ byte))
}

/// Fails unless every answer says OK.
pub(super) fn check_answers(setup: &Setup, answers: &str) -> Result<()> {
    for (body, answer) in setup.iter().zip(answers.lines()) {
        let accepted = answer.split('*').next().is_some_and(|answer| answer.ends_with(",OK"));
        ensure!(accepted, "the module refused `{body}`: {answer}");
    }
    Ok(())
}

/// Runs the lumps in process; gives the sentences of each.
///
/// # Errors
/// A setup command that the module refuses.
pub fn on_host(lumps: &[Lump], setup: &Setup, mut progress: impl FnMut(usize)) -> Result<Vec<String>> {
    let boot = Boot { git: "host", reset_cause: heapless::String::new() };
    let mut receiver = Receiver::new(Pin::default(), boot).context("the module cannot start")?;
    let mut answers = Vec::new();
    for body in setup {
        receiver.command(command(body).as_bytes(), &mut answers);
    }
    check_answers(setup, &String::from_utf8(answers)?)?;
    let mut sentences = Vec::with_capacity(lumps.len());
    for (done, lump) in lumps.iter().enumerate() {
        let mut said = Vec::new();
        receiver.gnss(&lump.bytes, (lump.elapsed_s * 1e3) as u64, &mut said);
        let text = String::from_utf8(said)?;
        let protected = text.contains("$PRAIS,") && text.contains(",P,");
        ensure!(receiver.pin().high == protected, "pin and verdict disagree at {} s", lump.elapsed_s);
        sentences.push(text);
        progress(done + 1);
    }
    Ok(sentences)
}
