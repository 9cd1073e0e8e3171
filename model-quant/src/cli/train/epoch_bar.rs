//! Progress bar of a training.

use crate::network::NetworkKind;
use crate::network::recipe::Recipe;
use crate::train::Progress;
use indicatif::{ProgressBar, ProgressStyle};

/// Progress bar over the epochs of both networks.
pub(super) struct EpochBar {
    pub(super) bar: ProgressBar,
    /// Epochs of one network.
    pub(super) epochs: usize,
    /// Epochs done, of both networks.
    pub(super) done: usize,
}

impl EpochBar {
    pub(super) fn new(recipe: &Recipe) -> Self {
        let epochs = recipe.epochs + recipe.grid_epochs;
        let bar = ProgressBar::new(2 * epochs as u64);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} epochs, {eta} left  {msg}") {
            bar.set_style(style);
        }
        Self { bar, epochs, done: 0 }
    }

    /// Counts an epoch and shows its errors.
    pub(super) fn add(&mut self, network: NetworkKind, progress: &Progress) {
        self.done += 1;
        self.bar.inc(1);
        self.bar.set_message(line(network, progress));
        if progress.epoch.is_multiple_of(self.epochs.div_ceil(10)) || progress.epoch == self.epochs {
            self.bar.suspend(|| eprintln!("{}", line(network, progress)));
        }
    }
}

fn line(network: NetworkKind, progress: &Progress) -> String {
    format!(
        "{} epoch {}{}: loss {:.2e}, mae {:.2e}, validation {:.2e}, mae {:.2e}",
        network.name(),
        progress.epoch,
        if progress.on_grid { " (grid)" } else { "" },
        progress.loss,
        progress.mean_absolute_error,
        progress.validation_loss,
        progress.validation_mean_absolute_error
    )
}
