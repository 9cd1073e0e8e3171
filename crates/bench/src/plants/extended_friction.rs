//! Friction of the clearance bearing with the effects that change it, planar or slice by slice.
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

use crate::description::Extension;

/// Reference of the load exponent, N.
const REFERENCE_N: f64 = 10e3;
/// Width of a change of friction, s: within one sample of a log, and smooth for the integrator.
pub(crate) const STEP_WIDTH_S: f64 = 2e-3;
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

/// Smooth step from 0 to 1 at a time.
pub(crate) fn smooth_step(time_s: f64, at_s: f64) -> f64 {
    0.5 * (1.0 + ((time_s - at_s) / STEP_WIDTH_S).tanh())
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
            dry *= 1.0 + term.change * smooth_step(time_s, term.time_s);
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
