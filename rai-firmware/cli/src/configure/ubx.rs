//! UBX frames: `B5 62`, class, identity, length, payload, two sums.

/// First bytes of a frame.
const SYNC: [u8; 2] = [0xB5, 0x62];

/// Bytes before the payload.
const HEADER: usize = 6;

/// Class and identity of a message.
pub(super) type Identity = (u8, u8);

pub(super) const ACK_NAK: Identity = (0x05, 0x00);
pub(super) const ACK_ACK: Identity = (0x05, 0x01);
pub(super) const CFG_MSG: Identity = (0x06, 0x01);
pub(super) const CFG_CFG: Identity = (0x06, 0x09);
pub(super) const CFG_VALSET: Identity = (0x06, 0x8A);
pub(super) const MON_VER: Identity = (0x0A, 0x04);

/// Returns a frame. The payload must be shorter than 65,536 bytes.
pub(super) fn frame((class, id): Identity, payload: &[u8]) -> Vec<u8> {
    let [low, high] = (payload.len() as u16).to_le_bytes();
    let mut bytes = vec![SYNC[0], SYNC[1], class, id, low, high];
    bytes.extend(payload);
    let sums = sums(&bytes[SYNC.len()..]);
    bytes.extend(sums);
    bytes
}

/// Returns the two sums over class, identity, length and payload (Fletcher's algorithm).
fn sums(bytes: &[u8]) -> [u8; 2] {
    bytes.iter().fold([0_u8; 2], |[first, second], byte| {
        let first = first.wrapping_add(*byte);
        [first, second.wrapping_add(first)]
    })
}

/// Removes the first whole frame from received bytes, with everything before it.
pub(super) fn take(bytes: &mut Vec<u8>) -> Option<(Identity, Vec<u8>)> {
    let mut start = 0;
    while let Some(found) = bytes.get(start..)?.iter().position(|byte| *byte == SYNC[0]) {
        start += found;
        match read(bytes.get(start..)?) {
            Some((identity, payload)) => {
                let end = start + HEADER + payload.len() + 2;
                bytes.drain(..end);
                return Some((identity, payload));
            }
            // What looks like the start of a longer frame may be noise, behind which one begins.
            None => start += 1,
        }
    }
    None
}

/// Reads a frame that begins here and is whole.
fn read(bytes: &[u8]) -> Option<(Identity, Vec<u8>)> {
    let [first, second, class, id, low, high] = *bytes.first_chunk::<HEADER>()?;
    let end = HEADER + usize::from(u16::from_le_bytes([low, high]));
    let is_whole =
        [first, second] == SYNC && sums(bytes.get(SYNC.len()..end)?) == *bytes.get(end..end + 2)?;
    is_whole.then(|| bytes.get(HEADER..end).map(|payload| ((class, id), payload.to_vec())))?
}
