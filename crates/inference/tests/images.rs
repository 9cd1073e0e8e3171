//! Bad images are refused with a reason; nothing that can be read from a file makes the loader panic.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::encode::seal;
use inference::layout::{COLLISION_TAPS, HEADER_LENGTH, IMAGE_LENGTH, convolution_length};
use inference::{Bearing, ContactState, ImageError, LayerName, Model, Pair, shipped};
use proptest::prelude::*;

fn copy(bearing: Bearing) -> Box<[u8; IMAGE_LENGTH]> {
    Box::new(shipped(bearing).try_into().expect("length of an image"))
}

/// Loads an image after a change that its check sum was made to fit.
fn resealed(change: impl FnOnce(&mut [u8; IMAGE_LENGTH])) -> Result<(), ImageError> {
    let mut image = copy(Bearing::Babbitt);
    change(&mut image);
    seal(&mut image);
    Model::load(image.as_slice()).map(|_| ())
}

fn put(image: &mut [u8; IMAGE_LENGTH], at: usize, bytes: &[u8]) {
    image[at..at + bytes.len()].copy_from_slice(bytes);
}

#[test]
fn every_flipped_byte_is_refused() {
    for bearing in Bearing::ALL {
        for at in 0..IMAGE_LENGTH {
            let mut image = copy(bearing);
            image[at] ^= 0xff;
            assert!(Model::load(image.as_slice()).is_err(), "byte {at}");
        }
    }
}

#[test]
fn every_truncation_and_every_extension_is_refused_by_length() {
    let mut bytes = shipped(Bearing::Plastic).to_vec();
    for length in 0..bytes.len() {
        let error = Model::load(&bytes[..length]).expect_err("short image");
        assert_eq!(error, ImageError::Length { found: length, expected: IMAGE_LENGTH });
    }
    bytes.push(0);
    assert!(matches!(Model::load(&bytes), Err(ImageError::Length { .. })));
}

#[test]
fn each_field_of_the_header_has_its_own_reason() {
    assert_eq!(resealed(|_| ()), Ok(()));
    assert_eq!(resealed(|image| put(image, 0, b"ELF")), Err(ImageError::Magic));
    assert_eq!(resealed(|image| put(image, 8, &[9, 0])), Err(ImageError::Version { found: 9, expected: 1 }));
    assert_eq!(resealed(|image| put(image, 10, &[7])), Err(ImageError::Bearing { found: 7 }));
    assert!(matches!(resealed(|image| put(image, 11, &[3])), Err(ImageError::Field { .. })));
    let declared = resealed(|image| put(image, 12, &1u32.to_le_bytes()));
    assert_eq!(declared, Err(ImageError::DeclaredLength { found: 1, expected: IMAGE_LENGTH as u32 }));
    assert!(matches!(
        resealed(|image| put(image, 84, &[9])),
        Err(ImageError::Shape { network: "collision", found: [9, ..], .. })
    ));
    assert!(matches!(
        resealed(|image| put(image, 89, &[32])),
        Err(ImageError::Shape { network: "friction", found: [_, 32, ..], .. })
    ));
    for (at, name) in [
        (24, "radial clearance range"),
        (28, "radial clearance range"),
        (36, "deformation range"),
        (44, "rate ratio range"),
        (52, "sliding speed range"),
        (60, "normal force range"),
        (64, "latch floor"),
        (68, "slow speed scale"),
        (72, "fast speed scale"),
    ] {
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            let result = resealed(|image| put(image, at, &bad.to_le_bytes()));
            assert_eq!(result, Err(ImageError::Field { name }), "{bad} at {at}");
        }
    }
    let mut image = copy(Bearing::Babbitt);
    image[3000] ^= 1;
    assert!(matches!(Model::load(image.as_slice()), Err(ImageError::Crc { .. })));
}

#[test]
fn a_layer_that_could_overflow_is_named() {
    let second = HEADER_LENGTH + convolution_length(COLLISION_TAPS);
    let error = resealed(|image| put(image, second + 4, &i32::MAX.to_le_bytes())).expect_err("overflow");
    let ImageError::Layer { layer, largest_accumulator } = error else { panic!("{error}") };
    assert_eq!(layer, LayerName::CollisionConvolution(1));
    assert!(largest_accumulator > i64::from(i32::MAX));
    assert!(error.to_string().contains("collision convolution 1"), "{error}");

    let multipliers = second + 64;
    let error = resealed(|image| put(image, multipliers, &0i32.to_le_bytes())).expect_err("multiplier");
    assert_eq!(
        error,
        ImageError::Layer { layer: LayerName::CollisionConvolution(1), largest_accumulator: 0 }
    );
}

proptest! {
    #[test]
    fn noise_is_refused_and_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..2 * IMAGE_LENGTH)) {
        prop_assert!(Model::load(&bytes).is_err());
    }

    #[test]
    fn a_resealed_image_loads_and_runs_or_is_refused(
        changes in proptest::collection::vec((0..IMAGE_LENGTH, any::<u8>()), 1..20),
        deformation in -1e-4..3e-4_f32,
    ) {
        let mut image = copy(Bearing::Plastic);
        for (at, byte) in changes {
            image[at] = byte;
        }
        seal(&mut image);
        if let Ok(model) = Model::load(image.as_slice()) {
            let mut pair = Pair::new(model);
            let state = ContactState { radial_clearance_m: 1e-3, deformation_m: deformation, ..Default::default() };
            for _ in 0..10 {
                prop_assert!(pair.step(&state).normal_force_n >= 0.0);
            }
        }
    }
}
