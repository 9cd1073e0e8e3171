//! The checks that a package has to pass before it is run.

use inference::{Bearing, Model};
use link::update::{MANIFEST_LENGTH, SIGNATURE_LENGTH, SignedManifest, UpdateRefusal};

use crate::manifest::{Manifest, hash_of};
use crate::self_test::{self, RECORD_LENGTH};
use crate::signature::{KEY_LENGTH, is_signed};

/// Cause of a sound image that is for another bearing.
pub const WRONG_BEARING: u8 = 100;

/// An image that passed, where it lies.
#[derive(Clone, Copy, Debug)]
pub struct Checked<'a> {
    /// The image.
    pub image: &'a [u8],
    /// The model over it.
    pub model: Model<'a>,
}

/// A manifest that is sound, for this board and signed for this key.
///
/// # Errors
///
/// Why not.
pub fn authentic(
    signed: &SignedManifest,
    board: u16,
    key: &[u8; KEY_LENGTH],
) -> Result<Manifest, UpdateRefusal> {
    let bytes: [u8; MANIFEST_LENGTH] = joined(&signed.manifest);
    let manifest = Manifest::parse(&bytes, board)?;
    let signature: [u8; SIGNATURE_LENGTH] = joined(&signed.signature);
    if is_signed(&bytes, &signature, key) { Ok(manifest) } else { Err(UpdateRefusal::Signature) }
}

/// Checks a payload, at an address divisible by 4, against its manifest: hash, images, self-tests. Gives the images by bearing code.
///
/// # Errors
///
/// Why it is refused.
pub fn check<'a>(manifest: &Manifest, payload: &'a [u8]) -> Result<[Option<Checked<'a>>; 2], UpdateRefusal> {
    if hash_of(payload) != manifest.hash {
        return Err(UpdateRefusal::Hash);
    }
    let mut rest = payload;
    let mut take = |length: u32| {
        let (part, behind) = rest.split_at_checked(length as usize).ok_or(UpdateRefusal::Lengths)?;
        rest = behind;
        Ok(part)
    };
    let [first, second] = manifest.images;
    let images = [take(first)?, take(second)?];
    let [first, second] = manifest.samples.map(|samples| samples.saturating_mul(RECORD_LENGTH as u32));
    let records = [take(first)?, take(second)?];
    let mut package = [None; 2];
    let parts = images.into_iter().zip(records).zip(Bearing::ALL);
    for (to, ((image, records), bearing)) in package.iter_mut().zip(parts) {
        if !image.is_empty() {
            *to = Some(checked(image, records, bearing)?);
        }
    }
    Ok(package)
}

fn checked<'a>(image: &'a [u8], records: &[u8], bearing: Bearing) -> Result<Checked<'a>, UpdateRefusal> {
    let code = bearing.code();
    let model =
        Model::load(image).map_err(|error| UpdateRefusal::Image { bearing: code, cause: error.cause() })?;
    if model.header().bearing != bearing {
        return Err(UpdateRefusal::Image { bearing: code, cause: WRONG_BEARING });
    }
    self_test::run(model, records).map_err(|sample| UpdateRefusal::SelfTest { bearing: code, sample })?;
    Ok(Checked { image, model })
}

fn joined<const N: usize, const M: usize>(parts: &[[u8; 32]; M]) -> [u8; N] {
    let mut bytes = [0; N];
    for (to, from) in bytes.iter_mut().zip(parts.as_flattened()) {
        *to = *from;
    }
    bytes
}
