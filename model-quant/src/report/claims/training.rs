//! Claim 15: training and validation errors over the epochs.
//!
//! The figures come from the history file of a training ([`crate::train::history`]); the shipped
//! networks have one. Errors are relative to the rms of the networks' targets. Over-fitting is
//! measured over the last tenth of the epochs, because the error of a single epoch depends on the
//! order of its rows.

use super::{Claim, Verdict};
use crate::data::file_io::FileError;
use crate::train::history::{Epoch, History};
use inference::BearingMaterial;

/// Number of epochs in the paper.
const PAPER_EPOCHS: usize = 200;
const MSE: f64 = 1e-3;
const MAE: f64 = 2e-2;
const OVERFIT: f64 = 1.25;

/// Training figures of one network of one bearing.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainingFacts {
    /// Bearing and network.
    pub name: String,
    /// Number of epochs.
    pub epochs: usize,
    /// Mean squared error on validation rows after the last epoch, divided by the target's mean
    /// square.
    pub mse: f64,
    /// Mean absolute error on validation rows after the last epoch, divided by the target's rms.
    pub mae: f64,
    /// Ratio of the mean squared errors on validation and training rows, both over the last tenth
    /// of the epochs.
    pub overfit: f64,
}

impl TrainingFacts {
    /// Computes the figures of both networks; a network without epochs is skipped.
    pub(crate) fn from_history(history: &History) -> Vec<Self> {
        let one = |network: &str| {
            let epochs: Vec<&Epoch> = history.epochs_of(network).collect();
            let last = epochs.last()?;
            let tenth = epochs.get(epochs.len() - epochs.len().div_ceil(10)..).unwrap_or_default();
            let sum = |read: fn(&Epoch) -> f64| tenth.iter().map(|epoch| read(epoch)).sum::<f64>();
            Some(Self {
                name: format!("{} {network}", history.bearing),
                epochs: epochs.len(),
                mse: last.validation_loss,
                mae: last.validation_mae,
                overfit: sum(|e| e.validation_loss) / sum(|e| e.loss),
            })
        };
        ["collision", "friction"].into_iter().filter_map(one).collect()
    }
}

/// Figures of the shipped networks.
///
/// # Errors
///
/// An embedded history has other content.
pub fn measure() -> Result<Vec<TrainingFacts>, FileError> {
    let histories: Result<Vec<History>, FileError> =
        BearingMaterial::ALL.into_iter().map(History::shipped).collect();
    Ok(histories?.iter().flat_map(TrainingFacts::from_history).collect())
}

/// Evaluates claim 15.
pub fn assess(facts: &[TrainingFacts]) -> Claim {
    let small = !facts.is_empty() && facts.iter().all(|f| f.mse <= MSE && f.mae <= MAE);
    let long = facts.iter().all(|f| f.epochs >= PAPER_EPOCHS);
    let fits = facts.iter().all(|f| f.overfit <= OVERFIT);
    let each = facts.iter().map(|f| {
        format!(
            "{} after {} epochs: MSE {:.1e}, MAE {:.1e}, validation over training {:.2}",
            f.name, f.epochs, f.mse, f.mae, f.overfit
        )
    });
    let why: Vec<String> = each.collect();
    Claim {
        id: 15,
        claim: "After 200 epochs MSE and MAE are near 0 and validation shows no clear over-fitting.",
        verdict: Verdict::from_conditions(small && long && fits, small),
        threshold: "on validation rows, after 200 epochs or more, MSE at most 1e-3 of the target's mean \
                    square and MAE at most 2e-2 of its rms; over the last tenth of the epochs MSE on \
                    validation rows at most 1.25 times that on rows of the training; \
                    partly: the errors are small",
        why: if why.is_empty() { "no history of a training was given".into() } else { why.join("; ") },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(epochs: usize, mse: f64, mae: f64, overfit: f64) -> Verdict {
        assess(&[TrainingFacts { name: "x".into(), epochs, mse, mae, overfit }]).verdict
    }

    #[test]
    fn claim_15_requires_long_training_and_small_errors_that_generalise() {
        assert_eq!(verdict(200, 1e-4, 5e-3, 1.1), Verdict::Holds);
        assert_eq!(verdict(200, 1e-4, 5e-3, 2.0), Verdict::Partly);
        assert_eq!(verdict(60, 1e-4, 5e-3, 1.1), Verdict::Partly);
        assert_eq!(verdict(200, 1e-2, 5e-3, 1.0), Verdict::DoesNotHold);
        assert_eq!(verdict(200, 1e-4, 5e-2, 1.0), Verdict::DoesNotHold);
        assert_eq!(assess(&[]).verdict, Verdict::DoesNotHold);
    }

    #[test]
    fn over_fitting_is_measured_over_the_last_tenth_of_the_epochs() {
        let epoch = |epoch: usize, validation_loss: f64| Epoch {
            network: "friction".into(),
            epoch,
            on_grid: false,
            loss: 1e-4,
            mae: 5e-3,
            validation_loss,
            validation_mae: 6e-3,
        };
        let early = (1..=18).map(|n| epoch(n, 9e-4));
        let epochs = early.chain([epoch(19, 1e-4), epoch(20, 2e-4)]).collect();
        let history = History { bearing: "plastic".into(), training_id: "0".into(), epochs };
        let facts = TrainingFacts::from_history(&history);
        assert_eq!(facts.len(), 1);
        let found = &facts[0];
        assert_eq!(
            (found.name.as_str(), found.epochs, found.mse, found.mae),
            ("plastic friction", 20, 2e-4, 6e-3)
        );
        assert!((found.overfit - 1.5).abs() < 1e-12);
    }
}
