//! An instance of another program's unit.

use super::library::{Callbacks, Component, Functions, Messages, MissingFunction};
use super::{Import, ImportError, ImportedVariable};
use std::cell::Cell;
use std::ffi::{CString, c_int};
use std::path::Path;
use std::sync::PoisonError;

/// Highest status of the standard that is no failure: a warning.
const WARNING: c_int = 1;
/// Status after which an instance can only be freed.
const ERROR: c_int = 3;
/// Status after which nothing may be called.
const FATAL: c_int = 4;

/// Running instance of a unit.
pub struct Slave {
    functions: Functions,
    component: Component,
    messages: Box<Messages>,
    /// Functions of this program, which the unit may call as long as it lives.
    _callbacks: Box<Callbacks>,
    is_running: bool,
    time_s: f64,
    /// Worst status so far, which decides what may still be called.
    worst: Cell<c_int>,
}

impl Slave {
    /// Loads the library of a unit, sets parameters and inputs, and initialises it at `start_s`.
    ///
    /// This runs the unit's own code, with the rights of this program.
    pub fn start(
        import: &Import,
        values: &[(&ImportedVariable, f64)],
        start_s: f64,
    ) -> Result<Self, ImportError> {
        let functions = Functions::load(&import.library()?, import.description.version)
            .map_err(|reason| import.unusable(reason))?;
        let messages = Box::new(Messages::default());
        let callbacks = Box::new(Callbacks::new(&messages));
        let resources = std::path::absolute(import.folder.path().join("resources"))
            .map_err(|error| import.unusable(error.to_string()))?;
        let resources = match import.version() {
            "2.0" => uri(&resources),
            _ => format!("{}/", resources.display()),
        };
        let text = |text: &str| CString::new(text).map_err(|error| import.unusable(error.to_string()));
        let texts = [text("pintle")?, text(&import.description.guid)?, text(&resources)?];
        let [name, guid, resources] = &texts;
        let component = functions
            .instantiate([name, guid, resources], &callbacks)
            .map_err(|name| import.unusable(missing(&name)))?;
        let mut slave = Self {
            functions,
            component,
            messages,
            _callbacks: callbacks,
            is_running: false,
            time_s: start_s,
            worst: Cell::new(0),
        };
        if component.is_null() {
            return Err(slave.failed("Instantiate", 3));
        }
        for (variable, value) in values {
            slave.set(variable, *value)?;
        }
        slave.check("EnterInitializationMode", slave.functions.enter(component, start_s))?;
        for name in ["ExitInitializationMode"] {
            slave.check(name, slave.functions.transition(component, name))?;
        }
        slave.is_running = true;
        Ok(slave)
    }

    /// Sets a variable.
    pub fn set(&mut self, variable: &ImportedVariable, value: f64) -> Result<(), ImportError> {
        self.access(variable, value, true).map(drop)
    }

    /// Value of a variable.
    pub fn get(&mut self, variable: &ImportedVariable) -> Result<f64, ImportError> {
        self.access(variable, 0.0, false)
    }

    fn access(
        &mut self,
        variable: &ImportedVariable,
        mut value: f64,
        is_set: bool,
    ) -> Result<f64, ImportError> {
        let Some(kind) = variable.kind else {
            return Err(ImportError::Unusable {
                file: variable.name.clone(),
                reason: "found a type that is not supported; expected one Real, Integer or Boolean".into(),
            });
        };
        let place = (variable.reference, kind);
        let status = self.functions.access(self.component, place, &mut value, is_set);
        self.check(if is_set { "Set" } else { "Get" }, status)?;
        Ok(value)
    }

    /// Takes a step from the time reached.
    pub fn step(&mut self, step_s: f64) -> Result<(), ImportError> {
        let (status, reached_s) = match self.functions.step(self.component, self.time_s, step_s) {
            Ok(found) => found,
            Err(name) => return self.check("DoStep", Err(name)),
        };
        self.check("DoStep", Ok(status))?;
        let Some(reached_s) = reached_s else {
            return Err(self.failed("DoStep, which ended the simulation,", status));
        };
        if (reached_s - self.time_s - step_s).abs() > 1e-6 * step_s {
            return Err(self.failed("DoStep, which returned early,", status));
        }
        self.time_s += step_s;
        Ok(())
    }

    fn check(
        &self,
        function: &'static str,
        status: Result<c_int, MissingFunction>,
    ) -> Result<(), ImportError> {
        self.worst.set(self.worst.get().max(status.as_ref().copied().unwrap_or_default()));
        match status {
            Ok(status) if status <= WARNING => Ok(()),
            Ok(status) => Err(self.failed(function, status)),
            Err(name) => Err(ImportError::Unusable { file: name.clone(), reason: missing(&name) }),
        }
    }

    fn failed(&self, function: &'static str, status: c_int) -> ImportError {
        let messages = self.messages.lock().unwrap_or_else(PoisonError::into_inner);
        let messages = messages.iter().map(|message| format!(": {}", message.trim())).collect();
        ImportError::Failed { function, status, messages }
    }
}

/// File URI of an absolute path.
fn uri(path: &Path) -> String {
    let mut uri = String::from("file://");
    for byte in path.to_string_lossy().bytes() {
        if byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            uri.push_str(&format!("%{byte:02X}"));
        }
    }
    uri
}

fn missing(function: &str) -> String {
    format!("found no function {function}; expected one that the standard requires")
}

impl Drop for Slave {
    fn drop(&mut self) {
        // The standard forbids every call after a fatal status, and the end after an error.
        if self.component.is_null() || self.worst.get() >= FATAL {
            return;
        }
        if self.is_running && self.worst.get() < ERROR {
            // A unit that cannot end its simulation is freed all the same.
            let _ = self.functions.transition(self.component, "Terminate");
        }
        self.functions.free(self.component);
    }
}
