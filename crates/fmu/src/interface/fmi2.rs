//! FMI 2.0 for co-simulation.

use super::{Component, Log, Status, absent, call, free, read, slice, slice_mut, text, write};
use crate::instance::Instance;
use crate::variable::Type;
use std::ffi::{CString, c_char, c_int, c_void};
use std::path::PathBuf;

type Logger = unsafe extern "C" fn(*mut c_void, *const c_char, Status, *const c_char, *const c_char, ...);

/// Functions of the program.
#[repr(C)]
struct Callbacks {
    logger: Option<Logger>,
    allocate: *mut c_void,
    free: *mut c_void,
    finished: *mut c_void,
    environment: *mut c_void,
}

struct Sink {
    logger: Option<Logger>,
    environment: *mut c_void,
    name: CString,
}

impl Log for Sink {
    fn report(&self, status: Status, message: &str) {
        // The message is a format of printf.
        let message = CString::new(message.replace('%', "%%").replace('\0', " "));
        if let (Some(logger), Ok(message)) = (self.logger, message) {
            let category = c"logStatusError";
            // SAFETY: the program's function, with strings that live through the call.
            unsafe {
                logger(self.environment, self.name.as_ptr(), status, category.as_ptr(), message.as_ptr())
            };
        }
    }
}

/// Kind of unit that a program requires: `fmi2CoSimulation`.
const CO_SIMULATION: c_int = 1;

#[unsafe(no_mangle)]
extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetDebugLogging(
    _: *mut c_void,
    _: c_int,
    _: usize,
    _: *const *const c_char,
) -> Status {
    Status::Ok
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    guid: *const c_char,
    resources: *const c_char,
    callbacks: *const Callbacks,
    _visible: c_int,
    _logging: c_int,
) -> *mut c_void {
    // SAFETY: the program's promises.
    let (name, guid, resources, callbacks) =
        unsafe { (text(name), text(guid), text(resources), callbacks.as_ref()) };
    let log = Sink {
        logger: callbacks.and_then(|callbacks| callbacks.logger),
        environment: callbacks.map_or(std::ptr::null_mut(), |callbacks| callbacks.environment),
        name: CString::new(name).unwrap_or_default(),
    };
    let open = || {
        if kind == CO_SIMULATION {
            Instance::open(&folder(&resources), &guid)
        } else {
            Err("found a call for model exchange; the unit is for co-simulation".into())
        }
    };
    let instance = std::panic::catch_unwind(open).unwrap_or_else(|_| Err("a defect of the unit".into()));
    Component::open(instance, log)
}

/// Path of a file URI; a text without a scheme is a path.
fn folder(uri: &str) -> PathBuf {
    let Some(path) = uri.strip_prefix("file:") else { return uri.into() };
    // `file:///a`, `file://localhost/a` and `file:/a` are the same.
    let path = path.strip_prefix("//").map_or(path, |rest| rest.find('/').map_or("", |slash| &rest[slash..]));
    let mut bytes = Vec::with_capacity(path.len());
    let mut rest = path.as_bytes();
    while let Some((&first, others)) = rest.split_first() {
        let digits = others.get(..2).and_then(|two| std::str::from_utf8(two).ok());
        let code = digits.filter(|_| first == b'%').and_then(|two| u8::from_str_radix(two, 16).ok());
        bytes.push(code.unwrap_or(first));
        rest = if code.is_some() { &others[2..] } else { others };
    }
    let path = String::from_utf8_lossy(&bytes).into_owned();
    // On Windows `/C:/a` is `C:/a`.
    let is_drive = path.as_bytes().get(2) == Some(&b':');
    PathBuf::from(if cfg!(windows) && is_drive { &path[1..] } else { &path })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2FreeInstance(component: *mut c_void) {
    // SAFETY: the program's promise.
    unsafe { free::<Sink>(component) };
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetupExperiment(
    component: *mut c_void,
    has_tolerance: c_int,
    tolerance: f64,
    start_s: f64,
    _has_stop: c_int,
    _stop_s: f64,
) -> Status {
    let tolerance = (has_tolerance != 0).then_some(tolerance);
    // SAFETY: the program's promise.
    unsafe { call::<Sink>(component, |instance| instance.set_up(start_s, tolerance)) }
}

transitions! {
    Sink;
    fmi2EnterInitializationMode => |instance| instance.enter_initialisation();
    fmi2ExitInitializationMode => |instance| instance.exit_initialisation();
    fmi2Terminate => |instance| instance.terminate();
    fmi2Reset => |instance| { instance.reset(); Ok(()) };
    fmi2CancelStep => |_| Err("found a call to cancel a step; steps are not asynchronous".into());
}

/// Defines the functions that read and set variables of a type.
macro_rules! accessors {
    ($($get:ident, $set:ident, $value:ty, $kind:expr, $to:expr, $from:expr;)*) => {
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $get(
                component: *mut c_void,
                references: *const u32,
                count: usize,
                values: *mut $value,
            ) -> Status {
                // SAFETY: the program's promises.
                unsafe {
                    let (references, values) = (slice(references, count), slice_mut(values, count));
                    call::<Sink>(component, |instance| read(instance, references, values, ($kind, $to)))
                }
            }

            #[unsafe(no_mangle)]
            unsafe extern "C" fn $set(
                component: *mut c_void,
                references: *const u32,
                count: usize,
                values: *const $value,
            ) -> Status {
                // SAFETY: the program's promises.
                unsafe {
                    let (references, values) = (slice(references, count), slice(values, count));
                    call::<Sink>(component, |instance| write(instance, references, values, ($kind, $from)))
                }
            }
        )*
    };
}

accessors! {
    fmi2GetReal, fmi2SetReal, f64, Type::Real, |value| value, |value| value;
    fmi2GetInteger, fmi2SetInteger, c_int, Type::Integer, |value| value as c_int, f64::from;
    fmi2GetBoolean, fmi2SetBoolean, c_int, Type::Boolean, |value| c_int::from(value != 0.0),
        |value| f64::from(u8::from(value != 0));
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetString(
    component: *mut c_void,
    _: *const u32,
    count: usize,
    _: *mut *const c_char,
) -> Status {
    // SAFETY: the program's promise.
    unsafe { call::<Sink>(component, |_| absent(count, "String")) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetString(
    component: *mut c_void,
    _: *const u32,
    count: usize,
    _: *const *const c_char,
) -> Status {
    // SAFETY: the program's promise.
    unsafe { call::<Sink>(component, |_| absent(count, "String")) }
}

state_functions! {
    Sink;
    fmi2GetFMUstate, fmi2SetFMUstate, fmi2FreeFMUstate,
    fmi2SerializedFMUstateSize, fmi2SerializeFMUstate, fmi2DeSerializeFMUstate
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetDirectionalDerivative(
    component: *mut c_void,
    _: *const u32,
    _: usize,
    _: *const u32,
    _: usize,
    _: *const f64,
    _: *mut f64,
) -> Status {
    // SAFETY: the program's promise.
    unsafe { call::<Sink>(component, |_| Err("directional derivatives: the unit has none".into())) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetRealInputDerivatives(
    component: *mut c_void,
    _: *const u32,
    count: usize,
    _: *const c_int,
    _: *const f64,
) -> Status {
    // SAFETY: the program's promise.
    unsafe { call::<Sink>(component, |_| absent(count, "derivative of an input")) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    component: *mut c_void,
    _: *const u32,
    count: usize,
    _: *const c_int,
    _: *mut f64,
) -> Status {
    // SAFETY: the program's promise.
    unsafe { call::<Sink>(component, |_| absent(count, "derivative of an output")) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2DoStep(component: *mut c_void, start_s: f64, step_s: f64, _: c_int) -> Status {
    // SAFETY: the program's promise.
    unsafe { call::<Sink>(component, |instance| instance.step(start_s, step_s)) }
}

/// Defines the functions about steps in the background, which the unit does not take.
macro_rules! statuses {
    ($($name:ident: $value:ty;)*) => {
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $name(_: *mut c_void, _: c_int, _: *mut $value) -> Status {
                Status::Discard
            }
        )*
    };
}

statuses! {
    fmi2GetStatus: Status;
    fmi2GetRealStatus: f64;
    fmi2GetIntegerStatus: c_int;
    fmi2GetBooleanStatus: c_int;
    fmi2GetStringStatus: *const c_char;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_uri_becomes_a_path() {
        for (uri, path) in [
            ("file:///tmp/a%20b/resources", "/tmp/a b/resources"),
            ("file:/tmp/a", "/tmp/a"),
            ("file://localhost/tmp/a", "/tmp/a"),
            ("/tmp/a", "/tmp/a"),
            ("file:///tmp/100%", "/tmp/100%"),
        ] {
            assert_eq!(folder(uri), PathBuf::from(path), "{uri}");
        }
    }
}
