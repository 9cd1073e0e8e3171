//! Force of the contact with its gradient over the filter's state.
//!
//! Elastic force: hybrid law of Bai and Zhao as the paper prints it, `K(d) = S(d) d^2` with `S(d) =
//! sqrt(2) (pi/8) E* (3D + 2d)/(D + d)^1.5`. Normal force `N = (1+e) K(d) (1 + r d')`, `r = e^l
//! chi/v` with the approach speed `v` of the onset. The filter moves every estimate of `l` into
//! `v`, so that `l` is 0 here. Friction `f = -(1+q) mu(v_t) N`.
//!
//! Near the onset the deformation is known no better than the clearance, and a tangent to the force
//! at its mean is no approximation: without contact it is 0 and would hide the clearance. The
//! square of the deformation is therefore replaced by its expectation over the normal distribution
//! of the deformation, restricted to contact, and the slope by that expectation's derivative.
//!
//! With the networks as the source of the contact, `K(d) (1 + r d')` and `mu` are multiplied by the
//! ratio of their forces to the law's at the last estimate ([`Ratios`]); the gradients stay the
//! law's, multiplied in the same way.

use super::arithmetic::{inverse_root, larger, smaller};
use super::configuration::FilterConfiguration;
use super::ratios::Ratios;
use super::state::{BIAS, Bias, CLEARANCE, FRICTION, Gradient, MOTION, Motion, STIFFNESS};
use crate::integrity::words;
use contact::FrictionLaw;
use core::f32::consts::{PI, SQRT_2};

/// Deviations beyond which the sign of the deformation is certain.
const CERTAIN: f32 = 4.0;
/// Least distance of the journal from the centre of the bearing, m: its direction must exist.
const MIN_DISTANCE_M: f32 = 1e-7;
/// Largest second derivative of tanh: 4/(3 sqrt 3).
const TANH_CURVATURE: f32 = 0.77;

/// Constants of the contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactModel {
    /// `sqrt(2) (pi/8) E*`, Pa.
    modulus: f32,
    clearance: f32,
    dissipation_factor: f32,
    /// Least approach speed that networks and law are evaluated at, m/s.
    floor: f32,
    friction: FrictionLaw<f32>,
}
words!(ContactModel { modulus, clearance, dissipation_factor, floor, friction });

/// Kinematics of the contact, SI units.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// Direction of the contact.
    pub(super) normal_y: f32,
    /// Direction of the contact.
    pub(super) normal_z: f32,
    /// 1 over the distance of the journal's centre from that of the bearing.
    nearness: f32,
    /// Deformation; negative without contact.
    pub(super) deformation: f32,
    /// Rate of the deformation.
    pub(super) rate: f32,
    /// Speed of the journal's centre around that of the bearing.
    pub(super) around: f32,
    /// Clearance with its estimated offset.
    gap: f32,
}
words!(Place { normal_y, normal_z, nearness, deformation, rate, around, gap });

/// Forces of the contact and their partial derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Forces {
    pub(super) place: Place,
    /// Normal force, 0 or more, N.
    pub(super) normal: f32,
    /// Friction force in the direction of positive sliding, N.
    pub(super) friction: f32,
    /// Error of the normal force's linear approximation, N.
    pub(super) normal_curvature: f32,
    /// Error of the friction force's linear approximation, N.
    pub(super) friction_curvature: f32,
    by_deformation: f32,
    by_rate: f32,
    by_stiffness: f32,
    by_damping: f32,
    by_sliding: f32,
    /// Friction per normal force.
    pub(super) by_normal: f32,
    pub(super) by_friction_factor: f32,
    /// Derivative of the sliding speed over the journal's Y speed, as far as the shaft turns.
    turning_slope: f32,
    /// Sliding speed, m/s.
    pub(super) sliding: f32,
    /// Normal force of the described law at this place, N.
    pub(super) law_normal: f32,
    /// Signed coefficient of the described friction law; 0 without contact.
    pub(super) law_coefficient: f32,
}
words!(Forces {
    place,
    normal,
    friction,
    normal_curvature,
    friction_curvature,
    by_deformation,
    by_rate,
    by_stiffness,
    by_damping,
    by_sliding,
    by_normal,
    by_friction_factor,
    turning_slope,
    sliding,
    law_normal,
    law_coefficient,
});

/// Standard deviations that decide how the contact is linearised.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Deviations {
    /// Deformation, m.
    pub(super) deformation: f32,
    /// Sliding speed, m/s.
    pub(super) sliding: f32,
    /// Stiffness factor.
    pub(super) stiffness: f32,
    /// Damping factor.
    pub(super) damping: f32,
}
words!(Deviations { deformation, sliding, stiffness, damping });

/// Motion of the shaft that a force depends on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turning {
    /// Speed of the surface, m/s.
    pub(super) surface: f32,
    /// Its derivative over the journal's Y speed.
    pub(super) slope: f32,
    /// Latched approach speed, m/s.
    pub(super) approach: f32,
    /// Forces of the networks over those of the law.
    pub(super) ratios: Ratios,
}

impl Place {
    /// Direction around the bearing: the normal turned by a quarter.
    pub(super) fn tangent(&self) -> (f32, f32) {
        (-self.normal_z, self.normal_y)
    }
}

impl Forces {
    /// No contact at a place.
    const fn none(place: Place, turning: &Turning) -> Self {
        Self {
            place,
            normal: 0.0,
            friction: 0.0,
            normal_curvature: 0.0,
            friction_curvature: 0.0,
            by_deformation: 0.0,
            by_rate: 0.0,
            by_stiffness: 0.0,
            by_damping: 0.0,
            by_sliding: 0.0,
            by_normal: 0.0,
            by_friction_factor: 0.0,
            turning_slope: turning.slope,
            sliding: turning.surface - place.around,
            law_normal: 0.0,
            law_coefficient: 0.0,
        }
    }

    /// Returns the gradient of the normal force.
    pub(super) fn normal_gradient(&self) -> Gradient {
        let place = self.place;
        let (tangent_y, tangent_z) = place.tangent();
        // The direction turns with the journal, and with it the radial part of the speed.
        let turned = self.by_rate * place.around * place.nearness;
        Gradient {
            motion: Motion::new(
                self.by_deformation * place.normal_y + turned * tangent_y,
                self.by_deformation * place.normal_z + turned * tangent_z,
                self.by_rate * place.normal_y,
                self.by_rate * place.normal_z,
            ),
            bias: Bias::new(0.0, self.by_stiffness, -self.by_deformation, 0.0, self.by_damping, 0.0),
        }
    }

    /// Returns the derivatives of the friction force over the motion at the same normal force.
    pub(super) fn sliding_gradient(&self) -> Motion {
        let place = self.place;
        let (tangent_y, tangent_z) = place.tangent();
        let turned = self.by_sliding * place.rate * place.nearness;
        Motion::new(
            turned * tangent_y,
            turned * tangent_z,
            self.by_sliding * (self.turning_slope - tangent_y),
            -self.by_sliding * tangent_z,
        )
    }

    /// Returns force components on the journal, Y and Z.
    pub(super) fn components(&self) -> (f32, f32) {
        let Place { normal_y, normal_z, .. } = self.place;
        (
            self.friction * normal_z - self.normal * normal_y,
            -self.normal * normal_z - self.friction * normal_y,
        )
    }

    /// Returns the derivatives of the force components over the position as far as the direction of
    /// the contact turns, each over Y and Z.
    pub(super) fn turning_gradients(&self) -> ((f32, f32), (f32, f32)) {
        let Place { normal_y, normal_z, nearness, .. } = self.place;
        let along = (self.friction * normal_y + self.normal * normal_z) * nearness;
        let across = (self.friction * normal_z - self.normal * normal_y) * nearness;
        ((-along * normal_z, along * normal_y), (-across * normal_z, across * normal_y))
    }
}

impl ContactModel {
    pub(super) fn new(config: &FilterConfiguration) -> Self {
        Self {
            modulus: SQRT_2 * PI / 8.0 * config.effective_modulus_pa,
            clearance: config.radial_clearance_m,
            dissipation_factor: config.dissipation_factor,
            floor: config.latch_floor_m_s,
            friction: config.friction,
        }
    }

    /// Returns the kinematics of the contact at a state.
    pub(super) fn place(&self, motion: &Motion, bias: &Bias) -> Place {
        let [y, z, speed_y, speed_z] = (*motion).into();
        let square = larger(y * y + z * z, MIN_DISTANCE_M * MIN_DISTANCE_M);
        let nearness = inverse_root(square);
        let (normal_y, normal_z) = (y * nearness, z * nearness);
        let gap = larger(self.clearance + bias[CLEARANCE], MIN_DISTANCE_M);
        Place {
            normal_y,
            normal_z,
            nearness,
            deformation: square * nearness - gap,
            rate: normal_y * speed_y + normal_z * speed_z,
            around: normal_y * speed_z - normal_z * speed_y,
            gap,
        }
    }

    /// Returns force over the square of the deformation, `S(d)`, in N/m2, and its derivative.
    fn shape(&self, gap: f32, deformation: f32) -> (f32, f32) {
        let size = 3.0 * gap + 2.0 * deformation;
        let root = inverse_root(gap + deformation);
        let square = root * root;
        let power = self.modulus * square * root;
        (power * size, power * (2.0 - 1.5 * size * square))
    }

    /// Returns the elastic force of a deformation as large as the noise of the position sensors, N:
    /// the smallest deviation that an estimate may claim.
    pub(super) fn force_of_noise(&self, noise: f32) -> f32 {
        self.shape(self.clearance, 0.0).0 * noise * noise
    }

    /// Returns the forces at a place.
    pub(super) fn forces(&self, place: Place, bias: &Bias, turning: &Turning, sds: &Deviations) -> Forces {
        let mut forces = Forces::none(place, turning);
        if place.deformation <= -CERTAIN * sds.deformation {
            return forces;
        }
        self.add_normal(&mut forces, bias, turning, sds);
        if forces.normal > 0.0 {
            self.add_friction(&mut forces, bias, turning, sds);
        }
        forces
    }

    /// Adds the normal force with its derivatives.
    fn add_normal(&self, forces: &mut Forces, bias: &Bias, turning: &Turning, sds: &Deviations) {
        let place = forces.place;
        let (square, twice) = contact_moments(place.deformation, sds.deformation);
        let (shape, shape_slope) = self.shape(place.gap, larger(place.deformation, 0.0));
        let ratio = self.dissipation_factor / turning.approach;
        let stiffness = (1.0 + bias[STIFFNESS]) * turning.ratios.normal;
        let damping = 1.0 + ratio * place.rate;
        let elastic = shape * square;
        let normal = stiffness * elastic * damping;
        let touching = larger(place.deformation, 0.0);
        let described = 1.0 + self.dissipation_factor / larger(turning.approach, self.floor) * place.rate;
        forces.law_normal = larger(shape * touching * touching * described, 0.0);
        if normal <= 0.0 {
            // The damping takes back the elastic force, as far as the rate is known.
            forces.normal_curvature = stiffness * elastic;
            return;
        }
        forces.normal = normal;
        forces.by_deformation = stiffness * damping * (shape * twice + shape_slope * square);
        forces.by_rate = stiffness * elastic * ratio;
        forces.by_stiffness = turning.ratios.normal * elastic * damping;
        forces.by_damping = stiffness * elastic * ratio * place.rate;
        // Second-order terms: the square of the deformation, and products of uncertain factors.
        let deformation = (forces.by_deformation * sds.deformation).abs();
        let stiffness = (forces.by_stiffness * sds.stiffness).abs();
        let damping = (forces.by_damping * sds.damping).abs();
        let products = deformation * damping + stiffness * (deformation + damping);
        forces.normal_curvature =
            SQRT_2 * shape * sds.deformation * sds.deformation + products / larger(normal, 1.0);
    }

    /// Adds friction with its derivatives.
    fn add_friction(&self, forces: &mut Forces, bias: &Bias, turning: &Turning, sds: &Deviations) {
        let sliding = forces.sliding;
        let (coefficient, slope) = self.friction.signed_coefficient(sliding);
        let level = (1.0 + bias[FRICTION]) * turning.ratios.friction;
        forces.law_coefficient = coefficient;
        forces.by_normal = -level * coefficient;
        forces.friction = forces.by_normal * forces.normal;
        forces.by_sliding = -level * slope * forces.normal;
        forces.by_friction_factor = -turning.ratios.friction * coefficient * forces.normal;
        let width = self.friction.regularisation_m_s;
        if sliding.abs() < 3.0 * width {
            let ratio = sds.sliding / width;
            let steepest = self.friction.static_coefficient * forces.normal;
            forces.friction_curvature = smaller(0.5 * TANH_CURVATURE * ratio * ratio, 0.3) * steepest;
        }
    }
}

/// Returns the expectation of `max(d, 0)^2` and its derivative for a normally distributed `d`.
fn contact_moments(mean: f32, deviation: f32) -> (f32, f32) {
    let ratio = mean / deviation;
    if ratio >= CERTAIN {
        return (mean * mean + deviation * deviation, 2.0 * mean);
    }
    let density = 0.398_942_3 * libm::expf(-0.5 * ratio * ratio);
    // Abramowitz and Stegun, formula 26.2.17, error below 1e-7.
    let t = 1.0 / (1.0 + 0.231_641_9 * ratio.abs());
    let series = 0.319_381_53 + t * (-0.356_563_78 + t * (1.781_477_9 + t * (-1.821_256 + t * 1.330_274_4)));
    let tail = density * t * series;
    let touching = if ratio > 0.0 { 1.0 - tail } else { tail };
    let first = mean * touching + deviation * density;
    (mean * first + deviation * deviation * touching, 2.0 * first)
}

const _: () = assert!(MOTION == 4 && BIAS == 6);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::configuration::BENCH_B;
    use crate::estimator::filter_configuration;
    use contact::BearingMaterial;

    #[test]
    fn a_force_that_the_damping_takes_back_is_as_uncertain_as_the_elastic_force() {
        let bench = filter_configuration(BearingMaterial::Babbitt, &BENCH_B.bench, &BENCH_B.monitor);
        let contact = ContactModel::new(&bench);
        let forces = |rate: f32| {
            let motion = Motion::new(bench.radial_clearance_m + 2e-5, 0.0, rate, 0.0);
            let (bias, sds) = (Bias::zeros(), Deviations { deformation: 1e-6, ..Deviations::default() });
            let turning = Turning { surface: 0.0, slope: 0.0, approach: 0.1, ratios: Ratios::LAW };
            contact.forces(contact.place(&motion, &bias), &bias, &turning, &sds)
        };
        let (resting, leaving) = (forces(0.0), forces(-1.0));
        assert!(resting.normal > 1e3 && leaving.normal == 0.0, "{resting:?} {leaving:?}");
        assert!((leaving.normal_curvature / resting.normal - 1.0).abs() < 1e-3, "{leaving:?}");
    }
}
