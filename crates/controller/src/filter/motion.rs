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

use super::configuration::{FilterConfiguration, GRAVITY};
use super::contact::{ContactModel, Deviations, Forces, Turning};
use super::drive::DriveMotion;
use super::state::{
    BIAS, Bias, Covariance, DAMPING, Gradient, MOTION, Motion, RESIDUAL, STIFFNESS, Transition,
};
use nalgebra::{Matrix2, SMatrix, Vector2};

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
    load_share: f32,
    journal_radius: f32,
    residual_time: f32,
}

/// Inputs of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inputs {
    pub(super) drive: DriveMotion,
    pub(super) load: f32,
    pub(super) approach: f32,
}

/// Crank at a state.
#[derive(Clone, Copy, Debug)]
struct Crank {
    sine: f32,
    lever: f32,
    turning: f32,
}

/// Accelerations of the journal and what they consist of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evaluated {
    acceleration: Vector2<f32>,
    /// Force of the drive on the crank pin, N.
    pub(super) drive_force: f32,
    pub(super) forces: Forces,
    /// Radius of the journal over the lever of the crank.
    arm: f32,
    /// Accelerations per force along Y and Z, 1/kg.
    per_y: f32,
    per_z: f32,
}

/// Gradients of two quantities, a row for each.
type Rows = SMatrix<f32, 2, { MOTION + BIAS }>;

/// Gradients of the accelerations, and of the drive's force.
pub(super) struct Gradients {
    accelerations: (Gradient, Gradient),
    bearing_y: Gradient,
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
            load_share: 1.0 - config.load_lever_m / config.drive_lever_m,
            journal_radius: config.journal_radius_m,
            residual_time: config.residual_time(),
        }
    }

    fn crank(&self, drive: &DriveMotion, motion: &Motion) -> Crank {
        let sine = ((drive.displacement - motion.x) / self.drive_lever).clamp(-MAX_SINE, MAX_SINE);
        let lever = self.drive_lever * libm::sqrtf(1.0 - sine * sine);
        Crank { sine, lever, turning: (drive.speed - motion.z) / lever }
    }

    /// Returns sliding speed without the journal's own motion, m/s: friction turns where it is
    /// small.
    pub(super) fn surface_speed(&self, drive: &DriveMotion, motion: &Motion) -> f32 {
        self.crank(drive, motion).turning * self.journal_radius
    }

    /// Returns the standard deviations that decide how the contact is linearised.
    pub(super) fn deviations(
        &self,
        motion: &Motion,
        bias: &Bias,
        drive: &DriveMotion,
        covariance: &Covariance,
    ) -> Deviations {
        let place = self.contact.place(motion, bias);
        let (tangent_y, tangent_z) = place.tangent();
        let slip = -self.journal_radius / self.crank(drive, motion).lever - tangent_y;
        Deviations {
            deformation: root(covariance.deformation_variance(place.normal_y, place.normal_z))
                .max(MIN_DEVIATION_M),
            sliding: root(covariance.speed_variance(slip, -tangent_z)),
            stiffness: root(covariance.bias_variance(STIFFNESS)),
            damping: root(covariance.bias_variance(DAMPING)),
        }
    }

    /// Returns accelerations and forces at a state.
    pub(super) fn evaluate(
        &self,
        motion: &Motion,
        bias: &Bias,
        inputs: &Inputs,
        deviations: &Deviations,
    ) -> Evaluated {
        let Crank { sine, lever, turning } = self.crank(&inputs.drive, motion);
        let arm = self.journal_radius / lever;
        let place = self.contact.place(motion, bias);
        let surface =
            Turning { surface: turning * self.journal_radius, slope: -arm, approach: inputs.approach };
        let forces = self.contact.forces(place, bias, &surface, deviations);
        let reflected = self.inertia / (lever * lever);
        let (per_y, per_z) = (1.0 / (self.mass + reflected), 1.0 / self.mass);
        let (force_y, force_z) = forces.components();
        let driven = reflected * (inputs.drive.acceleration + self.drive_lever * sine * turning * turning);
        let residual = bias.get(RESIDUAL).copied().unwrap_or_default();
        let along = driven + inputs.load * self.load_share + residual + force_y - forces.friction * arm;
        let acceleration = Vector2::new(along * per_y, force_z * per_z - GRAVITY);
        let drive_force = self.mass * acceleration.x - inputs.load - force_y;
        Evaluated { acceleration, drive_force, forces, arm, per_y, per_z }
    }

    /// Advances the motion by a time in s; `inputs` at its start and at its end.
    pub(super) fn step(
        &self,
        motion: &Motion,
        bias: &Bias,
        inputs: [&Inputs; 2],
        deviations: &Deviations,
        time: f32,
    ) -> Step {
        let [start, end] = inputs;
        let at_start = self.evaluate(motion, bias, start, deviations);
        let (y, z) = at_start.gradients().accelerations;
        let accelerations = Rows::from_rows(&[y.transpose(), z.transpose()]);
        let solver = Solver::new(&accelerations, time);
        let (positions, speeds) = split(motion);
        let (first_p, first_v) = solver.solve(speeds, at_start.acceleration);
        let midway = join(positions + first_p * time, speeds + first_v * time);
        let at_end = self.evaluate(&midway, bias, end, deviations);
        let (_, end_speeds) = split(&midway);
        let (second_p, second_v) =
            solver.solve(end_speeds - first_p * 2.0, at_end.acceleration - first_v * 2.0);
        let motion = join(
            positions + (first_p * 1.5 + second_p * 0.5) * time,
            speeds + (first_v * 1.5 + second_v * 0.5) * time,
        );
        let residual = 1.0 / (1.0 + time / self.residual_time);
        let curvature = at_start.curvature_noise(time);
        Step { motion, transition: solver.transition(&accelerations, residual), curvature }
    }
}

impl Evaluated {
    /// Magnitude of the acceleration, m/s2.
    pub(super) fn acceleration_size(&self) -> f32 {
        root(self.acceleration.norm_squared())
    }

    /// Returns the gradients over motion and bias.
    pub(super) fn gradients(&self) -> Gradients {
        let normal = self.forces.normal_gradient();
        let friction = self.forces.friction_gradient(&normal);
        let (bearing_y, bearing_z) = self.forces.component_gradients(&normal, &friction);
        let mut along_y = bearing_y - friction * self.arm;
        along_y[MOTION + RESIDUAL] = 1.0;
        Gradients { accelerations: (along_y * self.per_y, bearing_z * self.per_z), bearing_y }
    }

    /// Returns the gradient of the drive's force.
    pub(super) fn drive_force_gradient(&self) -> Gradient {
        let Gradients { accelerations: (along_y, _), bearing_y } = self.gradients();
        along_y * (1.0 / self.per_z) - bearing_y
    }

    /// Returns the covariance of the speeds that the second-order terms of the forces add in a time
    /// in s.
    fn curvature_noise(&self, time: f32) -> Matrix2<f32> {
        let Forces { place, normal_curvature, friction_curvature, .. } = self.forces;
        let normal = Vector2::new(-place.normal_y * self.per_y, -place.normal_z * self.per_z)
            * (normal_curvature * time);
        let friction = Vector2::new((place.normal_z - self.arm) * self.per_y, -place.normal_y * self.per_z)
            * (friction_curvature * time);
        normal * normal.transpose() + friction * friction.transpose()
    }
}

/// Linear systems of a step.
struct Solver {
    by_position: Matrix2<f32>,
    by_speed: Matrix2<f32>,
    inverse: Matrix2<f32>,
    time: f32,
}

impl Solver {
    fn new(accelerations: &Rows, time: f32) -> Self {
        let by_position = accelerations.fixed_columns::<2>(0).into_owned();
        let by_speed = accelerations.fixed_columns::<2>(2).into_owned();
        let part = GAMMA * time;
        let system = Matrix2::identity() - (by_speed + by_position * part) * part;
        let determinant = system.m11 * system.m22 - system.m12 * system.m21;
        let adjugate = Matrix2::new(system.m22, -system.m12, -system.m21, system.m11);
        let inverse = adjugate * (1.0 / determinant.max(MIN_DETERMINANT));
        Self { by_position, by_speed, inverse, time }
    }

    /// Solves `(1 - gamma h J) k = r` for the parts of positions and speeds.
    fn solve<const N: usize>(
        &self,
        positions: SMatrix<f32, 2, N>,
        speeds: SMatrix<f32, 2, N>,
    ) -> (SMatrix<f32, 2, N>, SMatrix<f32, 2, N>) {
        let part = GAMMA * self.time;
        let solved = self.inverse * (speeds + self.by_position * positions * part);
        (positions + solved * part, solved)
    }

    /// Returns the derivative of the step over motion and bias: the step applied to its own
    /// Jacobian, in which the bias stays as it is.
    fn transition(&self, accelerations: &Rows, residual: f32) -> Transition {
        let time = self.time;
        let mut speeds = Rows::zeros();
        speeds.fixed_view_mut::<2, 2>(0, 2).fill_with_identity();
        let (first_p, first_v) = self.solve(speeds, *accelerations);
        let moved = self.by_position * first_p + self.by_speed * first_v;
        let (second_p, second_v) =
            self.solve(speeds + first_v * time - first_p * 2.0, accelerations + moved * time - first_v * 2.0);
        let mut positions = (first_p * 1.5 + second_p * 0.5) * time;
        let mut own = positions.fixed_view_mut::<2, 2>(0, 0);
        own += Matrix2::identity();
        let speeds = speeds + (first_v * 1.5 + second_v * 0.5) * time;
        let mut transition = Transition { by_motion: SMatrix::zeros(), by_bias: SMatrix::zeros(), residual };
        let Transition { by_motion, by_bias, .. } = &mut transition;
        by_motion.fixed_view_mut::<2, MOTION>(0, 0).copy_from(&positions.fixed_columns::<MOTION>(0));
        by_motion.fixed_view_mut::<2, MOTION>(2, 0).copy_from(&speeds.fixed_columns::<MOTION>(0));
        by_bias.fixed_view_mut::<2, BIAS>(0, 0).copy_from(&positions.fixed_columns::<BIAS>(MOTION));
        by_bias.fixed_view_mut::<2, BIAS>(2, 0).copy_from(&speeds.fixed_columns::<BIAS>(MOTION));
        transition
    }
}

fn root(value: f32) -> f32 {
    libm::sqrtf(value)
}

fn split(motion: &Motion) -> (Vector2<f32>, Vector2<f32>) {
    let [y, z, speed_y, speed_z] = (*motion).into();
    (Vector2::new(y, z), Vector2::new(speed_y, speed_z))
}

fn join(positions: Vector2<f32>, speeds: Vector2<f32>) -> Motion {
    Motion::new(positions.x, positions.y, speeds.x, speeds.y)
}
