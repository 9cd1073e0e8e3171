#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), no_std)]
#![allow(unsafe_code, reason = "the boundary to C: each function checks the pointers that it gets")]

mod status;
mod storage;
mod values;

use inference::{Estimate, Model, Pair};
pub use status::pintle_status_text;
use status::{OK, Status};
use storage::{Storage, check, image, input, loaded, put, storage};
use values::{CEstimate, CInfo, CSample, CState};

/// Version of the interface: the header's `PINTLE_INTERFACE_VERSION`.
const INTERFACE_VERSION: u32 = 1;

/// Handler of a panic that no function reaches: a linked program does not contain it.
#[cfg(all(panic = "abort", not(test)))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

/// Returns the version of the interface that the library was built for.
#[unsafe(no_mangle)]
pub extern "C" fn pintle_interface_version() -> u32 {
    INTERFACE_VERSION
}

/// Checks an image.
///
/// # Safety
///
/// `bytes` is null or points to `size` readable bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pintle_image_check(bytes: *const u8, size: usize) -> Status {
    // SAFETY: the caller's promise about `bytes`.
    status(unsafe { image(bytes, size) }.and_then(|image| load(image).map(drop)))
}

/// Checks an image and starts a model on it with an empty history.
///
/// # Safety
///
/// `model` is null or points to a storage that nothing else uses. `bytes` is null or points to
/// `size` bytes that stay readable and unchanged while the model is used.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pintle_model_init(model: *mut Storage, bytes: *const u8, size: usize) -> Status {
    // SAFETY: the caller's promise about `model`.
    let storage = match unsafe { storage(model) } {
        Ok(storage) => storage,
        Err(status) => return status,
    };
    storage.clear();
    // SAFETY: the caller's promise about `bytes`.
    let pair = unsafe { image(bytes, size) }.and_then(load).map(Pair::new);
    status(pair.map(|pair| storage.fill(pair)))
}

/// Estimates the forces of a sample in SI units.
///
/// # Safety
///
/// Every pointer is null or points to its object; nothing else uses the model meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pintle_model_push(
    model: *mut Storage,
    state: *const CState,
    estimate: *mut CEstimate,
) -> Status {
    // SAFETY: the caller's promise.
    let state = unsafe { input(state) };
    // SAFETY: the caller's promise.
    status(unsafe { estimated(model, estimate, |pair| Ok(pair.push(&state?.to_state()))) })
}

/// Estimates the forces of a sample in integers.
///
/// # Safety
///
/// As for [`pintle_model_push`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pintle_model_step(
    model: *mut Storage,
    sample: *const CSample,
    estimate: *mut CEstimate,
) -> Status {
    // SAFETY: the caller's promise.
    let sample = unsafe { input(sample) };
    // SAFETY: the caller's promise.
    status(unsafe { estimated(model, estimate, |pair| Ok(pair.step(&sample?.to_sample()))) })
}

/// Records a missing sample.
///
/// # Safety
///
/// As for [`pintle_model_push`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pintle_model_skip(model: *mut Storage, estimate: *mut CEstimate) -> Status {
    // SAFETY: the caller's promise.
    status(unsafe { estimated(model, estimate, |pair| Ok(pair.skip())) })
}

/// Clears the history.
///
/// # Safety
///
/// `model` is null or points to a storage that nothing else uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pintle_model_reset(model: *mut Storage) -> Status {
    // SAFETY: the caller's promise.
    status(unsafe { loaded(model) }.map(Pair::reset))
}

/// Writes what the image says of itself.
///
/// # Safety
///
/// Every pointer is null or points to its object.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pintle_model_info(model: *mut Storage, info: *mut CInfo) -> Status {
    let write = || {
        // SAFETY: the caller's promise.
        let pair = unsafe { loaded(model) }?;
        check(info)?;
        // SAFETY: checked; the caller's promise.
        unsafe { put(info, CInfo::from_model(pair.model())) };
        Ok(())
    };
    status(write())
}

fn load(image: &'static [u8]) -> Result<Model<'static>, Status> {
    Model::load(image).map_err(|error| status::of_image(&error))
}

fn status(result: Result<(), Status>) -> Status {
    result.err().unwrap_or(OK)
}

/// Runs the networks once and writes the estimate. All pointers are checked first, so that a
/// refused call does not change the history.
///
/// # Safety
///
/// Both pointers are null or point to their object; nothing else uses the model meanwhile.
unsafe fn estimated(
    model: *mut Storage,
    estimate: *mut CEstimate,
    run: impl FnOnce(&mut Pair<'static>) -> Result<Estimate, Status>,
) -> Result<(), Status> {
    // SAFETY: the caller's promise.
    let pair = unsafe { loaded(model) }?;
    check(estimate)?;
    let found = CEstimate::from_estimate(&run(pair)?);
    // SAFETY: checked; the caller's promise.
    unsafe { put(estimate, found) };
    Ok(())
}

#[cfg(test)]
mod tests;
