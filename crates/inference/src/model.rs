//! Model image, checked once and then read in place.

use crate::chain::{Chain, Then};
use crate::convolution::Convolution;
use crate::features::{COLLISION_INPUTS, FRICTION_INPUTS};
use crate::head::Head;
use crate::image::{
    CRC_LENGTH, HEADER_LENGTH, Header, ImageError, LayerName, ReadLayers, Reader, checksum, prove,
};
use crate::weights::LayerInput;
use core::hash::{Hash, Hasher};

/// Channels of every convolution of the shipped networks.
pub const CHANNELS: usize = 16;
/// Columns of each of their convolutions.
pub const KERNEL: usize = 3;
/// Convolutions of a network.
pub const CONVOLUTIONS: usize = 3;
/// Columns of the last convolution that the head takes.
pub const HEAD_COLUMNS: usize = 2;
/// Number of input columns that one output depends on.
pub const WINDOW: usize = CONVOLUTIONS * (KERNEL - 1) + HEAD_COLUMNS;

/// Network of the shipped family: three convolutions and a head over columns of `IN` features, with
/// activations `B` (16 or 8 bits) between the layers. Features always have 16 bits.
pub type Network<'a, B, const IN: usize> = Then<
    Convolution<'a, i16, B, IN, CHANNELS, KERNEL>,
    Then<
        Convolution<'a, B, B, CHANNELS, CHANNELS, KERNEL>,
        Then<Convolution<'a, B, B, CHANNELS, CHANNELS, KERNEL>, Head<'a, B, CHANNELS, HEAD_COLUMNS, 1>>,
    >,
>;

/// Activation between the layers of the shipped networks: `i16` (default) or `i8` (compact).
pub trait Between: LayerInput {}
impl Between for i16 {}
impl Between for i8 {}

/// The two networks of one bearing, read from the bytes of their image.
#[derive(Clone, Copy, Debug)]
pub struct Model<'a, B: Between = i16> {
    header: Header,
    checksum: u32,
    collision: Network<'a, B, COLLISION_INPUTS>,
    friction: Network<'a, B, FRICTION_INPUTS>,
}

/// Names of the networks in messages, in the order of the image.
const NETWORKS: [&str; 2] = ["collision", "friction"];

impl<'a, B: Between> Model<'a, B> {
    /// Checks an image and borrows it.
    ///
    /// # Errors
    ///
    /// The reason, for an address not divisible by 4, a wrong length, magic, version, checksum or
    /// bearing, a header field out of range, a layer whose shape differs from this type's, or a
    /// layer whose sums could overflow.
    pub fn load(image: &'a [u8]) -> Result<Self, ImageError> {
        let (body, sum) = image.split_last_chunk::<CRC_LENGTH>().ok_or(ImageError::TooShort)?;
        let (head, networks) = body.split_first_chunk::<HEADER_LENGTH>().ok_or(ImageError::TooShort)?;
        // Magic, version and length first: a file of another kind must not be reported as a wrong
        // checksum.
        let header = Header::parse(head, image.len());
        if let Err(error @ (ImageError::Magic | ImageError::Version { .. } | ImageError::Length { .. })) =
            header
        {
            return Err(error);
        }
        let (found, expected) = (checksum(body), u32::from_le_bytes(*sum));
        if found != expected {
            return Err(ImageError::Crc { found, expected });
        }
        let header = header?;
        let mut reader = Reader::new(networks);
        let [collision, friction] = NETWORKS.map(|network| LayerName { network, index: 0 });
        let model = Self {
            header,
            checksum: found,
            collision: ReadLayers::read(&mut reader, collision)?,
            friction: ReadLayers::read(&mut reader, friction)?,
        };
        if !reader.is_empty() {
            return Err(ImageError::Trailing);
        }
        prove(networks).map_err(|unproven| unproven.named(name))?;
        Ok(model)
    }

    /// Header of the image.
    pub fn header(&self) -> Header {
        self.header
    }

    /// Checksum of the image, which identifies it.
    pub fn checksum(&self) -> u32 {
        self.checksum
    }

    /// Hashes the configuration besides the image's bytes: the header and the addresses of the
    /// layers' parameters.
    pub fn hash_config(&self, state: &mut impl Hasher) {
        self.header.hash(state);
        self.checksum.hash(state);
        self.collision.hash_config(state);
        self.friction.hash_config(state);
    }

    /// The collision network.
    pub fn collision(&self) -> &Network<'a, B, COLLISION_INPUTS> {
        &self.collision
    }

    /// The friction network.
    pub fn friction(&self) -> &Network<'a, B, FRICTION_INPUTS> {
        &self.friction
    }
}

/// Returns the name of a layer by its position; the collision network's layers come first.
fn name(layer: u8) -> LayerName {
    let [collision, friction] = NETWORKS;
    match layer.checked_sub(CONVOLUTIONS as u8 + 1) {
        None => LayerName { network: collision, index: layer },
        Some(index) => LayerName { network: friction, index },
    }
}
