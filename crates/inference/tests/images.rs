//! Bad images are refused with a reason; no bytes make the loader panic.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::features::{COLLISION_INPUTS, FRICTION_INPUTS};
use inference::image::write::{LayerParts, WriteError, image, image_length, seal};
use inference::image::{CRC_LENGTH, HEADER_LENGTH, LayerName, LayerShape, SHAPE_LENGTH, WeightForm};
use inference::model::{CHANNELS, HEAD_COLUMNS, KERNEL};
use inference::{
    BearingMaterial, Convolution, Head, ImageError, Model, Network, Pair, Sample, Scale, shipped,
};
use proptest::prelude::*;

/// A copy of an image at an address that it can be read from.
struct Copied {
    words: Vec<u32>,
    length: usize,
}

impl Copied {
    fn new(bytes: &[u8]) -> Self {
        let mut words = vec![0; bytes.len().div_ceil(4)];
        bytemuck::cast_slice_mut(&mut words)[..bytes.len()].copy_from_slice(bytes);
        Self { words, length: bytes.len() }
    }

    fn bytes(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.words)[..self.length]
    }

    fn bytes_mut(&mut self) -> &mut [u8] {
        &mut bytemuck::cast_slice_mut(&mut self.words)[..self.length]
    }
}

fn load(image: &Copied) -> Result<(), ImageError> {
    Model::<i16>::load(image.bytes()).map(|_| ())
}

/// Loads a shipped image after a change, with the checksum adapted.
fn resealed(change: impl FnOnce(&mut [u8])) -> Result<(), ImageError> {
    let mut image = Copied::new(shipped(BearingMaterial::Babbitt));
    change(image.bytes_mut());
    seal(image.bytes_mut());
    load(&image)
}

fn put(image: &mut [u8], at: usize, bytes: &[u8]) {
    image[at..at + bytes.len()].copy_from_slice(bytes);
}

#[test]
fn every_flipped_byte_is_refused() {
    for bearing in BearingMaterial::ALL {
        let mut image = Copied::new(shipped(bearing));
        for at in 0..image.length {
            image.bytes_mut()[at] ^= 0xff;
            assert!(load(&image).is_err(), "byte {at}");
            image.bytes_mut()[at] ^= 0xff;
        }
        assert_eq!(load(&image), Ok(()));
    }
}

#[test]
fn every_truncation_and_extension_is_refused() {
    let whole = shipped(BearingMaterial::Plastic);
    for length in 0..whole.len() {
        let error = load(&Copied::new(&whole[..length])).expect_err("short image");
        let expected = match length {
            0..68 => ImageError::TooShort,
            _ => ImageError::Length { found: length, expected: whole.len() as u32 },
        };
        assert_eq!(error, expected);
    }
    let longer = [whole, &[0; 4]].concat();
    assert!(matches!(load(&Copied::new(&longer)), Err(ImageError::Length { .. })));
}

#[test]
fn an_address_that_weights_cannot_be_read_from_is_refused() {
    let moved = Copied::new(&[&[0], shipped(BearingMaterial::Plastic)].concat());
    assert_eq!(Model::<i16>::load(&moved.bytes()[1..]).map(|_| ()), Err(ImageError::Alignment));
}

#[test]
fn each_header_field_is_refused_with_its_name() {
    let length = shipped(BearingMaterial::Babbitt).len();
    assert_eq!(resealed(|_| ()), Ok(()));
    assert_eq!(resealed(|image| put(image, 0, b"ELF")), Err(ImageError::Magic));
    assert_eq!(resealed(|image| put(image, 8, &[9, 0])), Err(ImageError::Version { found: 9, expected: 3 }));
    assert_eq!(resealed(|image| put(image, 10, &[7])), Err(ImageError::Bearing { found: 7 }));
    assert_eq!(
        resealed(|image| put(image, 12, &1u32.to_le_bytes())),
        Err(ImageError::Length { found: length, expected: 1 })
    );
    let half_powers = ImageError::Field { name: "half powers", found: 3, expected: [0, 2] };
    assert_eq!(resealed(|image| put(image, 11, &[3])), Err(half_powers));
    assert_eq!(half_powers.to_string(), "model image: half powers: found 3, expected 0 to 2");
    let reserved = ImageError::Field { name: "reserved number", found: 1, expected: [0, 0] };
    assert_eq!(resealed(|image| put(image, 60, &[1])), Err(reserved));
    // No rate would be inside the range at the floor.
    let floor = resealed(|image| {
        put(image, 24 + 4 * 3, &(1u32 << 12).to_le_bytes());
        put(image, 24 + 4 * 6, &15u32.to_le_bytes());
    });
    assert_eq!(
        floor,
        Err(ImageError::Field { name: "latch floor in nm/s", found: 15, expected: [16, 1 << 30] })
    );
    let names = [
        "radial clearance",
        "radial clearance",
        "deformation",
        "rate ratio",
        "sliding speed",
        "normal force",
        "latch floor",
        "slow speed",
        "fast speed",
    ];
    for (index, name) in names.into_iter().enumerate() {
        for value in [0, u32::MAX] {
            let refused = resealed(|image| put(image, 24 + 4 * index, &u32::to_le_bytes(value)));
            assert!(
                matches!(refused, Err(ImageError::Field { name: named, found, .. })
                    if named.starts_with(name) && (found == value || index == 1)),
                "field {index}: {refused:?}"
            );
        }
    }
}

#[test]
fn layers_are_refused_by_name() {
    let first = LayerName { network: "collision", index: 0 };
    let kernel = resealed(|image| put(image, HEADER_LENGTH + 1, &[5]));
    assert!(matches!(kernel, Err(ImageError::Shape { layer, found: Some(shape), .. })
        if layer == first && shape.columns == 5));
    let nonsense = resealed(|image| put(image, HEADER_LENGTH, &[9]));
    assert!(matches!(nonsense, Err(ImageError::Shape { layer, found: None, .. }) if layer == first));
    // The first layer's multipliers follow four biases and four times 12 groups of weights.
    let zero = resealed(|image| put(image, HEADER_LENGTH + SHAPE_LENGTH + 13 * 16, &[0; 4]));
    assert_eq!(zero, Err(ImageError::Scale { layer: first }));
    let bias = resealed(|image| put(image, HEADER_LENGTH + SHAPE_LENGTH + 8, &i32::MAX.to_le_bytes()));
    assert!(
        matches!(bias, Err(ImageError::Overflow { layer, output: 2, largest })
        if layer == first && largest >= i64::from(i32::MAX)),
        "{bias:?}"
    );
    // A model of another type refuses the image.
    let other = Model::<i8>::load(shipped(BearingMaterial::Babbitt)).map(|_| ());
    assert!(matches!(other, Err(ImageError::Shape { layer, .. }) if layer == first), "{other:?}");
}

/// Shapes of a model's eight layers.
fn shapes<B: inference::model::Between>(features: WeightForm, between: WeightForm) -> [LayerShape; 8] {
    let hidden = Convolution::<B, B, CHANNELS, CHANNELS, KERNEL>::shape(between);
    let head = Head::<B, CHANNELS, HEAD_COLUMNS, 1>::shape(between);
    [
        Convolution::<i16, B, COLLISION_INPUTS, CHANNELS, KERNEL>::shape(features),
        hidden,
        hidden,
        head,
        Convolution::<i16, B, FRICTION_INPUTS, CHANNELS, KERNEL>::shape(features),
        hidden,
        hidden,
        head,
    ]
}

/// Returns an image whose weights are all equal.
fn uniform(shapes: &[LayerShape], weight: i16) -> Result<Copied, WriteError> {
    let header = Model::<i16>::load(shipped(BearingMaterial::Babbitt)).expect("shipped image").header();
    let (weights, ones) = (vec![weight; 768], [1; 16]);
    let parts: Vec<LayerParts<'_>> = (shapes.iter())
        .map(|&shape| LayerParts {
            shape,
            biases: &ones[..usize::from(shape.outputs)],
            multipliers: if shape.output_bits == 32 { &[] } else { &ones },
            scale: Scale { multiplier: 1 << 30, shift: 40 },
            weights: &weights[..usize::from(shape.outputs) * shape.taps()],
        })
        .collect();
    let mut copied = Copied { words: vec![0; image_length(shapes) / 4], length: image_length(shapes) };
    assert_eq!(image(&header, &parts, copied.bytes_mut())?, copied.length);
    Ok(copied)
}

#[test]
fn the_bound_of_a_sum_follows_from_the_actual_weights() {
    let wide = shapes::<i16>(WeightForm::Wide, WeightForm::Wide);
    // 48 taps of 1365 stay below 2^31 / 2^15 = 65536; 48 of 1366 do not.
    assert_eq!(load(&uniform(&wide, 1365).expect("image")), Ok(()));
    let error = load(&uniform(&wide, 1366).expect("image"));
    let layer = LayerName { network: "collision", index: 1 };
    assert_eq!(error, Err(ImageError::Overflow { layer, output: 0, largest: 48 * 1366 * 32768 + 1 }));
    let friction = uniform(&wide, -1365).map(|mut image| {
        let at = image.length - CRC_LENGTH - 4;
        put(image.bytes_mut(), at, &i16::MIN.to_le_bytes());
        put(image.bytes_mut(), at + 2, &i16::MIN.to_le_bytes());
        seal(image.bytes_mut());
        load(&image)
    });
    let layer = LayerName { network: "friction", index: 3 };
    assert!(
        matches!(friction, Ok(Err(ImageError::Overflow { layer: found, .. })) if found == layer),
        "{friction:?}"
    );
}

#[test]
fn wide_weights_on_8_bit_activations_have_no_kernel() {
    let mut mixed = shapes::<i8>(WeightForm::Wide, WeightForm::Packed);
    let image = uniform(&mixed, 1).expect("image");
    assert!(Model::<i8>::load(image.bytes()).is_ok());
    mixed[1].form = WeightForm::Wide;
    let image = uniform(&mixed, 1).expect("image");
    assert!(matches!(Model::<i8>::load(image.bytes()).map(|_| ()), Err(ImageError::Shape { .. })));
}

#[test]
fn a_small_buffer_and_parts_of_wrong_lengths_are_refused() {
    let shapes = shapes::<i16>(WeightForm::Packed, WeightForm::Packed);
    let header = Model::<i16>::load(shipped(BearingMaterial::Babbitt)).expect("shipped image").header();
    let part = LayerParts {
        shape: shapes[0],
        biases: &[0; 16],
        multipliers: &[1; 16],
        scale: Scale { multiplier: 1, shift: 30 },
        weights: &[0; 16 * 24],
    };
    assert_eq!(image(&header, &[part], &mut [0; 100]), Err(WriteError::NoRoom));
    let wrong = LayerParts { biases: &[0; 15], ..part };
    assert_eq!(image(&header, &[wrong], &mut [0; 1000]), Err(WriteError::Lengths));
    assert!(image(&header, &[part], &mut [0; 1000]).is_ok());
}

/// Bytes of an image in flash, as in the README.
#[test]
fn sizes_are_as_documented() {
    let readme = include_str!("../README.md");
    let image = shipped(BearingMaterial::Babbitt).len();
    assert_eq!(image, image_length(&shapes::<i16>(WeightForm::Wide, WeightForm::Wide)));
    assert!(readme.contains(&format!("{image} bytes")), "README: {image} bytes of an image");
    let packed = image_length(&shapes::<i16>(WeightForm::Packed, WeightForm::Packed));
    assert!(readme.contains(&format!("{packed} bytes")), "README: {packed} bytes of a packed image");
    assert_eq!(<Network<'_, i16, 8> as inference::chain::Chain<'_, i16, 8>>::WINDOW, inference::WINDOW);
}

proptest! {
    #[test]
    fn any_bytes_are_refused_or_run(
        mut bytes in proptest::collection::vec(any::<u8>(), 0..400), sealed in any::<bool>(),
    ) {
        let mut image = Copied::new(shipped(BearingMaterial::Babbitt));
        let start = bytes.first().copied().map_or(0, usize::from) * 30 % image.length;
        bytes.truncate(image.length - start);
        put(image.bytes_mut(), start, &bytes);
        if sealed {
            seal(image.bytes_mut());
        }
        if let Ok(model) = Model::<i16>::load(image.bytes()) {
            let mut pair: Pair = Pair::new(model);
            let sample = Sample {
                radial_clearance_nm: 500_000,
                deformation_pm: 30_000_000,
                ..Sample::default()
            };
            for _ in 0..10 {
                prop_assert!(pair.step(&sample).normal_force_mn >= 0);
            }
        }
    }
}
