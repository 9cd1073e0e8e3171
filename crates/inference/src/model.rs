//! A model image, checked once and then read in place.

use crate::error::{ImageError, LayerName};
use crate::header::Header;
use crate::layout::{COLLISION_TAPS, FRICTION_TAPS, HEADER_LENGTH, IMAGE_LENGTH, check_sum};
use crate::network::Network;
use crate::read::Reader;

/// The two networks of one bearing, over the bytes of their image.
#[derive(Clone, Debug)]
pub struct Model<'a> {
    header: Header,
    collision: Network<'a, COLLISION_TAPS>,
    friction: Network<'a, FRICTION_TAPS>,
}

impl<'a> Model<'a> {
    /// Checks an image and borrows it. The image may lie at any address.
    ///
    /// Refused, with the reason: a wrong length, magic, version, check sum, bearing, shape; ranges that are not finite
    /// or not in order; a layer whose accumulator could overflow.
    pub fn load(image: &'a [u8]) -> Result<Self, ImageError> {
        let wrong_length = ImageError::Length { found: image.len(), expected: IMAGE_LENGTH };
        let image: &[u8; IMAGE_LENGTH] = image.try_into().map_err(|_| wrong_length)?;
        let (body, sum) = image.split_last_chunk().ok_or(wrong_length)?;
        let (head, networks) = body.split_first_chunk::<HEADER_LENGTH>().ok_or(wrong_length)?;
        let expected = u32::from_le_bytes(*sum);
        // Magic and version first: a file of another kind deserves a better message than "check sum".
        let header = Header::parse(head, IMAGE_LENGTH, expected);
        if let Err(error @ (ImageError::Magic | ImageError::Version { .. })) = header {
            return Err(error);
        }
        let found = check_sum(body);
        if found != expected {
            return Err(ImageError::Crc { found, expected });
        }
        let header = header?;
        let mut reader = Reader::new(networks, IMAGE_LENGTH);
        Ok(Self {
            header,
            collision: Network::read(&mut reader, LayerName::CollisionConvolution, LayerName::CollisionHead)?,
            friction: Network::read(&mut reader, LayerName::FrictionConvolution, LayerName::FrictionHead)?,
        })
    }

    /// What the image says about itself.
    pub fn header(&self) -> Header {
        self.header
    }

    pub(crate) fn header_ref(&self) -> &Header {
        &self.header
    }

    /// The collision network.
    pub fn collision(&self) -> &Network<'a, COLLISION_TAPS> {
        &self.collision
    }

    /// The friction network.
    pub fn friction(&self) -> &Network<'a, FRICTION_TAPS> {
        &self.friction
    }
}
