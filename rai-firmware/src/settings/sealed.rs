//! Settings in memory that survives a restart.
//!
//! Settings are stored as commands, one per line, and obeyed again at the next start. They
//! therefore pass every check of a command. Because memory has arbitrary contents after power-on,
//! three conditions must hold: the mark, the CRC-32 of the text, and the hash of the settings read
//! back ([`Configuration::hash`]).
//!
//! | bytes | what |
//! |---|---|
//! | 0 to 3 | mark |
//! | 4 to 7 | hash of the settings |
//! | 8 to 11 | CRC-32 of all behind, and of the hash |
//! | 12 … | text, to the first 0 |

use heapless::String;

use super::fields::Fields;
use super::reported::Crc32;
use super::value::{Commands, Take, tell};
use super::{Configuration, Phase, PhaseEffect, Setting};

/// Bytes of settings that survive a restart.
pub const SEALED_BYTES: usize = 1024;

/// Mark that is improbable in memory after power-on.
const MARK: [u8; 4] = *b"RAIs";
/// Bytes before the text.
const HEAD: usize = 12;
/// Longest line: a key and eight coefficients with all their digits, 141 bytes.
const LINE: usize = 144;

/// Contents of the sealed memory.
#[allow(clippy::large_enum_variant)] // There is no heap to put it on, and one lives for a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Unsealed {
    /// Settings that the previous run sealed.
    Settings(Configuration),
    /// Settings that are damaged.
    Damaged,
    /// No mark of sealed settings.
    Nothing,
}

impl Configuration {
    /// Seals the settings into memory. If they do not fit, the memory is marked as damaged.
    pub fn seal(&self, memory: &mut [u8; SEALED_BYTES]) {
        memory.fill(0);
        let mut length = HEAD;
        let mut whole = true;
        self.say_commands(|line| {
            let line = line.as_bytes();
            match memory.get_mut(length..length + line.len()) {
                // A zero must follow the text.
                Some(place) if length + line.len() < SEALED_BYTES => {
                    place.copy_from_slice(line);
                    length += line.len();
                }
                _ => whole = false,
            }
        });
        if let Some((head, text)) = memory.split_first_chunk_mut::<HEAD>() {
            let hash = self.hash().to_le_bytes();
            let seal = if whole { checksum(hash, text) } else { !checksum(hash, text) };
            let bytes = MARK.into_iter().chain(hash).chain(seal.to_le_bytes());
            head.iter_mut().zip(bytes).for_each(|(place, byte)| *place = byte);
        }
    }

    /// Reads the settings that the previous run sealed.
    pub fn unseal(memory: &[u8; SEALED_BYTES]) -> Unsealed {
        let Some((&[m0, m1, m2, m3, h0, h1, h2, h3, s0, s1, s2, s3], text)) =
            memory.split_first_chunk::<HEAD>()
        else {
            return Unsealed::Nothing;
        };
        if [m0, m1, m2, m3] != MARK {
            return Unsealed::Nothing;
        }
        let hash = [h0, h1, h2, h3];
        if checksum(hash, text) != u32::from_le_bytes([s0, s1, s2, s3]) {
            return Unsealed::Damaged;
        }
        let settings = text.split(|byte| *byte == 0).next().and_then(obey);
        match settings.filter(|settings| settings.hash() == u32::from_le_bytes(hash)) {
            Some(settings) => Unsealed::Settings(settings),
            None => Unsealed::Damaged,
        }
    }

    /// Passes the commands that make these settings to `take`, line by line. The numbers of a named
    /// phase are left out, because setting them would make the phase `CUSTOM`.
    fn say_commands(&self, mut take: impl FnMut(&str)) {
        for setting in Setting::ALL {
            if setting.row().phase != PhaseEffect::Leaves || self.phase == Phase::Custom {
                self.say_commands_of(*setting, &mut take);
            }
        }
    }

    fn say_commands_of(&self, setting: Setting, take: Take<'_>) {
        let value = self.value(setting);
        let (mut wanted, others) = match value.commands() {
            Commands::None => return,
            Commands::One => (usize::MAX, usize::MAX),
            Commands::Several(first, others) => (first, others),
        };
        let mut line = String::<LINE>::new();
        // A line that does not fit is invalid, and the hash exposes it.
        let _ = line.push_str(setting.key());
        let mut fields = 0;
        tell(value, &mut |field| {
            if fields == wanted {
                wanted = others;
                let _ = line.push('\n');
                take(&line);
                line.clear();
                let _ = line.push_str(setting.key());
                fields = 0;
            }
            let _ = line.push(',');
            let _ = line.push_str(field);
            fields += 1;
        });
        let _ = line.push('\n');
        take(&line);
    }
}

/// Obeys lines of commands, each with its line end.
fn obey(text: &[u8]) -> Option<Configuration> {
    let mut settings = Configuration::at_start();
    let mut line = String::<LINE>::new();
    for byte in text {
        if *byte == b'\n' {
            obey_line(&line, &mut settings)?;
            line.clear();
        } else {
            line.push(char::from(*byte)).ok()?;
        }
    }
    line.is_empty().then_some(settings)
}

fn obey_line(line: &str, settings: &mut Configuration) -> Option<()> {
    let mut fields = Fields::between_commas(Some(line));
    let setting = Setting::named(fields.next()?)?;
    settings.change(setting, &mut fields).ok()
}

fn checksum(hash: [u8; 4], text: &[u8]) -> u32 {
    let mut crc = Crc32::new();
    hash.iter().chain(text).for_each(|byte| crc.push(*byte));
    crc.value()
}

#[cfg(test)]
mod tests {
    use std::borrow::ToOwned;
    use std::format;
    use std::string::String;
    use std::vec::Vec;

    use super::*;

    /// Returns the settings that these commands make.
    fn settings(commands: &[&str]) -> Configuration {
        let text = commands.join("\n") + "\n";
        obey(text.as_bytes()).expect("commands that are obeyed")
    }

    fn cases() -> [Configuration; 10] {
        [
            Configuration::at_start(),
            settings(&["PHASE,LPV200", "TTA,3", "MASK,12.5", "METHOD,RANSAC", "CLOCKAID,ON"]),
            // Requirements that were set one by one after a phase.
            settings(&["PHASE,LPV200", "METHOD,SEPARATION", "HAL,60", "VAL,100"]),
            settings(&["PHASE,LPV200", "PHASE,CUSTOM"]),
            settings(&["HAL,40", "VAL,35", "PFA,1e-5", "PMD,1e-4", "TTA,3600"]),
            settings(&["IONO,1.4e-8,2.2e-8,-6e-8,-1.2e-7,9.6e4,1.3e5,-6.5e4,-3.3e5", "POLICY,T2"]),
            settings(&["ISM,RESEARCH-AIR", "ISM,G,2.4,2.4,0,1e-5,1e-4", "ISM,E,6,4.5,0.75,0,2e-4"]),
            // A requirement that a phase leaves free, and a coefficient at its limit with more
            // digits than are reported.
            settings(&["PHASE,LPV200", "PFF,1e-9", "MASK,5"]),
            settings(&["IONO,-1.1920928955078125e-7,0,0,0,0,0,0,0"]),
            longest(),
        ]
    }

    /// Returns the settings with the longest text.
    fn longest() -> Configuration {
        let numbers = [
            "HAL,99998.123456",
            "VAL,99998.123456",
            "PFA,6.666666667e-5",
            "PFF,1.234567891e-12",
            "TTA,3599.123456",
            "MASK,59.123456",
            "METHOD,SIMULTANEOUS",
            "SYSTEMS,GRECJ",
            "CN0MASK,54.123456",
            "VMAX,9999.123456",
            "HEIGHT,-11999.123456,1999999.123456",
            "RECOVER,100,599.123456",
            "FREQ,SINGLE",
            "BAUD,921600",
            "IONO,-1.234567891e-100,-1.234567891e-100,-1.234567891e-100,-1.234567891e-100,\
             -99999.123456,-999999.123456,-999999.123456,-999999.123456",
            "ISM,RESEARCH-AIR",
        ];
        let outputs = Configuration::at_start().outputs;
        let outputs = outputs.rates().map(|(name, _)| format!("OUTPUT,{name},255"));
        let promise =
            |letter| format!("ISM,{letter},99.123456,98.123456,97.123456,1.234567891e-12,1.234567891e-12");
        let lines =
            numbers.map(str::to_owned).into_iter().chain(outputs).chain(["G", "R", "E", "C"].map(promise));
        let lines: Vec<String> = lines.collect();
        settings(&lines.iter().map(String::as_str).collect::<Vec<_>>())
    }

    #[test]
    fn what_is_sealed_is_read_back() {
        for want in cases() {
            let mut memory = [0xA5; SEALED_BYTES];
            want.seal(&mut memory);
            let Unsealed::Settings(have) = Configuration::unseal(&memory) else { panic!("{want:?}") };
            assert_eq!(have.hash(), want.hash());
            assert_eq!((have.phase, have.policy, have.method), (want.phase, want.policy, want.method));
            assert_eq!(have.requirements(), want.requirements());
            assert_eq!(have.promises, want.promises);
        }
    }

    /// The text must not change between versions, because another version may read it.
    #[test]
    fn settings_at_start_are_sealed_as_ever() {
        let mut memory = [0; SEALED_BYTES];
        Configuration::at_start().seal(&mut memory);
        let text = memory[HEAD..].split(|byte| *byte == 0).next().expect("a text");
        let have = std::str::from_utf8(text).expect("ASCII");
        let want = "PHASE,NPA\nPFF,1e-7\nTTA,10\nPOLICY,T1\nMETHOD,AUTO\nLEVELS,BOUND\nSYSTEMS,GEC\nMASK,10\n\
                    CLOCKAID,OFF\nCN0MASK,20\nVMAX,515\nHEIGHT,-500,20000\nRECOVER,3,3\nFREQ,AUTO\n\
                    NOISE,AUTO\nBAUD,AUTO\nOUTPUT,RMC,1\nOUTPUT,GGA,1\nOUTPUT,GNS,1\nOUTPUT,VTG,1\n\
                    OUTPUT,ZDA,1\nOUTPUT,GSA,1\nOUTPUT,GST,1\nOUTPUT,GBS,1\nOUTPUT,GSV,0\n\
                    OUTPUT,HEARTBEAT,0\nOUTPUT,GPS_INPUT,0\nOUTPUT,GNSS_INTEGRITY,0\nISM,ICAO\nSPOOFFLAG,HOLD\nPLACE,OFF\n";
        assert_eq!(have.strip_suffix("TOY,3\n"), Some(want));
    }

    #[test]
    fn one_flipped_bit_breaks_the_seal() {
        for want in cases() {
            let mut memory = [0; SEALED_BYTES];
            want.seal(&mut memory);
            for bit in 8 * MARK.len()..8 * SEALED_BYTES {
                let mut broken = memory;
                broken[bit / 8] ^= 1 << (bit % 8);
                assert_eq!(Configuration::unseal(&broken), Unsealed::Damaged, "bit {bit}");
            }
        }
    }

    #[test]
    fn memory_after_power_on_holds_no_settings() {
        for noise in [0, 0xFF, 0x55, 0xA5] {
            assert_eq!(Configuration::unseal(&[noise; SEALED_BYTES]), Unsealed::Nothing);
        }
    }
}
