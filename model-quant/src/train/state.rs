//! State of a training between two epochs, as bytes.
//!
//! Layout, little-endian: magic (8 bytes), version (u32), length of the notes (u32), the notes as
//! JSON; then as f32: parameters and both moments in the layout's order, the best free weights if
//! any, the freezer's grid and mask if any; then a CRC-32 over everything before it. Random draws
//! need no state, because each depends on seed, purpose and index alone.

use super::freezer::Freezer;
use super::optimiser::Adam;
use super::training::{Best, Progress, Training};
use crate::network::Network;
use crate::network::recipe::Recipe;
use inference::image::checksum;
use serde::{Deserialize, Serialize};

const MAGIC: [u8; 8] = *b"PINTLES\n";
const VERSION: u32 = 1;

/// JSON part of a state.
#[derive(Serialize, Deserialize)]
struct Notes {
    recipe: Recipe,
    #[serde(rename = "lane")]
    stream: u64,
    adam_steps: u64,
    best: Option<(usize, f64)>,
    has_freezer: bool,
    history: Vec<Progress>,
}

/// Reason why a training cannot be resumed.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// The bytes are not a state or are damaged.
    #[error("training state: found {found}, expected {expected}")]
    Damaged {
        /// Content found.
        found: String,
        /// Content expected.
        expected: String,
    },
    /// Its notes cannot be parsed.
    #[error("training state: notes: {0}")]
    Notes(#[from] serde_json::Error),
    /// It belongs to another recipe or network.
    #[error("training state of another recipe or network: found {found}, expected {expected}")]
    Other {
        /// Recipe of the state.
        found: String,
        /// Requested recipe.
        expected: String,
    },
}

fn damaged(found: impl Into<String>, expected: impl Into<String>) -> StateError {
    StateError::Damaged { found: found.into(), expected: expected.into() }
}

impl Training<'_> {
    /// Encodes everything that the next epoch depends on.
    ///
    /// # Errors
    ///
    /// None if all numbers are finite.
    pub fn to_bytes(&self) -> Result<Vec<u8>, serde_json::Error> {
        let notes = serde_json::to_vec(&Notes {
            recipe: self.recipe.clone(),
            stream: self.stream,
            adam_steps: self.trainer.adam.steps,
            best: self.best.as_ref().map(|best| (best.epoch, best.loss)),
            has_freezer: self.freezer.is_some(),
            history: self.history.clone(),
        })?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((notes.len() as u32).to_le_bytes());
        bytes.extend(notes);
        let trainer = &self.trainer;
        let vectors = [&trainer.parameters, &trainer.adam.mean, &trainer.adam.square].into_iter().flatten();
        bytes.extend(vectors.flat_map(|value| value.to_le_bytes()));
        let best = self.best.as_ref().map(|best| &best.network);
        let frozen = self.freezer.as_ref().map(Freezer::parts).into_iter().flatten();
        let networks = best.into_iter().chain(frozen);
        bytes.extend(networks.flat_map(Network::parameters).flat_map(f32::to_le_bytes));
        let sum = checksum(&bytes);
        bytes.extend(sum.to_le_bytes());
        Ok(bytes)
    }

    /// Restores the state from [`Training::to_bytes`] of a training with the same recipe and
    /// sources.
    ///
    /// # Errors
    ///
    /// Damaged bytes, or another recipe or network.
    pub fn resume_from(&mut self, bytes: &[u8]) -> Result<(), StateError> {
        let begin = [MAGIC.as_slice(), &VERSION.to_le_bytes()].concat();
        let remaining = bytes
            .strip_prefix(begin.as_slice())
            .ok_or_else(|| damaged("other first bytes", format!("a training state of version {VERSION}")))?;
        let short = || damaged(format!("{} bytes", bytes.len()), "more");
        let (body, sum) = bytes.split_last_chunk::<4>().ok_or_else(short)?;
        let (found, expected) = (checksum(body), u32::from_le_bytes(*sum));
        if found != expected {
            return Err(damaged(format!("checksum {found:#010x}"), format!("{expected:#010x}")));
        }
        let (length, remaining) = remaining.split_first_chunk::<4>().ok_or_else(short)?;
        let (notes, remaining) =
            remaining.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or_else(short)?;
        let notes: Notes = serde_json::from_slice(notes)?;
        if notes.recipe != *self.recipe || notes.stream != self.stream {
            let text = |recipe: &Recipe| serde_json::to_string(recipe).unwrap_or_default();
            return Err(StateError::Other { found: text(&notes.recipe), expected: text(self.recipe) });
        }
        let numbers = remaining.len().saturating_sub(sum.len()) / 4;
        let (packed, plain) = (self.trainer.layout.length, self.trainer.shape().parameters());
        let networks = usize::from(notes.best.is_some()) + 2 * usize::from(notes.has_freezer);
        let expected = 3 * packed + networks * plain;
        if numbers != expected {
            return Err(damaged(format!("{numbers} numbers"), expected.to_string()));
        }
        let mut values = remaining.as_chunks::<4>().0.iter().map(|word| f32::from_le_bytes(*word));
        let mut take = |count| values.by_ref().take(count).collect::<Vec<f32>>();
        self.trainer.parameters = take(packed);
        self.trainer.adam = Adam { mean: take(packed), square: take(packed), steps: notes.adam_steps };
        let shape = self.trainer.shape().clone();
        let mut network = || {
            let mut network = Network::zero(shape.clone());
            for (slot, value) in network.slices_mut().flatten().zip(&mut values) {
                *slot = value;
            }
            network
        };
        self.best = notes.best.map(|(epoch, loss)| Best { epoch, loss, network: network() });
        self.freezer = notes.has_freezer.then(|| Freezer::from_parts([network(), network()]));
        self.history = notes.history;
        let free = self.freezer.as_ref().map(Freezer::free).cloned();
        self.trainer.set_free(free.as_ref());
        Ok(())
    }
}
