//! Signed packages of model images: the updates of a controller ([`model_package`]).
//!
//! A package consists of at most one image for each bearing, a self-test for each image, and the
//! signature. A self-test has 32 samples over the image's training range with the outputs of the
//! networks. The same images, version, board and key give the same bytes.

use crate::quantise::image::AlignedImage;
use ed25519_dalek::{Signer, SigningKey};
use inference::{BearingMaterial, Header, ImageError, Model, Pair, Sample};
use link::update::{MANIFEST_LENGTH, SIGNATURE_LENGTH, SignedManifest, UpdateRefusal};
use model_package::{MAX_VERSION, MIN_SAMPLES, Manifest, authenticate, check, hash_of, self_test};
use std::path::Path;

/// Number of samples of a self-test.
pub(crate) const SAMPLES: u32 = 32;
const _: () =
    assert!(SAMPLES >= MIN_SAMPLES, "the result of a self-test must not depend on the networks' start");

/// Bytes before the payload.
const SIGNED: usize = MANIFEST_LENGTH + SIGNATURE_LENGTH;

/// Properties of a package besides its images.
#[derive(Clone, Copy, Debug)]
pub struct PackageProperties {
    /// Code of the board.
    pub board: u16,
    /// Version of the model, from 1.
    pub version: u32,
    /// True if the controller may install it over a newer version.
    pub may_be_older: bool,
    /// True if the controller must no longer trust the keys that its firmware lists before the
    /// signer's.
    pub revokes_older_keys: bool,
}

/// Reason why a package could not be made or read.
#[derive(Debug, thiserror::Error)]
pub enum PackageError {
    /// An image was refused.
    #[error("{0}")]
    Image(ImageError),
    /// Two images for one bearing.
    #[error("two images for the {0} bearing, expected one")]
    Twice(&'static str),
    /// No image.
    #[error("no image, expected at least one")]
    Empty,
    /// Version that no controller accepts; 0 denotes the built-in models.
    #[error("version {0}, expected 1 to {MAX_VERSION}: 0 stands for the models built into a firmware")]
    Version(u32),
    /// The bytes are not a package.
    #[error("{found} bytes, expected {expected}")]
    Length {
        /// Bytes found.
        found: usize,
        /// Bytes expected: by the manifest, or at least a manifest and a signature.
        expected: usize,
    },
    /// A check of the controller fails.
    #[error("{0}")]
    Refused(UpdateRefusal),
}

/// A package in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Package {
    /// Manifest and signature.
    pub signed: SignedManifest,
    /// Decoded manifest.
    pub manifest: Manifest,
    /// Bytes after the signature.
    pub payload: AlignedImage,
}

impl Package {
    /// Makes a package and signs it.
    ///
    /// # Errors
    ///
    /// No image, two of one bearing, one that a controller would refuse, or a version out of range.
    pub fn new(
        properties: PackageProperties,
        images: &[AlignedImage],
        key: &SigningKey,
    ) -> Result<Self, PackageError> {
        if !(1..=MAX_VERSION).contains(&properties.version) {
            return Err(PackageError::Version(properties.version));
        }
        let mut parts = [const { None::<(&[u8], Vec<u8>)> }; BearingMaterial::COUNT];
        for image in images {
            let model: Model<'_> = Model::load(image).map_err(PackageError::Image)?;
            let bearing = model.header().bearing;
            let part = parts.get_mut(usize::from(bearing.code())).ok_or(PackageError::Empty)?;
            if part.replace((image, records(model))).is_some() {
                return Err(PackageError::Twice(bearing.name()));
            }
        }
        if images.is_empty() {
            return Err(PackageError::Empty);
        }
        let images = || parts.iter().flatten().flat_map(|(image, _)| image.iter());
        let tests = || parts.iter().flatten().flat_map(|(_, records)| records);
        let payload: Vec<u8> = images().chain(tests()).copied().collect();
        let manifest = Manifest {
            board: properties.board,
            version: properties.version,
            may_be_older: properties.may_be_older,
            revokes_older_keys: properties.revokes_older_keys,
            images: parts.each_ref().map(|part| part.as_ref().map_or(0, |(image, _)| image.len() as u32)),
            samples: parts.each_ref().map(|part| if part.is_some() { SAMPLES } else { 0 }),
            hash: hash_of(&payload),
        };
        let signed = sign(&manifest, key);
        Ok(Self { signed, manifest, payload: AlignedImage::copy(&payload) })
    }

    /// Decodes a package. The signature is not checked: the controller does that with its own key.
    ///
    /// # Errors
    ///
    /// The bytes are not a package or differ from the manifest.
    pub fn parse(bytes: &[u8]) -> Result<Self, PackageError> {
        let short = PackageError::Length { found: bytes.len(), expected: SIGNED };
        let Some((head, payload)) = bytes.split_at_checked(SIGNED) else { return Err(short) };
        let &[a, b, c, d, e] = head.as_chunks::<32>().0 else { return Err(short) };
        let signed = SignedManifest { manifest: [a, b, c], signature: [d, e] };
        let Some(bytes) = head.first_chunk::<MANIFEST_LENGTH>() else { return Err(short) };
        let board = u16::from_le_bytes([bytes[10], bytes[11]]);
        let manifest = Manifest::parse(bytes, board).map_err(PackageError::Refused)?;
        let expected = manifest.length() as usize;
        if payload.len() != expected {
            return Err(PackageError::Length {
                found: payload.len() + SIGNED,
                expected: expected.saturating_add(SIGNED),
            });
        }
        let payload = AlignedImage::copy(payload);
        check(&manifest, &payload).map_err(PackageError::Refused)?;
        Ok(Self { signed, manifest, payload })
    }

    /// Reads a package file.
    ///
    /// # Errors
    ///
    /// Those of the operating system, or of [`Package::parse`].
    pub fn read(path: &Path) -> std::io::Result<Result<Self, PackageError>> {
        std::fs::read(path).map(|bytes| Self::parse(&bytes))
    }

    /// Encodes the file.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        [self.signed.manifest.as_flattened(), self.signed.signature.as_flattened(), &self.payload].concat()
    }

    /// Returns true if a controller that trusts this key would accept the signature.
    #[must_use]
    pub(crate) fn is_signed_for(&self, key: &[u8; 32]) -> bool {
        authenticate(&self.signed, self.manifest.board, &[*key]).is_ok()
    }

    /// Bearing, checksum, header and length of every image.
    #[must_use]
    pub(crate) fn images(&self) -> Vec<(BearingMaterial, u32, Header, usize)> {
        let checked = check(&self.manifest, &self.payload).unwrap_or_default();
        let images = checked.into_iter().flatten();
        images
            .map(|c| (c.model.header().bearing, c.model.checksum(), c.model.header(), c.image.len()))
            .collect()
    }
}

fn sign(manifest: &Manifest, key: &SigningKey) -> SignedManifest {
    let bytes = manifest.to_bytes();
    let signature = key.sign(&bytes).to_bytes();
    let mut signed = SignedManifest { manifest: [[0; 32]; 3], signature: [[0; 32]; 2] };
    signed.manifest.as_flattened_mut().copy_from_slice(&bytes);
    signed.signature.as_flattened_mut().copy_from_slice(&signature);
    signed
}

/// Self-test records: samples through contact and gap, approach and retreat, both sliding
/// directions, up to a tenth beyond the training range, with the outputs of the networks.
fn records(model: Model<'_>) -> Vec<u8> {
    let header = model.header();
    let mut pair: Pair<'_> = Pair::new(model);
    (0..SAMPLES).flat_map(|step| self_test::record(&mut pair, &sample(&header, step))).collect()
}

fn sample(header: &Header, step: u32) -> Sample {
    // Steps of 1/16 of a range; each quantity has a different period.
    let part =
        |range: u64, sixteenths: i64| (i64::try_from(range).unwrap_or(i64::MAX) * sixteenths / 16) as i32;
    let step = i64::from(step);
    let approach = (header.latch_floor_nm_s * 4).min(1 << 30);
    let rate = (u64::from(approach) * u64::from(header.rate_ratio_high_q16)) >> 16;
    Sample {
        radial_clearance_nm: header.clearance_low_nm.midpoint(header.clearance_high_nm),
        deformation_pm: part(header.deformation_high_pm.into(), (step * 5) % 21 - 3),
        deformation_rate_nm_s: part(rate.min(1 << 30), (step * 7) % 35 - 17),
        approach_speed_nm_s: approach,
        sliding_speed_nm_s: part(header.sliding_speed_high_nm_s.into(), (step * 3) % 33 - 16),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inference::shipped;

    const PROPERTIES: PackageProperties =
        PackageProperties { board: 0x0405, version: 3, may_be_older: false, revokes_older_keys: false };

    fn package(images: &[BearingMaterial]) -> Result<Package, PackageError> {
        let images: Vec<_> = images.iter().map(|&bearing| AlignedImage::copy(shipped(bearing))).collect();
        Package::new(PROPERTIES, &images, &SigningKey::from_bytes(&[9; 32]))
    }

    #[test]
    fn a_package_is_the_same_bytes_in_any_order_and_survives_its_file() {
        let one = package(&BearingMaterial::ALL).expect("package");
        let other = package(&[BearingMaterial::Plastic, BearingMaterial::Babbitt]).expect("package");
        assert_eq!(one, other);
        assert_eq!(Package::parse(&one.to_bytes()).expect("package"), one);
        assert_eq!(one.images().len(), 2);
        let key = SigningKey::from_bytes(&[9; 32]).verifying_key().to_bytes();
        assert!(one.is_signed_for(&key) && !one.is_signed_for(&[1; 32]));
    }

    #[test]
    fn the_self_test_goes_through_contact_and_gap_and_notices_other_weights() {
        for bearing in BearingMaterial::ALL {
            let package = package(&[bearing]).expect("package");
            let mut image = shipped(bearing).to_vec();
            let records = package.payload.get(image.len()..).expect("records");
            let forces: Vec<i32> =
                records.as_chunks::<4>().0.chunks(8).map(|words| i32::from_le_bytes(words[5])).collect();
            assert!(forces.contains(&0) && forces.iter().any(|&force| force > 1_000_000), "{forces:?}");
            // Half of the weights never affect an output: many channels are always 0, and so are
            // some inputs. 256 random samples detect hardly more. Corrupted bytes are detected by
            // the hash.
            let positions: Vec<_> = (264..image.len() - 4).step_by(83).collect();
            let noticed = positions.iter().filter(|&&at| {
                image[at] ^= 0x40;
                inference::image::write::seal(&mut image);
                let corrupted = AlignedImage::copy(&image);
                image[at] ^= 0x40;
                Model::load(&corrupted).map_or(true, |model| self_test::run(model, records).is_err())
            });
            assert!(noticed.count() * 3 > positions.len());
        }
    }

    #[test]
    fn what_is_no_package_is_refused_with_the_reason() {
        assert!(matches!(package(&[]), Err(PackageError::Empty)));
        assert!(matches!(package(&[BearingMaterial::Babbitt; 2]), Err(PackageError::Twice("babbitt"))));
        let bytes = package(&BearingMaterial::ALL).expect("package").to_bytes();
        for length in [0, 100, 160, bytes.len() - 1] {
            let error = Package::parse(bytes.get(..length).expect("part")).expect_err("too short");
            assert!(matches!(error, PackageError::Length { found, .. } if found == length), "{error}");
        }
        let mut corrupted = bytes.clone();
        corrupted[3000] ^= 1;
        assert!(matches!(Package::parse(&corrupted), Err(PackageError::Refused(UpdateRefusal::Hash))));
        corrupted[0] = b'Q';
        assert!(matches!(Package::parse(&corrupted), Err(PackageError::Refused(UpdateRefusal::Magic))));
    }
}
