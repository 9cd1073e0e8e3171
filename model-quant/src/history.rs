//! What happened in every epoch of a training, as a file beside the checkpoint: `BEARING.history.json`.
//!
//! Bearing, training id, recipe and the epochs of both networks, an epoch a line; errors in units of the target's rms.
//! [`crate::training_report::history`] reads it.

use crate::pipeline::{Network, Outcome};
use crate::train::Progress;
use serde_json::{Value, json};

fn entry(network: Network, progress: &Progress) -> Value {
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

/// The epochs of both networks, collision first.
pub fn epochs(outcome: &Outcome) -> Vec<Value> {
    (Network::ALL.into_iter().zip(&outcome.histories))
        .flat_map(|(network, epochs)| epochs.iter().map(move |progress| entry(network, progress)))
        .collect()
}

/// The file of a training whose checkpoint has this id.
pub fn file(outcome: &Outcome, training_id: u64) -> String {
    let lines: Vec<String> = epochs(outcome).iter().map(Value::to_string).collect();
    format!(
        "{{\"bearing\":{},\n\"training_id\":\"{training_id:016x}\",\n\"recipe\":{},\n\"epochs\":[\n{}\n]}}\n",
        json!(outcome.checkpoint.bearing.name()),
        json!(outcome.checkpoint.recipe),
        lines.join(",\n")
    )
}
