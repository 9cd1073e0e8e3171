//! Forces without contact: networks with gaps between contacts, and the estimator with the journal
//! out of contact.
//!
//! Bench B stays in contact after its start, so its runs alone show little. The contact of the run
//! with the law is used with every second section moved out of contact by as much as it was in: the
//! networks' histories are then half contact, half gap. The estimator gets the same run with the
//! journal moved inwards by much more than the sensors' noise.

use super::conditions::{Condition, LawRun};
use crate::cli::error::CliError;
use crate::run::configuration::estimator_configuration;
use crate::run::force::{SAMPLE_RATE_HZ, contact_state};
use crate::run::sensing;
use bench::Bench;
use bench::plants::transmission::{ContactView, Snapshot, Transmission};
use controller::Estimator;
use inference::{Model, Pair, shipped};
use model_quant::network::float_pair::FloatPair;
use serde::Serialize;

/// Samples of a stretch in or out of contact: as long as the networks' window.
const STRETCH: usize = inference::WINDOW;
/// Gap that the estimator's journal is drawn to, over that of the position sensors' noise by 25.
const MARGIN_M: f64 = 5e-6;

/// The largest forces without contact, N.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GapAccuracy {
    /// Largest force of the quantised networks between contacts, N.
    pub network_n: f64,
    /// Largest force of the float networks between contacts, N.
    pub float_network_n: f64,
    /// Largest force of the estimator with its journal out of contact, N.
    pub estimator_n: f64,
    /// Samples without contact that were tried.
    pub samples: usize,
}

impl GapAccuracy {
    /// The largest of all.
    pub fn largest_n(&self) -> f64 {
        self.network_n.max(self.float_network_n).max(self.estimator_n)
    }
}

/// Tries a condition.
pub fn measure(condition: &Condition, law: &LawRun, seed: u64) -> Result<GapAccuracy, CliError> {
    let bearing = condition.bearing;
    let refused = |e: &dyn std::fmt::Debug| CliError::Work(format!("{}: {e:?}", condition.name()));
    let mut pair: Pair = Pair::new(Model::load(shipped(bearing)).map_err(|e| refused(&e))?);
    let mut float = FloatPair::new(bearing).map_err(|e| refused(&e))?;
    let mut found = GapAccuracy { network_n: 0.0, float_network_n: 0.0, estimator_n: 0.0, samples: 0 };
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
    let plant = Transmission::new(&law.bench, law.bench.drive_profile(), law.bench.load_profile());
    let configuration = estimator_configuration(&plant, &law.bench, SAMPLE_RATE_HZ)?;
    let mut estimator = Estimator::new(shipped(bearing), configuration).map_err(|e| refused(&e))?;
    let inside_m = plant.radial_clearance_m() - MARGIN_M;
    let drawn: Vec<Snapshot> = samples.iter().map(|s| limit_radius(s, inside_m)).collect();
    let described = Bench::from(law.bench.clone());
    for frame in sensing::frames(&described, &drawn, seed.wrapping_add(condition.index)) {
        let estimate = estimator.step(&frame);
        found.samples += 1;
        found.estimator_n = larger(estimate.normal_force_n, estimate.friction_torque_nm, found.estimator_n);
    }
    Ok(found)
}

/// The bench with the journal no further out than `inside_m`, in the same direction.
fn limit_radius(sample: &Snapshot, inside_m: f64) -> Snapshot {
    let distance = sample.y_m.hypot(sample.z_m);
    let factor = (inside_m / distance.max(f64::MIN_POSITIVE)).min(1.0);
    Snapshot { y_m: factor * sample.y_m, z_m: factor * sample.z_m, ..*sample }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_journal_is_drawn_in_along_its_own_direction() {
        let out = Snapshot { y_m: 3e-4, z_m: -4e-4, ..Snapshot::default() };
        let drawn = limit_radius(&out, 1e-4);
        assert!((drawn.y_m - 0.6e-4).abs() < 1e-12 && (drawn.z_m + 0.8e-4).abs() < 1e-12);
        assert_eq!(limit_radius(&out, 1.0), out);
    }
}
