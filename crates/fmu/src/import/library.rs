//! Functions of a unit's library for the two versions of the interface as one set of calls.
#![allow(unsafe_code, reason = "calls of functions in a loaded library")]

use crate::variable::Type;
use crate::xml::Version;
use libloading::Library;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Instance of a unit.
pub(super) type Component = *mut c_void;

/// Messages that a unit has logged.
pub(super) type Messages = Mutex<Vec<String>>;

type Accessor<T> = unsafe extern "C" fn(Component, *const u32, usize, *mut T) -> c_int;
type SizedAccessor<T> = unsafe extern "C" fn(Component, *const u32, usize, *mut T, usize) -> c_int;
type Transition = unsafe extern "C" fn(Component) -> c_int;
type Free = unsafe extern "C" fn(Component);

/// Functions of a program for a unit of FMI 2.0.
#[repr(C)]
pub(super) struct Callbacks {
    logger: unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char),
    allocate: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    free: unsafe extern "C" fn(*mut c_void),
    finished: *const c_void,
    environment: *mut c_void,
}

unsafe extern "C" {
    fn calloc(count: usize, size: usize) -> *mut c_void;
    fn free(memory: *mut c_void);
}

/// Maximum number of messages that are kept.
const MAX_MESSAGES: usize = 20;

unsafe fn keep(environment: *mut c_void, message: *const c_char) {
    // SAFETY: the environment is the list that outlives the instance; the text is a C string.
    let (Some(messages), false) = (unsafe { environment.cast::<Messages>().as_ref() }, message.is_null())
    else {
        return;
    };
    // SAFETY: as above.
    let text = unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned();
    let mut messages = messages.lock().unwrap_or_else(PoisonError::into_inner);
    if messages.len() < MAX_MESSAGES {
        messages.push(text);
    }
}

/// Logger of FMI 2.0. Further arguments of its format are not read: the format itself is kept.
unsafe extern "C" fn log_2(
    environment: *mut c_void,
    _: *const c_char,
    _: c_int,
    _: *const c_char,
    message: *const c_char,
) {
    // SAFETY: the unit's promise.
    unsafe { keep(environment, message) };
}

unsafe extern "C" fn log_3(environment: *mut c_void, _: c_int, _: *const c_char, message: *const c_char) {
    // SAFETY: the unit's promise.
    unsafe { keep(environment, message) };
}

impl Callbacks {
    pub(super) fn new(messages: &Messages) -> Self {
        Self {
            logger: log_2,
            allocate: calloc,
            free,
            finished: std::ptr::null(),
            environment: std::ptr::from_ref(messages).cast_mut().cast(),
        }
    }
}

/// A loaded library.
pub(super) struct Functions {
    library: Library,
    version: Version,
}

/// Name of a function that the library does not have.
pub(super) type MissingFunction = String;

impl Functions {
    pub(super) fn load(path: &Path, version: Version) -> Result<Self, String> {
        // SAFETY: loading runs the unit's own code, which is the purpose of an import.
        let library = unsafe { Library::new(path) }.map_err(|error| error.to_string())?;
        Ok(Self { library, version })
    }

    /// Function by its name without `fmi2` or `fmi3`.
    ///
    /// # Safety
    ///
    /// `F` is the type that the standard gives the function.
    unsafe fn function<F: Copy>(&self, two: &str, three: &str) -> Result<F, MissingFunction> {
        let name = match self.version {
            Version::Two => format!("fmi2{two}"),
            Version::Three => format!("fmi3{three}"),
        };
        // SAFETY: the caller's promise.
        unsafe { self.library.get::<F>(name.as_bytes()) }.map(|function| *function).map_err(|_| name)
    }

    pub(super) fn instantiate(
        &self,
        [name, guid, resources]: [&CStr; 3],
        callbacks: &Callbacks,
    ) -> Result<Component, MissingFunction> {
        type Two = unsafe extern "C" fn(
            *const c_char,
            c_int,
            *const c_char,
            *const c_char,
            *const Callbacks,
            c_int,
            c_int,
        ) -> Component;
        type Three = unsafe extern "C" fn(
            *const c_char,
            *const c_char,
            *const c_char,
            bool,
            bool,
            bool,
            bool,
            *const u32,
            usize,
            *mut c_void,
            unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char),
            *const c_void,
        ) -> Component;
        let [name, guid, resources] = [name.as_ptr(), guid.as_ptr(), resources.as_ptr()];
        // SAFETY: types of the standard; the texts live through the call, the callbacks longer.
        unsafe {
            match self.version {
                Version::Two => {
                    let open: Two = self.function("Instantiate", "")?;
                    Ok(open(name, 1, guid, resources, callbacks, 0, 0))
                }
                Version::Three => {
                    let open: Three = self.function("", "InstantiateCoSimulation")?;
                    let (none, environment) = (std::ptr::null(), callbacks.environment);
                    let (vars, unused) = (std::ptr::null(), false);
                    Ok(open(
                        name,
                        guid,
                        resources,
                        unused,
                        unused,
                        unused,
                        unused,
                        vars,
                        0,
                        environment,
                        log_3,
                        none,
                    ))
                }
            }
        }
    }

    /// Sets up the experiment and enters the initialisation. Returns the status.
    pub(super) fn enter(&self, component: Component, start_s: f64) -> Result<c_int, MissingFunction> {
        type Setup = unsafe extern "C" fn(Component, c_int, f64, f64, c_int, f64) -> c_int;
        type Enter = unsafe extern "C" fn(Component, bool, f64, f64, bool, f64) -> c_int;
        // SAFETY: types of the standard.
        unsafe {
            match self.version {
                Version::Two => {
                    let set_up: Setup = self.function("SetupExperiment", "")?;
                    let status = set_up(component, 0, 0.0, start_s, 0, 0.0);
                    if status > 1 {
                        return Ok(status);
                    }
                    self.transition(component, "EnterInitializationMode")
                }
                Version::Three => {
                    let enter: Enter = self.function("", "EnterInitializationMode")?;
                    Ok(enter(component, false, 0.0, start_s, false, 0.0))
                }
            }
        }
    }

    /// Calls a function that has only the instance as argument.
    pub(super) fn transition(&self, component: Component, name: &str) -> Result<c_int, MissingFunction> {
        // SAFETY: type of the standard.
        unsafe { Ok(self.function::<Transition>(name, name)?(component)) }
    }

    pub(super) fn free(&self, component: Component) {
        // SAFETY: type of the standard. A library without the function leaks the instance.
        unsafe {
            if let Ok(free) = self.function::<Free>("FreeInstance", "FreeInstance") {
                free(component);
            }
        }
    }

    /// Reads or sets a variable of a type.
    pub(super) fn access(
        &self,
        component: Component,
        (reference, kind): (u32, Type),
        value: &mut f64,
        is_set: bool,
    ) -> Result<c_int, MissingFunction> {
        let verb = if is_set { "Set" } else { "Get" };
        let names = match kind {
            Type::Real => ["Real", "Float64"],
            Type::Integer => ["Integer", "Int32"],
            Type::Boolean => ["Boolean", "Boolean"],
        };
        let names = names.map(|name| format!("{verb}{name}"));
        match (kind, self.version) {
            (Type::Real, _) => self.access_as::<f64>(component, reference, (value, |v| v, |v| v), &names),
            (Type::Boolean, Version::Three) => {
                let from: fn(bool) -> f64 = |v| f64::from(u8::from(v));
                self.access_as::<bool>(component, reference, (value, |v| v != 0.0, from), &names)
            }
            _ => self.access_as::<c_int>(component, reference, (value, |v| v as c_int, f64::from), &names),
        }
    }

    fn access_as<T: Copy>(
        &self,
        component: Component,
        reference: u32,
        (value, to, from): (&mut f64, fn(f64) -> T, fn(T) -> f64),
        [two, three]: &[String; 2],
    ) -> Result<c_int, MissingFunction> {
        let mut own = to(*value);
        // SAFETY: types of the standard, with one reference and one value.
        let status = unsafe {
            match self.version {
                Version::Two => {
                    self.function::<Accessor<T>>(two, "")?(component, &raw const reference, 1, &raw mut own)
                }
                Version::Three => {
                    let access: SizedAccessor<T> = self.function("", three)?;
                    access(component, &raw const reference, 1, &raw mut own, 1)
                }
            }
        };
        *value = from(own);
        Ok(status)
    }

    /// Takes a step. Returns the status, and the time reached; none if the unit ends the
    /// simulation.
    pub(super) fn step(
        &self,
        component: Component,
        start_s: f64,
        step_s: f64,
    ) -> Result<(c_int, Option<f64>), MissingFunction> {
        type Two = unsafe extern "C" fn(Component, f64, f64, c_int) -> c_int;
        type Three = unsafe extern "C" fn(
            Component,
            f64,
            f64,
            bool,
            *mut bool,
            *mut bool,
            *mut bool,
            *mut f64,
        ) -> c_int;
        let (mut reached_s, mut end) = (start_s + step_s, false);
        // SAFETY: types of the standard; the flags live through the call.
        let status = unsafe {
            match self.version {
                Version::Two => self.function::<Two>("DoStep", "")?(component, start_s, step_s, 1),
                Version::Three => {
                    let step: Three = self.function("", "DoStep")?;
                    let (mut event, mut early) = (false, false);
                    step(
                        component,
                        start_s,
                        step_s,
                        true,
                        &raw mut event,
                        &raw mut end,
                        &raw mut early,
                        &raw mut reached_s,
                    )
                }
            }
        };
        Ok((status, (!end).then_some(reached_s)))
    }
}
