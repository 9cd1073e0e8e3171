//! Runs in steps from outside, as a co-simulation takes them: inputs hold over a step, and the
//! memory between two steps is plain data that can be saved and restored.

mod held;
mod mechanism;
mod transmission;

pub use held::HeldContact;
pub(super) use held::HeldMemory;
pub use mechanism::{MechanismMemory, SteppedMechanism};
pub use transmission::{BenchMemory, External, SteppedBench};

use crate::integrate::{
    ContactPhase, Impact, Integration, IntegrationError, Pause, SlicedPlant, Tolerances, resume,
};
use serde::{Deserialize, Serialize};

/// State of a plant and its contacts between two steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Memory {
    state: Vec<f64>,
    pause: Pause,
}

impl Memory {
    /// Plant at its start, with its contacts in a gap.
    fn new(state: Vec<f64>, contacts: usize) -> Self {
        Self { state, pause: Pause { contacts: vec![ContactPhase::default(); contacts], step_s: 0.0 } }
    }

    /// Integrates over a span and returns the periods in contact that it touches: those that
    /// continue, and those that begin.
    fn advance<P: SlicedPlant<N>, const N: usize>(
        &mut self,
        plant: &P,
        span_s: (f64, f64),
        tolerances: &Tolerances<N>,
    ) -> Result<Vec<Impact>, IntegrationError> {
        let state = std::array::from_fn(|i| self.state.get(i).copied().unwrap_or_default());
        let Integration { state, impacts, pause, .. } =
            resume(plant, span_s, (state, &self.pause), tolerances)?;
        *self = Self { state: state.to_vec(), pause };
        Ok(impacts)
    }
}
