//! True parameters and step of a driven axis. Units: SI, efforts in N or N m.

/// Step, s.
pub(super) const STEP_S: f64 = 2.5e-4;

/// An axis with its true parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RealAxis {
    /// True for a rotary axis.
    pub rotary: bool,
    /// Inertia, kg or kg m2.
    pub inertia: f64,
    /// Dry friction effort, N or N m.
    pub coulomb: f64,
    /// Viscous friction effort per speed.
    pub viscous: f64,
    /// Friction coefficient of the load.
    pub load_coefficient: f64,
    /// Share of the load that acts on the effort.
    pub load_gain: f64,
    /// Radius at which friction acts, m.
    pub radius_m: f64,
    /// Width of the friction sign, m/s.
    pub sign_width_m_s: f64,
    /// Temperature rise at the start of the log, relative to that of one second of sliding.
    pub warm: f64,
}
