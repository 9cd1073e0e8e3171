//! The networks' normal force against the analytic law at the same contact.
//!
//! ```text
//! F_law = F_el (1 + chi d'/v0),  F_el = c d^2 (3D + 2d)/(D + d)^1.5,  c = sqrt(2) (pi/8) E*     the printed hybrid law
//! |F_net - F_law| > share F_el (1 + |chi d'/v0|) + floor                                       outside
//! ```
//!
//! The deformation, its rate and the approach speed are those that the networks got: what is tested is the networks, not the
//! conditioning. The share covers what they may differ by: their own error, the samples before the newest that they look at, a
//! modulus of the configuration that is not the trained one. An estimate that carries a remark of its own about training range, warming
//! up or an unfilled window is not held against the law; it already says that it is not to be compared.
//!
//! One sample in four is looked at: altered weights are altered for longer.
//!
//! A law that came out as no number (a clearance of 0) is never exceeded; the configuration's ranges rule it out.

use inference::{ContactState, Flags};
use link::track::MonitorConfiguration;

use crate::constants::Sum;
use crate::flags::WINDOW_FILLING;
use crate::tracking::{at_least, at_most};

/// Remarks that excuse an estimate from the comparison.
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
pub struct Envelope {
    modulus_factor: f32,
    damping: f32,
    share: f32,
    floor_n: f32,
    /// Root of the journal's distance from the centre, in m^0.5: kept from sample to sample, as the distance moves little between two.
    root: f32,
}

impl Envelope {
    /// The envelope that a configuration asks for.
    #[must_use]
    pub fn new(radial_clearance_nm: u32, monitor: &MonitorConfiguration) -> Self {
        Self {
            modulus_factor: core::f32::consts::SQRT_2
                * (core::f32::consts::PI / 8.0)
                * (monitor.effective_modulus_kpa as f32 * 1e3),
            damping: monitor.damping_per_mille as f32 * 1e-3,
            share: monitor.envelope_per_mille as f32 * 1e-3,
            floor_n: monitor.envelope_floor_mn as f32 * 1e-3,
            root: libm::sqrtf(radial_clearance_nm as f32 * 1e-9),
        }
    }

    pub(super) fn constants(&self, sum: &mut Sum) {
        sum.floats(&[self.modulus_factor, self.damping, self.share, self.floor_n]);
    }

    /// Whether a normal force is outside the envelope of the law at a contact.
    pub fn is_outside(&mut self, state: &ContactState, normal_force_n: f32) -> bool {
        let clearance_m = state.radial_clearance_m;
        let deformation_m = at_most(at_least(state.deformation_m, 0.0), clearance_m + 1e-3);
        let distance_m = clearance_m + deformation_m;
        self.root = 0.5 * (self.root + distance_m / self.root);
        let elastic_n =
            self.modulus_factor * (deformation_m * deformation_m) * (3.0 * clearance_m + 2.0 * deformation_m)
                / (distance_m * self.root);
        let damping = self.damping * state.deformation_rate_m_s / state.approach_speed_m_s;
        let law_n = at_least(elastic_n * (1.0 + damping), 0.0);
        let width_n = self.share * elastic_n * (1.0 + damping.abs()) + self.floor_n;
        (normal_force_n - law_n).abs() > width_n
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::configuration::BENCH_B;
    use contact::{Dissipation, Material, NormalLaw, Stiffness, effective_modulus_pa};

    #[test]
    fn the_middle_of_the_envelope_is_the_law_and_its_ends_are_as_far_as_configured() {
        let monitor =
            MonitorConfiguration { envelope_per_mille: 100, envelope_floor_mn: 50_000, ..BENCH_B.monitor };
        for clearance_m in [0.1e-3, 0.5e-3, 1e-3] {
            let law = NormalLaw {
                stiffness: Stiffness::HybridAsPrinted {
                    effective_modulus_pa: effective_modulus_pa(&Material::BABBITT, &Material::STEEL),
                    radial_clearance_m: clearance_m,
                },
                dissipation: Dissipation::ZhiyingQishao,
                restitution: 0.4,
                latch_floor_m_s: 1e-3,
            };
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
                let mut envelope = Envelope::new((clearance_m * 1e9) as u32, &monitor);
                let mut outside = |force: f64| {
                    // The kept root needs a few samples after a leap of the distance.
                    (0..4).map(|_| envelope.is_outside(&state, force as f32)).last().unwrap()
                };
                for sign in [-1.0, 1.0] {
                    assert!(!outside(expected + sign * 0.98 * width), "{state:?}");
                    assert!(outside(expected + sign * 1.02 * width), "{state:?}");
                }
            }
        }
    }
}
