//! Extended Kalman filter of the contact force, with the uncertainty of its estimate.
//!
//! States: position and speed of the journal, a residual force along Y, and what is not exactly
//! known about the bearing: factors on stiffness, friction and damping, and an offset of the
//! clearance. Measured are the position of the journal, the angle of the shaft, the load and, where
//! there is a sensor, the force of the drive. Without that sensor the mass is considered: a common
//! factor on mass, inertia, modulus and all forces leaves position and angle as they are, so no
//! filter can see it. `docs/estimation.md` derives the filter and quotes what it reaches.
//!
//! SI units throughout; f32 with `+ - * /` and functions of `libm`, so that every machine computes
//! the same bits. No heap, no panic; every division is by a number that is kept away from 0.

mod arithmetic;
mod configuration;
mod contact;
mod drive;
mod estimate;
mod measurement;
mod model;
mod motion;
mod noise_levels;
mod ratios;
mod skew;
mod state;

pub use configuration::{FilterConfiguration, FilterError, SensorNoise, Uncertainty};
pub use estimate::FilterEstimate;
pub use measurement::Measurement;
pub use skew::Skew;

use crate::integrity::{Checksum, Words};
pub(crate) use model::NetworkForces;
use model::{BenchModel, State};

/// The filter of one bench.
#[derive(Clone, Debug)]
pub struct Filter {
    model: FilterModel,
    state: FilterState,
}

/// Knowledge of the filter from earlier samples.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FilterState(Option<State>);

impl Words for FilterState {
    #[inline]
    fn add_to(&self, sum: &mut impl Checksum) {
        self.0.add_to(sum);
    }
}

/// Number of skipped samples above which a sequence number went back.
const MAX_SKIPPED: u32 = i32::MAX.cast_unsigned();

/// Constants of the filter of one bench, apart from its state.
#[derive(Clone, Debug)]
pub(crate) struct FilterModel(BenchModel);

impl Words for FilterModel {
    fn add_to(&self, sum: &mut impl Checksum) {
        self.0.add_to(sum);
    }
}

impl FilterModel {
    /// Derives the constants of a bench.
    ///
    /// # Errors
    ///
    /// A value of the configuration is out of range.
    pub(crate) fn new(config: &FilterConfiguration) -> Result<Self, FilterError> {
        config.check()?;
        Ok(Self(BenchModel::new(config)))
    }

    /// Sets the time between the samples of the probes; 0 at the start.
    pub(crate) const fn set_skew(&mut self, skew: Skew) {
        self.0.set_skew(skew);
    }

    /// Takes one sample and estimates. A sample with a missing value (not a number) is only
    /// predicted. After `lost` samples a complete one continues with what has been learnt. A
    /// state that is no longer finite is forgotten: the next sample starts anew.
    #[inline(never)]
    pub(crate) fn step(
        &self,
        state: &mut FilterState,
        measured: &Measurement,
        lost: Option<u32>,
    ) -> FilterEstimate {
        let Self(model) = self;
        match (&mut state.0, lost) {
            // A repeated or earlier sample says nothing new.
            (Some(_), Some(lost)) if lost > MAX_SKIPPED => {}
            (Some(state), Some(lost)) if measured.is_complete() => model.resume(state, measured, lost),
            (Some(state), Some(lost)) => model.lose(state, lost),
            (Some(state), None) => model.follow(state, measured),
            (None, _) if measured.is_complete() => state.0 = Some(model.start(measured)),
            (None, _) => return FilterEstimate::UNKNOWN,
        }
        let positive = state.0.as_ref().filter(|state| state.is_positive());
        match positive.map(|state| model.estimate(state)) {
            Some(estimate) if estimate.is_finite() => estimate,
            _ => {
                state.0 = None;
                FilterEstimate::UNKNOWN
            }
        }
    }

    /// Takes over the forces of the networks at the last estimate; without them the law is used.
    pub(crate) fn set_networks(&self, state: &mut FilterState, networks: Option<NetworkForces>) {
        if let Some(state) = &mut state.0 {
            self.0.set_networks(state, networks);
        }
    }
}

impl Filter {
    /// Size of what changes from sample to sample, in bytes.
    pub const STATE_BYTES: usize = size_of::<State>();

    /// Creates the filter of a bench; the first sample starts it.
    ///
    /// # Errors
    ///
    /// A value of the configuration is out of range.
    pub fn new(config: &FilterConfiguration) -> Result<Self, FilterError> {
        Ok(Self { model: FilterModel::new(config)?, state: FilterState::default() })
    }

    /// Sets the time between the samples of the probes; 0 at the start.
    pub const fn set_skew(&mut self, skew: Skew) {
        self.model.set_skew(skew);
    }

    /// Takes one sample and estimates. A sample with a missing value (not a number) is only
    /// predicted. A state that is no longer finite is forgotten: the next sample starts anew.
    pub fn step(&mut self, measured: &Measurement) -> FilterEstimate {
        self.model.step(&mut self.state, measured, None)
    }
}
