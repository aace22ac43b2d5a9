//! Calls of the C interface as bytes, for the C program that makes them, and its answers.
//!
//! The head of `rai-firmware/capi/tests/calls.c` defines the formats.

use anyhow::{Context as _, Result, ensure};
use raim_core::epoch::Epoch;

/// Calls in their order.
#[derive(Clone, Debug, Default)]
pub struct Calls {
    bytes: Vec<u8>,
}

impl Calls {
    fn add(&mut self, kind: u8, payload: &[&[u8]]) {
        let length: usize = payload.iter().map(|part| part.len()).sum();
        self.bytes.push(kind);
        self.bytes.extend((length as u32).to_le_bytes());
        for part in payload {
            self.bytes.extend(*part);
        }
    }

    /// Requests version, sizes and alignments.
    pub fn sizes(&mut self) {
        self.add(b's', &[]);
    }

    /// Makes a monitor: phase, method, policy, clock aiding, as the header numbers them.
    pub fn prepare(&mut self, [phase, method, policy, clock_aid]: [u8; 4]) {
        self.add(b'p', &[&[phase, method, policy, clock_aid]]);
    }

    /// Judges an epoch.
    pub fn judge<const N: usize>(&mut self, epoch: &Epoch<N>) {
        let mut ranges = Vec::new();
        for observation in epoch.observations() {
            let position = observation.position;
            let numbers =
                [position.x_m, position.y_m, position.z_m, observation.range_m, observation.sigma_m];
            ranges.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
            let satellite = observation.satellite;
            let (letter, number) = satellite.name();
            ranges.extend([letter as u8, number, 0, 0, 0, 0, 0, 0]);
        }
        self.add(b'm', &[&epoch.time_s().to_le_bytes(), &ranges]);
    }

    /// Forgets the last position.
    pub fn forget(&mut self) {
        self.add(b'f', &[]);
    }

    /// Asks a monitor for accuracy and residuals.
    pub fn explain(&mut self) {
        self.add(b'n', &[]);
    }

    /// Makes a receiver.
    pub fn start(&mut self) {
        self.add(b'i', &[]);
    }

    /// Sends bytes to the GNSS port.
    pub fn gnss(&mut self, now_ms: u64, bytes: &[u8]) {
        self.add(b'g', &[&now_ms.to_le_bytes(), bytes]);
    }

    /// Lets time pass.
    pub fn tick(&mut self, now_ms: u64) {
        self.add(b't', &[&now_ms.to_le_bytes()]);
    }

    /// Sends bytes to the host port.
    pub fn command(&mut self, bytes: &[u8]) {
        self.add(b'c', &[bytes]);
    }

    /// Sets by key and values; asks with empty values.
    pub fn set(&mut self, key: &str, values: &str) {
        self.add(b'k', &[key.as_bytes(), &[0], values.as_bytes(), &[0]]);
    }

    /// Asks a receiver for accuracy, velocity, residuals and counters.
    pub fn explain_receiver(&mut self) {
        self.add(b'a', &[]);
    }

    /// Returns all calls, encoded for the program.
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// Answer to a call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Kind of the call.
    pub kind: u8,
    /// Status of the call.
    pub status: u8,
    /// Depth of the stack below the caller, bytes; 0 on a host.
    pub stack_bytes: u32,
    /// Output of the call.
    pub given: Vec<u8>,
}

impl Answer {
    /// Returns the name of the function that was called.
    pub fn function(&self) -> &'static str {
        match self.kind {
            b'p' => "rai_monitor_init",
            b'm' => "rai_monitor_judge",
            b'f' => "rai_monitor_forget",
            b'i' => "rai_receiver_init",
            b'g' => "rai_receiver_gnss",
            b't' => "rai_receiver_tick",
            b'c' => "rai_receiver_command",
            b'k' => "rai_receiver_set",
            b'n' => "rai_monitor_residuals",
            b'a' => "rai_receiver_residuals",
            _ => "",
        }
    }
}

/// Parses the answers in a file of the program.
///
/// # Errors
/// If the file ends within an answer.
pub fn answers(mut bytes: &[u8]) -> Result<Vec<Answer>> {
    let mut answers = Vec::new();
    while let Some((head, rest)) = bytes.split_first_chunk::<10>() {
        let [kind, status, s0, s1, s2, s3, l0, l1, l2, l3] = *head;
        let length = u32::from_le_bytes([l0, l1, l2, l3]) as usize;
        let (given, rest) = rest.split_at_checked(length).context("the last answer is cut short")?;
        let stack_bytes = u32::from_le_bytes([s0, s1, s2, s3]);
        answers.push(Answer { kind, status, stack_bytes, given: given.to_vec() });
        bytes = rest;
    }
    ensure!(bytes.is_empty(), "the last answer is incomplete");
    Ok(answers)
}
