//! What is known of Galileo's ephemerides by OSNMA.

#[cfg(feature = "osnma")]
use raim_firmware::osnma::{Standing, Summary};

use crate::pointer::{Versioned, give, status_of};
use crate::receiver::{at, rai_receiver_t};
use crate::status::rai_status_t;

/// There is no key, the setting `AUTH` is `OFF`, or the library was built without OSNMA.
pub const RAI_OSNMA_NONE: u8 = 0;
/// There is a root of the tree and no key: a new key is awaited.
pub const RAI_OSNMA_NOKEY: u8 = 1;
/// No root key is proved yet.
pub const RAI_OSNMA_WAIT: u8 = 2;
/// The root key is signed by a key with another number.
pub const RAI_OSNMA_OTHERKEY: u8 = 3;
/// The system uses functions that the library lacks.
pub const RAI_OSNMA_UNSUPPORTED: u8 = 4;
/// Tags are checked; how old the sky is, is not known.
pub const RAI_OSNMA_UNDATED: u8 = 5;
/// Tags are checked; those with a later key are proof.
pub const RAI_OSNMA_LATER: u8 = 6;
/// Tags are checked; all are proof.
pub const RAI_OSNMA_DATED: u8 = 7;
/// The system says that its tags must not be used.
pub const RAI_OSNMA_DONTUSE: u8 = 8;
/// The system's alert has ended the use of OSNMA.
pub const RAI_OSNMA_STOPPED: u8 = 9;
/// Two satellites sent false words or keys within the last 5 minutes.
pub const RAI_OSNMA_FALSE: u8 = 10;

/// What is known of Galileo's ephemerides. It is never about ranges, nor about the position.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rai_authentication_t {
    /// `sizeof(rai_authentication_t)`, set by the caller.
    pub size: u32,
    /// State, `RAI_OSNMA_NONE` to `RAI_OSNMA_FALSE`.
    pub state: u8,
    /// Number of the public key that signed the root key; 0 before that.
    pub key: u8,
    /// Number of the chain in force; 0 before there is one.
    pub chain: u8,
    /// Number of satellites in view whose ephemerides are proved.
    pub proved: u8,
    /// Number of those whose ephemerides are not.
    pub unproved: u8,
    /// Number of those whose ephemerides are false.
    pub false_count: u8,
    /// Reserved for later use.
    pub reserved: [u8; 6],
    /// Age of the oldest proof, s; NaN without a proof.
    pub oldest_proof_s: f64,
}

#[allow(unsafe_code)]
// SAFETY: `repr(C)`, its size first, and integers and a double, of which every pattern of bits is a
// value.
unsafe impl Versioned for rai_authentication_t {
    const FIRST_SIZE: usize = 24;
}

const _: () = assert!(
    size_of::<rai_authentication_t>() == 24,
    "a field came or moved: raise RAI_ABI_VERSION if it moved"
);

impl rai_authentication_t {
    const NONE: Self = Self {
        size: size_of::<Self>() as u32,
        state: RAI_OSNMA_NONE,
        key: 0,
        chain: 0,
        proved: 0,
        unproved: 0,
        false_count: 0,
        reserved: [0; 6],
        oldest_proof_s: f64::NAN,
    };

    #[cfg(feature = "osnma")]
    fn of(summary: &Summary, standing: Standing) -> Self {
        let (key, chain) = summary.key_and_chain.unwrap_or((0, 0));
        Self {
            state: number(standing),
            key,
            chain,
            proved: summary.proved,
            unproved: summary.unproved,
            false_count: summary.false_,
            oldest_proof_s: summary.oldest_proof_s.map_or(f64::NAN, f64::from),
            ..Self::NONE
        }
    }
}

/// Returns the number of a state; 0 for one that this interface does not know.
#[cfg(feature = "osnma")]
const fn number(standing: Standing) -> u8 {
    match standing {
        Standing::NoKey => RAI_OSNMA_NOKEY,
        Standing::Waiting => RAI_OSNMA_WAIT,
        Standing::OtherKey => RAI_OSNMA_OTHERKEY,
        Standing::Unsupported => RAI_OSNMA_UNSUPPORTED,
        Standing::Undated => RAI_OSNMA_UNDATED,
        Standing::Later => RAI_OSNMA_LATER,
        Standing::Dated => RAI_OSNMA_DATED,
        Standing::DontUse => RAI_OSNMA_DONTUSE,
        Standing::Stopped => RAI_OSNMA_STOPPED,
        Standing::False => RAI_OSNMA_FALSE,
        _ => RAI_OSNMA_NONE,
    }
}

/// Writes what is known of Galileo's ephemerides now, as the sentence `PRAIO` does.
///
/// # Safety
/// As for `rai_receiver_pin`; `authentication` is null or points to a struct of the size that it begins
/// with.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_authentication(
    receiver: *const rai_receiver_t,
    authentication: *mut rai_authentication_t,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let receiver = unsafe { at(receiver) };
    status_of(receiver.and_then(|receiver| {
        #[cfg(feature = "osnma")]
        let known = receiver
            .authentication()
            .zip(receiver.standing())
            .map_or(rai_authentication_t::NONE, |(summary, standing)| {
                rai_authentication_t::of(summary, standing)
            });
        #[cfg(not(feature = "osnma"))]
        let (known, _) = (rai_authentication_t::NONE, receiver);
        // SAFETY: guaranteed by the caller.
        unsafe { give(authentication, &known) }
    }))
}
