//! Terms that the nominal plants leave out and effects switch on. Without any term a plant is
//! nominal. Their equations are in `crate::effects`; their use is in `crate::plants`.

use crate::signals::Profile;

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
    pub(super) drive: Option<Profile>,
    pub(super) load: Option<Profile>,
}

/// Terms of the transmission bench.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extension {
    /// Courses of drive and load that were read from files.
    pub courses: LoggedCourses,
    /// Friction force on the journal per sliding speed, N s/m.
    pub viscous_n_s_m: f64,
    /// Friction force per sliding speed that reverses its sign in backward sliding, N s/m.
    pub viscous_asymmetry_n_s_m: f64,
    /// Relative change of the friction level, with opposite signs in the two directions.
    pub coulomb_asymmetry: f64,
    /// Exponent of the normal force in the coefficient.
    pub load_exponent: f64,
    /// Friction that falls with speed.
    pub stribeck: Vec<StribeckTerm>,
    /// Changes of dry friction.
    pub friction_steps: Vec<StepTerm>,
    /// Static friction after a standstill.
    pub breakaway: Option<BreakawayTerm>,
    /// Sliding distance over which friction reverses, m; 0: none.
    pub presliding_distance_m: f64,
    /// Friction over temperature.
    pub thermal: Option<ThermalTerm>,
    /// Temperature rise at the first sample, K: a per-log parameter that no effect sets.
    pub temperature_start_k: f64,
    /// Compliance of the hydraulic column between drive cylinder and fork, m/N.
    pub hydraulic_compliance_m_n: f64,
    /// Lag of the fork after the drive cylinder, s.
    pub drive_lag_s: f64,
    /// Play of the fork in addition to that of `[fork]`, m.
    pub backlash_m: f64,
    /// Ripple of the load over time, N.
    pub load_ripples: Vec<RippleTerm>,
    /// Torque on the shaft over its angle, N m.
    pub position_ripples: Vec<RippleTerm>,
    /// Torsional compliance of the shaft between drive and load crank, rad/(N m).
    pub shaft_compliance_rad_nm: f64,
    /// Second harmonic of the journal's radius over its angle: cosine and sine, m.
    pub out_of_round_m: [f64; 2],
    /// Film in the clearance.
    pub film: Option<FilmTerm>,
}

/// Terms of a driven axis; efforts in N or N m.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisExtension {
    /// Viscous effort per speed that reverses its sign in backward motion.
    pub viscous_asymmetry: f64,
    /// Dry friction per displacement from the neutral position.
    pub friction_slope: f64,
    /// Effort that falls with speed.
    pub stribeck: Vec<StribeckTerm>,
    /// Changes of dry friction.
    pub friction_steps: Vec<StepTerm>,
    /// Static friction after a rest.
    pub breakaway: Option<BreakawayTerm>,
    /// Sliding distance over which friction reverses, m at the friction radius; 0: none.
    pub presliding_distance_m: f64,
    /// Friction over temperature.
    pub thermal: Option<ThermalTerm>,
    /// Temperature rise at the first sample, K: a per-log parameter that no effect sets.
    pub temperature_start_k: f64,
    /// Lag of the axis after its logged motion, s.
    pub drive_lag_s: f64,
    /// Ripple of the load over time, N.
    pub load_ripples: Vec<RippleTerm>,
    /// Effort over position.
    pub position_ripples: Vec<RippleTerm>,
}
