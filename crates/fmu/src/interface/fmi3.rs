//! FMI 3.0 for co-simulation.

use super::{Component, Log, Status, absent, call, free, read, slice, slice_mut, text, write};
use crate::instance::Instance;
use crate::variable::Type;
use std::ffi::{CString, c_char, c_void};
use std::path::Path;

type Logger = unsafe extern "C" fn(*mut c_void, Status, *const c_char, *const c_char);

struct Sink {
    logger: Option<Logger>,
    environment: *mut c_void,
}

impl Log for Sink {
    fn report(&self, status: Status, message: &str) {
        if let (Some(logger), Ok(message)) = (self.logger, CString::new(message.replace('\0', " "))) {
            // SAFETY: the program's function, with strings that live through the call.
            unsafe { logger(self.environment, status, c"logStatusError".as_ptr(), message.as_ptr()) };
        }
    }
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetDebugLogging(
    _: *mut c_void,
    _: bool,
    _: usize,
    _: *const *const c_char,
) -> Status {
    Status::Ok
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateModelExchange(
    _: *const c_char,
    _: *const c_char,
    _: *const c_char,
    _: bool,
    _: bool,
    environment: *mut c_void,
    logger: Option<Logger>,
) -> *mut c_void {
    let error = Err("found a call for model exchange; the unit is for co-simulation".into());
    Component::open(error, Sink { logger, environment })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _: *const c_char,
    _: *const c_char,
    _: *const c_char,
    _: bool,
    _: bool,
    environment: *mut c_void,
    logger: Option<Logger>,
    _: *mut c_void,
    _: *mut c_void,
    _: *mut c_void,
) -> *mut c_void {
    let error = Err("found a call for scheduled execution; the unit is for co-simulation".into());
    Component::open(error, Sink { logger, environment })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _has_events: bool,
    _may_return_early: bool,
    _: *const u32,
    _: usize,
    environment: *mut c_void,
    logger: Option<Logger>,
    _intermediate: *mut c_void,
) -> *mut c_void {
    // SAFETY: the program's promises.
    let (token, resources) = unsafe { (text(token), text(resources)) };
    let open = || Instance::open(Path::new(&resources), &token);
    let instance = std::panic::catch_unwind(open).unwrap_or_else(|_| Err("a defect of the unit".into()));
    Component::open(instance, Sink { logger, environment })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3FreeInstance(component: *mut c_void) {
    // SAFETY: the program's promise.
    unsafe { free::<Sink>(component) };
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3EnterInitializationMode(
    component: *mut c_void,
    has_tolerance: bool,
    tolerance: f64,
    start_s: f64,
    _has_stop: bool,
    _stop_s: f64,
) -> Status {
    let enter = |instance: &mut Instance| {
        instance.set_up(start_s, has_tolerance.then_some(tolerance))?;
        instance.enter_initialisation()
    };
    // SAFETY: the program's promise.
    unsafe { call::<Sink>(component, enter) }
}

transitions! {
    Sink;
    fmi3ExitInitializationMode => |instance| instance.exit_initialisation();
    fmi3Terminate => |instance| instance.terminate();
    fmi3Reset => |instance| { instance.reset(); Ok(()) };
    fmi3EnterEventMode => |_| absent(1, "event");
    fmi3EnterStepMode => |_| Ok(());
    fmi3EnterConfigurationMode => |_| absent(1, "structural parameter");
    fmi3ExitConfigurationMode => |_| absent(1, "structural parameter");
    fmi3EvaluateDiscreteStates => |_| Ok(());
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
                values_count: usize,
            ) -> Status {
                // SAFETY: the program's promises.
                unsafe {
                    let (references, values) = (slice(references, count), slice_mut(values, values_count));
                    call::<Sink>(component, |instance| read(instance, references, values, ($kind, $to)))
                }
            }

            #[unsafe(no_mangle)]
            unsafe extern "C" fn $set(
                component: *mut c_void,
                references: *const u32,
                count: usize,
                values: *const $value,
                values_count: usize,
            ) -> Status {
                // SAFETY: the program's promises.
                unsafe {
                    let (references, values) = (slice(references, count), slice(values, values_count));
                    call::<Sink>(component, |instance| write(instance, references, values, ($kind, $from)))
                }
            }
        )*
    };
}

accessors! {
    fmi3GetFloat64, fmi3SetFloat64, f64, Type::Real, |value| value, |value| value;
    fmi3GetInt32, fmi3SetInt32, i32, Type::Integer, |value| value as i32, f64::from;
    fmi3GetBoolean, fmi3SetBoolean, bool, Type::Boolean, |value| value != 0.0,
        |value| f64::from(u8::from(value));
}

/// Defines the functions for types that no unit has.
macro_rules! absent_types {
    ($($get:ident, $set:ident, $kind:literal;)*) => {
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $get(
                component: *mut c_void,
                _: *const u32,
                count: usize,
                _: *mut c_void,
                _: usize,
            ) -> Status {
                // SAFETY: the program's promise.
                unsafe { call::<Sink>(component, |_| absent(count, $kind)) }
            }

            #[unsafe(no_mangle)]
            unsafe extern "C" fn $set(
                component: *mut c_void,
                _: *const u32,
                count: usize,
                _: *const c_void,
                _: usize,
            ) -> Status {
                // SAFETY: the program's promise.
                unsafe { call::<Sink>(component, |_| absent(count, $kind)) }
            }
        )*
    };
}

absent_types! {
    fmi3GetFloat32, fmi3SetFloat32, "Float32";
    fmi3GetInt8, fmi3SetInt8, "Int8";
    fmi3GetUInt8, fmi3SetUInt8, "UInt8";
    fmi3GetInt16, fmi3SetInt16, "Int16";
    fmi3GetUInt16, fmi3SetUInt16, "UInt16";
    fmi3GetUInt32, fmi3SetUInt32, "UInt32";
    fmi3GetInt64, fmi3SetInt64, "Int64";
    fmi3GetUInt64, fmi3SetUInt64, "UInt64";
    fmi3GetString, fmi3SetString, "String";
}

/// Defines functions of parts of the standard that no unit has, with the types of their arguments
/// after the instance.
macro_rules! absent_parts {
    ($($name:ident($($argument:ty),*), $part:literal;)*) => {
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $name(component: *mut c_void, $(_: $argument),*) -> Status {
                // SAFETY: the program's promise.
                unsafe { call::<Sink>(component, |_| absent(1, $part)) }
            }
        )*
    };
}

/// References of variables.
type References = *const u32;
/// Array that is not read.
type Array = *const c_void;
/// Array that is not written.
type Place = *mut c_void;

absent_parts! {
    fmi3GetBinary(References, usize, *mut usize, Place, usize), "Binary";
    fmi3SetBinary(References, usize, *const usize, Array, usize), "Binary";
    fmi3GetClock(References, usize, *mut bool), "Clock";
    fmi3SetClock(References, usize, *const bool), "Clock";
    fmi3GetIntervalDecimal(References, usize, *mut f64, Place), "Clock";
    fmi3GetIntervalFraction(References, usize, *mut u64, *mut u64, Place), "Clock";
    fmi3GetShiftDecimal(References, usize, *mut f64), "Clock";
    fmi3GetShiftFraction(References, usize, *mut u64, *mut u64), "Clock";
    fmi3SetIntervalDecimal(References, usize, *const f64), "Clock";
    fmi3SetIntervalFraction(References, usize, *const u64, *const u64), "Clock";
    fmi3SetShiftDecimal(References, usize, *const f64), "Clock";
    fmi3SetShiftFraction(References, usize, *const u64, *const u64), "Clock";
    fmi3GetOutputDerivatives(References, usize, *const i32, *mut f64, usize), "derivative of an output";
    fmi3GetDirectionalDerivative(References, usize, References, usize, *const f64, usize, *mut f64, usize),
        "directional derivative";
    fmi3GetAdjointDerivative(References, usize, References, usize, *const f64, usize, *mut f64, usize),
        "adjoint derivative";
    fmi3GetNumberOfVariableDependencies(u32, *mut usize), "array";
    fmi3GetVariableDependencies(u32, *mut usize, *mut u32, *mut usize, Place, usize), "array";
    fmi3UpdateDiscreteStates(*mut bool, *mut bool, *mut bool, *mut bool, *mut bool, *mut f64), "event";
    fmi3EnterContinuousTimeMode(), "continuous state";
    fmi3CompletedIntegratorStep(bool, *mut bool, *mut bool), "continuous state";
    fmi3SetTime(f64), "continuous state";
    fmi3SetContinuousStates(*const f64, usize), "continuous state";
    fmi3GetContinuousStateDerivatives(*mut f64, usize), "continuous state";
    fmi3GetEventIndicators(*mut f64, usize), "event";
    fmi3GetContinuousStates(*mut f64, usize), "continuous state";
    fmi3GetNominalsOfContinuousStates(*mut f64, usize), "continuous state";
    fmi3GetNumberOfEventIndicators(*mut usize), "event";
    fmi3GetNumberOfContinuousStates(*mut usize), "continuous state";
    fmi3ActivateModelPartition(u32, f64), "model partition";
}

state_functions! {
    Sink;
    fmi3GetFMUState, fmi3SetFMUState, fmi3FreeFMUState,
    fmi3SerializedFMUStateSize, fmi3SerializeFMUState, fmi3DeserializeFMUState
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3DoStep(
    component: *mut c_void,
    start_s: f64,
    step_s: f64,
    _no_return_before: bool,
    event_needed: *mut bool,
    terminate: *mut bool,
    early_return: *mut bool,
    last_time_s: *mut f64,
) -> Status {
    // SAFETY: the program's promises.
    unsafe {
        for flag in [event_needed, terminate, early_return] {
            flag.as_mut().into_iter().for_each(|flag| *flag = false);
        }
        let status = call::<Sink>(component, |instance| instance.step(start_s, step_s));
        let reached_s = if status == Status::Ok { start_s + step_s } else { start_s };
        last_time_s.as_mut().into_iter().for_each(|place| *place = reached_s);
        status
    }
}
