//! Comparison of the networks' normal force with the analytic law at the same contact.
//!
//! ```text
//! F_law = F_el (1 + chi d'/v0)
//! F_el  = c d^2 (3D + 2d)/(D + d)^1.5,  c = sqrt(2) (pi/8) E*
//! outside the envelope: |F_net - F_law| > share F_el (1 + |chi d'/v0|) + floor
//! ```
//!
//! `F_law` is the hybrid law as printed.
//!
//! Deformation, rate and approach speed are the inputs of the networks: the comparison tests the
//! networks, not the conditioning. The share covers the legitimate differences: the error of the
//! networks, the earlier samples that they depend on, and a configured modulus that is not the
//! trained one. An estimate with a flag about training range, warming up or an unfilled window is
//! not compared.
//!
//! One sample in four is compared: corrupted weights stay corrupted for longer.
//!
//! A law that is NaN (a clearance of 0) is never exceeded; the ranges of the configuration exclude
//! it.

use inference::{ContactState, Flags};
use link::track::MonitorConfiguration;

use crate::flags::WINDOW_FILLING;
use crate::integrity::words;
use crate::tracking::{at_least, at_most};

/// Flags that exclude an estimate from the comparison.
pub(super) const EXCUSED: Flags = Flags::from_bits(
    Flags::OUTSIDE_TRAINING.bits()
        | Flags::SATURATED.bits()
        | Flags::NON_FINITE.bits()
        | Flags::WARMING_UP.bits()
        | Flags::MISSING.bits()
        | WINDOW_FILLING.bits(),
);

/// The envelope of one bench.
#[derive(Clone, Debug)]
pub(super) struct Envelope {
    modulus_factor: f32,
    damping: f32,
    share: f32,
    floor_n: f32,
}
words!(Envelope { modulus_factor, damping, share, floor_n });

/// State of an [`Envelope`].
#[derive(Clone, Debug)]
pub(super) struct EnvelopeState {
    /// Root of the journal's distance from the centre, m^0.5. One step of Newton's iteration a
    /// sample follows the distance, which moves little between two samples.
    root: f32,
}

impl Envelope {
    /// Prepares the envelope of a configuration.
    pub(super) fn new(monitor: &MonitorConfiguration) -> Self {
        Self {
            modulus_factor: core::f32::consts::SQRT_2
                * (core::f32::consts::PI / 8.0)
                * (monitor.effective_modulus_kpa as f32 * 1e3),
            damping: monitor.damping_per_mille as f32 * 1e-3,
            share: monitor.envelope_per_mille as f32 * 1e-3,
            floor_n: monitor.envelope_floor_mn as f32 * 1e-3,
        }
    }

    /// Returns true if a normal force is outside the envelope of the law at a contact.
    pub(super) fn is_outside(
        &self,
        state: &mut EnvelopeState,
        contact: &ContactState,
        normal_force_n: f32,
    ) -> bool {
        let clearance_m = contact.radial_clearance_m;
        let deformation_m = at_most(at_least(contact.deformation_m, 0.0), clearance_m + 1e-3);
        let distance_m = clearance_m + deformation_m;
        state.root = 0.5 * (state.root + distance_m / state.root);
        let elastic_n =
            self.modulus_factor * (deformation_m * deformation_m) * (3.0 * clearance_m + 2.0 * deformation_m)
                / (distance_m * state.root);
        let damping = self.damping * contact.deformation_rate_m_s / contact.approach_speed_m_s;
        let law_n = at_least(elastic_n * (1.0 + damping), 0.0);
        let width_n = self.share * elastic_n * (1.0 + damping.abs()) + self.floor_n;
        (normal_force_n - law_n).abs() > width_n
    }
}

impl EnvelopeState {
    /// Starts at the edge of the clearance.
    pub(super) fn new(radial_clearance_nm: u32) -> Self {
        Self { root: libm::sqrtf(radial_clearance_nm as f32 * 1e-9) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::configuration::BENCH_B;
    use contact::BearingMaterial;

    #[test]
    fn the_envelope_has_the_configured_width_around_the_law() {
        let monitor =
            MonitorConfiguration { envelope_per_mille: 100, envelope_floor_mn: 50_000, ..BENCH_B.monitor };
        for clearance_m in [0.1e-3, 0.5e-3, 1e-3] {
            let law = BearingMaterial::Babbitt.normal_law(clearance_m, 1e-3);
            for (deformation_m, rate_m_s) in [(1e-6, 0.0), (20e-6, 0.5e-3), (40e-6, -0.4e-3), (90e-6, 1e-3)] {
                let state = ContactState {
                    radial_clearance_m: clearance_m as f32,
                    deformation_m: deformation_m as f32,
                    deformation_rate_m_s: rate_m_s as f32,
                    approach_speed_m_s: 3e-3,
                    sliding_speed_m_s: 0.1,
                };
                let elastic = law.force_n(deformation_m, 0.0, 3e-3);
                let expected = law.force_n(deformation_m, rate_m_s, 3e-3);
                let width = 0.1 * elastic * (1.0 + (expected / elastic - 1.0).abs()) + 50.0;
                let envelope = Envelope::new(&monitor);
                let mut root = EnvelopeState::new((clearance_m * 1e9) as u32);
                let mut outside = |force: f64| {
                    // The root needs a few samples after a jump of the distance.
                    (0..4).map(|_| envelope.is_outside(&mut root, &state, force as f32)).last().unwrap()
                };
                for sign in [-1.0, 1.0] {
                    assert!(!outside(expected + sign * 0.98 * width), "{state:?}");
                    assert!(outside(expected + sign * 1.02 * width), "{state:?}");
                }
            }
        }
    }
}
