//! Terms that the nominal plants leave out and effects switch on, with their equations. Without any
//! term a plant is nominal. A term of friction, or of the effort of an axis, is complete here; one
//! with a state or another force is also used in `crate::plants`.

mod axis;
mod bearing;

pub use axis::AxisExtension;
pub(crate) use axis::Rubbing;
pub use bearing::Extension;
pub(crate) use bearing::Memory;

use crate::signals::Profile;

/// Width of a change of friction, s: within one sample of a log, and smooth for the integrator.
const STEP_WIDTH_S: f64 = 2e-3;
/// Maximum factor of dry friction over temperature, against thermal runaway.
const MAX_LEVEL: f64 = 3.0;

/// Friction that falls with speed: `rise exp(-|v|/speed)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StribeckTerm {
    /// Rise at speed 0: coefficient (bearing) or effort (axis).
    pub rise: f64,
    /// Speed in m/s over which the rise falls to 1/e.
    pub speed_m_s: f64,
}

/// Dry friction that changes at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTerm {
    /// Relative change (bearing) or effort (axis).
    pub change: f64,
    /// Time of the change in the log's time, s.
    pub time_s: f64,
}

impl StepTerm {
    /// Smooth step from 0 to the change.
    fn at(&self, time_s: f64) -> f64 {
        self.change * (0.5 * (1.0 + ((time_s - self.time_s) / STEP_WIDTH_S).tanh()))
    }
}

/// Static friction that builds up at standstill and is lost by sliding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BreakawayTerm {
    /// Excess after a long standstill: relative (bearing) or effort (axis).
    pub excess: f64,
    /// Time of standstill over which the excess builds up, s.
    pub rest_time_s: f64,
    /// Sliding distance over which the excess is lost, m.
    pub distance_m: f64,
}

impl BreakawayTerm {
    /// Rate of the memory (0 to 1) at a sliding speed, 1/s.
    pub(crate) fn rate_per_s(&self, memory: f64, sliding_m_s: f64) -> f64 {
        (1.0 - memory) / self.rest_time_s - sliding_m_s.abs() * memory / self.distance_m
    }

    /// Memory at a steady sliding speed, and the rate at which it is approached, 1/s.
    pub(crate) fn steady(&self, sliding_m_s: f64) -> (f64, f64) {
        let rate = 1.0 / self.rest_time_s + sliding_m_s.abs() / self.distance_m;
        (1.0 / (self.rest_time_s * rate), rate)
    }
}

/// Friction that depends on the temperature rise that it causes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalTerm {
    /// Relative change of dry friction per kelvin.
    pub level_per_k: f64,
    /// Temperature rise per heat flow, K/W.
    pub resistance_k_w: f64,
    /// Time constant of the rise, s.
    pub time_constant_s: f64,
}

impl ThermalTerm {
    /// Rate of the temperature rise in K/s under a heat flow.
    pub(crate) fn rate_k_s(&self, rise_k: f64, heat_w: f64) -> f64 {
        (self.resistance_k_w * heat_w - rise_k) / self.time_constant_s
    }

    /// Factor of dry friction at a temperature rise.
    pub(crate) fn level(&self, rise_k: f64) -> f64 {
        (1.0 + self.level_per_k * rise_k).clamp(0.0, MAX_LEVEL)
    }
}

/// A sinusoidal disturbance over time or position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RippleTerm {
    /// Amplitude of the cosine.
    pub cos: f64,
    /// Amplitude of the sine.
    pub sin: f64,
    /// Cycles per unit of the argument.
    pub per_unit: f64,
}

impl RippleTerm {
    fn phase(&self, argument: f64) -> f64 {
        core::f64::consts::TAU * self.per_unit * argument
    }

    /// Value at a time or a position.
    pub(crate) fn at(&self, argument: f64) -> f64 {
        let (sin, cos) = self.phase(argument).sin_cos();
        self.cos * cos + self.sin * sin
    }

    /// Integral over the argument; for a ripple over position the negative potential.
    pub(crate) fn integral(&self, argument: f64) -> f64 {
        let (sin, cos) = self.phase(argument).sin_cos();
        (self.cos * sin - self.sin * cos) / (core::f64::consts::TAU * self.per_unit)
    }
}

/// Sum of ripples at a time or a position.
pub(crate) fn ripples(terms: &[RippleTerm], argument: f64) -> f64 {
    terms.iter().map(|term| term.at(argument)).sum()
}

/// Lubricant film that is squeezed out between journal and bearing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmTerm {
    /// Viscosity, Pa s.
    pub viscosity_pa_s: f64,
    /// Minimum thickness, due to roughness, m.
    pub min_thickness_m: f64,
}

/// Courses that were read from files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoggedCourses {
    pub(in crate::description) drive: Option<Profile>,
    pub(in crate::description) load: Option<Profile>,
}
