//! GLONASS strings: 85 bits every two seconds. Strings 1 to 4 are the ephemeris.
//!
//! A page is a string with the idle bit first. Numbers are a sign bit and a magnitude. The strings
//! of one frame follow each other within eight seconds and do not identify their set. A set is
//! therefore read only in order: string 1 begins it, and each further string must directly follow
//! the one before.
//!
//! | string | fields |
//! |---|---|
//! | all | number 1 (4) |
//! | 1 | vx 21, ax 45, x 50 |
//! | 2 | health 5, `t_b` 9, vy 21, ay 45, y 50 |
//! | 3 | `γ_n` 6, `l_n` 20, vz 21, az 45, z 50 |
//! | 4 | `τ_n` 5, `Δτ_n` 27, `F_T` 52, slot 70 |
//!
//! References: [GLO-ICD] 4.4, 4.5.
//!
//! [GLO-ICD]: crate#references

use raim_core::satellite::SatelliteId;

use super::Refusal;
use super::message::{NavigationMessage, Reader};
use super::parity::is_glonass_string;
use crate::ephemeris::{Health, StateBroadcast, glonass_accuracy_m};
use crate::input::bits::{Bits, Packed};
use crate::input::{Message, Unread};
use crate::time::{GpsTime, glonass_time};

/// Factor from the message's kilometres to metres.
const KM: f64 = 1e3;

/// GLONASS strings.
pub(super) struct Glonass;

impl NavigationMessage for Glonass {
    const WORDS: usize = 3;
    const PAGE_BYTES: usize = 11;
    const PAGES: usize = 4;

    fn read<'a>(reader: &mut Reader<'_>) -> Result<Option<Message<'a>>, Unread> {
        let string = string(reader.words()?)?;
        let number @ 1..=4 = number(Bits(&string)) else {
            return Ok(None);
        };
        let (satellite, calendar) = (reader.transmission.satellite, reader.calendar);
        let mut set = reader.add(number - 1, &string)?;
        if !set.follows(number - 1) {
            return Ok(None);
        }
        let Some(strings) = set.all() else {
            return Ok(None);
        };
        let leap = calendar.leap_second().ok_or(Unread::LeapUnknown)?;
        let now = calendar.present().ok_or(Unread::WithoutWeek)?;
        let state = ephemeris(satellite, &strings, now, leap.seconds)?;
        drop(strings);
        set.keep(0);
        Ok(Some(Message::State(state)))
    }
}

/// Returns the string in its words.
fn string(words: &[u32; Glonass::WORDS]) -> Result<[u8; Glonass::PAGE_BYTES], Refusal> {
    let [first, second, third] = *words;
    let mut packed = Packed::new();
    packed.push(first, 32);
    packed.push(second, 32);
    packed.push(third >> 11, 21);
    let bits = Bits(&packed.bytes);
    if bits.is_set(0) {
        return Err(Refusal::Malformed);
    }
    if is_glonass_string(bits) { Ok(packed.bytes) } else { Err(Refusal::Parity) }
}

/// Returns the number of a string, 1 to 15.
fn number(string: Bits<'_>) -> u32 {
    string.unsigned(1, 4)
}

/// Returns the ephemeris in strings 1 to 4, with the present time and the leap seconds.
fn ephemeris(
    satellite: SatelliteId,
    pages: &[Bits<'_>],
    now: GpsTime,
    leap_s: u8,
) -> Result<StateBroadcast, Refusal> {
    let &[first, second, third, fourth] = pages else { return Err(Refusal::Malformed) };
    let slot = fourth.small(70, 5);
    if slot != 0 && slot != satellite.number() {
        return Err(Refusal::Value);
    }
    let axes = [first, second, third];
    let is_well = !second.is_set(5) && !third.is_set(20);
    Ok(StateBroadcast {
        satellite,
        health: Health::of_satellite(is_well),
        accuracy_m: glonass_accuracy_m(fourth.small(52, 4)),
        toe: glonass_time(second.unsigned(9, 7) * 900, leap_s, now).ok_or(Refusal::Value)?,
        position_m: axes.map(|axis| axis.magnitude(50, 27, -11) * KM),
        velocity_m_s: axes.map(|axis| axis.magnitude(21, 24, -20) * KM),
        acceleration_m_s2: axes.map(|axis| (axis.magnitude(45, 5, -30) * KM) as f32),
        clock_s: -fourth.magnitude(5, 22, -30),
        clock_s_s: third.magnitude(6, 11, -40),
        delay_l2_s: fourth.magnitude(27, 5, -30) as f32,
    })
}
