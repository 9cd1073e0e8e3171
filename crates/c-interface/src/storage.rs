//! Memory that C owns: the storage of a model, images, inputs and outputs.

use crate::status::{ALIGNMENT, IMAGE_LENGTH, NOT_LOADED, NULL, Status};
use inference::Pair;

/// Number of 64-bit words of a storage by the width of a pointer, 32 and 64 bits: the header's
/// `PINTLE_MODEL_SIZE` / 8.
pub(crate) const WORDS_BY_POINTER: [usize; 2] = [274, 308];
/// Number of words here.
pub(crate) const WORDS: usize = WORDS_BY_POINTER[if size_of::<usize>() > 4 { 1 } else { 0 }];

/// Storage of a model: C's `pintle_model`.
#[repr(C)]
#[derive(Debug)]
pub struct Storage {
    words: [u64; WORDS],
}

/// Content of a storage. The mark comes first and is read alone, because a storage may contain
/// anything before [`Storage::fill`].
#[repr(C)]
struct Content {
    mark: u64,
    pair: Pair<'static>,
}

const _: () = assert!(size_of::<Content>() <= size_of::<Storage>(), "a model fits into its storage");
const _: () = assert!(align_of::<Content>() <= align_of::<Storage>(), "a storage is aligned for a model");

/// Mark of a storage that contains a model: no text, no address, not 0.
const LOADED: u64 = 0x9e8d_51c3_f0a6_27b4;

impl Storage {
    /// Marks the storage as empty.
    pub(crate) fn clear(&mut self) {
        self.words[0] = 0;
    }

    /// Puts a model into the storage.
    pub(crate) fn fill(&mut self, pair: Pair<'static>) {
        let content = (&raw mut *self).cast::<Content>();
        // SAFETY: the storage is large enough and aligned (asserted above), and borrowed mutably.
        unsafe { content.write(Content { mark: LOADED, pair }) };
    }
}

/// Refuses a null pointer and a misaligned one.
pub(crate) fn check<T>(pointer: *const T) -> Result<(), Status> {
    if pointer.is_null() {
        Err(NULL)
    } else if !pointer.is_aligned() {
        Err(ALIGNMENT)
    } else {
        Ok(())
    }
}

/// Borrows a storage.
///
/// # Safety
///
/// The pointer is null or points to a storage that nothing else uses during the call.
pub(crate) unsafe fn storage<'a>(model: *mut Storage) -> Result<&'a mut Storage, Status> {
    check(model)?;
    // SAFETY: neither null nor misaligned; the caller promises the rest.
    Ok(unsafe { &mut *model })
}

/// Borrows the model in a storage.
///
/// # Safety
///
/// As for [`storage`].
pub(crate) unsafe fn loaded<'a>(model: *mut Storage) -> Result<&'a mut Pair<'static>, Status> {
    // SAFETY: the caller's promise.
    let storage = unsafe { storage(model) }?;
    if storage.words[0] != LOADED {
        return Err(NOT_LOADED);
    }
    // SAFETY: only `fill` writes the mark, together with a model; the borrow is the storage's.
    Ok(unsafe { &mut (*(&raw mut *storage).cast::<Content>()).pair })
}

/// Borrows the bytes of an image. The caller promises to keep them, so they outlive every model.
///
/// # Safety
///
/// The pointer is null or points to `size` bytes that stay readable and unchanged.
pub(crate) unsafe fn image(bytes: *const u8, size: usize) -> Result<&'static [u8], Status> {
    check(bytes)?;
    if isize::try_from(size).is_err() {
        return Err(IMAGE_LENGTH);
    }
    // SAFETY: not null, at most `isize::MAX` bytes; the caller promises the rest.
    Ok(unsafe { core::slice::from_raw_parts(bytes, size) })
}

/// Reads an input.
///
/// # Safety
///
/// The pointer is null or points to a readable object.
pub(crate) unsafe fn input<T: Copy>(pointer: *const T) -> Result<T, Status> {
    check(pointer)?;
    // SAFETY: neither null nor misaligned; the caller promises the rest.
    Ok(unsafe { *pointer })
}

/// Writes an output.
///
/// # Safety
///
/// The pointer has passed [`check`] and points to a writable object.
pub(crate) unsafe fn put<T>(pointer: *mut T, value: T) {
    // SAFETY: the caller's promise. The old content is not read, so it may be uninitialised.
    unsafe { pointer.write(value) };
}
