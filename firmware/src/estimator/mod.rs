//! One tick: a sensor sample becomes an estimate of the contact's forces.
//!
//! A calibrated sample: checks ([`Plausibility`]) -> distance and direction ([`ContactFrame`]) -> motion (parabolas
//! through the last samples, `signals`) -> deformation and its rate (Newton's law ahead, the measured position behind,
//! `newton` and `observer`) -> onset ([`Latch`]) -> sliding speed -> networks ([`inference::Pair`])
//! -> force components, torque, flags. Whole numbers from the sensor frame to the networks' forces; no branch on data but for a restart of the
//! history after a fault.
//!
//! Noise, delay and error of what the sensors' samples become, at 10 kHz; noise gains are per unit of one sample's noise (rates: a sample, so 0.0112 is
//! 0.022 mm/s for 0.2 um), errors are shares of the amplitude at 10, 30, 45, 65, 100 Hz, the delay is the worst from 10 to 100 Hz. Computed by the test in `response.rs`:
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
//! The observer alone is what a motion gets that Newton's law does not tell; what of it exceeds the noise hands over to the window.
//!
//! The contact's direction is that of the newest raw sample, no delay: at half a millimetre 0.2 um of noise turn it by 0.4 mrad, a
//! parabola through a swing of 60 Hz by 28 mrad. Until the windows are full after a start, a gap or a jump the newest raw position is used and
//! the rates are 0: flagged, not guessed.

mod conditioning;
mod geometry;
mod latch;
mod newton;
mod observer;
mod plausibility;
#[cfg(test)]
mod response;
mod setup;
mod signals;
#[cfg(test)]
mod tests;
mod whole;
mod window;

use inference::held::{WordSum, hold};
use inference::{ContactState, Flags, Model, Pair, Sample};
use link::{Configuration, EstimateFrame, Refusal, SensorFrame};

pub use conditioning::{Conditioning, MASS_RANGE_G, Masses, NOISE_RANGE_NM};
pub use geometry::{ContactFrame, DISTANCE_STEPS_PER_NM, POSITION_LIMIT_NM};
pub use latch::Latch;
pub use plausibility::{Findings, Limits, MAX_DEFORMATION_NM, Plausibility, STUCK_SAMPLES, SwingLimit};
pub(crate) use setup::bearing_of;
pub use setup::bench_ranges;
pub use signals::{DEFORMATION_WINDOW, SHAFT_WINDOW, SWING_WINDOW, WINDOW};
pub use window::{WideWindow, Window};

use crate::constants::Sum;
use crate::flags::{ONSET_NOT_SEEN, WINDOW_FILLING};
use geometry::cut;
use newton::{Newton, Told};
use observer::{Observer, Radial};
use plausibility::DISCONTINUITY;
use setup::Setup;
use signals::Signals;
use whole::saturated;

/// Metres in a step of the distance.
const STEP_M: f32 = 1e-9 / DISTANCE_STEPS_PER_NM as f32;
/// Newtons in a millinewton.
const MILLI: f32 = 1e-3;

/// The estimator of one bench.
#[derive(Clone, Debug)]
pub struct Estimator {
    setup: Setup,
    plausibility: Plausibility,
    signals: Signals,
    newton: Newton,
    observer: Observer,
    latch: Latch,
    pair: Pair<'static>,
    sample: Sample,
    /// Of what observer and Newton's law have carried over from the last tick; another one after a tick that was spoilt.
    carried: WordSum,
}

impl Estimator {
    /// Creates the estimator for a bench from a model image, with the masses of the project's bench.
    ///
    /// # Errors
    ///
    /// A value of the configuration is out of range, or the image is damaged or made for another bearing.
    pub fn new(image: &'static [u8], configuration: Configuration) -> Result<Self, Refusal> {
        let bearing = bearing_of(&configuration)?;
        Self::conditioned(image, configuration, &Conditioning::of_bench(bearing))
    }

    /// Creates the estimator for a bench from a model image and what its conditioning is told.
    ///
    /// # Errors
    ///
    /// A value of the configuration is out of range, or the image is damaged or made for another bearing.
    pub fn conditioned(
        image: &'static [u8],
        configuration: Configuration,
        conditioning: &Conditioning,
    ) -> Result<Self, Refusal> {
        let (setup, model) = Setup::new(image, configuration)?;
        let period_us = configuration.sample_period_us;
        let newton = Newton::new(conditioning, period_us);
        let mut estimator = Self {
            plausibility: Plausibility::new(configuration.radial_clearance_nm, period_us),
            signals: Signals::new(period_us, configuration.journal_radius_nm),
            observer: Observer::new(period_us, conditioning.noise_nm, newton.has_masses()),
            newton,
            latch: Latch::new(setup.latch_floor_nm_s, setup.unseen_approach_nm_s),
            pair: Pair::new(model),
            sample: Sample::default(),
            carried: WordSum::default(),
            setup,
        };
        estimator.carried = estimator.carry();
        Ok(estimator)
    }

    /// What the configuration and the image set.
    pub(crate) fn constants(&self, sum: &mut Sum) {
        self.setup.constants(sum);
        self.plausibility.constants(sum);
        self.signals.constants(sum);
        self.newton.constants(sum);
        self.observer.constants(sum);
        self.latch.constants(sum);
        self.pair.constants(sum);
    }

    /// The watch over the samples: what was found in the last one.
    #[must_use]
    pub const fn plausibility(&self) -> &Plausibility {
        &self.plausibility
    }

    /// The watch over the samples, to be given its limits and what the drivers say of the next one.
    pub const fn plausibility_mut(&mut self) -> &mut Plausibility {
        &mut self.plausibility
    }

    /// The contact as the networks saw it at the last tick, in whole numbers.
    #[must_use]
    pub const fn sample(&self) -> &Sample {
        &self.sample
    }

    /// The same in SI units: what another law is to be held against.
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

    /// Goes on with another model of the same bearing from the next sample on. The networks' history starts anew; the conditioning and
    /// the latch, which do not depend on the model, go on.
    pub fn switch(&mut self, model: Model<'static>) {
        self.pair.switch(model);
    }

    #[inline]
    fn carry(&self) -> WordSum {
        let mut sum = WordSum::default();
        self.observer.carried(&mut sum);
        self.newton.carried(&mut sum);
        sum
    }

    /// Takes one sample and estimates. The tick count of the result is 0; whoever can measure it fills it in.
    // A function of its own, as `Signals::push`, the observer, the tracker and the holding are: in one with the monitor the registers do not suffice by
    // far, which costs a hundred instructions.
    #[inline(never)]
    pub fn step(&mut self, frame: &SensorFrame) -> EstimateFrame {
        let altered = self.carry() != self.carried;
        if altered {
            self.newton.restart();
        }
        let mut flags = self.plausibility.check(frame);
        if flags.intersects(DISCONTINUITY) {
            self.signals.restart();
            self.newton.restart();
            self.latch.reset();
            self.pair.reset();
        }
        let (y, z) = (cut(frame.journal_y_nm), cut(frame.journal_z_nm));
        let contact = ContactFrame::at(y, z);
        let measured = contact.distance.saturating_sub(self.setup.radial_clearance);
        let push = || self.signals.push(y, z, measured, frame.shaft_angle_nrad);
        let (kept, spoilt, motion) = hold(contact.words(), push);
        let contact = ContactFrame::of(kept);
        let measured = contact.distance.saturating_sub(self.setup.radial_clearance);
        let turning = contact.turning(motion.y_nm_s, motion.z_nm_s);
        let window = Radial { deformation: motion.deformation, rate_nm_s: motion.deformation_rate_nm_s };
        let open = !motion.rate_known | (window.deformation < 0) | altered;
        let settled = motion.rate_known & !altered;
        let predicted = self.newton.rate_nm_s(&contact, turning, motion.y_nm_s, settled);
        let radial = self.observer.step(measured, window, predicted, open);
        let (approach_nm_s, onset_seen) =
            self.latch.update(radial.deformation, radial.rate_nm_s, motion.rate_known);
        self.sample = Sample {
            radial_clearance_nm: self.setup.radial_clearance_nm,
            // 62.5 pm a step.
            deformation_pm: saturated(i64::from(radial.deformation).wrapping_mul(125) >> 1),
            deformation_rate_nm_s: radial.rate_nm_s,
            approach_speed_nm_s: approach_nm_s,
            sliding_speed_nm_s: motion.surface_nm_s.saturating_sub(turning),
        };
        let kept = [contact.normal_y, contact.normal_z, radial.deformation, radial.rate_nm_s];
        let [normal_y, normal_z, deformation, rate] = kept.map(i32::cast_unsigned);
        let kept = [normal_y, normal_z, deformation, rate, approach_nm_s];
        let ([normal_y, normal_z, deformation, rate, approach_nm_s], spoilt_too, mut estimate) =
            hold(kept, || self.pair.step(&self.sample));
        let contact = contact.towards(normal_y.cast_signed(), normal_z.cast_signed());
        let radial = Radial { deformation: deformation.cast_signed(), rate_nm_s: rate.cast_signed() };
        let spoilt =
            (spoilt | spoilt_too != 0) | estimate.is_spoilt() | estimate.flags.contains(Flags::ALTERED);
        let (normal_mn, friction_mn) = (estimate.normal_force_mn, estimate.friction_force_mn);
        let (force_y_mn, force_z_mn) = contact.force(normal_mn, friction_mn);
        let told = Told {
            normal_mn,
            friction_mn,
            force_y_mn,
            rate_nm_s: radial.rate_nm_s,
            approach_nm_s: approach_nm_s.max(self.setup.image_floor_nm_s),
            warm: !estimate.flags.contains(Flags::WARMING_UP),
        };
        self.newton.remember(&told, radial.deformation <= 0);
        self.carried = self.carry().spoilt(spoilt);

        // A rate at the end of its whole numbers is another one.
        let cut_off = (radial.rate_nm_s == i32::MAX) | (radial.rate_nm_s == i32::MIN);
        flags |= WINDOW_FILLING.when(!motion.full)
            | ONSET_NOT_SEEN.when(!onset_seen)
            | Flags::OUTSIDE_RATE_RATIO.when(cut_off & (radial.deformation > 0))
            | Flags::ALTERED.when(altered | spoilt)
            | estimate.flags;
        EstimateFrame {
            sequence: frame.sequence,
            time_us: frame.time_us,
            normal_force_n: normal_mn as f32 * MILLI,
            force_y_n: force_y_mn as f32 * MILLI,
            force_z_n: force_z_mn as f32 * MILLI,
            friction_torque_nm: friction_mn as f32 * MILLI * self.setup.journal_radius_m,
            deformation_m: radial.deformation as f32 * STEP_M,
            contact_angle_rad: contact.angle_rad(),
            flags: flags.bits(),
            saturated: estimate.saturated,
            instruction_ticks: 0,
        }
    }
}

/// The flags of an estimate as a set.
#[must_use]
pub const fn flags_of(estimate: &EstimateFrame) -> Flags {
    Flags::from_bits(estimate.flags)
}
