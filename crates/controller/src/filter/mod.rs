//! Extended Kalman filter of the contact force, with the uncertainty of its estimate.
//!
//! States: position and speed of the journal, a residual force along Y, and what is not exactly
//! known about the bearing: factors on stiffness, friction and damping, and an offset of the
//! clearance. Measured are the position of the journal, the angle of the shaft, the load and, where
//! there is a sensor, the force of the drive. The mass is considered, not estimated: a common
//! factor on mass, inertia, modulus and all forces leaves position and angle as they are, so no
//! filter can see it. `docs/estimation.md` derives the filter and quotes what it reaches.
//!
//! SI units throughout; f32 with `+ - * /` and functions of `libm`, so that every machine computes
//! the same bits. No heap, no panic; every division is by a number that is kept away from 0.

mod configuration;
mod contact;
mod drive;
mod motion;
mod state;

pub use configuration::{FilterConfiguration, FilterError, SensorNoise, Uncertainty};

use contact::{Deviations, Forces};
use drive::DriveTracker;
use micromath::F32Ext;
use motion::{Dynamics, Evaluated, Inputs};
use nalgebra::Matrix2;
use state::{Bias, CLEARANCE, Covariance, DAMPING, FRICTION, Gradient, MOTION, Motion, RESIDUAL, STIFFNESS};

/// Deviations of the deformation below 0 at which contact counts as lost.
const SEPARATION: f32 = 3.0;
/// Time in s over which the squares of the innovations are averaged.
const INNOVATION_TIME_S: f32 = 0.01;
/// Expectation of the normalised squares of a sample's two innovations.
const EXPECTED_INNOVATION: f32 = 2.0;
/// Average above which the model does not fit. Of white noise over a hundred samples it is 15
/// standard deviations above the expectation.
const MAX_INNOVATION: f32 = 5.0;
/// Range of the factors on stiffness and friction, less 1.
const FACTOR_RANGE: (f32, f32) = (-0.9, 9.0);
/// Range of the approach speed: shares of its floor and of a fall through the clearance.
const APPROACH_RANGE: (f32, f32) = (0.5, 10.0);
/// Declared deviations beyond which the stiffness of a model that does not fit was learnt wrong.
const MAX_DEVIATIONS: f32 = 5.0;
/// Largest correction of the damping by one sample, on a logarithmic scale.
const MAX_DAMPING_CHANGE: f32 = 1.0;

/// One sample of the sensors, SI units.
#[derive(Clone, Copy, Debug, Default)]
pub struct Measurement {
    /// Position of the journal along Y from the centre of the bearing, m.
    pub journal_y_m: f32,
    /// Position of the journal along Z, upwards, m.
    pub journal_z_m: f32,
    /// Angle of the shaft, rad.
    pub shaft_angle_rad: f32,
    /// Load along Y, N.
    pub load_force_n: f32,
    /// Force of the drive on the crank pin along Y, N, where it is measured.
    pub drive_force_n: Option<f32>,
}

impl Measurement {
    /// Returns true if every value is a number.
    fn is_complete(&self) -> bool {
        let Self { journal_y_m, journal_z_m, shaft_angle_rad, load_force_n, drive_force_n } = *self;
        [journal_y_m, journal_z_m, shaft_angle_rad, load_force_n, drive_force_n.unwrap_or_default()]
            .iter()
            .all(|value| value.is_finite())
    }
}

/// Estimate of a sample with its standard deviations.
#[derive(Clone, Copy, Debug, Default)]
pub struct FilterEstimate {
    /// Normal force, N.
    pub normal_force_n: f32,
    /// Standard deviation of the normal force, N; above 0.
    pub normal_force_sd_n: f32,
    /// Friction force, positive in the direction of positive sliding, N.
    pub friction_force_n: f32,
    /// Force of the bearing on the journal along Y, N.
    pub force_y_n: f32,
    /// Force of the bearing on the journal along Z, N.
    pub force_z_n: f32,
    /// Standard deviation of the force vector, N; above 0.
    pub force_sd_n: f32,
    /// Torque of the bearing on the shaft, N m.
    pub friction_torque_nm: f32,
    /// Standard deviation of the torque, N m; above 0.
    pub friction_torque_sd_nm: f32,
    /// Deformation, m; negative without contact.
    pub deformation_m: f32,
    /// Radial clearance, m.
    pub clearance_m: f32,
    /// Standard deviation of the clearance, m.
    pub clearance_sd_m: f32,
    /// Stiffness over the described one.
    pub stiffness_factor: f32,
    /// Standard deviation of the stiffness factor.
    pub stiffness_sd: f32,
    /// Friction over the described one.
    pub friction_factor: f32,
    /// Standard deviation of the friction factor.
    pub friction_sd: f32,
    /// True as long as the start still dominates the uncertainty.
    pub is_converging: bool,
    /// False if the innovations are larger than model and sensors explain. The variances of force
    /// and torque are then multiplied by the excess.
    pub fits: bool,
}

impl FilterEstimate {
    /// Returns true if forces, deviations and factors are numbers.
    fn is_finite(&self) -> bool {
        let sums = [
            self.force_y_n + self.force_z_n + self.force_sd_n + self.normal_force_sd_n,
            self.friction_torque_nm + self.friction_torque_sd_nm,
            self.clearance_m + self.stiffness_factor + self.friction_factor,
        ];
        sums.iter().all(|sum| sum.is_finite())
    }

    /// Estimate while nothing is known: before the first complete sample, and after a state that
    /// was no longer finite.
    const UNKNOWN: Self = Self {
        normal_force_n: 0.0,
        normal_force_sd_n: f32::INFINITY,
        friction_force_n: 0.0,
        force_y_n: 0.0,
        force_z_n: 0.0,
        force_sd_n: f32::INFINITY,
        friction_torque_nm: 0.0,
        friction_torque_sd_nm: f32::INFINITY,
        deformation_m: 0.0,
        clearance_m: 0.0,
        clearance_sd_m: f32::INFINITY,
        stiffness_factor: 1.0,
        stiffness_sd: f32::INFINITY,
        friction_factor: 1.0,
        friction_sd: f32::INFINITY,
        is_converging: true,
        fits: true,
    };
}

/// The filter of one bench.
#[derive(Clone, Debug)]
pub struct Filter {
    config: FilterConfiguration,
    dynamics: Dynamics,
    state: Option<State>,
}

/// State from sample to sample.
#[derive(Clone, Copy, Debug)]
struct State {
    motion: Motion,
    bias: Bias,
    covariance: Covariance,
    drive: DriveTracker,
    deviations: Deviations,
    load: f32,
    /// Approach speed of the onset, over the factor by which the damping has been corrected since.
    approach: f32,
    is_touching: bool,
    /// Average of the normalised squares of the innovations.
    innovation: f32,
}

impl Filter {
    /// Creates the filter of a bench; the first sample starts it.
    ///
    /// # Errors
    ///
    /// A value of the configuration is out of range.
    pub fn new(config: &FilterConfiguration) -> Result<Self, FilterError> {
        config.check()?;
        Ok(Self { config: *config, dynamics: Dynamics::new(config), state: None })
    }

    /// Forgets everything that was measured, for example after a gap in the samples.
    pub const fn restart(&mut self) {
        self.state = None;
    }

    /// Takes one sample and estimates. A sample of which a value is missing, which is not a number,
    /// is predicted.
    pub fn step(&mut self, measured: &Measurement) -> FilterEstimate {
        let displacement =
            measured.journal_y_m + self.config.drive_lever_m * libm::sinf(measured.shaft_angle_rad);
        let is_complete = measured.is_complete();
        let Some(mut state) = self.state.take().filter(|state| state.covariance.is_positive()) else {
            if !is_complete {
                return FilterEstimate::UNKNOWN;
            }
            let mut state = self.start(measured, displacement);
            let at = self.evaluate(&mut state);
            return self.finish(state, &at);
        };
        self.predict(&mut state);
        if is_complete {
            state.load = measured.load_force_n;
            state.drive.correct(self.config.sample_period_s, displacement);
            self.correct(&mut state, measured);
            if state.innovation > MAX_INNOVATION {
                if self.is_free(&mut state) {
                    self.recover(&mut state, measured);
                } else if self.is_implausible(&state, measured) {
                    state = State { drive: state.drive, ..self.start(measured, displacement) };
                }
            }
        }
        let at = self.onset(&mut state);
        self.finish(state, &at)
    }

    /// Returns true if the state excludes a contact.
    fn is_free(&self, state: &mut State) -> bool {
        self.evaluate(state).forces.normal == 0.0
    }

    /// Returns true if the stiffness is far from what is declared. With a drive force it also
    /// explains a wrong mass, and friction may be another than the described one: neither counts.
    fn is_implausible(&self, state: &State, measured: &Measurement) -> bool {
        let [declared, ..] = self.config.factor_sds();
        let stiffness = state.bias.get(STIFFNESS).copied().unwrap_or_default();
        measured.drive_force_n.is_none() && stiffness.abs() > MAX_DEVIATIONS * declared
    }

    /// Starts anew at the surface of the bearing.
    ///
    /// A journal without contact that moves as no known force explains touches the bearing, so the
    /// clearance is wrong.
    fn recover(&self, state: &mut State, measured: &Measurement) {
        let distance = libm::hypotf(measured.journal_y_m, measured.journal_z_m);
        let displacement = state.drive.motion().displacement;
        let mut fresh = State { drive: state.drive, ..self.start(measured, displacement) };
        if let Some(offset) = fresh.bias.get_mut(CLEARANCE) {
            *offset = distance - self.config.radial_clearance_m;
        }
        *state = fresh;
    }

    /// Keeps the state and returns its estimate. A state that is no longer finite is forgotten: the
    /// next sample starts anew.
    fn finish(&mut self, state: State, at: &Evaluated) -> FilterEstimate {
        let estimate = self.estimate(&state, at);
        if !estimate.is_finite() {
            return FilterEstimate::UNKNOWN;
        }
        self.state = Some(state);
        estimate
    }

    /// Returns the state after the first sample.
    ///
    /// A journal beyond the described clearance need not press the bearing: the clearance may be
    /// larger. It starts at the surface then, with half of the distance as further uncertainty.
    fn start(&self, measured: &Measurement, displacement: f32) -> State {
        let config = &self.config;
        let distance = libm::hypotf(measured.journal_y_m, measured.journal_z_m);
        let beyond = (distance - config.radial_clearance_m).max(0.0);
        let noise = config.noise.position_m;
        let speed = config.speed_sd();
        let [stiffness, clearance, friction] = config.factor_sds();
        let unknown_drive = config.reflected_mass() * config.jerk_sd() * config.jerk_time();
        let residual = libm::sqrtf(config.residual_variance(measured.load_force_n) + square(unknown_drive));
        State {
            motion: Motion::new(measured.journal_y_m, measured.journal_z_m, 0.0, 0.0),
            bias: Bias::new(0.0, 0.0, beyond, 0.0, 0.0),
            covariance: Covariance::from_deviations(
                &Motion::new(noise, noise, speed, speed),
                &Bias::new(
                    residual,
                    stiffness,
                    libm::hypotf(clearance, 0.5 * beyond),
                    friction,
                    config.damping_sd(),
                ),
            ),
            drive: DriveTracker::new(config, displacement),
            deviations: Deviations::default(),
            load: measured.load_force_n,
            approach: speed,
            is_touching: false,
            innovation: EXPECTED_INNOVATION,
        }
    }

    /// Predicts the state one sample on, in two steps where friction turns abruptly.
    fn predict(&self, state: &mut State) {
        let surface = self.dynamics.surface_speed(&state.drive.motion(), &state.motion);
        let steps: u8 = if self.dynamics.contact.turns_abruptly(surface) { 2 } else { 1 };
        let time = self.config.sample_period_s / f32::from(steps);
        for _ in 0..steps {
            let inputs = |state: &State| Inputs {
                drive: state.drive.motion(),
                load: state.load,
                approach: state.approach,
            };
            let start = inputs(state);
            state.drive.advance(time);
            let end = inputs(state);
            let step =
                self.dynamics.step(&state.motion, &state.bias, [&start, &end], &state.deviations, time);
            state.motion = step.motion;
            if let Some(residual) = state.bias.get_mut(RESIDUAL) {
                *residual *= step.transition.residual;
            }
            state.covariance.advance(&step.transition);
            let model = Matrix2::identity() * (FilterConfiguration::acceleration_density() * time);
            let speeds = step.curvature + model;
            state.covariance.add_noise(&speeds, &self.bias_noise(state, time));
        }
    }

    /// Returns the variances that a time in s adds to the bias.
    fn bias_noise(&self, state: &State, time: f32) -> Bias {
        let config = &self.config;
        let unknown_drive =
            config.reflected_mass() * config.reflected_mass() * state.drive.acceleration_variance();
        let residual = config.residual_variance(state.load) + unknown_drive;
        let [stiffness, clearance, friction] = config.factor_sds();
        let drift = |deviation: f32| deviation * deviation * FilterConfiguration::drift_rate() * time;
        Bias::new(
            residual * 2.0 * time / config.residual_time(),
            drift(stiffness),
            drift(clearance),
            drift(friction),
            drift(config.damping_sd()),
        )
    }

    /// Corrects the state by the measured position and, where it is measured, the drive force.
    fn correct(&self, state: &mut State, measured: &Measurement) {
        let noise = self.config.noise.position_m;
        let y = state.covariance.correct_position(0, measured.journal_y_m - state.motion.x, noise * noise);
        state.motion += y.motion;
        state.bias += y.bias;
        let z = state.covariance.correct_position(1, measured.journal_z_m - state.motion.y, noise * noise);
        state.motion += z.motion;
        state.bias += z.bias;
        let share = (self.config.sample_period_s / INNOVATION_TIME_S).min(1.0);
        state.innovation += share * (y.normalised + z.normalised - state.innovation);
        if let Some(force) = measured.drive_force_n {
            let at = self.evaluate(state);
            let noise = self.config.noise.drive_force_n;
            let drive = state.covariance.correct_scalar(
                &at.drive_force_gradient(),
                force - at.drive_force,
                noise * noise,
            );
            state.motion += drive.motion;
            state.bias += drive.bias;
        }
        self.scale_damping(state);
        let (low, high) = FACTOR_RANGE;
        for place in [STIFFNESS, FRICTION] {
            if let Some(factor) = state.bias.get_mut(place) {
                *factor = factor.clamp(low, high);
            }
        }
    }

    /// Moves the estimated change of the damping from the bias into the approach speed.
    ///
    /// The speed of an onset may be wrong by a multiple, so the change counts as the logarithm of a
    /// factor. `(1 - l/2)/(1 + l/2)` is `exp(-l)` to the third order, and positive.
    fn scale_damping(&self, state: &mut State) {
        let Some(damping) = state.bias.get_mut(DAMPING) else { return };
        let half = 0.5 * damping.clamp(-MAX_DAMPING_CHANGE, MAX_DAMPING_CHANGE);
        *damping = 0.0;
        let (low, high) = APPROACH_RANGE;
        let approach = state.approach * (1.0 - half) / (1.0 + half);
        state.approach = approach.clamp(low * self.config.latch_floor_m_s, high * self.config.speed_sd());
    }

    /// Returns accelerations and forces at a state, after its deviations have been brought up to
    /// date.
    fn evaluate(&self, state: &mut State) -> Evaluated {
        let drive = state.drive.motion();
        state.deviations = self.dynamics.deviations(&state.motion, &state.bias, &drive, &state.covariance);
        let inputs = Inputs { drive, load: state.load, approach: state.approach };
        self.dynamics.evaluate(&state.motion, &state.bias, &inputs, &state.deviations)
    }

    /// Latches the approach speed at the onset of contact; returns the forces after that.
    ///
    /// The speed is uncertain by the deviation of the rate, and by the time at which the journal
    /// passed a clearance that is not exactly known. An uncertain speed is replaced by the middle,
    /// on a logarithmic scale, of what is possible; the damping factor finds the rest.
    fn onset(&self, state: &mut State) -> Evaluated {
        let at = self.evaluate(state);
        let place = at.forces.place;
        let deformation_sd = state.deviations.deformation;
        if place.deformation < -SEPARATION * deformation_sd {
            state.is_touching = false;
        }
        if state.is_touching || place.deformation <= 0.0 {
            return at;
        }
        let floor = self.config.latch_floor_m_s;
        let rate_sd = libm::sqrtf(state.covariance.speed_variance(place.normal_y, place.normal_z));
        let speed = place.rate.max(0.5 * rate_sd).max(floor);
        let passing = at.acceleration_size() * deformation_sd / (speed * speed);
        let spread = libm::hypotf(rate_sd / speed, passing);
        let least = (speed / (1.0 + spread)).max(floor);
        let ratio = libm::sqrtf(speed / least);
        state.approach = speed / ratio;
        state.is_touching = true;
        let deviation = libm::hypotf(self.config.damping_sd(), spread.min(ratio));
        state.covariance.restart_bias(DAMPING, deviation);
        self.evaluate(state)
    }

    /// Returns the estimate of a state.
    fn estimate(&self, state: &State, at: &Evaluated) -> FilterEstimate {
        let Forces { place, normal, friction, .. } = at.forces;
        let covariance = &state.covariance;
        let (force_y_n, force_z_n) = at.forces.components();
        let mass = self.config.uncertainty.mass_share;
        let gradient = at.forces.normal_gradient();
        let least = square(self.dynamics.contact.force_of_noise(self.config.noise.position_m));
        let friction_variance = covariance.variance(&at.forces.friction_gradient(&gradient))
            + square(at.forces.friction_curvature)
            + square(mass * friction);
        let normal_variance = covariance.variance(&gradient)
            + square(at.forces.normal_curvature)
            + square(mass * normal)
            + least;
        let excess = (state.innovation / EXPECTED_INNOVATION).max(1.0);
        let fits = state.innovation <= MAX_INNOVATION;
        let widening = if fits { 1.0 } else { excess };
        let bias = |place: usize| state.bias.get(place).copied().unwrap_or_default();
        let deviation = |place: usize| reported_root(covariance.bias_variance(place));
        let radius = self.config.journal_radius_m;
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
            clearance_m: self.config.radial_clearance_m + bias(CLEARANCE),
            clearance_sd_m: deviation(CLEARANCE),
            stiffness_factor: 1.0 + bias(STIFFNESS),
            stiffness_sd: deviation(STIFFNESS),
            friction_factor: 1.0 + bias(FRICTION),
            friction_sd: deviation(FRICTION),
            is_converging: self.is_converging(state, at),
            fits,
        }
    }

    /// Returns true as long as the start dominates the uncertainty: of the drive's motion, or of
    /// the deformation in contact.
    fn is_converging(&self, state: &State, at: &Evaluated) -> bool {
        let config = &self.config;
        let drive_variance = square(config.reflected_mass()) * state.drive.acceleration_variance();
        let deformation = at.forces.place.deformation.max(config.uncertainty.clearance_m);
        drive_variance > config.residual_variance(state.load)
            || state.deviations.deformation > 0.1 * deformation
    }
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

const _: () = assert!(size_of::<Gradient>() == 4 * (MOTION + 5));
