//! Claim 15: the errors of the shipped networks, on rows they were trained on and on rows they never saw.
//!
//! The history of the errors over the epochs is not stored with the models, so over-fitting is judged by the end of the
//! training: the float networks run over as many rows of the training set as of a fresh one, with the same kind of
//! history before each. Errors are relative to the rms of the law's force.

use super::{Claim, Verdict};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::draw::{Draw, Purpose};
use crate::features::FloatFeatures;
use crate::float_pair::{self, FloatPair};
use crate::rows::rows;
use crate::window::history;
use inference::Bearing;

/// Rows of either kind.
const ROWS: usize = 8192;
const MSE: f64 = 1e-3;
const MAE: f64 = 2e-2;
const OVERFIT: f64 = 1.25;

/// One network of one bearing.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainingFacts {
    /// Bearing and network.
    pub name: String,
    /// Passes of the training over its rows.
    pub epochs: usize,
    /// Mean squared error on rows of the training, over the force's mean square.
    pub trained_mse: f64,
    /// The same on rows that no training saw.
    pub unseen_mse: f64,
    /// Mean absolute error on unseen rows, over the force's rms.
    pub unseen_mae: f64,
}

/// Measures the shipped float networks.
pub fn measure() -> Result<Vec<TrainingFacts>, CheckpointError> {
    let mut facts = Vec::new();
    for bearing in Bearing::ALL {
        let bytes = float_pair::shipped(bearing);
        let checkpoint = Checkpoint::from_bytes(bytes)?;
        let trained = errors(&checkpoint, Purpose::TrainingRows);
        let unseen = errors(&checkpoint, Purpose::TestRows);
        for (index, network) in ["collision", "friction"].into_iter().enumerate() {
            facts.push(TrainingFacts {
                name: format!("{} {network}", bearing.name()),
                epochs: checkpoint.recipe.epochs + checkpoint.recipe.grid_epochs,
                trained_mse: trained[index].0,
                unseen_mse: unseen[index].0,
                unseen_mae: unseen[index].1,
            });
        }
    }
    Ok(facts)
}

/// Relative mean squared and mean absolute error of both networks, collision first.
fn errors(checkpoint: &Checkpoint, purpose: Purpose) -> [(f64, f64); 2] {
    let mut pair = FloatPair::of(checkpoint, 0);
    let features = FloatFeatures::of(&checkpoint.header());
    let recipe = &checkpoint.recipe;
    let mut sums = [[0.0; 3]; 2];
    for (index, row) in rows(checkpoint.bearing, recipe.range, recipe.seed, purpose, ROWS).iter().enumerate()
    {
        let mut draw = Draw::new(recipe.seed, Purpose::FixedHistories, 3 << 32 | index as u64);
        pair.reset();
        let mut found = [0.0; 2];
        for state in &history(&features, row, &mut draw) {
            let estimate = pair.push(state);
            found = [f64::from(estimate.normal_force_n), f64::from(estimate.friction_force_n)];
        }
        for ((sum, law), found) in sums.iter_mut().zip([row.normal_force_n, row.friction_force_n]).zip(found)
        {
            let error = found - law;
            *sum = [sum[0] + error * error, sum[1] + error.abs(), sum[2] + law * law];
        }
    }
    sums.map(|[squared, absolute, law]| (squared / law, absolute / (law * ROWS as f64).sqrt()))
}

/// Judges claim 15.
pub fn judge(facts: &[TrainingFacts]) -> Claim {
    let small = !facts.is_empty() && facts.iter().all(|f| f.unseen_mse <= MSE && f.unseen_mae <= MAE);
    let fits = facts.iter().all(|f| f.unseen_mse <= OVERFIT * f.trained_mse);
    let each = facts.iter().map(|f| {
        format!(
            "{}: MSE {:.1e}, MAE {:.1e}, unseen over trained {:.2}",
            f.name,
            f.unseen_mse,
            f.unseen_mae,
            f.unseen_mse / f.trained_mse
        )
    });
    Claim {
        id: 15,
        claim: "After 200 epochs MSE and MAE are near 0 and validation shows no clear over-fitting.",
        verdict: Verdict::of(small && fits, small),
        threshold: "on unseen rows MSE at most 1e-3 of the force's mean square and MAE at most 2e-2 of its rms; MSE on \
                    unseen rows at most 1.25 times that on rows of the training; partly: the errors are small",
        why: format!(
            "{}. After {} epochs, the shipped float networks; the history over the epochs is not stored with them, so \
             this is the end of the training only",
            each.collect::<Vec<_>>().join("; "),
            facts.first().map_or(0, |f| f.epochs)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(trained_mse: f64, unseen_mse: f64, unseen_mae: f64) -> Verdict {
        let facts = TrainingFacts { name: "x".into(), epochs: 200, trained_mse, unseen_mse, unseen_mae };
        judge(&[facts]).verdict
    }

    #[test]
    fn claim_15_wants_small_errors_that_generalise() {
        assert_eq!(verdict(1e-4, 1.1e-4, 5e-3), Verdict::Holds);
        assert_eq!(verdict(1e-4, 2e-4, 5e-3), Verdict::Partly);
        assert_eq!(verdict(1e-2, 1e-2, 5e-3), Verdict::DoesNotHold);
        assert_eq!(judge(&[]).verdict, Verdict::DoesNotHold);
    }
}
