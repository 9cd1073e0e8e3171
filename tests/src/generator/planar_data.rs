//! Parameters, hidden effects, state and outputs of the planar transmission bench.

/// Hidden effects of a log.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hidden {
    /// Wear: added radial clearance in m.
    pub clearance_m: f64,
    /// Relative change of dry friction.
    pub friction: f64,
    /// Friction force per sliding speed, N s/m.
    pub viscous_n_s_m: f64,
    /// Compliance between cylinder and fork, m/N.
    pub compliance_m_n: f64,
    /// Delay of the journal's Y sensor in s.
    pub journal_y_delay_s: f64,
    /// Offset of the bearing's Y force sensor in N.
    pub force_y_offset_n: f64,
    /// Force on the journal along Z at the drive's third harmonic, N: an effect outside of every
    /// catalogue.
    pub third_harmonic_n: f64,
}

/// A real bench: close to its description, but not equal.
#[derive(Clone, Copy, Debug)]
pub struct RealBench {
    /// Drive and load crank, m.
    pub levers_m: (f64, f64),
    /// Mass in kg and inertia in kg m2.
    pub inertia: (f64, f64),
    /// Radial clearance, m.
    pub clearance_m: f64,
    /// Young's modulus, Pa.
    pub modulus_pa: f64,
    /// Factor on friction.
    pub friction: f64,
    /// Load, N.
    pub load_n: f64,
    /// Number of cycles of 1 s.
    pub cycles: usize,
    /// Correlation of the sensor noise from sample to sample; 0: white.
    pub noise_colour: f64,
    /// True if the shaft may tilt in its bearing.
    pub tilts: bool,
}

/// State: y, z, y', z', th, th' (the last two for a compliant drive only), angle and speed of the
/// load crank on a shaft that twists, slopes of the shaft in Y and Z and their rates.
pub(super) type State = [f64; 12];

/// Quantities of a step.
pub(super) struct Row {
    pub(super) drive: (f64, f64),
    pub(super) load: f64,
    /// Angle, speed, y, z, F_cy, F_cz, T_f, fork force.
    pub(super) outputs: [f64; 8],
}
