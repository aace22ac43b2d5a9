//! Requests to a module in another program, and its answers, as bytes.
//!
//! ```text
//! request   kind (1) · own clock, ms (8) · length (4) · bytes
//! answer    pin (1) · length (4) · bytes                           integers little-endian
//! ```
//!
//! Cargo joins the features of all packages that it builds together. A module with fewer parts must
//! therefore be a program of its own, which is built by itself.

use std::io::{self, Read, Write};

/// Longest request or answer, bytes: above what a line carries in an epoch.
const LONGEST: usize = 1 << 24;

/// Kind of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// Bytes of the host port; the answer is what the module says.
    Command,
    /// Bytes of the GNSS port; the answer is what the module says.
    Gnss,
    /// The time alone; the answer is what the module says.
    Tick,
    /// Memory of the settings; the answer is the memory with the sealed settings.
    Seal,
    /// Memory of the settings. The module starts anew from it and seals the settings; the answer is
    /// the memory.
    Restart,
    /// The answer is the hash of the settings.
    Hash,
    /// Name of a counter; the answer is its number.
    Counter,
}

impl Kind {
    const ALL: [Self; 7] =
        [Self::Command, Self::Gnss, Self::Tick, Self::Seal, Self::Restart, Self::Hash, Self::Counter];

    fn of(byte: u8) -> io::Result<Self> {
        let found = Self::ALL.into_iter().find(|kind| *kind as u8 == byte);
        found.ok_or_else(|| io::Error::new(io::ErrorKind::InvalidData, "no kind of request"))
    }
}

/// Request to the module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    /// Kind, which defines the meaning of the bytes.
    pub kind: Kind,
    /// Time by the module's own clock, ms.
    pub now_ms: u64,
    /// Bytes that the kind asks for.
    pub bytes: Vec<u8>,
}

impl Request {
    /// Reads a request, or `None` at the end of the input.
    ///
    /// # Errors
    /// If the input ends within a request or is none.
    pub fn read(input: &mut impl Read) -> io::Result<Option<Self>> {
        let mut kind = [0];
        if input.read(&mut kind)? == 0 {
            return Ok(None);
        }
        let mut now_ms = [0; 8];
        input.read_exact(&mut now_ms)?;
        let (kind, bytes) = (Kind::of(kind[0])?, read_bytes(input)?);
        Ok(Some(Self { kind, now_ms: u64::from_le_bytes(now_ms), bytes }))
    }

    /// Writes the request.
    ///
    /// # Errors
    /// If the output is closed.
    pub fn write(&self, output: &mut impl Write) -> io::Result<()> {
        output.write_all(&[self.kind as u8])?;
        output.write_all(&self.now_ms.to_le_bytes())?;
        write_bytes(output, &self.bytes)
    }
}

/// Answer of the module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// True while the pin is high.
    pub is_promised: bool,
    /// Bytes, whose meaning the kind of the request defines.
    pub bytes: Vec<u8>,
}

impl Answer {
    /// Reads an answer.
    ///
    /// # Errors
    /// If the input ends within an answer.
    pub fn read(input: &mut impl Read) -> io::Result<Self> {
        let mut pin = [0];
        input.read_exact(&mut pin)?;
        Ok(Self { is_promised: pin[0] != 0, bytes: read_bytes(input)? })
    }

    /// Writes the answer.
    ///
    /// # Errors
    /// If the output is closed.
    pub fn write(&self, output: &mut impl Write) -> io::Result<()> {
        output.write_all(&[u8::from(self.is_promised)])?;
        write_bytes(output, &self.bytes)
    }
}

fn read_bytes(input: &mut impl Read) -> io::Result<Vec<u8>> {
    let mut length = [0; 4];
    input.read_exact(&mut length)?;
    let length = u32::from_le_bytes(length) as usize;
    if length > LONGEST {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "too long"));
    }
    let mut bytes = vec![0; length];
    input.read_exact(&mut bytes)?;
    Ok(bytes)
}

fn write_bytes(output: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    output.write_all(&(bytes.len() as u32).to_le_bytes())?;
    output.write_all(bytes)?;
    output.flush()
}

#[cfg(test)]
mod tests {
    use super::{Answer, Kind, Request};

    #[test]
    fn requests_and_answers_come_as_they_were_sent() {
        let mut line = Vec::new();
        let requests = Kind::ALL.map(|kind| Request { kind, now_ms: 1 << 40, bytes: vec![kind as u8; 3] });
        for request in &requests {
            request.write(&mut line).expect("memory");
        }
        let mut input = line.as_slice();
        for request in &requests {
            assert_eq!(Request::read(&mut input).expect("a request").as_ref(), Some(request));
        }
        assert_eq!(Request::read(&mut input).expect("the end"), None);
        assert!(Request::read(&mut &line[..5]).is_err(), "cut");
        assert!(Request::read(&mut [99; 40].as_slice()).is_err(), "no kind");

        let answer = Answer { is_promised: true, bytes: b"$PRAI".to_vec() };
        let mut line = Vec::new();
        answer.write(&mut line).expect("memory");
        assert_eq!(Answer::read(&mut line.as_slice()).expect("an answer"), answer);
    }
}
