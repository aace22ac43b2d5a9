//! References to a caller's objects, made from its pointers for the time of one call.
//!
//! All checks of pointers are here: null, alignment, length, and whether the memory holds an
//! object. An [`Object`] begins with a mark, which only its construction writes, last.

use core::mem::MaybeUninit;

use crate::RAI_ABI_VERSION;
use crate::status::{
    RAI_STATUS_MISALIGNED, RAI_STATUS_NOT_INITIALISED, RAI_STATUS_NULL, RAI_STATUS_SHORT, RAI_STATUS_SIZE,
    rai_status_t,
};

/// Returns the mark of an object: "RAI", the kind, and the version of the interface.
const fn mark(kind: u8) -> u64 {
    0x5241_4900_0000_0000 | (kind as u64) << 32 | RAI_ABI_VERSION as u64
}

/// Contents of a caller's memory after an object has been made there.
#[repr(C)]
pub(crate) struct Object<V, const KIND: u8> {
    mark: u64,
    value: V,
}

impl<V, const KIND: u8> Object<V, KIND> {
    /// Returns room for an object in a caller's memory.
    ///
    /// # Safety
    /// `memory` is null or points to `length` bytes that no other code uses while the room exists.
    #[allow(unsafe_code)]
    pub(crate) unsafe fn room<'a>(memory: *mut u8, length: usize) -> Result<Room<'a, V, KIND>, rai_status_t> {
        let object = memory.cast::<MaybeUninit<Self>>();
        if object.is_null() {
            return Err(RAI_STATUS_NULL);
        }
        if !object.is_aligned() {
            return Err(RAI_STATUS_MISALIGNED);
        }
        if length < size_of::<Self>() {
            return Err(RAI_STATUS_SHORT);
        }
        // SAFETY: not null, aligned, long enough, not shared during this call, and of unspecified
        // contents.
        Ok(Room(unsafe { &mut *object }))
    }

    /// Returns the object behind a handle.
    ///
    /// # Safety
    /// `handle` is null or points to memory in which [`Room::fill`] may have put an object, and
    /// which no other code uses during the call. If the memory holds none, its first eight bytes
    /// are initialised.
    #[allow(unsafe_code)]
    pub(crate) unsafe fn at<'a>(handle: *mut u8) -> Result<&'a mut V, rai_status_t> {
        let object = handle.cast::<Self>();
        if object.is_null() {
            return Err(RAI_STATUS_NULL);
        }
        if !object.is_aligned() {
            return Err(RAI_STATUS_MISALIGNED);
        }
        // SAFETY: not null, aligned; the mark is the first field.
        if unsafe { object.cast::<u64>().read() } != mark(KIND) {
            return Err(RAI_STATUS_NOT_INITIALISED);
        }
        // SAFETY: the mark is written with the whole object, and its memory is not shared during
        // the call.
        Ok(unsafe { &mut (*object).value })
    }
}

/// Memory of a caller that is about to hold an object.
pub(crate) struct Room<'a, V, const KIND: u8>(&'a mut MaybeUninit<Object<V, KIND>>);

impl<V, const KIND: u8> Room<'_, V, KIND> {
    /// Makes an object in place. `make` writes it part by part, so that the whole is not on the
    /// stack first. If `make` or `finish` refuses it, no object has been made.
    ///
    /// # Safety
    /// `make` writes every field of the value whose place it is given, unless it refuses.
    #[allow(unsafe_code)]
    pub(crate) unsafe fn fill(
        self,
        make: impl FnOnce(*mut V) -> Result<(), rai_status_t>,
        finish: impl FnOnce(&mut V) -> Result<(), rai_status_t>,
    ) -> Result<(), rai_status_t> {
        let object = self.0.as_mut_ptr();
        // SAFETY: both fields are inside the room, which is aligned and not shared; the value is
        // written before a reference to it exists.
        unsafe {
            (&raw mut (*object).mark).write(0);
            let value = &raw mut (*object).value;
            make(value)?;
            finish(&mut *value)?;
            (&raw mut (*object).mark).write(mark(KIND));
        }
        Ok(())
    }
}

/// A struct of the interface that begins with its size.
///
/// # Safety
/// `repr(C)`, its first field is a `u32` with the size that the caller knows, and every pattern of
/// bits is a value of it.
#[allow(unsafe_code)]
pub(crate) unsafe trait Versioned: Copy {
    /// Size of its first version, the smallest valid one.
    const FIRST_SIZE: usize;
}

/// Checks a pointer to a struct that begins with its size, and returns that size.
///
/// # Safety
/// `pointer` is null or points to a struct whose first field is initialised.
#[allow(unsafe_code)]
unsafe fn size_at<S: Versioned>(pointer: *const S) -> Result<usize, rai_status_t> {
    if pointer.is_null() {
        return Err(RAI_STATUS_NULL);
    }
    if !pointer.is_aligned() {
        return Err(RAI_STATUS_MISALIGNED);
    }
    // SAFETY: not null and aligned, and the first field is a `u32`.
    let size = unsafe { pointer.cast::<u32>().read() } as usize;
    if size < S::FIRST_SIZE { Err(RAI_STATUS_SIZE) } else { Ok(size) }
}

/// Reads a struct; fields that the caller does not know keep their value in `known`.
///
/// # Safety
/// `pointer` is null or points to as many initialised bytes as the struct's first field states.
#[allow(unsafe_code)]
pub(crate) unsafe fn take<S: Versioned>(pointer: *const S, mut known: S) -> Result<S, rai_status_t> {
    // SAFETY: guaranteed by the caller.
    let size = unsafe { size_at(pointer) }?;
    if size > size_of::<S>() {
        // Settings of a later version would be ignored silently.
        return Err(RAI_STATUS_SIZE);
    }
    // SAFETY: both are at least `size` bytes long and do not overlap; every pattern of bits is a
    // value.
    unsafe { core::ptr::copy_nonoverlapping(pointer.cast::<u8>(), (&raw mut known).cast::<u8>(), size) };
    Ok(known)
}

/// Writes a struct, as far as the caller knows it; its size stays as the caller wrote it.
///
/// # Safety
/// `pointer` is null or points to a struct whose first field is initialised and states how many
/// bytes may be written.
#[allow(unsafe_code)]
pub(crate) unsafe fn give<S: Versioned>(pointer: *mut S, value: &S) -> Result<(), rai_status_t> {
    // SAFETY: guaranteed by the caller.
    let size = unsafe { size_at(pointer) }?;
    let skip = size_of::<u32>();
    let length = size.min(size_of::<S>()) - skip;
    // SAFETY: after the size both have `length` bytes, and do not overlap.
    unsafe {
        core::ptr::copy_nonoverlapping(
            core::ptr::from_ref(value).cast::<u8>().add(skip),
            pointer.cast::<u8>().add(skip),
            length,
        );
    }
    Ok(())
}

/// Checks, before any work, that a struct can be written later.
///
/// # Safety
/// As for [`give`].
#[allow(unsafe_code)]
pub(crate) unsafe fn can_give<S: Versioned>(pointer: *mut S) -> Result<(), rai_status_t> {
    // SAFETY: guaranteed by the caller.
    unsafe { size_at(pointer.cast_const()) }.map(drop)
}

/// Returns a caller's array; null is allowed for one without elements.
///
/// # Safety
/// `pointer` is null or points to `count` initialised elements that no other code writes to during
/// the call.
#[allow(unsafe_code)]
pub(crate) unsafe fn slice<'a, E>(pointer: *const E, count: usize) -> Result<&'a [E], rai_status_t> {
    if count == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() {
        return Err(RAI_STATUS_NULL);
    }
    if !pointer.is_aligned() {
        return Err(RAI_STATUS_MISALIGNED);
    }
    if count > isize::MAX as usize / size_of::<E>().max(1) {
        return Err(crate::status::RAI_STATUS_COUNT);
    }
    // SAFETY: not null, aligned, no longer than memory can be, and initialised, as guaranteed by
    // the caller.
    Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
}

/// Returns a caller's array to write to; null is allowed for one without elements.
///
/// # Safety
/// `pointer` is null or points to `count` elements of any contents that no other code uses during
/// the call.
#[allow(unsafe_code)]
pub(crate) unsafe fn places<'a, E>(
    pointer: *mut E,
    count: usize,
) -> Result<&'a mut [MaybeUninit<E>], rai_status_t> {
    if count == 0 {
        return Ok(&mut []);
    }
    if pointer.is_null() {
        return Err(RAI_STATUS_NULL);
    }
    if !pointer.is_aligned() {
        return Err(RAI_STATUS_MISALIGNED);
    }
    if count > isize::MAX as usize / size_of::<E>().max(1) {
        return Err(crate::status::RAI_STATUS_COUNT);
    }
    // SAFETY: not null, aligned, no longer than memory can be, of any contents, and not shared, as
    // guaranteed by the caller.
    Ok(unsafe { core::slice::from_raw_parts_mut(pointer.cast(), count) })
}

/// Converts a result to a status.
pub(crate) fn status_of(result: Result<(), rai_status_t>) -> rai_status_t {
    result.err().unwrap_or(crate::status::RAI_STATUS_OK)
}
