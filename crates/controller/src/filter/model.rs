//! Steps of the filter: prediction, correction, onset of contact, estimate.

use super::arithmetic::{larger, root, sine, smaller};
use super::configuration::{FilterConfiguration, GRAVITY};
use super::contact::{Deviations, Forces};
use super::drive::{DriveModel, DriveTracker};
use super::estimate::FilterEstimate;
use super::measurement::Measurement;
use super::motion::{Dynamics, Evaluated, Inputs};
use super::noise_levels::NoiseLevels;
use super::ratios::Ratios;
use super::skew::Skew;
use super::state::{Bias, CLEARANCE, Covariance, DAMPING, FRICTION, MASS, Motion, RESIDUAL, STIFFNESS};
use crate::integrity::words;
use micromath::F32Ext;
use nalgebra::{Matrix2, Vector2};

/// Deviations of the deformation below 0 at which contact counts as lost.
const SEPARATION: f32 = 3.0;
/// Expectation of the normalised squares of a sample's two innovations.
const EXPECTED_INNOVATION: f32 = 2.0;
/// Average above which the model does not fit. Of white noise over a hundred samples it is 15
/// standard deviations above the expectation.
const MAX_INNOVATION: f32 = 5.0;
/// Range of the factors on stiffness, friction and mass, less 1.
const FACTOR_RANGE: (f32, f32) = (-0.9, 9.0);
/// Range of the approach speed: shares of its floor and of a fall through the clearance.
const APPROACH_RANGE: (f32, f32) = (0.5, 10.0);
/// Declared deviations beyond which the stiffness of a model that does not fit was learnt wrong.
const MAX_DEVIATIONS: f32 = 5.0;
/// Largest correction of the damping by one sample, on a logarithmic scale.
const MAX_DAMPING_CHANGE: f32 = 1.0;

/// Samples without a complete measurement after which the motion starts anew.
const MAX_MISSED: u32 = 50;
/// Standard deviation of the radial speed in contact as a share of the approach speed.
const CONTACT_RATE: f32 = 0.5;
/// Longest time without samples over which the factors drift, s.
const MAX_DRIFT_S: f32 = 300.0;
/// Lost samples over which the motion of the drive is extrapolated.
const MAX_LOST: u32 = 64;

/// Forces of the networks at the contact of the last estimate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NetworkForces {
    /// Normal force, N, 0 or more.
    pub(crate) normal_n: f32,
    /// Friction force, N.
    pub(crate) friction_n: f32,
    /// Normal force at which half of their difference from the law is taken, N; above 0.
    pub(crate) blend_n: f32,
}

/// State from sample to sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    motion: Motion,
    bias: Bias,
    covariance: Covariance,
    drive: DriveTracker,
    deviations: Deviations,
    /// Accelerations and forces at this state.
    at: Evaluated,
    load: f32,
    /// Approach speed of the onset, over the factor by which the damping has been corrected since.
    approach: f32,
    is_touching: bool,
    /// Average of the normalised squares of the innovations.
    innovation: f32,
    /// Forces of the networks over those of the law; 1 where the law is used.
    ratios: Ratios,
    /// Samples since the last complete one.
    missed: u32,
    /// True if this sample contradicted the model so much that the state was started anew.
    is_repaired: bool,
}
words!(State {
    motion,
    bias,
    covariance,
    drive,
    deviations,
    at,
    load,
    approach,
    is_touching,
    innovation,
    ratios,
    missed,
    is_repaired,
});

impl State {
    /// Returns true if every variance is a number above 0.
    pub(super) fn is_positive(&self) -> bool {
        self.covariance.is_positive()
    }

    /// Returns the inputs of the equations of motion.
    fn inputs(&self) -> Inputs {
        let Self { drive, load, approach, ratios, .. } = *self;
        Inputs { drive: drive.motion(), load, approach, ratios }
    }
}

/// Constants of a bench.
#[derive(Clone, Debug)]
pub(super) struct BenchModel {
    config: FilterConfiguration,
    dynamics: Dynamics,
    drive: DriveModel,
    levels: NoiseLevels,
    skew: Skew,
}
words!(BenchModel { config, dynamics, drive, levels, skew });

impl BenchModel {
    /// Derives the constants from a configuration that has been checked.
    pub(super) fn new(config: &FilterConfiguration) -> Self {
        Self {
            config: *config,
            dynamics: Dynamics::new(config),
            drive: DriveModel::new(config),
            levels: NoiseLevels::new(config),
            skew: Skew::default(),
        }
    }

    /// Sets the time between the samples of the probes.
    pub(super) const fn set_skew(&mut self, skew: Skew) {
        self.skew = skew;
    }

    /// Takes over the forces of the networks at the last estimate, in N, or the law without them.
    pub(super) fn set_networks(&self, state: &mut State, networks: Option<NetworkForces>) {
        let forces = &state.at.forces;
        state.ratios = match networks {
            Some(NetworkForces { normal_n, friction_n, blend_n })
                if forces.law_normal > 0.0 && forces.normal > 0.0 =>
            {
                // Below the blended force the coefficients lose their meaning, both alike.
                let share = 1.0 / larger(normal_n, blend_n);
                let described = forces.law_coefficient.abs() * (normal_n * share);
                let coefficients = [friction_n.abs() * share, described];
                Ratios::new([normal_n, forces.law_normal], coefficients, blend_n)
            }
            // Without contact the last ratios serve the next onset.
            Some(_) => state.ratios,
            None => Ratios::LAW,
        };
    }

    /// Continues after lost samples: the drive moved on, the motion of the journal is taken from
    /// the sample, what has been learnt about the bearing stays.
    pub(super) fn resume(&self, state: &mut State, measured: &Measurement, lost: u32) {
        self.proceed(state, measured, lost, lost > MAX_LOST);
    }

    /// Continues `lost` samples after the last complete one; with the drive started anew or
    /// extrapolated.
    fn proceed(&self, state: &mut State, measured: &Measurement, lost: u32, starts_drive: bool) {
        if starts_drive {
            state.drive = DriveTracker::new(&self.config, self.displacement(measured));
            state.bias[RESIDUAL] = 0.0;
        } else {
            for _ in 0..=lost {
                state.drive.advance(&self.drive);
            }
            state.drive.correct(&self.drive, self.displacement(measured));
        }
        self.restart_motion(state, measured, lost);
        if starts_drive {
            let residual = self.unknown_residual(measured.load_force_n);
            state.covariance.restart_bias(RESIDUAL, residual);
        }
        let samples = smaller(lost as f32 + 1.0, MAX_DRIFT_S / self.config.sample_period_s);
        state.covariance.add_noise(&Matrix2::zeros(), &(self.levels.factor_drift() * samples));
        self.evaluate(state);
        self.onset(state);
    }

    /// Standard deviation of the residual force while the drive's acceleration is unknown, N.
    fn unknown_residual(&self, load: f32) -> f32 {
        let config = &self.config;
        let unknown_drive = config.reflected_mass() * config.jerk_sd() * config.jerk_time();
        root(self.levels.residual_variance(load) + square(unknown_drive))
    }

    /// Predicts a sample after lost ones; the next complete one starts the motion anew.
    pub(super) fn lose(&self, state: &mut State, lost: u32) {
        self.predict(state);
        self.evaluate(state);
        state.missed = state.missed.max(MAX_MISSED).saturating_add(lost).saturating_add(1);
    }

    /// Takes the position of the journal from a sample after lost ones.
    ///
    /// Its speed around the bearing is known as far as the forces cannot have changed it since; its
    /// radial speed is that of the contact, which settles within a few samples, or of a fall.
    fn restart_motion(&self, state: &mut State, measured: &Measurement, lost: u32) {
        let noise = self.config.noise.position_m;
        let fall = self.levels.fall_speed;
        let time = lost.min(MAX_LOST).wrapping_add(1) as f32 * self.config.sample_period_s;
        let change = (state.at.acceleration_size() + GRAVITY) * time;
        let around_sd = smaller(change, fall);
        let around = if change < fall { state.at.forces.place.around } else { 0.0 };
        state.motion = Motion::new(measured.journal_y_m, measured.journal_z_m, 0.0, 0.0);
        let place = self.dynamics.contact.place(&state.motion, &state.bias);
        let radial_sd = if place.deformation > 0.0 { CONTACT_RATE * state.approach } else { fall };
        let (tangent_y, tangent_z) = place.tangent();
        (state.motion.z, state.motion.w) = (around * tangent_y, around * tangent_z);
        let normal = Vector2::new(place.normal_y, place.normal_z) * radial_sd;
        let tangent = Vector2::new(tangent_y, tangent_z) * around_sd;
        let speeds = normal * normal.transpose() + tangent * tangent.transpose();
        state.covariance.restart_motion(noise * noise, &speeds);
        state.load = measured.load_force_n;
        state.missed = 0;
    }

    /// Predicts a state one sample on and corrects it by the sample, if that is complete.
    pub(super) fn follow(&self, state: &mut State, measured: &Measurement) {
        if measured.is_complete() && state.missed > MAX_MISSED {
            // The predicted motion of the drive is no longer known.
            self.proceed(state, measured, state.missed, true);
            return;
        }
        self.predict(state);
        state.missed = state.missed.saturating_add(1);
        state.is_repaired = false;
        if measured.is_complete() {
            state.missed = 0;
            state.load = measured.load_force_n;
            let measured = &self.skew.removed_from(measured, &state.motion);
            state.drive.correct(&self.drive, self.displacement(measured));
            self.correct(state, measured);
            if state.innovation > MAX_INNOVATION {
                self.repair(state, measured);
            }
        }
        self.evaluate(state);
        self.onset(state);
    }

    /// Displacement of the drive that a sample shows, m.
    fn displacement(&self, measured: &Measurement) -> f32 {
        measured.journal_y_m + self.config.drive_lever_m * sine(measured.shaft_angle_rad)
    }

    /// Starts anew if the model does not fit because of a wrong clearance or stiffness.
    ///
    /// A journal without contact that moves as no known force explains touches the bearing: it
    /// starts at the surface. A stiffness far from the declared one has been learnt wrong; not so
    /// with a measured drive force, which soon corrects it.
    fn repair(&self, state: &mut State, measured: &Measurement) {
        self.evaluate(state);
        let [declared, ..] = self.config.factor_sds();
        let is_free = state.at.forces.normal == 0.0;
        let is_implausible =
            measured.drive_force_n.is_none() && state.bias[STIFFNESS].abs() > MAX_DEVIATIONS * declared;
        if !is_free && !is_implausible {
            return;
        }
        let (ratios, friction) = (state.ratios, state.bias[FRICTION]);
        *state = self.restart(measured, state.drive);
        (state.ratios, state.is_repaired) = (ratios, true);
        // Friction does not depend on clearance and stiffness: what was learnt is a better start.
        // With a measured drive force it is learnt anew at once.
        let friction = if measured.drive_force_n.is_some() { 0.0 } else { friction };
        let [.., declared] = self.config.factor_sds();
        state.bias[FRICTION] = friction;
        let deviation = root(square(declared) + square(0.5 * friction));
        state.covariance.restart_bias(FRICTION, deviation);
        if is_free {
            // As uncertain as at a start with the journal at this distance, on either side.
            let change = distance(measured) - self.config.radial_clearance_m;
            let [_, clearance, _] = self.config.factor_sds();
            state.bias[CLEARANCE] = change;
            let deviation = root(square(clearance) + square(0.5 * change));
            state.covariance.restart_bias(CLEARANCE, deviation);
        }
    }

    /// Returns the state after the first sample.
    pub(super) fn start(&self, measured: &Measurement) -> State {
        self.restart(measured, DriveTracker::new(&self.config, self.displacement(measured)))
    }

    /// Returns the state after a sample before which only the motion of the drive is known.
    ///
    /// A journal beyond the described clearance need not press the bearing: the clearance may be
    /// larger. It starts at the surface then, with half of the distance as further uncertainty.
    fn restart(&self, measured: &Measurement, drive: DriveTracker) -> State {
        let config = &self.config;
        let beyond = larger(distance(measured) - config.radial_clearance_m, 0.0);
        let noise = config.noise.position_m;
        let speed = self.levels.fall_speed;
        let [stiffness, clearance, friction] = config.factor_sds();
        let residual = self.unknown_residual(measured.load_force_n);
        let motion = Motion::new(measured.journal_y_m, measured.journal_z_m, 0.0, 0.0);
        let bias = Bias::new(0.0, 0.0, beyond, 0.0, 0.0, 0.0);
        let deviations = Bias::new(
            residual,
            stiffness,
            root(square(clearance) + square(0.5 * beyond)),
            friction,
            config.damping_sd(),
            0.0,
        );
        let covariance = Covariance::from_deviations(&Motion::new(noise, noise, speed, speed), &deviations);
        let (load, ratios) = (measured.load_force_n, Ratios::LAW);
        let inputs = Inputs { drive: drive.motion(), load, approach: speed, ratios };
        let located = self.dynamics.locate(&motion, &bias, &inputs.drive);
        let deviations = self.dynamics.deviations(&located, &covariance);
        State {
            motion,
            bias,
            covariance,
            drive,
            deviations,
            at: self.dynamics.evaluate(&located, &bias, &inputs, &deviations),
            load,
            approach: speed,
            is_touching: false,
            innovation: EXPECTED_INNOVATION,
            ratios,
            missed: 0,
            is_repaired: false,
        }
    }

    /// Predicts the state one sample on.
    fn predict(&self, state: &mut State) {
        state.drive.advance(&self.drive);
        let inputs = state.inputs();
        let step = self.dynamics.step(&state.motion, &state.bias, &state.at, &inputs, &state.deviations);
        state.motion = step.motion;
        state.bias[RESIDUAL] *= step.transition.residual;
        state.covariance.advance(&step.transition);
        let model = Matrix2::identity() * self.levels.speed_variance;
        let bias = self.levels.bias_variances(state.load, state.drive.acceleration_variance());
        state.covariance.add_noise(&(step.curvature + model), &bias);
    }

    /// Corrects the state by the measured position and, where it is measured, the drive force.
    fn correct(&self, state: &mut State, measured: &Measurement) {
        let noise = self.levels.position_variance;
        let y = state.covariance.correct_position::<0>(measured.journal_y_m - state.motion.x, noise);
        state.motion += y.motion;
        state.bias += y.bias;
        let z = state.covariance.correct_position::<1>(measured.journal_z_m - state.motion.y, noise);
        state.motion += z.motion;
        state.bias += z.bias;
        state.innovation += self.levels.innovation_share * (y.normalised + z.normalised - state.innovation);
        if let Some(force) = measured.drive_force_n {
            self.correct_by_force(state, force);
        }
        self.scale_damping(state);
        let (low, high) = FACTOR_RANGE;
        for place in [STIFFNESS, FRICTION, MASS] {
            state.bias[place] = state.bias[place].clamp(low, high);
        }
    }

    /// Corrects the state by the force of the drive, N. Only that force shows the mass: the first
    /// one makes it a state.
    fn correct_by_force(&self, state: &mut State, force: f32) {
        if state.covariance.bias_variance(MASS) == 0.0 {
            state.covariance.restart_bias(MASS, self.config.uncertainty.mass_share);
        }
        self.evaluate(state);
        let noise = self.config.noise.drive_force_n;
        let measured = state.covariance.project(&state.at.drive_force_gradient());
        let drive = state.covariance.correct(&measured, force - state.at.drive_force, noise * noise);
        state.motion += drive.motion;
        state.bias += drive.bias;
    }

    /// Moves the estimated change of the damping from the bias into the approach speed.
    ///
    /// The speed of an onset may be wrong by a multiple, so the change counts as the logarithm of a
    /// factor. `(1 - l/2)/(1 + l/2)` is `exp(-l)` to the third order, and positive.
    fn scale_damping(&self, state: &mut State) {
        let half = 0.5 * state.bias[DAMPING].clamp(-MAX_DAMPING_CHANGE, MAX_DAMPING_CHANGE);
        state.bias[DAMPING] = 0.0;
        let (low, high) = APPROACH_RANGE;
        let approach = state.approach * (1.0 - half) / (1.0 + half);
        // Not `clamp`, which panics if the limits are in the wrong order.
        let least = larger(approach, low * self.config.latch_floor_m_s);
        state.approach = smaller(least, high * self.levels.fall_speed);
    }

    /// Brings deviations, accelerations and forces of a state up to date.
    fn evaluate(&self, state: &mut State) {
        let inputs = state.inputs();
        let located = self.dynamics.locate(&state.motion, &state.bias, &inputs.drive);
        state.deviations = self.dynamics.deviations(&located, &state.covariance);
        state.at = self.dynamics.evaluate(&located, &state.bias, &inputs, &state.deviations);
    }

    /// Latches the approach speed at the onset of contact.
    ///
    /// The speed is uncertain by the deviation of the rate, and by the time at which the journal
    /// passed a clearance that is not exactly known. An uncertain speed is replaced by the middle,
    /// on a logarithmic scale, of what is possible; the damping factor finds the rest.
    fn onset(&self, state: &mut State) {
        let place = state.at.forces.place;
        let deformation_sd = state.deviations.deformation;
        if place.deformation < -SEPARATION * deformation_sd {
            state.is_touching = false;
        }
        if state.is_touching || place.deformation <= 0.0 {
            return;
        }
        let floor = self.config.latch_floor_m_s;
        let rate_sd = root(state.covariance.speed_variance(place.normal_y, place.normal_z));
        let speed = larger(larger(place.rate, 0.5 * rate_sd), floor);
        let passing = state.at.acceleration_size() * deformation_sd / (speed * speed);
        let spread = root(square(rate_sd / speed) + square(passing));
        let least = larger(speed / (1.0 + spread), floor);
        let ratio = root(speed / least);
        state.approach = speed / ratio;
        state.is_touching = true;
        let deviation = root(square(self.config.damping_sd()) + square(smaller(spread, ratio)));
        state.covariance.restart_bias(DAMPING, deviation);
        self.evaluate(state);
    }

    /// Returns the estimate of a state.
    pub(super) fn estimate(&self, state: &State) -> FilterEstimate {
        let Forces { place, normal, friction, by_normal, by_friction_factor, .. } = state.at.forces;
        let forces = &state.at.forces;
        let covariance = &state.covariance;
        let (force_y_n, force_z_n) = forces.components();
        let is_estimated = covariance.bias_variance(MASS) > 0.0;
        let mass = if is_estimated { 0.0 } else { self.config.uncertainty.mass_share };
        let least = self.levels.min_force_variance;
        let projection = covariance.project(&forces.normal_gradient());
        let sliding = forces.sliding_gradient();
        let shared = projection.motion.dot(&sliding) + projection.bias[FRICTION] * by_friction_factor;
        let friction_variance = by_normal * (by_normal * projection.variance + 2.0 * shared)
            + covariance.variance(&sliding, FRICTION, by_friction_factor)
            + square(forces.friction_curvature)
            + square(mass * friction);
        let normal_variance =
            projection.variance + square(forces.normal_curvature) + square(mass * normal) + least;
        let fits = state.innovation <= MAX_INNOVATION && !state.is_repaired;
        let excess = larger(state.innovation, MAX_INNOVATION) * (1.0 / EXPECTED_INNOVATION);
        let widening = if fits { 1.0 } else { excess };
        // Masses and levers are not estimated: their errors pass to the factors.
        let considered = |place: usize, share: f32| {
            let error = share * (1.0 + state.bias[place]);
            reported_root(covariance.bias_variance(place) + square(error))
        };
        let radius = self.config.journal_radius_m;
        let friction_variance = larger(friction_variance, 0.0);
        FilterEstimate {
            normal_force_n: normal,
            normal_force_sd_n: reported_root(widening * normal_variance),
            friction_force_n: friction,
            force_y_n,
            force_z_n,
            force_sd_n: reported_root(widening * (normal_variance + friction_variance)),
            friction_torque_nm: radius * friction,
            friction_torque_sd_nm: radius * reported_root(widening * (friction_variance + least)),
            deformation_m: place.deformation,
            clearance_m: self.config.radial_clearance_m + state.bias[CLEARANCE],
            // The offset of a probe is as uncertain as the noise of a sample, and looks like
            // clearance.
            clearance_sd_m: reported_root(
                covariance.bias_variance(CLEARANCE) + self.levels.position_variance,
            ),
            stiffness_factor: 1.0 + state.bias[STIFFNESS],
            stiffness_sd: considered(STIFFNESS, mass),
            friction_factor: 1.0 + state.bias[FRICTION],
            friction_sd: considered(FRICTION, self.config.uncertainty.lever_share),
            normal_y: place.normal_y,
            normal_z: place.normal_z,
            deformation_rate_m_s: place.rate,
            approach_speed_m_s: larger(state.approach, self.config.latch_floor_m_s),
            sliding_speed_m_s: forces.sliding,
            law_force_n: forces.law_normal,
            law_friction_n: -forces.law_coefficient * forces.law_normal,
            is_converging: self.is_converging(state),
            fits,
        }
    }

    /// Returns true as long as the start dominates the uncertainty: of the drive's motion, or of
    /// the deformation in contact.
    fn is_converging(&self, state: &State) -> bool {
        let drive_variance = self.levels.reflected_square * state.drive.acceleration_variance();
        let deformation = larger(state.at.forces.place.deformation, self.config.uncertainty.clearance_m);
        drive_variance > self.levels.residual_variance(state.load)
            || state.deviations.deformation > 0.1 * deformation
    }
}

/// Distance of the journal from the centre of the bearing that a sample shows, m.
fn distance(measured: &Measurement) -> f32 {
    root(square(measured.journal_y_m) + square(measured.journal_z_m))
}

/// Approximate root of a variance, at most 6 % too large: for deviations that are reported and not
/// fed back.
fn reported_root(variance: f32) -> f32 {
    // Not `variance.sqrt()`: on a host that would be the standard library's.
    F32Ext::sqrt(variance)
}

fn square(value: f32) -> f32 {
    value * value
}
