//! Checks that a package has to pass before it is used.

use inference::{BearingMaterial, Model};
use link::update::{MANIFEST_LENGTH, SIGNATURE_LENGTH, SignedManifest, UpdateRefusal};

use crate::manifest::{Manifest, hash_of};
use crate::self_test::{self, RECORD_LENGTH};
use crate::signature::{KEY_LENGTH, is_signed};

/// Cause code of a valid image for another bearing.
pub const WRONG_BEARING: u8 = 100;

/// An image that passed, in place.
#[derive(Clone, Copy, Debug)]
pub struct Checked<'a> {
    /// The image.
    pub image: &'a [u8],
    /// Model that reads the image.
    pub model: Model<'a>,
}

/// Parses a manifest and checks that it is valid, made for this board and signed with one of these
/// keys. Returns it with the index of the key.
///
/// # Errors
///
/// The reason for the refusal.
pub fn authenticate(
    signed: &SignedManifest,
    board: u16,
    keys: &[[u8; KEY_LENGTH]],
) -> Result<(Manifest, usize), UpdateRefusal> {
    let bytes: [u8; MANIFEST_LENGTH] = join(&signed.manifest);
    let manifest = Manifest::parse(&bytes, board)?;
    let signature: [u8; SIGNATURE_LENGTH] = join(&signed.signature);
    let signer = keys.iter().position(|key| is_signed(&bytes, &signature, key));
    signer.map(|signer| (manifest, signer)).ok_or(UpdateRefusal::Signature)
}

/// Checks a payload, at an address divisible by 4, against its manifest: hash, images, self-tests.
/// Returns the images by bearing code.
///
/// # Errors
///
/// The reason for the refusal.
pub fn check<'a>(
    manifest: &Manifest,
    payload: &'a [u8],
) -> Result<[Option<Checked<'a>>; BearingMaterial::COUNT], UpdateRefusal> {
    if hash_of(payload) != manifest.hash {
        return Err(UpdateRefusal::Hash);
    }
    let mut remaining = payload;
    let mut take = |length: u32| {
        let (part, later) = remaining.split_at_checked(length as usize).ok_or(UpdateRefusal::Lengths)?;
        remaining = later;
        Ok(part)
    };
    let mut parts = [[[].as_slice(); BearingMaterial::COUNT]; 2];
    let lengths = manifest.samples.map(|samples| samples.saturating_mul(RECORD_LENGTH as u32));
    for (part, length) in parts.as_flattened_mut().iter_mut().zip(manifest.images.into_iter().chain(lengths))
    {
        *part = take(length)?;
    }
    let [images, records] = parts;
    let mut package = [None; BearingMaterial::COUNT];
    let parts = images.into_iter().zip(records).zip(BearingMaterial::ALL);
    for (to, ((image, records), bearing)) in package.iter_mut().zip(parts) {
        if !image.is_empty() {
            *to = Some(check_image(image, records, bearing)?);
        }
    }
    Ok(package)
}

fn check_image<'a>(
    image: &'a [u8],
    records: &[u8],
    bearing: BearingMaterial,
) -> Result<Checked<'a>, UpdateRefusal> {
    let code = bearing.code();
    let model =
        Model::load(image).map_err(|error| UpdateRefusal::Image { bearing: code, cause: error.cause() })?;
    if model.header().bearing != bearing {
        return Err(UpdateRefusal::Image { bearing: code, cause: WRONG_BEARING });
    }
    self_test::run(model, records).map_err(|sample| UpdateRefusal::SelfTest { bearing: code, sample })?;
    Ok(Checked { image, model })
}

fn join<const N: usize, const M: usize>(parts: &[[u8; 32]; M]) -> [u8; N] {
    let mut bytes = [0; N];
    for (to, from) in bytes.iter_mut().zip(parts.as_flattened()) {
        *to = *from;
    }
    bytes
}
