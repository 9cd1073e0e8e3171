//! Spring and dashpot in parallel: Kelvin-Voigt, and the same with the dashpot set by a restitution
//! (Anagnostopoulos).
//!
//! `F = K d + c d'`, clamped at 0. Two relations connect its damping ratio `zeta = c/(2 sqrt(K m))`
//! with the restitution of a mass `m` in a free impact. They differ in the end of the contact:
//!
//! * at `d = 0`, after a phase in which the force pulls: `e = exp(-pi zeta/sqrt(1-zeta^2))`, hence
//!   `zeta = -ln e/sqrt(pi^2 + ln^2 e)`. By this relation Anagnostopoulos (1988, 2004) sets the
//!   dashpot.
//! * at `F = 0`, as here: `e = exp(-2 zeta/sqrt(1-zeta^2) acos zeta)` (Schwager and Poeschel 2007),
//!   which is larger. So a dashpot set by the first relation for `e = .4` produces .4720 without
//!   tension.
//!
//! Both are solutions of `m d'' + c d' + K d = 0` and are verified below by integrating it. The
//! second agrees with public implementations that quote its article; that Anagnostopoulos used the
//! first is recalled, not confirmed. The force jumps to `c d'0` at the onset, unlike every measured
//! contact: the known weakness of the model.

use crate::error::{LawError, above_zero, at_least_zero, expect};
use crate::real::Real;
use crate::stiffness::Stiffness;

/// `F = K d + c d'`, clamped at 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringDashpot<T = f64> {
    stiffness_n_m: T,
    damping_n_s_m: T,
}

impl<T: Real> SpringDashpot<T> {
    /// Kelvin-Voigt: `K` above 0 in N/m, `c` in N s/m.
    pub fn kelvin_voigt(stiffness_n_m: T, damping_n_s_m: T) -> Result<Self, LawError> {
        above_zero("stiffness (N/m)", stiffness_n_m)?;
        at_least_zero("damping (N s/m)", damping_n_s_m)?;
        Ok(Self { stiffness_n_m, damping_n_s_m })
    }

    /// Anagnostopoulos: `c = 2 zeta sqrt(K m)` with the damping ratio of a restitution `0 < e <= 1`
    /// at an effective mass in kg, `1/m = 1/m_1 + 1/m_2`.
    pub fn anagnostopoulos(stiffness_n_m: T, restitution: T, effective_mass_kg: T) -> Result<Self, LawError> {
        let e = restitution;
        expect("restitution", e, e > T::ZERO && e <= T::ONE, "above 0, at most 1")?;
        above_zero("stiffness (N/m)", stiffness_n_m)?;
        above_zero("effective mass (kg)", effective_mass_kg)?;
        let critical = T::from_f64(2.0) * (stiffness_n_m * effective_mass_kg).sqrt();
        Self::kelvin_voigt(stiffness_n_m, damping_ratio_for(e) * critical)
    }

    /// `c` in N s/m.
    pub fn damping_n_s_m(&self) -> T {
        self.damping_n_s_m
    }

    /// Elastic part.
    pub fn elastic(&self) -> Stiffness<T> {
        Stiffness::Linear { coefficient: self.stiffness_n_m }
    }

    /// Normal force in N, never negative.
    pub fn force_n(&self, deformation_m: T, rate_m_s: T) -> T {
        if deformation_m > T::ZERO {
            (self.stiffness_n_m * deformation_m + self.damping_n_s_m * rate_m_s).max(T::ZERO)
        } else {
            T::ZERO
        }
    }

    /// Restitution of a free impact of an effective mass in kg; 0 from critical damping on, where
    /// the contact only creeps back.
    pub fn produced_restitution(&self, effective_mass_kg: T) -> T {
        restitution_without_tension(
            self.damping_n_s_m / (T::from_f64(2.0) * (self.stiffness_n_m * effective_mass_kg).sqrt()),
        )
    }
}

/// Returns `zeta = -ln e/sqrt(pi^2 + ln^2 e)`: the damping ratio for a restitution `e` if the
/// dashpot may pull until `d = 0`.
pub(crate) fn damping_ratio_for<T: Real>(restitution: T) -> T {
    let logarithm = restitution.ln();
    let pi = T::from_f64(core::f64::consts::PI);
    -logarithm / (pi * pi + logarithm * logarithm).sqrt()
}

/// Returns `e = exp(-2 zeta/sqrt(1-zeta^2) acos zeta)`: the restitution if the contact ends with
/// its force.
///
/// At `zeta = 1` the limit is `exp(-2)`. Above it, with `acos` and the root replaced by their
/// hyperbolic forms, it falls further.
pub fn restitution_without_tension<T: Real>(damping_ratio: T) -> T {
    let zeta = damping_ratio;
    let two = T::from_f64(2.0);
    let gap = T::ONE - zeta * zeta;
    // acos(z)/sqrt(1-z^2) and its continuation ln(z + sqrt(z^2-1))/sqrt(z^2-1) are smooth at 1,
    // where both are 1.
    let quotient = if gap.abs() <= T::from_f64(16.0) * T::EPSILON {
        T::ONE
    } else if gap > T::ZERO {
        zeta.acos() / gap.sqrt()
    } else {
        let root = (-gap).sqrt();
        (zeta + root).ln() / root
    };
    (-two * zeta * quotient).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns rebound speed over approach speed of a spring and dashpot by RK4. The contact ends
    /// at `d = 0` if `pulls`, else at `F = 0`.
    fn rebound(zeta: f64, pulls: bool) -> f64 {
        let force = |d: f64, v: f64| d + 2.0 * zeta * v;
        let step = 1e-4;
        let (mut d, mut v) = (0.0, 1.0);
        loop {
            let (k1d, k1v) = (v, -force(d, v));
            let (k2d, k2v) = (v + 0.5 * step * k1v, -force(d + 0.5 * step * k1d, v + 0.5 * step * k1v));
            let (k3d, k3v) = (v + 0.5 * step * k2v, -force(d + 0.5 * step * k2d, v + 0.5 * step * k2v));
            let (k4d, k4v) = (v + step * k3v, -force(d + step * k3d, v + step * k3v));
            d += step / 6.0 * (k1d + 2.0 * k2d + 2.0 * k3d + k4d);
            v += step / 6.0 * (k1v + 2.0 * k2v + 2.0 * k3v + k4v);
            if if pulls { d <= 0.0 } else { force(d, v) <= 0.0 } {
                return -v;
            }
        }
    }

    #[test]
    fn both_relations_are_those_of_the_equation_of_motion() {
        for e in [0.1, 0.2, 0.4, 0.6, 0.8, 0.95] {
            let zeta = damping_ratio_for(e);
            assert!((rebound(zeta, true) - e).abs() < 2e-4, "pulling, e = {e}");
            let free = restitution_without_tension(zeta);
            assert!((rebound(zeta, false) - free).abs() < 2e-4, "free, e = {e}: {free}");
            assert!(free > e);
        }
        for zeta in [0.9, 1.0, 1.5] {
            let free = restitution_without_tension(zeta);
            assert!((rebound(zeta, false) - free).abs() < 2e-4, "zeta = {zeta}: {free}");
        }
    }

    #[test]
    fn without_tension_a_nominal_restitution_of_04_returns_more() {
        let law = SpringDashpot::anagnostopoulos(1e8, 0.4, 2.0).unwrap();
        assert!((law.produced_restitution(2.0) - 0.4720).abs() < 5e-5, "{}", law.produced_restitution(2.0));
        assert!((law.damping_n_s_m() - 2.0 * 0.280002 * 2e8_f64.sqrt()).abs() < 1.0);
    }

    #[test]
    fn bad_figures_are_refused() {
        assert!(SpringDashpot::kelvin_voigt(0.0, 1.0).is_err());
        assert!(SpringDashpot::kelvin_voigt(1.0, -1.0).is_err());
        assert!(SpringDashpot::anagnostopoulos(1.0, 0.0, 1.0).is_err());
        assert!(SpringDashpot::anagnostopoulos(1.0, 0.5, 0.0).is_err());
        assert_eq!(SpringDashpot::anagnostopoulos(1.0, 1.0, 1.0), SpringDashpot::kelvin_voigt(1.0, 0.0));
    }

    proptest! {
        #[test]
        fn it_never_pulls(d in -1e-3..1e-3_f64, rate in -1.0..1.0_f64) {
            let law = SpringDashpot::kelvin_voigt(1e7, 1e4).unwrap();
            prop_assert!(law.force_n(d, rate) >= 0.0);
            if d <= 0.0 { prop_assert_eq!(law.force_n(d, rate), 0.0); }
        }
    }
}
