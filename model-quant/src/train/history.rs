//! Training history: the errors of every epoch, as a file next to the checkpoint
//! (`BEARING.history.json`).
//!
//! The file has the bearing, the training id, the recipe and the epochs of both networks, one epoch
//! a line. Errors are in units of the target's rms.

use super::pipeline::Outcome;
use super::training::Progress;
use crate::data::file_io::FileError;
use crate::network::NetworkKind;
use inference::BearingMaterial;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::path::Path;

/// Errors after an epoch, in units of the target's rms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Epoch {
    /// `collision` or `friction`.
    pub network: String,
    /// Epochs done.
    pub epoch: usize,
    /// True in an epoch that moves the weights to the 8-bit grid.
    pub on_grid: bool,
    /// Mean squared error on the training rows.
    pub loss: f64,
    /// Mean absolute error on the training rows.
    pub mae: f64,
    /// Mean squared error on the validation rows.
    pub validation_loss: f64,
    /// Mean absolute error on the validation rows.
    pub validation_mae: f64,
}

/// Epochs of a training of both networks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct History {
    /// Bearing.
    pub bearing: String,
    /// Training id of the checkpoint in hexadecimal.
    pub training_id: String,
    /// Epochs.
    pub epochs: Vec<Epoch>,
}

impl History {
    /// Reads a history file.
    ///
    /// # Errors
    ///
    /// The file cannot be read or has other content.
    pub(crate) fn read(path: &Path) -> Result<Self, FileError> {
        FileError::json(path, &FileError::text(path)?, "the history of a training")
    }

    /// History of the shipped checkpoint of a bearing.
    ///
    /// # Errors
    ///
    /// The embedded file has other content.
    pub(crate) fn shipped(bearing: BearingMaterial) -> Result<Self, FileError> {
        let (path, text) = crate::network::shipped::shipped_training(bearing).history;
        FileError::json(Path::new(path), text, "the history of a training")
    }

    /// Epochs of one network in order.
    pub(crate) fn epochs_of<'a>(&'a self, network: &'a str) -> impl Iterator<Item = &'a Epoch> + Clone {
        self.epochs.iter().filter(move |epoch| epoch.network == network)
    }
}

fn entry(network: NetworkKind, progress: &Progress) -> Value {
    json!({
        "network": network.name(),
        "epoch": progress.epoch,
        "on_grid": progress.on_grid,
        "loss": progress.loss,
        "mae": progress.mean_absolute_error,
        "validation_loss": progress.validation_loss,
        "validation_mae": progress.validation_mean_absolute_error,
        "learning_rate": progress.learning_rate,
    })
}

/// Epochs of both networks as JSON, collision first.
pub(crate) fn epochs(outcome: &Outcome) -> Vec<Value> {
    (NetworkKind::ALL.into_iter().zip(&outcome.histories))
        .flat_map(|(network, epochs)| epochs.iter().map(move |progress| entry(network, progress)))
        .collect()
}

/// Text of the history file for a checkpoint with this training id.
pub fn file(outcome: &Outcome, training_id: u64) -> String {
    let lines: Vec<String> = epochs(outcome).iter().map(Value::to_string).collect();
    format!(
        "{{\"bearing\":{},\n\"training_id\":\"{training_id:016x}\",\n\"recipe\":{},\n\"epochs\":[\n{}\n]}}\n",
        json!(outcome.checkpoint.bearing.name()),
        json!(outcome.checkpoint.recipe),
        lines.join(",\n")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_histories_belong_to_the_shipped_checkpoints() {
        for bearing in BearingMaterial::ALL {
            let id = crate::network::checkpoint::Checkpoint::training_id(
                crate::network::shipped::shipped_checkpoint(bearing),
            );
            let history = History::shipped(bearing).unwrap();
            assert_eq!(
                (history.bearing.as_str(), history.training_id),
                (bearing.name(), format!("{id:016x}"))
            );
        }
    }

    #[test]
    fn a_history_file_is_read_and_other_content_is_refused_with_file_and_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.json");
        std::fs::write(
            &path,
            r#"{"bearing": "babbitt", "training_id": "00ff", "recipe": {},
            "epochs": [{"network": "collision", "epoch": 1,
            "on_grid": false, "loss": 1.5, "mae": 0.9, "validation_loss": 1.25, "validation_mae": 0.8}]}"#,
        )
        .unwrap();
        let history = History::read(&path).unwrap();
        assert_eq!(history.epochs_of("collision").next().unwrap().validation_loss, 1.25);
        assert_eq!(history.epochs_of("friction").count(), 0);
        std::fs::write(&path, r#"{"bearing": "babbitt", "training_id": 3}"#).unwrap();
        let error = History::read(&path).unwrap_err().to_string();
        assert!(error.contains("history.json: found invalid type") && error.contains("line 1"), "{error}");
        assert!(History::read(&folder.path().join("none")).unwrap_err().to_string().contains("none"));
    }
}
