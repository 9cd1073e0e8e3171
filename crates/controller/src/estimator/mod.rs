//! One tick: a sensor sample becomes an estimate of the contact forces.
//!
//! A calibrated sample is checked ([`Plausibility`]). Its position gives distance and direction of
//! the journal ([`ContactFrame`]), parabolas through the last samples give the motion (`signals`).
//! Newton's law predicts the rate of the deformation and the measured position corrects it
//! (`newton`, `observer`). The latch holds the approach speed of the onset (`latch`). Deformation,
//! rate, approach and sliding speed go through the networks ([`inference::Pair`]), whose forces
//! become force components, torque and flags.
//!
//! Every part has constants, set by the configuration, and a state. [`crate::integrity`] guards
//! both from outside. Integers from the sensor frame to the networks' forces; no branch depends on
//! data except the restart of the history after a fault.
//!
//! The table gives noise, delay and error of the conditioned signals at 10 kHz. Noise gains are per
//! unit of one sample's noise (of rates: per sample, so 0.0112 is 0.022 mm/s for 0.2 um). Errors
//! are shares of the amplitude at 10, 30, 45, 65, 100 Hz. The delay is the largest from 10 to 100
//! Hz. A test in `response_tests.rs` computes them:
//!
//! | output | noise gain | error, % | delay, ms | good after, samples |
//! |---|---|---|---|---|
//! | deformation, observer alone | 0.2691 | 2, 6, 15, 30, 59 | 0.78 | 250 |
//! | deformation, window | 0.4735 | 0, 0, 1, 2, 8 | 0.07 | 36 |
//! | rate, observer alone | 0.0112 | 12, 37, 56, 82, 114 | 2.19 | 250 |
//! | rate, Newton's law right to a tenth | 0.0112 | 1, 4, 6, 8, 11 | 0.20 | 250 |
//! | rate, window | 0.0626 | 0, 4, 9, 19, 44 | 0.39 | 36 |
//! | journal's speed | 0.1137 | 0, 2, 4, 9, 20 | 0.14 | 24 |
//! | shaft's speed | 0.0267 | 2, 14, 30, 59, 118 | 1.31 | 64 |
//!
//! The rows "observer alone" hold for motion that Newton's law does not predict; where its error
//! exceeds the noise, the window takes over.
//!
//! The direction of the contact is that of the newest raw sample, without delay: at half a
//! millimetre, 0.2 um of noise turn it by 0.4 mrad; a parabola through a swing of 60 Hz would turn
//! it by 28 mrad. Until the windows are full after a start, a gap or a jump, the newest raw
//! position is used and the rates are 0: flagged, not guessed.

mod arithmetic;
mod conditioning;
mod geometry;
mod latch;
mod newton;
mod observer;
mod plausibility;
#[cfg(test)]
mod response_tests;
mod setup;
mod signals;
#[cfg(test)]
mod tests;
mod window;

use inference::{ContactState, Flags, Model, Pair, Sample};
use link::crc32::Digest;
use link::{BenchConfiguration, EstimateFrame, Refusal, SensorFrame};

pub use conditioning::{Conditioning, MASS_RANGE_G, Masses, NOISE_RANGE_NM};
pub use geometry::{ContactFrame, DISTANCE_STEPS_PER_NM, POSITION_LIMIT_NM};
pub use plausibility::{Findings, Limits, MAX_DEFORMATION_NM, Plausibility, STUCK_SAMPLES, SwingLimit};
pub(crate) use setup::bearing_of;
pub use setup::{SAMPLE_PERIOD_RANGE_US, bench_ranges};
pub use signals::{DEFORMATION_WINDOW, SHAFT_WINDOW, SWING_WINDOW, WINDOW};
pub use window::{WideWindow, Window};

use crate::flags::{ONSET_NOT_SEEN, WINDOW_FILLING};
use crate::integrity::{Guarded, Words, words};
use arithmetic::saturated;
use geometry::cut;
use latch::{Latch, LatchState};
use newton::{Newton, NewtonState, PreviousEstimate};
use observer::{Observer, ObserverState, Radial};
use plausibility::DISCONTINUITY;
use setup::Setup;
use signals::{Motion, Signals, SignalsState};

/// Metres in a step of the distance.
const STEP_M: f32 = 1e-9 / DISTANCE_STEPS_PER_NM as f32;
/// Newtons in a millinewton.
const MILLI: f32 = 1e-3;

/// The estimator of one bench.
#[derive(Clone, Debug)]
pub struct Estimator {
    config: Config,
    plausibility: Plausibility,
    signals: SignalsState,
    conditioner: Guarded<ConditionerState>,
    latch: Guarded<LatchState>,
    /// The contact frame while the windows work.
    contact: Guarded<ContactFrame>,
    /// The conditioned contact while the networks work.
    conditioned: Guarded<Conditioned>,
    pair: Pair<'static>,
    sample: Sample,
}

/// Constants of a tick, set by configuration and image.
#[derive(Clone, Debug)]
struct Config {
    setup: Setup,
    signals: Signals,
    newton: Newton,
    observer: Observer,
    latch: Latch,
}
words!(Config { setup, signals, newton, observer, latch });

/// State of prediction and observer.
#[derive(Clone, Copy, Debug)]
struct ConditionerState {
    newton: NewtonState,
    observer: ObserverState,
}
words!(ConditionerState { newton, observer });

/// The part of the contact that is read again after the networks have returned its forces.
#[derive(Clone, Copy, Debug, Default)]
struct Conditioned {
    normal_y: i32,
    normal_z: i32,
    radial: Radial,
    approach_nm_s: u32,
}
words!(Conditioned { normal_y, normal_z, radial, approach_nm_s });

impl Estimator {
    /// Creates the estimator for a bench from a model image, with the masses of the project's
    /// bench.
    ///
    /// # Errors
    ///
    /// A value of the configuration is out of range, or the image is damaged or made for another
    /// bearing.
    pub fn new(image: &'static [u8], configuration: BenchConfiguration) -> Result<Self, Refusal> {
        let bearing = bearing_of(&configuration)?;
        Self::conditioned(image, configuration, &Conditioning::for_bearing(bearing))
    }

    /// Creates the estimator for a bench from a model image and the masses and noise for its
    /// conditioning.
    ///
    /// # Errors
    ///
    /// A value of the configuration is out of range, or the image is damaged or made for another
    /// bearing.
    pub fn conditioned(
        image: &'static [u8],
        configuration: BenchConfiguration,
        conditioning: &Conditioning,
    ) -> Result<Self, Refusal> {
        let (setup, model) = Setup::new(image, configuration)?;
        let period_us = configuration.sample_period_us;
        let newton = Newton::new(conditioning, period_us);
        let config = Config {
            signals: Signals::new(period_us, configuration.journal_radius_nm),
            observer: Observer::new(period_us, conditioning.noise_nm, newton.has_masses()),
            newton,
            latch: Latch::new(setup.latch_floor_nm_s, setup.unseen_approach_nm_s),
            setup,
        };
        Ok(Self {
            plausibility: Plausibility::new(configuration.radial_clearance_nm, period_us),
            signals: SignalsState::new(),
            conditioner: Guarded::new(ConditionerState {
                newton: NewtonState::default(),
                observer: config.observer.start(),
            }),
            latch: Guarded::new(config.latch.unknown()),
            contact: Guarded::default(),
            conditioned: Guarded::default(),
            pair: Pair::new(model),
            sample: Sample::default(),
            config,
        })
    }

    /// Adds everything that configuration and image set to the CRC of the configuration.
    pub(crate) fn add_config_to(&self, crc: &mut Digest) {
        self.config.add_to(crc);
        self.plausibility.add_config_to(crc);
        self.pair.hash_config(crc);
    }

    /// Returns the checks of the samples, with the findings in the last one.
    #[must_use]
    pub const fn plausibility(&self) -> &Plausibility {
        &self.plausibility
    }

    /// Returns the checks of the samples, to set limits and the drivers' status of the next one.
    pub const fn plausibility_mut(&mut self) -> &mut Plausibility {
        &mut self.plausibility
    }

    /// Inputs of the networks at the last tick, as integers.
    #[must_use]
    pub const fn sample(&self) -> &Sample {
        &self.sample
    }

    /// The same in SI units, for a comparison with another law.
    #[must_use]
    pub fn state(&self) -> ContactState {
        ContactState {
            radial_clearance_m: self.sample.radial_clearance_nm as f32 * 1e-9,
            deformation_m: self.sample.deformation_pm as f32 * 1e-12,
            deformation_rate_m_s: self.sample.deformation_rate_nm_s as f32 * 1e-9,
            approach_speed_m_s: self.sample.approach_speed_nm_s as f32 * 1e-9,
            sliding_speed_m_s: self.sample.sliding_speed_nm_s as f32 * 1e-9,
        }
    }

    /// Switches to another model of the same bearing from the next sample on. The networks'
    /// history starts anew. The prediction takes the new model's floor; observer and latch
    /// continue.
    pub fn switch(&mut self, model: Model<'static>) {
        self.config.setup.image_floor_nm_s = model.header().latch_floor_nm_s;
        self.pair.switch(model);
    }

    /// Takes one sample and estimates. The tick count of the result is 0; a caller that can
    /// measure it sets it.
    // Not inlined, like `Signals::push`, the observer, the tracker and the safe state: merged with
    // the monitor there are too few registers, which costs a hundred instructions.
    #[inline(never)]
    pub fn step(&mut self, frame: &SensorFrame) -> EstimateFrame {
        let is_conditioner_corrupted = self.check_conditioner();
        let doubts = self.plausibility.check(frame);
        if doubts.intersects(DISCONTINUITY) {
            self.restart();
        }

        let (y, z) = (cut(frame.journal_y_nm), cut(frame.journal_z_nm));
        let contact = ContactFrame::at(y, z);
        let deformation = self.deformation(&contact);
        self.contact.store(contact);
        let motion = self.config.signals.push(&mut self.signals, y, z, deformation, frame.shaft_angle_nrad);
        let (contact, is_contact_corrupted) = self.contact.load();

        let turning = contact.turning(motion.y_nm_s, motion.z_nm_s);
        let radial = self.observe(&contact, turning, &motion, is_conditioner_corrupted);
        let (approach_nm_s, is_onset_seen, is_latch_corrupted) =
            self.update_latch(radial, motion.is_rate_known);
        self.sample = Sample {
            radial_clearance_nm: self.config.setup.radial_clearance_nm,
            // 62.5 pm a step.
            deformation_pm: saturated(i64::from(radial.deformation).wrapping_mul(125) >> 1),
            deformation_rate_nm_s: radial.rate_nm_s,
            approach_speed_nm_s: approach_nm_s,
            sliding_speed_nm_s: motion.surface_nm_s.saturating_sub(turning),
        };

        let ContactFrame { normal_y, normal_z, .. } = contact;
        self.conditioned.store(Conditioned { normal_y, normal_z, radial, approach_nm_s });
        let mut forces = self.pair.step(&self.sample);
        let (Conditioned { normal_y, normal_z, radial, approach_nm_s }, is_conditioned_corrupted) =
            self.conditioned.load();
        let contact = contact.towards(normal_y, normal_z);
        let is_tick_corrupted = is_contact_corrupted
            | is_conditioned_corrupted
            | forces.is_corrupted()
            | forces.flags.contains(Flags::CORRUPTED);

        let (normal_mn, friction_mn) = (forces.normal_force_mn, forces.friction_force_mn);
        let (force_y_mn, force_z_mn) = contact.force(normal_mn, friction_mn);
        let estimate = PreviousEstimate {
            normal_mn,
            friction_mn,
            force_y_mn,
            rate_nm_s: radial.rate_nm_s,
            approach_nm_s: approach_nm_s.max(self.config.setup.image_floor_nm_s),
            is_warm: !forces.flags.contains(Flags::WARMING_UP),
        };
        self.config.newton.store(
            &mut self.conditioner.value_mut().newton,
            &estimate,
            radial.deformation <= 0,
        );
        self.conditioner.seal(is_tick_corrupted);

        // A saturated rate is not the true one.
        let is_rate_cut = (radial.rate_nm_s == i32::MAX) | (radial.rate_nm_s == i32::MIN);
        let flags = doubts
            | WINDOW_FILLING.when(!motion.is_full)
            | ONSET_NOT_SEEN.when(!is_onset_seen)
            | Flags::OUTSIDE_RATE_RATIO.when(is_rate_cut & (radial.deformation > 0))
            | Flags::CORRUPTED.when(is_conditioner_corrupted | is_latch_corrupted | is_tick_corrupted)
            | forces.flags;
        EstimateFrame {
            sequence: frame.sequence,
            time_us: frame.time_us,
            normal_force_n: normal_mn as f32 * MILLI,
            force_y_n: force_y_mn as f32 * MILLI,
            force_z_n: force_z_mn as f32 * MILLI,
            friction_torque_nm: friction_mn as f32 * MILLI * self.config.setup.journal_radius_m,
            deformation_m: radial.deformation as f32 * STEP_M,
            contact_angle_rad: contact.angle_rad(),
            flags: flags.bits(),
            saturated: forces.saturated,
            instruction_ticks: 0,
        }
    }

    /// Returns the deformation at a journal position, nm/16; negative without contact.
    #[inline]
    fn deformation(&self, contact: &ContactFrame) -> i32 {
        contact.distance.saturating_sub(self.config.setup.radial_clearance)
    }

    /// Returns deformation and rate: Newton's law predicts, the observer corrects, the window
    /// replaces both without contact.
    #[inline]
    fn observe(
        &mut self,
        contact: &ContactFrame,
        turning: i32,
        motion: &Motion,
        is_conditioner_corrupted: bool,
    ) -> Radial {
        let window = Radial { deformation: motion.deformation, rate_nm_s: motion.deformation_rate_nm_s };
        let is_open = !motion.is_rate_known | (window.deformation < 0) | is_conditioner_corrupted;
        let is_settled = motion.is_rate_known & !is_conditioner_corrupted;
        let measured = self.deformation(contact);
        let Config { newton, observer, .. } = &self.config;
        let state = self.conditioner.value_mut();
        let predicted = newton.rate_nm_s(&mut state.newton, contact, turning, motion.y_nm_s, is_settled);
        observer.step(&mut state.observer, measured, window, predicted, is_open)
    }

    /// Updates the latch, which restarts if it is corrupted. Returns the approach speed in nm/s,
    /// whether the onset of the contact was seen, and whether the latch was corrupted.
    #[inline]
    fn update_latch(&mut self, radial: Radial, is_rate_known: bool) -> (u32, bool, bool) {
        let latch = &self.config.latch;
        let is_corrupted = self.latch.is_corrupted();
        let state = self.latch.value_mut();
        if is_corrupted {
            *state = latch.unknown();
        }
        let (approach_nm_s, is_onset_seen) =
            latch.update(state, radial.deformation, radial.rate_nm_s, is_rate_known);
        self.latch.seal(false);
        (approach_nm_s, is_onset_seen, is_corrupted)
    }

    /// Checks the state of prediction and observer; returns true if it is corrupted. The prediction
    /// is then restarted; the observer follows the window.
    #[inline]
    fn check_conditioner(&mut self) -> bool {
        let is_corrupted = self.conditioner.is_corrupted();
        if is_corrupted {
            self.conditioner.value_mut().newton.restart();
        }
        is_corrupted
    }

    /// Restarts everything that depends on the samples before this one.
    fn restart(&mut self) {
        self.signals.restart();
        self.conditioner.value_mut().newton.restart();
        self.latch = Guarded::new(self.config.latch.unknown());
        self.pair.reset();
    }
}

/// The flags of an estimate as a set.
#[must_use]
pub const fn flags_of(estimate: &EstimateFrame) -> Flags {
    Flags::from_bits(estimate.flags)
}
