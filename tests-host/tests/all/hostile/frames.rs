//! Frames taken apart, changed and sealed again, so that hostile content has a correct CRC.

use rtcm_rs::msg::{Msg1077T, Msg1127T};
use rtcm_rs::{Message, MessageBuilder, MessageFrame};

/// Number of bytes before and after the payload of a frame.
const HEADER: usize = 3;
const PARITY: usize = 3;

/// Cuts a lump into its frames.
pub(crate) fn frames(lump: &[u8]) -> Vec<Vec<u8>> {
    let (mut frames, mut rest) = (Vec::new(), lump);
    while rest.len() > HEADER {
        let payload = usize::from(rest[1]) << 8 | usize::from(rest[2]);
        let (frame, others) = rest.split_at(HEADER + payload + PARITY);
        frames.push(frame.to_vec());
        rest = others;
    }
    frames
}

/// Returns the payload of a frame.
pub(crate) fn payload(frame: &[u8]) -> &[u8] {
    &frame[HEADER..frame.len() - PARITY]
}

/// Returns a payload of `length` bytes that names a message type and otherwise consists of `fill`.
pub(crate) fn claiming(number: u16, length: usize, fill: u8) -> Vec<u8> {
    let mut payload = vec![fill; length];
    payload[0] = (number >> 4) as u8;
    payload[1] = (number << 4) as u8 | fill & 0x0F;
    payload
}

/// Decodes the message of a frame.
pub(crate) fn message(frame: &[u8]) -> Message {
    MessageFrame::new(frame).expect("a frame").get_message()
}

/// Encodes a message as a frame.
pub(crate) fn frame(message: &Message) -> Vec<u8> {
    MessageBuilder::new().build_message(message).expect("a message that can be written").to_vec()
}

/// Returns a lump with each of its messages changed.
pub(crate) fn changed(lump: &[u8], mut change: impl FnMut(&mut Message)) -> Vec<u8> {
    let rewritten = |bytes: Vec<u8>| {
        let mut message = message(&bytes);
        change(&mut message);
        frame(&message)
    };
    frames(lump).into_iter().flat_map(rewritten).collect()
}

/// Returns a lump with only the wanted messages.
pub(crate) fn only(lump: &[u8], wanted: impl Fn(&Message) -> bool) -> Vec<u8> {
    frames(lump).into_iter().filter(|bytes| wanted(&message(bytes))).flatten().collect()
}

/// Returns true for an ephemeris.
pub(crate) fn is_ephemeris(message: &Message) -> bool {
    matches!(message, Message::Msg1019(_) | Message::Msg1042(_))
}

/// Returns the GPS ranges of an epoch.
pub(crate) fn gps(lump: &[u8]) -> Msg1077T {
    let found = frames(lump).iter().map(|bytes| message(bytes)).find_map(|message| match message {
        Message::Msg1077(gps) => Some(gps),
        _ => None,
    });
    found.expect("ranges of GPS")
}

/// Returns the `BeiDou` ranges of an epoch.
pub(crate) fn beidou(lump: &[u8]) -> Msg1127T {
    let found = frames(lump).iter().map(|bytes| message(bytes)).find_map(|message| match message {
        Message::Msg1127(beidou) => Some(beidou),
        _ => None,
    });
    found.expect("ranges of BeiDou")
}
