//! Terms of the transmission bench, and the friction of its bearing, planar or slice by slice.
//!
//! The dry friction `F` of the described law (or of a network) at sliding speed `v` becomes
//!
//! ```text
//! F' = (F - N sum rise e^(-|v|/v_s) s) (1 + a s) (N/10 kN)^k (1 + x m)
//!      (1 + sum c H(t - t_0)) (1 + b dT) w/s - c_v v - c_a |v|,          s = tanh(v/v_r)
//! ```
//!
//! with three memories. Standstill: `m' = (1 - m)/t_r - |v| m/d` (ageing law of rate-and-state
//! friction, Dieterich 1979). Temperature rise: `dT' = (R_th P - dT)/tau`. Pre-sliding: `w' = |v|
//! (s - w)/d_0`, with `w` in place of `s`; the sign reverses exponentially over distance (Dahl 1968
//! with exponent 1), and as `d_0` goes to 0 `w` becomes `s`.

use super::{BreakawayTerm, FilmTerm, LoggedCourses, RippleTerm, StepTerm, StribeckTerm, ThermalTerm};

/// Reference of the load exponent, N.
const REFERENCE_N: f64 = 10e3;
/// Sign below which pre-sliding is not applied, as nothing slides.
const MIN_SIGN: f64 = 1e-9;

/// Memory of friction.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Memory {
    /// Deflection of the law's bristles in m, or the pre-sliding sign.
    pub(crate) bristle: f64,
    /// Share of the excess that a standstill has built up.
    pub(crate) breakaway: f64,
    /// Temperature rise in K.
    pub(crate) rise_k: f64,
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

impl Extension {
    /// Returns whether friction is that of the described law.
    pub(crate) fn leaves_friction(&self) -> bool {
        self.viscous_n_s_m == 0.0
            && self.viscous_asymmetry_n_s_m == 0.0
            && self.coulomb_asymmetry == 0.0
            && self.load_exponent == 0.0
            && self.stribeck.is_empty()
            && self.friction_steps.is_empty()
            && self.breakaway.is_none()
            && self.presliding_distance_m == 0.0
            && self.thermal.is_none()
    }

    /// Friction in N along the sliding direction of a bearing under `normal_n`, if its described
    /// law gives `dry_n`. `sign` is that of the sliding speed, regularised unless the law sticks.
    pub(crate) fn friction_n(
        &self,
        time_s: f64,
        normal_n: f64,
        dry_n: f64,
        v: f64,
        sign: f64,
        memory: &Memory,
    ) -> f64 {
        let mut dry = dry_n;
        for term in &self.stribeck {
            dry -= term.rise * normal_n * (-v.abs() / term.speed_m_s).exp() * sign;
        }
        dry *= 1.0 + self.coulomb_asymmetry * sign;
        if self.load_exponent != 0.0 && normal_n > 0.0 {
            dry *= (normal_n / REFERENCE_N).powf(self.load_exponent);
        }
        if let Some(term) = &self.breakaway {
            dry *= 1.0 + term.excess * memory.breakaway;
        }
        for term in &self.friction_steps {
            dry *= 1.0 + term.at(time_s);
        }
        if let Some(term) = &self.thermal {
            dry *= term.level(memory.rise_k);
        }
        if self.presliding_distance_m > 0.0 && sign.abs() > MIN_SIGN {
            dry *= memory.bristle / sign;
        }
        dry - self.viscous_n_s_m * v - self.viscous_asymmetry_n_s_m * v * sign
    }
}
