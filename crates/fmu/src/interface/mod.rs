//! The two C interfaces of a unit. Each function turns its pointers into values, calls the
//! [`Instance`](crate::instance::Instance), and reports an error to the program's log.
//!
//! The program that loads the library promises what the standard demands: pointers are valid for
//! the stated number of elements, and an instance is used by one thread at a time. A null instance
//! is an error. A panic does not leave the library.
#![allow(unsafe_code, reason = "the boundary to C, as the standard defines it")]
#![allow(non_snake_case, reason = "names of the standard")]

/// Defines functions that call one of the instance's without arguments; `$sink` is the log.
macro_rules! transitions {
    ($sink:ty; $($name:ident => $run:expr;)*) => {
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $name(component: *mut c_void) -> Status {
                // SAFETY: the program's promise.
                unsafe { call::<$sink>(component, $run) }
            }
        )*
    };
}

/// Defines the functions that save, restore and serialise a state; `$sink` is the log.
macro_rules! state_functions {
    (
        $sink:ty;
        $get:ident, $set:ident, $free:ident, $size:ident, $serialise:ident, $deserialise:ident
    ) => {
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $get(component: *mut c_void, place: *mut *mut c_void) -> Status {
            // SAFETY: the program's promises.
            unsafe { call::<$sink>(component, |instance| super::save(instance, place)) }
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn $set(component: *mut c_void, saved: *mut c_void) -> Status {
            // SAFETY: the program's promises.
            unsafe { call::<$sink>(component, |instance| instance.restore(super::state(saved)?.clone())) }
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn $free(component: *mut c_void, place: *mut *mut c_void) -> Status {
            // SAFETY: the program's promises.
            unsafe { call::<$sink>(component, |_| super::free_state(place)) }
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn $size(component: *mut c_void, saved: *mut c_void, size: *mut usize) -> Status {
            // SAFETY: the program's promises.
            unsafe { call::<$sink>(component, |_| super::state_size(saved, size)) }
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn $serialise(
            component: *mut c_void,
            saved: *mut c_void,
            bytes: *mut u8,
            size: usize,
        ) -> Status {
            // SAFETY: the program's promises.
            unsafe { call::<$sink>(component, |_| super::serialise(saved, bytes, size)) }
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn $deserialise(
            component: *mut c_void,
            bytes: *const u8,
            size: usize,
            place: *mut *mut c_void,
        ) -> Status {
            // SAFETY: the program's promises.
            unsafe { call::<$sink>(component, |_| super::deserialise(bytes, size, place)) }
        }
    };
}

mod fmi2;
mod fmi3;

use crate::instance::{Instance, State};
use crate::variable::Type;
use std::ffi::{CStr, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Return value of a function, the same in both versions; 1 would be a warning.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Status {
    Ok = 0,
    Discard = 2,
    Error = 3,
    Fatal = 4,
}

/// Sends a message to the program's log.
trait Log {
    fn report(&self, status: Status, message: &str);
}

/// An instance with its log.
struct Component<L> {
    instance: Instance,
    log: L,
}

impl<L: Log> Component<L> {
    /// Opens an instance on the heap; null after an error, which is logged.
    fn open(instance: Result<Instance, String>, log: L) -> *mut c_void {
        match instance {
            Ok(instance) => Box::into_raw(Box::new(Self { instance, log })).cast(),
            Err(message) => {
                log.report(Status::Error, &message);
                std::ptr::null_mut()
            }
        }
    }
}

/// Runs a function of an instance and logs its error.
unsafe fn call<L: Log>(
    component: *mut c_void,
    run: impl FnOnce(&mut Instance) -> Result<(), String>,
) -> Status {
    // SAFETY: a component that is not null comes from `Component::open`, and one thread uses it.
    let Some(component) = (unsafe { component.cast::<Component<L>>().as_mut() }) else {
        return Status::Error;
    };
    match catch_unwind(AssertUnwindSafe(|| run(&mut component.instance))) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(message)) => {
            component.log.report(Status::Error, &message);
            Status::Error
        }
        Err(_) => {
            component.log.report(Status::Fatal, "a defect of the unit ended the call");
            Status::Fatal
        }
    }
}

unsafe fn free<L>(component: *mut c_void) {
    if !component.is_null() {
        // SAFETY: the component comes from `Component::open`, and the program gives it up.
        drop(unsafe { Box::from_raw(component.cast::<Component<L>>()) });
    }
}

/// Elements of an array; none of a null pointer.
unsafe fn slice<'a, T>(values: *const T, count: usize) -> &'a [T] {
    if values.is_null() || count == 0 {
        return &[];
    }
    // SAFETY: the program's promise.
    unsafe { std::slice::from_raw_parts(values, count) }
}

/// Elements of an array for writing; none of a null pointer.
unsafe fn slice_mut<'a, T>(values: *mut T, count: usize) -> &'a mut [T] {
    if values.is_null() || count == 0 {
        return &mut [];
    }
    // SAFETY: the program's promise.
    unsafe { std::slice::from_raw_parts_mut(values, count) }
}

/// A C string; empty for a null pointer.
unsafe fn text(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: the program's promise.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

/// Reads variables of a type.
fn read<T>(
    instance: &mut Instance,
    references: &[u32],
    values: &mut [T],
    (kind, convert): (Type, impl Fn(f64) -> T),
) -> Result<(), String> {
    same_length(references, values)?;
    for (reference, value) in references.iter().zip(values) {
        *value = convert(instance.get(*reference, kind)?);
    }
    Ok(())
}

/// Sets variables of a type.
fn write<T: Copy>(
    instance: &mut Instance,
    references: &[u32],
    values: &[T],
    (kind, convert): (Type, impl Fn(T) -> f64),
) -> Result<(), String> {
    same_length(references, values)?;
    for (reference, value) in references.iter().zip(values) {
        instance.set(*reference, kind, convert(*value))?;
    }
    Ok(())
}

fn same_length<T>(references: &[u32], values: &[T]) -> Result<(), String> {
    if references.len() == values.len() {
        Ok(())
    } else {
        Err(format!("found {} value references and {} values", references.len(), values.len()))
    }
}

/// Error of variables of a type that no unit has; none if none are named.
fn absent(count: usize, kind: &str) -> Result<(), String> {
    if count == 0 { Ok(()) } else { Err(format!("found variables of type {kind}; the unit has none")) }
}

/// Saves the state at `place`, in the memory of the state that is there if there is one.
unsafe fn save(instance: &Instance, place: *mut *mut c_void) -> Result<(), String> {
    // SAFETY: the program's promise.
    let place = unsafe { place.as_mut() }.ok_or("state: found a null pointer")?;
    // SAFETY: a state that is not null comes from here.
    match unsafe { place.cast::<State>().as_mut() } {
        Some(state) => *state = instance.save(),
        None => *place = Box::into_raw(Box::new(instance.save())).cast(),
    }
    Ok(())
}

unsafe fn state<'a>(state: *mut c_void) -> Result<&'a State, String> {
    // SAFETY: a state that is not null comes from `save` or `deserialise`.
    unsafe { state.cast::<State>().as_ref() }.ok_or_else(|| "state: found a null pointer".into())
}

unsafe fn free_state(place: *mut *mut c_void) -> Result<(), String> {
    // SAFETY: the program's promise.
    if let Some(place) = unsafe { place.as_mut() }
        && !place.is_null()
    {
        // SAFETY: a state that is not null comes from `save` or `deserialise`.
        drop(unsafe { Box::from_raw(place.cast::<State>()) });
        *place = std::ptr::null_mut();
    }
    Ok(())
}

unsafe fn state_size(saved: *mut c_void, size: *mut usize) -> Result<(), String> {
    // SAFETY: the program's promises.
    let (saved, size) = unsafe { (state(saved)?, size.as_mut()) };
    *size.ok_or("size: found a null pointer")? = saved.to_bytes()?.len();
    Ok(())
}

unsafe fn serialise(saved: *mut c_void, bytes: *mut u8, size: usize) -> Result<(), String> {
    // SAFETY: the program's promises.
    let (saved, place) = unsafe { (state(saved)?.to_bytes()?, slice_mut(bytes, size)) };
    let found = place.len();
    let expected = saved.len();
    let place = place.get_mut(..expected);
    place
        .ok_or_else(|| format!("state: found room for {found} bytes; expected {expected}"))?
        .copy_from_slice(&saved);
    Ok(())
}

unsafe fn deserialise(bytes: *const u8, size: usize, place: *mut *mut c_void) -> Result<(), String> {
    // SAFETY: the program's promises.
    let (bytes, place) = unsafe { (slice(bytes, size), place.as_mut()) };
    let state = State::from_bytes(bytes)?;
    *place.ok_or("state: found a null pointer")? = Box::into_raw(Box::new(state)).cast();
    Ok(())
}
