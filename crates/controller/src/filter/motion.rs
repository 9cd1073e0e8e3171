//! Equations of motion of the journal and a step of them that is stable at any stiffness.
//!
//! The crank pin follows the drive, so the angle is no state: `sin th = (x - y)/R_d`, `R_c = R_d
//! cos th`, `th' = (x' - y')/R_c`. With the bearing's force `(F_y, F_z)` and friction `f`:
//!
//! `(m + J/R_c^2) y'' = J/R_c^2 (x'' + R_d sin th th'^2) + F_L (1 - R_l/R_d) + W + F_y - f R_J/R_c`
//!
//! `m z'' = F_z - m g`
//!
//! The contact's damping brings rates of up to eight per sample. The step is Rosenbrock's with two
//! stages and `gamma = 1 - 1/sqrt 2` (Verwer et al., SIAM J. Sci. Comput. 20, 1999): L-stable, of
//! second order. Positions are integrals of speeds, so its linear systems reduce to two by two. The
//! transition of the covariance is the derivative of the same step.

use super::arithmetic::{inverse_root, larger, root};
use super::configuration::{FilterConfiguration, GRAVITY};
use super::contact::{ContactModel, Deviations, Forces, Place, Turning};
use super::drive::DriveMotion;
use super::ratios::Ratios;
use super::state::{
    Bias, Covariance, DAMPING, FRICTION, Gradient, MASS, Motion, Pair, RESIDUAL, STIFFNESS, Transition,
};
use crate::integrity::words;
use nalgebra::Matrix2;

/// `1 - 1/sqrt 2`.
const GAMMA: f32 = 0.292_893_22;
/// Largest magnitude of the crank's sine. Beyond 72 degrees a crank is near its dead point.
const MAX_SINE: f32 = 0.95;
/// Least determinant of a step's linear system; that of a stable contact is 1 or more.
const MIN_DETERMINANT: f32 = 1e-3;
/// Least standard deviation of the deformation, m.
const MIN_DEVIATION_M: f32 = 1e-10;

/// Constants of the motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dynamics {
    pub(super) contact: ContactModel,
    mass: f32,
    inertia: f32,
    drive_lever: f32,
    inverse_drive_lever: f32,
    load_share: f32,
    journal_radius: f32,
    time: f32,
    /// Share of the residual force that is left after a sample.
    residual_share: f32,
}
words!(Dynamics {
    contact,
    mass,
    inertia,
    drive_lever,
    inverse_drive_lever,
    load_share,
    journal_radius,
    time,
    residual_share,
});

/// Inputs of the equations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inputs {
    pub(super) drive: DriveMotion,
    pub(super) load: f32,
    pub(super) approach: f32,
    pub(super) ratios: Ratios,
}

/// Crank at a state.
#[derive(Clone, Copy, Debug)]
struct Crank {
    sine: f32,
    /// 1 over the crank's length across the drive's direction, 1/m.
    nearness: f32,
    turning: f32,
}

/// Crank and contact at a state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Located {
    crank: Crank,
    pub(super) place: Place,
}

/// Accelerations of the journal and what they consist of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evaluated {
    acceleration: Pair,
    /// Force of the drive on the crank pin, N.
    pub(super) drive_force: f32,
    pub(super) forces: Forces,
    /// Radius of the journal over the lever of the crank.
    arm: f32,
    /// Described mass of the shaft, kg.
    mass: f32,
    /// Accelerations per force along Y and Z, 1/kg.
    per_y: f32,
    per_z: f32,
}
words!(Evaluated { acceleration, drive_force, forces, arm, mass, per_y, per_z });

/// Gradients of the accelerations.
struct Linearised {
    /// Over the positions.
    by_position: Matrix2<f32>,
    /// Over the speeds.
    by_speed: Matrix2<f32>,
    /// Over the bias, along Y and Z.
    by_bias: [Bias; 2],
}

/// Result of a step.
pub(super) struct Step {
    pub(super) motion: Motion,
    pub(super) transition: Transition,
    /// Covariance of the speeds that the second-order terms of the forces add.
    pub(super) curvature: Matrix2<f32>,
}

impl Dynamics {
    pub(super) fn new(config: &FilterConfiguration) -> Self {
        Self {
            contact: ContactModel::new(config),
            mass: config.mass_kg,
            inertia: config.inertia_kg_m2,
            drive_lever: config.drive_lever_m,
            inverse_drive_lever: 1.0 / config.drive_lever_m,
            load_share: 1.0 - config.load_lever_m / config.drive_lever_m,
            journal_radius: config.journal_radius_m,
            time: config.sample_period_s,
            residual_share: 1.0 / (1.0 + config.sample_period_s / config.residual_time()),
        }
    }

    /// Returns crank and contact at a state.
    pub(super) fn locate(&self, motion: &Motion, bias: &Bias, drive: &DriveMotion) -> Located {
        let sine = ((drive.displacement - motion.x) * self.inverse_drive_lever).clamp(-MAX_SINE, MAX_SINE);
        let nearness = self.inverse_drive_lever * inverse_root(1.0 - sine * sine);
        let turning = (drive.speed - motion.z) * nearness;
        Located { crank: Crank { sine, nearness, turning }, place: self.contact.place(motion, bias) }
    }

    /// Returns the standard deviations that decide how the contact is linearised.
    pub(super) fn deviations(&self, at: &Located, covariance: &Covariance) -> Deviations {
        let Located { crank, place } = at;
        let (tangent_y, tangent_z) = place.tangent();
        let slip = -self.journal_radius * crank.nearness - tangent_y;
        Deviations {
            deformation: larger(
                root(covariance.deformation_variance(place.normal_y, place.normal_z)),
                MIN_DEVIATION_M,
            ),
            sliding: root(covariance.speed_variance(slip, -tangent_z)),
            stiffness: root(covariance.bias_variance(STIFFNESS)),
            damping: root(covariance.bias_variance(DAMPING)),
        }
    }

    /// Returns accelerations and forces where crank and contact have been located.
    pub(super) fn evaluate(
        &self,
        at: &Located,
        bias: &Bias,
        inputs: &Inputs,
        deviations: &Deviations,
    ) -> Evaluated {
        let Crank { sine, nearness, turning } = at.crank;
        let arm = self.journal_radius * nearness;
        let Inputs { approach, ratios, .. } = *inputs;
        let surface = Turning { surface: turning * self.journal_radius, slope: -arm, approach, ratios };
        let forces = self.contact.forces(at.place, bias, &surface, deviations);
        let reflected = self.inertia * nearness * nearness;
        let mass = self.mass * (1.0 + bias[MASS]);
        let (per_y, per_z) = (1.0 / (mass + reflected), 1.0 / mass);
        let (force_y, force_z) = forces.components();
        let driven = reflected * (inputs.drive.acceleration + self.drive_lever * sine * turning * turning);
        let along = driven + inputs.load * self.load_share + bias[RESIDUAL] + force_y - forces.friction * arm;
        let acceleration = Pair::new(along * per_y, force_z * per_z - GRAVITY);
        let drive_force = mass * acceleration.x - inputs.load - force_y;
        Evaluated { acceleration, drive_force, forces, arm, mass: self.mass, per_y, per_z }
    }

    /// Advances the motion by a sample, from the evaluated start; `inputs` at its end.
    pub(super) fn step(
        &self,
        motion: &Motion,
        bias: &Bias,
        start: &Evaluated,
        inputs: &Inputs,
        deviations: &Deviations,
    ) -> Step {
        let time = self.time;
        let linearised = start.linearised();
        let solver = Solver::new(&linearised, time);
        let (positions, speeds) = split(motion);
        let (first_p, first_v) = solver.solve(speeds, start.acceleration);
        let midway = join(positions + first_p * time, speeds + first_v * time);
        let at_end = self.evaluate(&self.locate(&midway, bias, &inputs.drive), bias, inputs, deviations);
        let (_, end_speeds) = split(&midway);
        let (second_p, second_v) =
            solver.solve(end_speeds - first_p * 2.0, at_end.acceleration - first_v * 2.0);
        let motion = join(
            positions + (first_p * 1.5 + second_p * 0.5) * time,
            speeds + (first_v * 1.5 + second_v * 0.5) * time,
        );
        let transition = solver.transition(linearised.by_bias, self.residual_share);
        Step { motion, transition, curvature: start.curvature_noise(time) }
    }
}

impl Evaluated {
    /// Magnitude of the acceleration, m/s2.
    pub(super) fn acceleration_size(&self) -> f32 {
        root(self.acceleration.norm_squared())
    }

    /// Accelerations per newton of friction.
    fn per_friction(&self) -> Pair {
        let place = self.forces.place;
        Pair::new((place.normal_z - self.arm) * self.per_y, -place.normal_y * self.per_z)
    }

    /// Accelerations per newton of normal force, without its friction.
    fn per_normal(&self) -> Pair {
        let place = self.forces.place;
        Pair::new(-place.normal_y * self.per_y, -place.normal_z * self.per_z)
    }

    /// Returns the gradients of the accelerations.
    fn linearised(&self) -> Linearised {
        let forces = &self.forces;
        let Gradient { motion: normal, bias } = forces.normal_gradient();
        let sliding = forces.sliding_gradient();
        let by_friction = self.per_friction();
        let by_normal = self.per_normal() + by_friction * forces.by_normal;
        let column = |place: usize| by_normal * normal[place] + by_friction * sliding[place];
        let ((y_by_y, y_by_z), (z_by_y, z_by_z)) = forces.turning_gradients();
        let turning =
            Matrix2::new(y_by_y * self.per_y, y_by_z * self.per_y, z_by_y * self.per_z, z_by_z * self.per_z);
        let mut by_bias = [bias * by_normal.x, bias * by_normal.y];
        let [along_y, along_z] = &mut by_bias;
        along_y[RESIDUAL] = self.per_y;
        along_y[FRICTION] = forces.by_friction_factor * by_friction.x;
        along_z[FRICTION] = forces.by_friction_factor * by_friction.y;
        along_y[MASS] = -self.mass * self.per_y * self.acceleration.x;
        along_z[MASS] = -self.mass * self.per_z * (self.acceleration.y + GRAVITY);
        Linearised {
            by_position: Matrix2::from_columns(&[column(0), column(1)]) + turning,
            by_speed: Matrix2::from_columns(&[column(2), column(3)]),
            by_bias,
        }
    }

    /// Returns the gradient of the drive's force.
    pub(super) fn drive_force_gradient(&self) -> Gradient {
        let forces = &self.forces;
        let Linearised { by_position, by_speed, by_bias: [along_y, _] } = self.linearised();
        let Gradient { motion: normal, bias } = forces.normal_gradient();
        let sliding = forces.sliding_gradient();
        let (normal_y, normal_z) = (forces.place.normal_y, forces.place.normal_z);
        let by_normal = forces.by_normal * normal_z - normal_y;
        let ((y_by_y, y_by_z), _) = forces.turning_gradients();
        let mut bearing = Gradient {
            motion: normal * by_normal + sliding * normal_z + Motion::new(y_by_y, y_by_z, 0.0, 0.0),
            bias: bias * by_normal,
        };
        bearing.bias[FRICTION] = forces.by_friction_factor * normal_z;
        let accelerated = Motion::new(by_position.m11, by_position.m12, by_speed.m11, by_speed.m12);
        let mass = 1.0 / self.per_z;
        let mut gradient =
            Gradient { motion: accelerated * mass - bearing.motion, bias: along_y * mass - bearing.bias };
        gradient.bias[MASS] += self.mass * self.acceleration.x;
        gradient
    }

    /// Returns the covariance of the speeds that the second-order terms of the forces add in a time
    /// in s.
    fn curvature_noise(&self, time: f32) -> Matrix2<f32> {
        let normal = self.per_normal() * (self.forces.normal_curvature * time);
        let friction = self.per_friction() * (self.forces.friction_curvature * time);
        let across = normal.x * normal.y + friction.x * friction.y;
        Matrix2::new(
            normal.x * normal.x + friction.x * friction.x,
            across,
            across,
            normal.y * normal.y + friction.y * friction.y,
        )
    }
}

/// Linear systems of a step: `M = (1 - gamma h J)^-1` in blocks of two by two.
struct Solver {
    by_position: Matrix2<f32>,
    by_speed: Matrix2<f32>,
    inverse: Matrix2<f32>,
    part: f32,
    time: f32,
}

impl Solver {
    fn new(linearised: &Linearised, time: f32) -> Self {
        let Linearised { by_position, by_speed, .. } = *linearised;
        let part = GAMMA * time;
        let system = Matrix2::identity() - (by_speed + by_position * part) * part;
        let determinant = system.m11 * system.m22 - system.m12 * system.m21;
        let adjugate = Matrix2::new(system.m22, -system.m12, -system.m21, system.m11);
        let inverse = adjugate * (1.0 / larger(determinant, MIN_DETERMINANT));
        Self { by_position, by_speed, inverse, part, time }
    }

    /// Solves `k = M r` for the parts of positions and speeds.
    fn solve(&self, positions: Pair, speeds: Pair) -> (Pair, Pair) {
        let solved = self.inverse * (speeds + self.by_position * positions * self.part);
        (positions + solved * self.part, solved)
    }

    /// Returns the derivative of the step over motion and bias.
    ///
    /// For linear equations the step is `1 + f(J) J` with `f = h (gamma M + (1 - gamma) M^2)`. The
    /// right column of `f` is the response to an acceleration; `f` and `J` commute.
    fn transition(&self, accelerations: [Bias; 2], residual: f32) -> Transition {
        let Self { by_position, by_speed, inverse, part, time } = self;
        let square = inverse * inverse + inverse * by_position * inverse * (part * part);
        let (once, twice) = (GAMMA * time, (1.0 - GAMMA) * time);
        let positions = (inverse * once + (inverse + square) * twice) * *part;
        let speeds = inverse * once + square * twice;
        let moved = positions * by_position;
        Transition {
            by_position: [Matrix2::identity() + moved, speeds * by_position],
            by_speed: [speeds, Matrix2::identity() + moved + speeds * by_speed],
            response: [positions, speeds],
            accelerations,
            residual,
        }
    }
}

fn split(motion: &Motion) -> (Pair, Pair) {
    let [y, z, speed_y, speed_z] = (*motion).into();
    (Pair::new(y, z), Pair::new(speed_y, speed_z))
}

fn join(positions: Pair, speeds: Pair) -> Motion {
    Motion::new(positions.x, positions.y, speeds.x, speeds.y)
}

#[cfg(test)]
mod tests {
    use super::super::state::{CLEARANCE, MASS};
    use super::*;
    use crate::configuration::BENCH_B;
    use crate::estimator::filter_configuration;
    use contact::BearingMaterial;

    /// Accelerations and force of the drive at a state in contact, with one state moved.
    fn at(moved: Option<(usize, f32)>) -> Evaluated {
        let bench = filter_configuration(BearingMaterial::Babbitt, &BENCH_B.bench, &BENCH_B.monitor);
        let dynamics = Dynamics::new(&bench);
        let mut motion = Motion::new(-3.08e-4, -4.265e-4, 2e-3, -1e-3);
        let mut bias = Bias::new(50.0, 0.02, 1e-6, 0.03, 0.0, 0.01);
        match moved {
            Some((place, by)) if place < 4 => motion[place] += by,
            Some((place, by)) => bias[place - 4] += by,
            None => {}
        }
        let drive = DriveMotion { displacement: 0.05, speed: 0.015, acceleration: 1.5 };
        let ratios = Ratios { normal: 1.1, friction: 0.9 };
        let inputs = Inputs { drive, load: 1e4, approach: 0.05, ratios };
        let sds = Deviations { deformation: 1e-7, sliding: 1e-5, stiffness: 0.01, damping: 0.01 };
        dynamics.evaluate(&dynamics.locate(&motion, &bias, &drive), &bias, &inputs, &sds)
    }

    #[test]
    fn gradients_of_accelerations_and_drive_force_are_derivatives() {
        // Steps of y, z, y', z', residual force, stiffness, clearance, friction; the damping has
        // moved into the approach speed, so its derivative is not that of a state.
        let steps = [1e-7, 1e-7, 1e-4, 1e-4, 100.0, 1e-2, 1e-7, 1e-2];
        let mass = (4 + MASS, 1e-2);
        assert_eq!((CLEARANCE, MASS), (2, 5));
        let middle = at(None);
        assert!(middle.forces.normal > 1e3 && middle.forces.friction.abs() > 100.0);
        let Linearised { by_position, by_speed, by_bias: [along_y, along_z] } = middle.linearised();
        let drive = middle.drive_force_gradient();
        for (place, step) in steps.into_iter().enumerate().chain([mass]) {
            let gradients = match place {
                0 | 1 => [by_position[(0, place)], by_position[(1, place)], drive.motion[place]],
                2 | 3 => [by_speed[(0, place - 2)], by_speed[(1, place - 2)], drive.motion[place]],
                _ => [along_y[place - 4], along_z[place - 4], drive.bias[place - 4]],
            };
            let (low, high) = (at(Some((place, -step))), at(Some((place, step))));
            let difference = |value: fn(&Evaluated) -> f32| (value(&high) - value(&low)) / (2.0 * step);
            let secants = [
                difference(|at| at.acceleration.x),
                difference(|at| at.acceleration.y),
                difference(|at| at.drive_force),
            ];
            // Rounding of the differences. The gradients leave out that the crank's lever changes.
            let noise = [2e-4 / step, 2e-4 / step, 4e-2 / step];
            for ((gradient, secant), noise) in gradients.into_iter().zip(secants).zip(noise) {
                let error = (gradient - secant).abs();
                assert!(error < 0.01 * secant.abs() + noise, "{place}: {gradient} {secant}");
            }
        }
    }
}
