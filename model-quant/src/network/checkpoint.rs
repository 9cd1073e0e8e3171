//! Float checkpoint: the result of a training as a file.
//!
//! Layout, little-endian: magic (8 bytes), version (u32), length of the recipe (u32), the recipe as
//! JSON; then, for the collision and the friction network, the float and the tuned weights as f32
//! in the order of [`Network::parameters`]; then a CRC-32 over everything before it. The CRC-64 of
//! the complete file is the training id of the images made from it.

use crate::data::ranges::header;
use crate::network::recipe::Recipe;
use crate::network::shipped::bearing_names;
use crate::network::{Network, NetworkKind, Shape};
use inference::image::checksum;
use inference::{BearingMaterial, Header};
use std::path::Path;

const MAGIC: [u8; 8] = *b"PINTLEF\n";
const VERSION: u32 = 1;
/// Maximum length of a recipe in bytes.
const RECIPE_LIMIT: usize = 1 << 16;
static CRC_64: crc::Crc<u64> = crc::Crc::<u64>::new(&crc::CRC_64_XZ);

/// Both results of the training of one network.
#[derive(Clone, Debug, PartialEq)]
pub struct Trained {
    /// Weights trained without rounding.
    pub float: Network,
    /// Weights trained further on the 8-bit grid, so that rounding costs little.
    pub tuned: Network,
}

/// Result of the training of both networks of a bearing.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// Recipe of the training.
    pub recipe: Recipe,
    /// Bearing of the recipe.
    pub bearing: BearingMaterial,
    /// The collision network.
    pub collision: Trained,
    /// The friction network.
    pub friction: Trained,
}

/// Reason why a checkpoint was refused.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// It is too short or too long.
    #[error("float checkpoint: found {found} bytes, expected {expected}")]
    Length {
        /// Bytes found.
        found: usize,
        /// Bytes expected.
        expected: usize,
    },
    /// Its first bytes are not those of a checkpoint.
    #[error("float checkpoint: the first bytes are not those of a float checkpoint of version {VERSION}")]
    Magic,
    /// Its checksum does not match its bytes.
    #[error("float checkpoint: checksum is {found:#010x}, expected {expected:#010x}")]
    Crc {
        /// Checksum of the bytes.
        found: u32,
        /// Checksum at the end of the file.
        expected: u32,
    },
    /// Its recipe exceeds the maximum length.
    #[error("float checkpoint: recipe: found {0} bytes, expected at most {RECIPE_LIMIT}")]
    RecipeLength(usize),
    /// Its recipe cannot be parsed.
    #[error("float checkpoint: recipe: {0}")]
    Recipe(#[from] serde_json::Error),
    /// Its recipe names no known bearing.
    #[error("float checkpoint: recipe: found bearing `{0}`, expected {names}", names = bearing_names())]
    Bearing(String),
    /// A weight is infinite or not a number.
    #[error("float checkpoint: found a weight that is not finite")]
    Weight,
}

/// Reason why a checkpoint file could not be loaded.
#[derive(Debug, thiserror::Error)]
pub(crate) enum LoadError {
    /// The file cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// The file.
        path: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is no checkpoint.
    #[error("{path}: {source}")]
    Checkpoint {
        /// The file.
        path: String,
        /// Error in its content.
        source: CheckpointError,
    },
}

/// Reads a checkpoint file; returns the checkpoint and its bytes.
pub(crate) fn read_checkpoint(path: &Path) -> Result<(Checkpoint, Vec<u8>), LoadError> {
    let name = || path.display().to_string();
    let bytes = std::fs::read(path).map_err(|source| LoadError::Read { path: name(), source })?;
    let checkpoint =
        Checkpoint::from_bytes(&bytes).map_err(|source| LoadError::Checkpoint { path: name(), source })?;
    Ok((checkpoint, bytes))
}

impl Checkpoint {
    /// Both results of the training of one network.
    pub fn trained(&self, kind: NetworkKind) -> &Trained {
        match kind {
            NetworkKind::Collision => &self.collision,
            NetworkKind::Friction => &self.friction,
        }
    }

    /// Encodes the file.
    pub fn to_bytes(&self) -> Result<Vec<u8>, serde_json::Error> {
        let recipe = serde_json::to_vec(&self.recipe)?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((recipe.len() as u32).to_le_bytes());
        bytes.extend(&recipe);
        for trained in [&self.collision, &self.friction] {
            for network in [&trained.float, &trained.tuned] {
                bytes.extend(network.parameters().flat_map(f32::to_le_bytes));
            }
        }
        let sum = checksum(&bytes);
        bytes.extend(sum.to_le_bytes());
        Ok(bytes)
    }

    /// Decodes a file.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let weights = 2 * 4 * NetworkKind::ALL.iter().map(|kind| kind.shape().parameters()).sum::<usize>();
        let short = |expected| CheckpointError::Length { found: bytes.len(), expected };
        let (start, _) = bytes.split_first_chunk::<16>().ok_or(short(20 + weights))?;
        let word = |at: usize| u32::from_le_bytes([start[at], start[at + 1], start[at + 2], start[at + 3]]);
        if start[..8] != MAGIC || word(8) != VERSION {
            return Err(CheckpointError::Magic);
        }
        let recipe_length = word(12) as usize;
        if recipe_length > RECIPE_LIMIT {
            return Err(CheckpointError::RecipeLength(recipe_length));
        }
        let expected = 16 + recipe_length + weights + 4;
        if bytes.len() != expected {
            return Err(short(expected));
        }
        let (body, sum) = bytes.split_last_chunk::<4>().ok_or(short(expected))?;
        let (found, expected) = (checksum(body), u32::from_le_bytes(*sum));
        if found != expected {
            return Err(CheckpointError::Crc { found, expected });
        }
        let (recipe, weights) = body[16..].split_at(recipe_length);
        let recipe: Recipe = serde_json::from_slice(recipe)?;
        let bearing = BearingMaterial::from_name(&recipe.bearing)
            .ok_or_else(|| CheckpointError::Bearing(recipe.bearing.clone()))?;
        let mut values = weights.as_chunks::<4>().0.iter().map(|word| f32::from_le_bytes(*word));
        if values.clone().any(|value| !value.is_finite()) {
            return Err(CheckpointError::Weight);
        }
        let mut take = |kind: NetworkKind| filled(kind.shape(), &mut values);
        let [collision, friction] =
            NetworkKind::ALL.map(|kind| Trained { float: take(kind), tuned: take(kind) });
        Ok(Self { recipe, bearing, collision, friction })
    }

    /// Training id of a file: CRC-64 of its bytes.
    pub fn training_id(bytes: &[u8]) -> u64 {
        CRC_64.checksum(bytes)
    }

    /// Header of the images made from this checkpoint, with training id 0.
    pub(crate) fn header(&self) -> Header {
        header(self.bearing, self.recipe.range)
    }
}

fn filled(shape: Shape, values: &mut impl Iterator<Item = f32>) -> Network {
    let mut network = Network::zero(shape);
    for (slot, value) in network.slices_mut().flatten().zip(values) {
        *slot = value;
    }
    network
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::draw::{Draw, Purpose};

    fn sample() -> Checkpoint {
        let mut draw = Draw::new(5, Purpose::Weights, 0);
        let mut start = |kind: NetworkKind| Network::start(kind.shape(), &mut draw);
        let [collision, friction] =
            NetworkKind::ALL.map(|kind| Trained { float: start(kind), tuned: start(kind) });
        Checkpoint {
            recipe: Recipe::standard(BearingMaterial::Plastic),
            bearing: BearingMaterial::Plastic,
            collision,
            friction,
        }
    }

    #[test]
    fn a_checkpoint_survives_its_file() {
        let bytes = sample().to_bytes().expect("bytes");
        assert_eq!(Checkpoint::from_bytes(&bytes).expect("checkpoint"), sample());
    }

    #[test]
    fn a_recipe_beyond_the_limit_is_refused_though_length_and_checksum_fit() {
        let start = sample().to_bytes().expect("bytes")[..12].to_vec();
        let weights = 2 * 4 * NetworkKind::ALL.iter().map(|kind| kind.shape().parameters()).sum::<usize>();
        for recipe in [RECIPE_LIMIT + 1, RECIPE_LIMIT + weights + 1, u32::MAX as usize] {
            let mut bytes = start.clone();
            bytes.extend((recipe as u32).to_le_bytes());
            bytes.resize(16 + RECIPE_LIMIT + weights, b' ');
            bytes.extend(checksum(&bytes).to_le_bytes());
            let refused = Checkpoint::from_bytes(&bytes).expect_err("too long");
            assert!(matches!(refused, CheckpointError::RecipeLength(found) if found == recipe), "{refused}");
        }
    }

    #[test]
    fn a_damaged_checkpoint_is_refused() {
        let bytes = sample().to_bytes().expect("bytes");
        for length in [0, 15, 16, 400, bytes.len() - 1] {
            assert!(Checkpoint::from_bytes(&bytes[..length]).is_err(), "{length} bytes");
        }
        for at in (0..bytes.len()).step_by(97) {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x20;
            assert!(Checkpoint::from_bytes(&damaged).is_err(), "byte {at}");
        }
    }
}
