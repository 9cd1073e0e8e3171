//! Packages for the tests, signed with the development key.

use ed25519_dalek::{Signer, SigningKey};
use inference::{BearingMaterial, Model, Pair, Sample, shipped};
use link::update::{CHUNK_LENGTH, SignedManifest, UpdateChunk, UpdateRequest};
use model_package::self_test::record;
use model_package::{Manifest, board, hash_of};

pub(crate) const BOARD: u16 = board::STM32F405;

/// Secret half of the development key.
pub(crate) fn key() -> SigningKey {
    let text = include_str!("../../../../model-quant/keys/development.key").lines().last().unwrap();
    SigningKey::from_bytes(&std::array::from_fn(|i| u8::from_str_radix(&text[2 * i..2 * i + 2], 16).unwrap()))
}

#[derive(Clone, Debug)]
pub(crate) struct Package {
    pub(crate) manifest: Manifest,
    pub(crate) signed: SignedManifest,
    pub(crate) payload: Vec<u8>,
}

/// The same networks with one slightly larger scale: another valid model.
pub(crate) fn image(bearing: BearingMaterial, version: u32) -> Vec<u8> {
    let mut image = shipped(bearing).to_vec();
    // The training id distinguishes them.
    image[16..20].copy_from_slice(&version.to_le_bytes());
    inference::image::write::seal(&mut image);
    image
}

pub(crate) fn records(image: &[u8]) -> Vec<u8> {
    let words: Vec<u32> = image.chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect();
    let mut pair: Pair<'_> = Pair::new(Model::load(bytemuck::cast_slice(&words)).unwrap());
    let sample = |step: i32| Sample {
        radial_clearance_nm: 500_000,
        deformation_pm: (step % 17 - 2) * 2_000_000,
        deformation_rate_nm_s: (step * 5 % 11 - 5) * 2_000_000,
        approach_speed_nm_s: 20_000_000,
        sliding_speed_nm_s: (step % 5 - 2) * 20_000_000,
    };
    (0..24).flat_map(|step| record(&mut pair, &sample(step))).collect()
}

impl Package {
    pub(crate) fn new(bearing: BearingMaterial, version: u32) -> Self {
        let image = image(bearing, version);
        let records = records(&image);
        Self::of(bearing, version, &image, &records)
    }

    /// A package of an image and its self-test, sound or not.
    pub(crate) fn of(bearing: BearingMaterial, version: u32, image: &[u8], records: &[u8]) -> Self {
        let payload = [image, records].concat();
        let mut manifest = Manifest {
            board: BOARD,
            version,
            may_be_older: false,
            revokes_older_keys: false,
            images: [0; BearingMaterial::COUNT],
            samples: [0; BearingMaterial::COUNT],
            hash: hash_of(&payload),
        };
        manifest.images[bearing.code() as usize] = image.len() as u32;
        manifest.samples[bearing.code() as usize] = records.len() as u32 / 32;
        Self { signed: sign(&manifest), manifest, payload }
    }

    pub(crate) fn signed_anew(self, change: impl FnOnce(&mut Manifest)) -> Self {
        self.signed_with(&key(), change)
    }

    /// The package with a change, signed with another key.
    pub(crate) fn signed_with(mut self, key: &SigningKey, change: impl FnOnce(&mut Manifest)) -> Self {
        change(&mut self.manifest);
        self.signed = sign_with(&self.manifest, key);
        self
    }

    pub(crate) fn begin(&self) -> UpdateRequest {
        UpdateRequest::Begin(self.signed)
    }

    pub(crate) fn chunk(&self, offset: u32) -> UpdateRequest {
        let mut bytes = [[0; 32]; CHUNK_LENGTH / 32];
        for (to, from) in bytes.as_flattened_mut().iter_mut().zip(&self.payload[offset as usize..]) {
            *to = *from;
        }
        UpdateRequest::Chunk(UpdateChunk { offset, bytes })
    }

    pub(crate) fn offsets(&self) -> impl DoubleEndedIterator<Item = u32> + use<> {
        (0..self.payload.len() as u32).step_by(CHUNK_LENGTH)
    }
}

pub(crate) fn sign(manifest: &Manifest) -> SignedManifest {
    sign_with(manifest, &key())
}

fn sign_with(manifest: &Manifest, key: &SigningKey) -> SignedManifest {
    let bytes = manifest.to_bytes();
    let signature = key.sign(&bytes).to_bytes();
    SignedManifest {
        manifest: *bytes.as_chunks::<32>().0.first_chunk().unwrap(),
        signature: *signature.as_chunks::<32>().0.first_chunk().unwrap(),
    }
}
