//! How the errors went over the epochs: the history that a training leaves beside its checkpoint ([`crate::history`]).

use super::FileError;
use inference::Bearing;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Errors after an epoch, in units of the target's rms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Epoch {
    /// `collision` or `friction`.
    pub network: String,
    /// Epochs done.
    pub epoch: usize,
    /// Whether the weights were on the 8-bit grid.
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

/// A training's epochs, both networks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct History {
    /// Bearing.
    pub bearing: String,
    /// Training id of the checkpoint in hexadecimal.
    pub training_id: String,
    /// Epochs.
    pub epochs: Vec<Epoch>,
}

impl History {
    /// Reads a history from a file.
    ///
    /// # Errors
    ///
    /// The file cannot be read or is none.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        FileError::json(path, &FileError::text(path)?, "the history of a training")
    }

    /// The history of a bearing's checked-in checkpoint.
    ///
    /// # Errors
    ///
    /// It is none.
    pub fn shipped(bearing: Bearing) -> Result<Self, FileError> {
        let (path, text) = match bearing {
            Bearing::Babbitt => {
                ("models/babbitt.history.json", include_str!("../../models/babbitt.history.json"))
            }
            Bearing::Plastic => {
                ("models/plastic.history.json", include_str!("../../models/plastic.history.json"))
            }
        };
        FileError::json(Path::new(path), text, "the history of a training")
    }

    /// The epochs of a network, in their order.
    pub fn of<'a>(&'a self, network: &'a str) -> impl Iterator<Item = &'a Epoch> + Clone {
        self.epochs.iter().filter(move |epoch| epoch.network == network)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checked_in_histories_are_those_of_the_checked_in_checkpoints() {
        for bearing in Bearing::ALL {
            let id = crate::checkpoint::Checkpoint::training_id(crate::float_pair::shipped(bearing));
            let history = History::shipped(bearing).unwrap();
            assert_eq!(
                (history.bearing.as_str(), history.training_id),
                (bearing.name(), format!("{id:016x}"))
            );
        }
    }

    #[test]
    fn a_training_s_output_is_read_and_anything_else_is_refused_by_file_and_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.json");
        std::fs::write(
            &path,
            r#"{"bearing": "babbitt", "training_id": "00ff", "recipe": {}, "epochs": [{"network": "collision", "epoch": 1,
            "on_grid": false, "loss": 1.5, "mae": 0.9, "validation_loss": 1.25, "validation_mae": 0.8}]}"#,
        )
        .unwrap();
        let history = History::read(&path).unwrap();
        assert_eq!(history.of("collision").next().unwrap().validation_loss, 1.25);
        assert_eq!(history.of("friction").count(), 0);
        std::fs::write(&path, r#"{"bearing": "babbitt", "training_id": 3}"#).unwrap();
        let error = History::read(&path).unwrap_err().to_string();
        assert!(error.contains("history.json: found invalid type") && error.contains("line 1"), "{error}");
        assert!(History::read(&folder.path().join("none")).unwrap_err().to_string().contains("none"));
    }
}
