//! Forces of the networks without contact.
//!
//! Bench B stays in contact after its start, so its runs alone show little. The contact of the run
//! with the law is used with every second section moved out of contact by as much as it was in: the
//! networks' histories are then half contact, half gap. What the estimator gives without contact is
//! measured in the worlds of `accuracy --worlds`.

use super::conditions::{Condition, LawRun};
use crate::cli::error::CliError;
use bench::plants::transmission::ContactView;
use inference::{Model, Pair, shipped};
use model_quant::network::float_pair::FloatPair;
use pintle_fmu::contact_state;
use schemars::JsonSchema;
use serde::Serialize;

/// Samples of a stretch in or out of contact: as long as the networks' window.
const STRETCH: usize = inference::WINDOW;

/// The largest forces without contact, N.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct GapAccuracy {
    /// Largest force of the quantised networks between contacts, N.
    pub network_n: f64,
    /// Largest force of the float networks between contacts, N.
    pub float_network_n: f64,
    /// Samples without contact that were tried.
    pub samples: usize,
}

impl GapAccuracy {
    /// The largest of all.
    pub fn largest_n(&self) -> f64 {
        self.network_n.max(self.float_network_n)
    }
}

/// Tries a condition.
pub fn measure(condition: &Condition, law: &LawRun) -> Result<GapAccuracy, CliError> {
    let bearing = condition.bearing;
    let refused = |e: &dyn std::fmt::Debug| CliError::Work(format!("{}: {e:?}", condition.name()));
    let mut pair: Pair = Pair::new(Model::load(shipped(bearing)).map_err(|e| refused(&e))?);
    let mut float = FloatPair::new(bearing).map_err(|e| refused(&e))?;
    let mut found = GapAccuracy { network_n: 0.0, float_network_n: 0.0, samples: 0 };
    let larger =
        |normal: f32, friction: f32, so_far: f64| so_far.max(f64::from(normal.abs().max(friction.abs())));
    let samples = &law.forced.run.samples;
    for (index, sample) in samples.iter().enumerate() {
        let apart = (index / STRETCH) % 2 == 1;
        let size = sample.contact.deformation_m.abs();
        let deformation_m = if apart { -size } else { size };
        let state = contact_state(&ContactView { deformation_m, ..sample.contact });
        let (estimate, floats) = (pair.push(&state), float.push(&state));
        if apart {
            found.samples += 1;
            found.network_n = larger(estimate.normal_force_n(), estimate.friction_force_n(), found.network_n);
            found.float_network_n =
                larger(floats.normal_force_n, floats.friction_force_n, found.float_network_n);
        }
    }
    Ok(found)
}
