//! A model image, checked once and then read in place.

use crate::chain::{Chain, Then};
use crate::convolution::Convolution;
use crate::error::ImageError;
use crate::features::{COLLISION_INPUTS, FRICTION_INPUTS};
use crate::head::Head;
use crate::image::{CRC_LENGTH, HEADER_LENGTH, Header, LayerName, Reader, check_sum, prove};
use core::hash::{Hash, Hasher};

/// Channels of every convolution of the shipped networks.
pub const CHANNELS: usize = 16;
/// Columns that each of their convolutions looks at.
pub const KERNEL: usize = 3;
/// Convolutions of a network.
pub const CONVOLUTIONS: usize = 3;
/// Columns of the last convolution that the head takes.
pub const HEAD_COLUMNS: usize = 2;
/// Input columns that one output depends on.
pub const WINDOW: usize = CONVOLUTIONS * (KERNEL - 1) + HEAD_COLUMNS;

/// A network of the family: three convolutions and a head over columns of `IN` features, with `B` (16 or 8 bits) between the
/// layers. Features have 16 bits whatever `B` is.
pub type Network<'a, B, const IN: usize> = Then<
    Convolution<'a, i16, B, IN, CHANNELS, KERNEL>,
    Then<
        Convolution<'a, B, B, CHANNELS, CHANNELS, KERNEL>,
        Then<Convolution<'a, B, B, CHANNELS, CHANNELS, KERNEL>, Head<'a, B, CHANNELS, HEAD_COLUMNS, 1>>,
    >,
>;

/// An activation between the layers of the shipped networks: `i16` (default) or `i8` (compact).
pub trait Between: crate::activation::Activation {}
impl Between for i16 {}
impl Between for i8 {}

/// The two networks of one bearing, over the bytes of their image.
#[derive(Clone, Copy, Debug)]
pub struct Model<'a, B: Between = i16> {
    header: Header,
    check_sum: u32,
    collision: Network<'a, B, COLLISION_INPUTS>,
    friction: Network<'a, B, FRICTION_INPUTS>,
}

/// Names of the networks in messages, in the order of the image.
const NETWORKS: [&str; 2] = ["collision", "friction"];

impl<'a, B: Between> Model<'a, B> {
    /// Checks an image and borrows it.
    ///
    /// Refused, with the reason: an address not divisible by 4, a wrong length, magic, version, check sum or bearing, a
    /// number of the header out of range, a layer of another shape than this type's, a layer whose sums could overflow.
    pub fn load(image: &'a [u8]) -> Result<Self, ImageError> {
        let (body, sum) = image.split_last_chunk::<CRC_LENGTH>().ok_or(ImageError::TooShort)?;
        let (head, networks) = body.split_first_chunk::<HEADER_LENGTH>().ok_or(ImageError::TooShort)?;
        // Magic, version and length first: a file of another kind deserves a better message than "check sum".
        let header = Header::parse(head, image.len());
        if let Err(error @ (ImageError::Magic | ImageError::Version { .. } | ImageError::Length { .. })) =
            header
        {
            return Err(error);
        }
        let (found, expected) = (check_sum(body), u32::from_le_bytes(*sum));
        if found != expected {
            return Err(ImageError::Crc { found, expected });
        }
        let header = header?;
        let mut reader = Reader::new(networks);
        let [collision, friction] = NETWORKS.map(|network| LayerName { network, index: 0 });
        let model = Self {
            header,
            check_sum: found,
            collision: Chain::read(&mut reader, collision)?,
            friction: Chain::read(&mut reader, friction)?,
        };
        if !reader.is_empty() {
            return Err(ImageError::Trailing);
        }
        prove(networks).map_err(|unproven| unproven.named(name))?;
        Ok(model)
    }

    /// What the image says about itself.
    pub fn header(&self) -> Header {
        self.header
    }

    /// Check sum of the image: its identity.
    pub fn check_sum(&self) -> u32 {
        self.check_sum
    }

    /// Gives what must stay as it is beside the image to a sum: what its header says, and where the layers' numbers lie.
    pub fn constants(&self, sum: &mut impl Hasher) {
        self.header.hash(sum);
        self.check_sum.hash(sum);
        self.collision.constants(sum);
        self.friction.constants(sum);
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

/// The layers of the collision network come first.
fn name(layer: u8) -> LayerName {
    let [collision, friction] = NETWORKS;
    match layer.checked_sub(CONVOLUTIONS as u8 + 1) {
        None => LayerName { network: collision, index: layer },
        Some(index) => LayerName { network: friction, index },
    }
}
