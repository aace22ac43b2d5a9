//! The functions of a receiver.

use std::ffi::CString;
use std::mem::MaybeUninit;
use std::ptr;

use rai::*;

use super::{sized, verdict};

/// Uninitialised room for sentences.
struct Room {
    bytes: Box<[MaybeUninit<u8>]>,
}

impl Room {
    fn new(capacity: usize) -> Self {
        Self { bytes: Box::new_uninit_slice(capacity) }
    }

    fn text(&mut self) -> rai_text_t {
        rai_text_t { bytes: self.bytes.as_mut_ptr().cast(), capacity: self.bytes.len(), length: 0, lost: 0 }
    }

    fn reported(&self, text: &rai_text_t) -> String {
        // SAFETY: so much has been written.
        let bytes = self.bytes.iter().take(text.length).map(|byte| unsafe { byte.assume_init() });
        String::from_utf8(bytes.collect()).expect("ASCII")
    }
}

fn receiver(text: &mut rai_text_t) -> Box<MaybeUninit<rai_receiver_t>> {
    let mut memory = Box::new_uninit();
    // SAFETY: the memory and the text have the stated sizes.
    let status = unsafe { rai_receiver_init(memory.as_mut_ptr(), RAI_RECEIVER_SIZE, text) };
    assert_eq!(status, RAI_STATUS_OK);
    memory
}

#[test]
fn a_receiver_speaks_obeys_and_notices_silence() {
    let mut room = Room::new(4096);
    let mut text = room.text();
    let mut memory = receiver(&mut text);
    assert!(room.reported(&text).starts_with("$PRAIV,"), "{}", room.reported(&text));
    let (at, mut judged, mut verdict) = (memory.as_mut_ptr(), 7, verdict());
    // SAFETY: the object is valid, there are as many bytes as stated, and the text has the stated
    // size.
    unsafe {
        assert_eq!(rai_receiver_report(at, &raw mut verdict), RAI_STATUS_OK);
        assert_eq!(verdict.state, RAI_STATE_NONE);
        text.length = 0;
        let noise = [0xD3, 0x00, 0x13, 0xB5, 0x62, 0x02, 0x15, 0x00];
        let status = rai_receiver_gnss(at, noise.as_ptr(), noise.len(), 10, &raw mut text, &raw mut judged);
        assert_eq!((status, judged, text.length), (RAI_STATUS_OK, 0, 0));
        // A refused call has judged nothing either.
        judged = 7;
        let status = rai_receiver_gnss(at, noise.as_ptr(), noise.len(), 10, ptr::null_mut(), &raw mut judged);
        assert_eq!((status, judged), (RAI_STATUS_NULL, 0));
        let command = b"$PRAIC,HAL,40*08\r\n";
        let status = rai_receiver_command(at, command.as_ptr(), command.len(), &raw mut text);
        assert_eq!(status, RAI_STATUS_OK);
        assert!(room.reported(&text).starts_with("$PRAIA,HAL,40"), "{}", room.reported(&text));
        text.length = 0;
        assert_eq!(rai_receiver_tick(at, u64::MAX, &raw mut text), RAI_STATUS_OK);
        let mut reason = 0;
        assert_eq!(rai_receiver_state(at, &raw mut reason), RAI_STATE_ALERT);
        assert_eq!(
            (reason, rai_receiver_pin(at), rai_receiver_reset_requested(at)),
            (RAI_REASON_STALE, 0, 0)
        );
        assert_eq!(rai_receiver_report(at, &raw mut verdict), RAI_STATUS_OK);
    }
    assert_eq!((verdict.state, verdict.reason), (RAI_STATE_ALERT, RAI_REASON_STALE));
    assert!(verdict.hpl_m.is_nan() && verdict.x_m.is_nan() && verdict.excluded_count == 0);
}

#[test]
fn sentences_without_room_are_counted_and_none_is_cut() {
    let mut room = Room::new(20);
    let mut text = room.text();
    let mut memory = receiver(&mut text);
    assert_eq!((text.length, text.lost), (0, 1));
    let at = memory.as_mut_ptr();
    let broken = |change: fn(&mut rai_text_t), text: &rai_text_t| {
        let mut text = rai_text_t { ..*text };
        change(&mut text);
        // SAFETY: a refused argument is not read.
        unsafe { rai_receiver_tick(at, 0, &raw mut text) }
    };
    assert_eq!(broken(|text| text.bytes = ptr::null_mut(), &text), RAI_STATUS_NULL);
    assert_eq!(broken(|text| text.length = 21, &text), RAI_STATUS_COUNT);
    assert_eq!(broken(|text| text.capacity = usize::MAX, &text), RAI_STATUS_COUNT);
    // SAFETY: as above.
    unsafe {
        assert_eq!(rai_receiver_tick(at, 0, ptr::null_mut()), RAI_STATUS_NULL);
        let beside = (&raw mut text).wrapping_byte_add(1);
        assert_eq!(rai_receiver_tick(at, 0, beside), RAI_STATUS_MISALIGNED);
    }
}

/// Returns a text of C.
fn c(text: &str) -> CString {
    CString::new(text).expect("no NUL")
}

#[test]
fn a_setting_needs_no_checksum_and_a_refused_one_says_why() {
    let mut room = Room::new(8192);
    let mut text = room.text();
    let mut memory = receiver(&mut text);
    let at = memory.as_mut_ptr();
    let set = |key: &str, values: Option<&str>, text: &mut rai_text_t| {
        let (key, values) = (c(key), values.map(c));
        let values = values.as_ref().map_or(ptr::null(), |values| values.as_ptr());
        text.length = 0;
        // SAFETY: the object is valid, both texts end with NUL, and the text has the stated size.
        unsafe { rai_receiver_set(at, key.as_ptr(), values, text) }
    };
    assert_eq!(set("PHASE", Some("LPV200"), &mut text), RAI_STATUS_OK);
    assert!(room.reported(&text).starts_with("$PRAIA,PHASE,LPV200,OK*"), "{}", room.reported(&text));
    assert_eq!(set("VAL", None, &mut text), RAI_STATUS_OK);
    assert!(room.reported(&text).starts_with("$PRAIA,VAL,35,OK*"), "{}", room.reported(&text));
    assert_eq!(set("OUTPUT", Some("RMC,1"), &mut text), RAI_STATUS_OK);
    assert_eq!(set("STATS", None, &mut text), RAI_STATUS_OK);
    assert!(room.reported(&text).contains(",cmd_ok,"), "{}", room.reported(&text));
    let long = "1".repeat(193);
    for (key, values, want) in [
        ("phase", Some("NPA"), RAI_STATUS_KEY),
        ("PHASE", Some("LPV300"), RAI_STATUS_WORD),
        ("MASK", Some("ninety"), RAI_STATUS_NUMBER),
        ("MASK", Some("91"), RAI_STATUS_SETTING),
        ("MASK", Some("5,6"), RAI_STATUS_VALUE_EXTRA),
        ("MASK", Some(""), RAI_STATUS_VALUE_MISSING),
        ("PFA", Some("2e-4"), RAI_STATUS_PROBABILITY),
        ("IONO", Some("0,0,0,0,0,0,0,0"), RAI_STATUS_ALL_ZERO),
        // Nothing that would end a sentence, or begin one, gets into an answer.
        ("MASK*00\r\n$PRAIC,HAL", Some("40"), RAI_STATUS_TEXT),
        ("MASK", Some("5*00"), RAI_STATUS_TEXT),
        ("MASK,5", None, RAI_STATUS_TEXT),
        ("MASK", Some(&long), RAI_STATUS_TEXT),
        ("Ma\u{df}ke", Some("5"), RAI_STATUS_TEXT),
    ] {
        assert_eq!(set(key, values, &mut text), want, "{key},{values:?}");
    }
    // SAFETY: a refused argument is not read.
    unsafe {
        let key = c("MASK");
        assert_eq!(rai_receiver_set(at, ptr::null(), ptr::null(), &raw mut text), RAI_STATUS_NULL);
        assert_eq!(rai_receiver_set(at, key.as_ptr(), ptr::null(), ptr::null_mut()), RAI_STATUS_NULL);
        assert_eq!(
            rai_receiver_set(ptr::null_mut(), key.as_ptr(), ptr::null(), &raw mut text),
            RAI_STATUS_NULL
        );
    }
}

#[test]
fn a_setting_in_the_middle_of_a_line_leaves_the_line_as_it_is() {
    let mut room = Room::new(4096);
    let mut text = room.text();
    let mut memory = receiver(&mut text);
    let at = memory.as_mut_ptr();
    let (first, second, key, value) = (b"$PRAIC,HA", b"L,40*08\r\n", c("MASK"), c("7"));
    // SAFETY: the object is valid, there are as many bytes as stated, and texts end with NUL.
    unsafe {
        assert_eq!(rai_receiver_command(at, first.as_ptr(), first.len(), &raw mut text), RAI_STATUS_OK);
        assert_eq!(rai_receiver_set(at, key.as_ptr(), value.as_ptr(), &raw mut text), RAI_STATUS_OK);
        text.length = 0;
        assert_eq!(rai_receiver_command(at, second.as_ptr(), second.len(), &raw mut text), RAI_STATUS_OK);
    }
    assert!(room.reported(&text).starts_with("$PRAIA,HAL,40,OK*"), "{}", room.reported(&text));
}

#[test]
fn a_receiver_without_an_epoch_has_counters_and_no_numbers() {
    let mut room = Room::new(4096);
    let mut text = room.text();
    let mut memory = receiver(&mut text);
    let at = memory.as_mut_ptr();
    let (mut velocity, mut accuracy): (rai_velocity_t, rai_accuracy_t) = (sized(), sized());
    let (mut counter, mut count): (rai_counter_t, _) = (sized(), 9);
    let mut authentication: rai_authentication_t = sized();
    authentication.proved = 9;
    let mut names = std::collections::BTreeSet::new();
    // SAFETY: the object is valid and each struct has the size that it states.
    unsafe {
        assert_eq!(rai_receiver_velocity(at, &raw mut velocity), RAI_STATUS_OK);
        assert_eq!(rai_receiver_accuracy(at, &raw mut accuracy), RAI_STATUS_OK);
        assert_eq!(rai_receiver_authentication(at, &raw mut authentication), RAI_STATUS_OK);
        assert_eq!(rai_receiver_authentication(at, ptr::null_mut()), RAI_STATUS_NULL);
        assert_eq!(rai_receiver_residuals(at, ptr::null_mut(), 0, &raw mut count), RAI_STATUS_OK);
        assert_eq!(rai_receiver_counter(at, usize::MAX, &raw mut counter), RAI_STATUS_COUNT);
        for number in 0.. {
            if rai_receiver_counter(at, number, &raw mut counter) == RAI_STATUS_COUNT {
                break;
            }
            let name = std::ffi::CStr::from_ptr(counter.name.as_ptr()).to_str().expect("ASCII").to_owned();
            assert_eq!(counter.value, 0, "{name}");
            assert!(names.insert(name), "each name once");
        }
    }
    assert!(velocity.east_m_s.is_nan() && accuracy.hdop.is_nan() && count == 0);
    assert_eq!((authentication.state, authentication.proved), (RAI_OSNMA_NONE, 0));
    assert!(authentication.oldest_proof_s.is_nan());
    assert!(names.contains("epochs_protected") && names.contains("cmd_ok"), "{names:?}");
}
