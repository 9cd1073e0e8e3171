//! The float checkpoint: what a training leaves behind, apart from the image.
//!
//! Little-endian: magic (8 bytes), version (u32), length of the recipe (u32), the recipe as JSON, then for the collision
//! and the friction network the free and the tuned weights as f32 in the order of [`Network::parameters`], then a CRC-32 over
//! everything before. The CRC-64 of the whole file is the training id of the images made from it.

use crate::network::{Network, Shape};
use crate::ranges::header;
use crate::recipe::Recipe;
use crate::shapes;
use crate::train::Trained;
use inference::image::check_sum;
use inference::{Bearing, Header};

const MAGIC: [u8; 8] = *b"PINTLEF\n";
const VERSION: u32 = 1;
/// Longest recipe that is read.
const RECIPE_LIMIT: usize = 1 << 16;
static CRC_64: crc::Crc<u64> = crc::Crc::<u64>::new(&crc::CRC_64_XZ);

/// Result of the training of both networks of a bearing.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// What it was trained with.
    pub recipe: Recipe,
    /// Bearing of the recipe.
    pub bearing: Bearing,
    /// The collision network.
    pub collision: Trained,
    /// The friction network.
    pub friction: Trained,
}

/// Why a checkpoint was refused.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// It ends early or goes on too long.
    #[error("float checkpoint: found {found} bytes, expected {expected}")]
    Length {
        /// Bytes found.
        found: usize,
        /// Bytes expected.
        expected: usize,
    },
    /// It does not begin as one.
    #[error("float checkpoint: the first bytes are not those of a float checkpoint of version {VERSION}")]
    Magic,
    /// Its check sum does not fit.
    #[error("float checkpoint: check sum is {found:#010x}, expected {expected:#010x}")]
    Crc {
        /// Check sum of the bytes.
        found: u32,
        /// Check sum at the end.
        expected: u32,
    },
    /// Its recipe is longer than any that is written.
    #[error("float checkpoint: recipe: found {0} bytes, expected at most {RECIPE_LIMIT}")]
    RecipeLength(usize),
    /// Its recipe cannot be read.
    #[error("float checkpoint: recipe: {0}")]
    Recipe(#[from] serde_json::Error),
    /// Its recipe names no known bearing.
    #[error("float checkpoint: recipe: found bearing `{0}`, expected `babbitt` or `plastic`")]
    Bearing(String),
    /// A weight is infinite or not a number.
    #[error("float checkpoint: found a weight that is not finite")]
    Weight,
}

/// The bearing of a name.
pub fn bearing_named(name: &str) -> Option<Bearing> {
    Bearing::ALL.into_iter().find(|bearing| bearing.name() == name)
}

impl Checkpoint {
    /// The bytes of the file.
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
        let sum = check_sum(&bytes);
        bytes.extend(sum.to_le_bytes());
        Ok(bytes)
    }

    /// Reads the bytes of a file.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let weights = 8 * (shapes::collision().parameters() + shapes::friction().parameters());
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
        let (found, expected) = (check_sum(body), u32::from_le_bytes(*sum));
        if found != expected {
            return Err(CheckpointError::Crc { found, expected });
        }
        let (recipe, weights) = body[16..].split_at(recipe_length);
        let recipe: Recipe = serde_json::from_slice(recipe)?;
        let bearing =
            bearing_named(&recipe.bearing).ok_or_else(|| CheckpointError::Bearing(recipe.bearing.clone()))?;
        let mut values = weights.as_chunks::<4>().0.iter().map(|word| f32::from_le_bytes(*word));
        if values.clone().any(|value| !value.is_finite()) {
            return Err(CheckpointError::Weight);
        }
        let mut take = |shape: &Shape| filled(shape, &mut values);
        let (first, second) = (shapes::collision(), shapes::friction());
        let collision = Trained { float: take(&first), tuned: take(&first) };
        let friction = Trained { float: take(&second), tuned: take(&second) };
        Ok(Self { recipe, bearing, collision, friction })
    }

    /// CRC-64 of the file's bytes.
    pub fn training_id(bytes: &[u8]) -> u64 {
        CRC_64.checksum(bytes)
    }

    /// The header that models made from this checkpoint get, without training id.
    pub fn header(&self) -> Header {
        header(self.bearing, self.recipe.range)
    }
}

fn filled(shape: &Shape, values: &mut impl Iterator<Item = f32>) -> Network {
    let mut network = Network::zero(shape.clone());
    for (slot, value) in network.slices_mut().flatten().zip(values) {
        *slot = value;
    }
    network
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{Draw, Purpose};

    fn sample() -> Checkpoint {
        let mut draw = Draw::new(5, Purpose::Weights, 0);
        let mut start = |shape: Shape| Network::start(shape, &mut draw);
        let collision = Trained { float: start(shapes::collision()), tuned: start(shapes::collision()) };
        let friction = Trained { float: start(shapes::friction()), tuned: start(shapes::friction()) };
        Checkpoint {
            recipe: Recipe::standard(Bearing::Plastic),
            bearing: Bearing::Plastic,
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
    fn a_recipe_beyond_the_limit_is_refused_though_length_and_check_sum_fit() {
        let start = sample().to_bytes().expect("bytes")[..12].to_vec();
        let weights = 8 * (shapes::collision().parameters() + shapes::friction().parameters());
        for recipe in [RECIPE_LIMIT + 1, RECIPE_LIMIT + weights + 1, u32::MAX as usize] {
            let mut bytes = start.clone();
            bytes.extend((recipe as u32).to_le_bytes());
            bytes.resize(16 + RECIPE_LIMIT + weights, b' ');
            bytes.extend(check_sum(&bytes).to_le_bytes());
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
