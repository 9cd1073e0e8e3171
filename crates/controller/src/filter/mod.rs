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
mod state;

pub use configuration::{FilterConfiguration, FilterError, SensorNoise, Uncertainty};
pub use estimate::FilterEstimate;
pub use measurement::Measurement;

use model::{Model, State};

/// The filter of one bench.
#[derive(Clone, Debug)]
pub struct Filter {
    model: Model,
    state: Option<State>,
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
        config.check()?;
        Ok(Self { model: Model::new(config), state: None })
    }

    /// Forgets everything that was measured, for example after a gap in the samples.
    pub const fn restart(&mut self) {
        self.state = None;
    }

    /// Takes one sample and estimates. A sample of which a value is missing, which is not a number,
    /// is predicted. A state that is no longer finite is forgotten: the next sample starts anew.
    pub fn step(&mut self, measured: &Measurement) -> FilterEstimate {
        let Self { model, state } = self;
        match state {
            Some(state) => model.follow(state, measured),
            None if measured.is_complete() => *state = Some(model.start(measured)),
            None => return FilterEstimate::UNKNOWN,
        }
        let estimate = state.as_ref().filter(|state| state.is_positive()).map(|state| model.estimate(state));
        match estimate {
            Some(estimate) if estimate.is_finite() => estimate,
            _ => {
                *state = None;
                FilterEstimate::UNKNOWN
            }
        }
    }
}
