//! One tick: a sensor sample becomes an estimate of the contact forces with its deviations.
//!
//! A calibrated sample is checked ([`Plausibility`]). The filter ([`crate::filter`]) predicts the
//! motion of the journal over a sample period and corrects it by the sample. At the estimated
//! contact the networks ([`inference::Pair`]) compute their forces. If the configuration names them
//! as the source of the contact, their ratios to the analytic law enter the filter's next
//! prediction and estimate; the law gives the gradients. Networks that are outside their training
//! range or the law's envelope, corrupted or still warming up are flagged, and the law is used.
//!
//! A sample whose motion cannot be trusted is predicted only. After lost samples the filter
//! continues with what it has learnt about the bearing.
//!
//! Configuration and state are separate. [`crate::integrity`] guards both from outside. The
//! networks compute in integers; the filter in f32 with operations that have the same bits on every
//! machine.

mod angle;
mod envelope;
mod jumps;
mod plausibility;
mod setup;

use inference::{ContactState, Flags, Model, Pair, Sample};
use link::crc32::Digest;
use link::track::MonitorConfiguration;
use link::{BenchConfiguration, EstimateFrame, Refusal, SensorFrame};

pub use plausibility::STUCK_SAMPLES;
pub(crate) use plausibility::{Limits, Plausibility, SwingLimit};
pub(crate) use setup::bench_ranges;
pub use setup::{SAMPLE_PERIOD_RANGE_US, filter_configuration};

use crate::filter::{FilterEstimate, FilterState, Measurement, NetworkForces, Skew};
use crate::flags::{
    CONVERGING, IMPLAUSIBLE_POSITION, JUMP, MODEL_MISFIT, NETWORK_OUTSIDE_LAW, NOT_STARTED, SENSOR_MISSING,
    SENSOR_SATURATED, SEQUENCE_GAP, STUCK, TIME_FAULT,
};
use crate::integrity::{Guarded, Words, words};
use angle::angle_rad;
use envelope::UNUSABLE;
use jumps::Jumps;
use setup::Setup;

/// Newtons in a millinewton.
const MILLI: f32 = 1e-3;
/// Samples with these flags do not show the motion of the journal.
const NO_MOTION: Flags = Flags::from_bits(
    SENSOR_MISSING.bits() | SENSOR_SATURATED.bits() | STUCK.bits() | IMPLAUSIBLE_POSITION.bits(),
);
/// Flags after which the earlier samples are not one sample period away.
const LOST_SAMPLES: Flags = Flags::from_bits(SEQUENCE_GAP.bits() | TIME_FAULT.bits());

/// The estimator of one bench.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Estimator {
    state: Guarded<State>,
    setup: Setup,
    plausibility: Plausibility,
    /// The filter's estimate while the networks work.
    waiting: Guarded<FilterEstimate>,
    pair: Pair<'static>,
    sample: Sample,
}

/// Knowledge from earlier samples.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    filter: FilterState,
    jumps: Jumps,
    /// Last load that was not faulty, N.
    load_n: f32,
}
words!(State { filter, jumps, load_n });

impl Estimator {
    /// Creates the estimator for a bench from a model image.
    ///
    /// # Errors
    ///
    /// A value of the configuration is out of range, or the image is damaged or made for another
    /// bearing. The monitor's fields are taken as validated ([`crate::monitor::ranges`]).
    pub fn new(
        image: &'static [u8],
        bench: &BenchConfiguration,
        monitor: &MonitorConfiguration,
    ) -> Result<Self, Refusal> {
        let (setup, model) = Setup::new(image, bench, monitor)?;
        Ok(Self {
            plausibility: Plausibility::new(bench.radial_clearance_nm, bench.sample_period_us),
            state: Guarded::new(State::default()),
            waiting: Guarded::new(FilterEstimate::UNKNOWN),
            pair: Pair::new(model),
            sample: Sample::default(),
            setup,
        })
    }

    /// Adds everything that configuration and image set to the CRC of the configuration.
    pub(crate) fn add_config_to(&self, crc: &mut Digest) {
        self.setup.add_to(crc);
        self.plausibility.add_config_to(crc);
        self.pair.hash_config(crc);
    }

    /// Returns the checks of the samples, with the findings in the last one.
    #[must_use]
    pub(crate) const fn plausibility(&self) -> &Plausibility {
        &self.plausibility
    }

    /// Returns the checks of the samples, to set limits and the drivers' status of the next one.
    pub(crate) const fn plausibility_mut(&mut self) -> &mut Plausibility {
        &mut self.plausibility
    }

    /// Inputs of the networks at the last tick, as integers.
    #[must_use]
    pub const fn sample(&self) -> &Sample {
        &self.sample
    }

    /// The same in SI units, for a comparison with another law.
    #[must_use]
    pub fn contact(&self) -> ContactState {
        ContactState {
            radial_clearance_m: self.sample.radial_clearance_nm as f32 * 1e-9,
            deformation_m: self.sample.deformation_pm as f32 * 1e-12,
            deformation_rate_m_s: self.sample.deformation_rate_nm_s as f32 * 1e-9,
            approach_speed_m_s: self.sample.approach_speed_nm_s as f32 * 1e-9,
            sliding_speed_m_s: self.sample.sliding_speed_nm_s as f32 * 1e-9,
        }
    }

    /// Switches to another model of the same bearing from the next sample on. The networks'
    /// history starts anew; the filter continues.
    pub(crate) fn switch(&mut self, model: Model<'static>) {
        self.setup.set_model(&model);
        self.pair.switch(model);
    }

    /// Sets the time between the samples of the probes.
    pub(crate) const fn set_skew(&mut self, skew: Skew) {
        self.setup.filter.set_skew(skew);
    }

    /// Takes one sample and estimates. The tick count of the result is 0; a caller that can
    /// measure it sets it.
    // Not inlined: merged with the monitor there are too few registers.
    #[inline(never)]
    pub fn step(&mut self, frame: &SensorFrame) -> EstimateFrame {
        let is_state_corrupted = self.check_state();
        let doubts = self.plausibility.check(frame);
        let lost = doubts.intersects(LOST_SAMPLES).then_some(self.plausibility.lost());
        let (measured, is_suspect) = self.measurement(frame, doubts, lost);
        let estimate = self.setup.filter.step(&mut self.state.value_mut().filter, &measured, lost);
        self.sample = Setup::sample(&estimate);
        self.waiting.store(estimate);

        let mut networks = self.pair.step(&self.sample);
        let (estimate, is_waiting_corrupted) = self.waiting.load();
        let is_tick_corrupted = is_waiting_corrupted | networks.is_corrupted();
        let forces = NetworkForces {
            normal_n: networks.normal_force_mn as f32 * MILLI,
            friction_n: networks.friction_force_mn as f32 * MILLI,
            blend_n: self.setup.blend_n,
        };
        let is_usable = !networks.flags.intersects(UNUSABLE);
        let is_outside = is_usable & self.setup.envelope.is_outside(forces.normal_n, estimate.law_force_n);
        let is_source = self.setup.uses_networks & is_usable & !is_outside & !is_tick_corrupted;
        let state = &mut self.state.value_mut().filter;
        self.setup.filter.set_networks(state, is_source.then_some(forces));
        self.state.seal(false);

        let flags = doubts
            | JUMP.when(is_suspect)
            | networks.flags
            | NETWORK_OUTSIDE_LAW.when(is_outside)
            | Flags::CORRUPTED.when(is_state_corrupted | is_tick_corrupted)
            | CONVERGING.when(estimate.is_converging)
            | MODEL_MISFIT.when(!estimate.fits)
            | NOT_STARTED.when(!estimate.force_sd_n.is_finite());
        let radius_m = self.setup.journal_radius_m;
        EstimateFrame {
            sequence: frame.sequence,
            time_us: frame.time_us,
            normal_force_n: estimate.normal_force_n,
            force_y_n: estimate.force_y_n,
            force_z_n: estimate.force_z_n,
            friction_torque_nm: estimate.friction_torque_nm,
            deformation_m: estimate.deformation_m,
            contact_angle_rad: angle_rad(estimate.normal_y, estimate.normal_z),
            normal_force_sd_n: estimate.normal_force_sd_n,
            force_sd_n: estimate.force_sd_n,
            friction_torque_sd_nm: estimate.friction_torque_sd_nm,
            network_force_n: forces.normal_n,
            network_torque_nm: forces.friction_n * radius_m,
            law_force_n: estimate.law_force_n,
            law_torque_nm: estimate.law_friction_n * radius_m,
            clearance_m: estimate.clearance_m,
            clearance_sd_m: estimate.clearance_sd_m,
            stiffness_factor: estimate.stiffness_factor,
            stiffness_sd: estimate.stiffness_sd,
            friction_factor: estimate.friction_factor,
            friction_sd: estimate.friction_sd,
            flags: flags.bits(),
            saturated: networks.saturated,
            instruction_ticks: 0,
        }
    }

    /// Converts a sample: without its motion if that cannot be trusted, with the last good load if
    /// its own is faulty. Returns whether it is not trusted because of a jump.
    #[inline]
    fn measurement(&mut self, frame: &SensorFrame, doubts: Flags, lost: Option<u32>) -> (Measurement, bool) {
        let State { load_n: load, jumps, .. } = self.state.value_mut();
        if !self.plausibility.findings().is_load_faulty() {
            *load = frame.load_force_mn as f32 * MILLI;
        }
        let has_no_value =
            [frame.journal_y_nm, frame.journal_z_nm, frame.shaft_angle_nrad].contains(&i32::MIN);
        let is_missing = doubts.contains(SENSOR_MISSING) | has_no_value;
        // Of a repeated or earlier sample the number is above 2^31: no time has passed.
        let lost = lost.filter(|&lost| lost < 1 << 31);
        let passed_us = self.setup.sample_period_us.saturating_mul(lost.unwrap_or(0).saturating_add(1));
        let events = (doubts.contains(JUMP), is_missing);
        let is_trusted = jumps.is_trusted(frame, events, (passed_us, lost.is_some()));
        let is_usable = is_trusted & !doubts.intersects(NO_MOTION);
        (self.setup.measurement(frame, *load, is_usable), !is_trusted & !is_missing)
    }

    /// Checks the state; returns true if it is corrupted. Everything that was learnt is forgotten
    /// then.
    #[inline]
    fn check_state(&mut self) -> bool {
        let is_corrupted = self.state.is_corrupted();
        if is_corrupted {
            self.state = Guarded::new(State::default());
        }
        is_corrupted
    }
}

/// The flags of an estimate as a set.
#[must_use]
pub const fn flags_of(estimate: &EstimateFrame) -> Flags {
    Flags::from_bits(estimate.flags)
}
