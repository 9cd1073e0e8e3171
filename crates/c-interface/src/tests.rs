use super::*;
use core::ffi::CStr;
use inference::{BearingMaterial, ContactState, Flags, ImageError, Sample, WINDOW, shipped};
use std::ptr::{null, null_mut};

const HEADER: &str = include_str!("../include/pintle_model.h");

/// Storage as C declares it, with arbitrary content.
fn empty() -> Storage {
    // SAFETY: words of any value are valid.
    unsafe { core::mem::transmute([0xa5_u64; storage::WORDS]) }
}

fn started() -> Storage {
    let mut storage = empty();
    assert_eq!(init(&mut storage, shipped(BearingMaterial::Babbitt)), OK);
    storage
}

fn init(model: &mut Storage, image: &[u8]) -> Status {
    // SAFETY: a storage and a slice; a model that outlives the slice is not used.
    unsafe { pintle_model_init(model, image.as_ptr(), image.len()) }
}

const STATE: CState = CState {
    radial_clearance_m: 0.5e-3,
    deformation_m: 3e-5,
    deformation_rate_m_s: 1e-3,
    approach_speed_m_s: 2e-3,
    sliding_speed_m_s: 0.1,
};
const SAMPLE: CSample = CSample {
    radial_clearance_nm: 400_000,
    deformation_pm: 20_000_000,
    deformation_rate_nm_s: -1000,
    approach_speed_nm_s: 3_000_000,
    sliding_speed_nm_s: -50_000_000,
};

#[test]
fn estimates_are_those_of_the_pair() {
    let mut pair: Pair = Pair::new(Model::load(shipped(BearingMaterial::Babbitt)).unwrap());
    let (mut model, mut found) = (started(), CEstimate::default());
    let state = ContactState {
        radial_clearance_m: 0.5e-3,
        deformation_m: 3e-5,
        deformation_rate_m_s: 1e-3,
        approach_speed_m_s: 2e-3,
        sliding_speed_m_s: 0.1,
    };
    let sample = Sample {
        radial_clearance_nm: 400_000,
        deformation_pm: 20_000_000,
        deformation_rate_nm_s: -1000,
        approach_speed_nm_s: 3_000_000,
        sliding_speed_nm_s: -50_000_000,
    };
    for _ in 0..WINDOW {
        // SAFETY: live objects.
        assert_eq!(unsafe { pintle_model_push(&mut model, &STATE, &mut found) }, OK);
        assert_eq!(found, CEstimate::from_estimate(&pair.push(&state)));
        // SAFETY: live objects.
        assert_eq!(unsafe { pintle_model_step(&mut model, &SAMPLE, &mut found) }, OK);
        assert_eq!(found, CEstimate::from_estimate(&pair.step(&sample)));
    }
    assert!(found.normal_force_n > 100.0 && found.friction_force_n > 0.0, "{found:?}");
    // SAFETY: live objects.
    assert_eq!(unsafe { pintle_model_skip(&mut model, &mut found) }, OK);
    assert_eq!(found.flags, (Flags::MISSING | Flags::WARMING_UP).bits());
    for _ in 0..WINDOW {
        // SAFETY: live objects.
        unsafe { pintle_model_push(&mut model, &STATE, &mut found) };
    }
    assert_eq!(found.flags, 0);
    // SAFETY: live objects.
    unsafe {
        assert_eq!(pintle_model_reset(&mut model), OK);
        pintle_model_push(&mut model, &STATE, &mut found);
    }
    assert_eq!(found.flags, Flags::WARMING_UP.bits());
}

#[test]
fn wrong_pointers_are_refused_and_change_nothing() {
    let (mut model, mut found, mut info) = (started(), CEstimate::default(), CInfo::default());
    // SAFETY (all calls): each pointer is null, misaligned or points to a live object.
    unsafe {
        let odd = (&raw mut model).wrapping_byte_add(4);
        let odd_found = (&raw mut found).wrapping_byte_add(1);
        let state = STATE;
        let odd_state = (&raw const state).wrapping_byte_add(2);
        let image = shipped(BearingMaterial::Babbitt).as_ptr();
        for (status, expected) in [
            (pintle_model_push(null_mut(), &STATE, &mut found), status::NULL),
            (pintle_model_push(&mut model, null(), &mut found), status::NULL),
            (pintle_model_push(&mut model, &STATE, null_mut()), status::NULL),
            (pintle_model_push(odd, &STATE, &mut found), status::ALIGNMENT),
            (pintle_model_push(&mut model, odd_state, &mut found), status::ALIGNMENT),
            (pintle_model_push(&mut model, &STATE, odd_found), status::ALIGNMENT),
            (pintle_model_step(&mut model, null(), &mut found), status::NULL),
            (pintle_model_step(&mut model, &SAMPLE, odd_found), status::ALIGNMENT),
            (pintle_model_skip(&mut model, null_mut()), status::NULL),
            (pintle_model_skip(null_mut(), &mut found), status::NULL),
            (pintle_model_reset(null_mut()), status::NULL),
            (pintle_model_reset(odd), status::ALIGNMENT),
            (pintle_model_info(&mut model, null_mut()), status::NULL),
            (pintle_model_info(null_mut(), &mut info), status::NULL),
            (pintle_model_init(null_mut(), image, 8380), status::NULL),
            (pintle_model_init(odd, image, 8380), status::ALIGNMENT),
            (pintle_image_check(null(), 0), status::NULL),
            (pintle_image_check(image, usize::MAX), status::IMAGE_LENGTH),
        ] {
            assert_eq!(status, expected);
        }
        assert_eq!((found, info), (CEstimate::default(), CInfo::default()));
        // A refused skip would have restarted the history, a refused push have filled it.
        for count in 1..=WINDOW {
            pintle_model_push(&mut model, null(), &mut found);
            pintle_model_push(&mut model, &STATE, &mut found);
            assert_eq!(found.flags == 0, count == WINDOW, "{count}");
        }
    }
}

#[test]
fn a_storage_without_a_model_is_refused() {
    let mut found = CEstimate::default();
    let mut refused = started();
    let image = shipped(BearingMaterial::Plastic);
    assert_eq!(init(&mut refused, &image[..100]), status::IMAGE_LENGTH);
    for mut model in [empty(), refused] {
        // SAFETY: live objects.
        unsafe {
            assert_eq!(pintle_model_push(&mut model, &STATE, &mut found), status::NOT_LOADED);
            assert_eq!(pintle_model_info(&mut model, &mut CInfo::default()), status::NOT_LOADED);
            assert_eq!(pintle_model_reset(&mut model), status::NOT_LOADED);
        }
    }
}

#[test]
fn every_corrupted_image_is_refused() {
    let intact = shipped(BearingMaterial::Babbitt);
    let mut words = vec![0_u64; intact.len().div_ceil(8) + 1];
    // SAFETY: the words' bytes.
    let bytes = unsafe { words.align_to_mut::<u8>().1 };
    let (image, _) = bytes.split_at_mut(intact.len());
    image.copy_from_slice(intact);
    // SAFETY (all calls): slices.
    let check = |image: &[u8]| unsafe { pintle_image_check(image.as_ptr(), image.len()) };
    assert_eq!(check(image), OK);
    for byte in 0..image.len() {
        image[byte] ^= 1 << (byte % 8);
        let found = check(image);
        assert!((status::IMAGE..status::IMAGE + 12).contains(&found), "byte {byte}: {found}");
        image[byte] ^= 1 << (byte % 8);
    }
    for length in 0..image.len() {
        assert_ne!(check(&image[..length]), OK, "{length}");
    }
    bytes.copy_within(..intact.len(), 1);
    assert_eq!(check(&bytes[1..=intact.len()]), status::of_image(&ImageError::Alignment));
}

#[test]
fn the_info_is_that_of_the_image() {
    let (mut model, mut info) = (started(), CInfo::default());
    // SAFETY: live objects.
    assert_eq!(unsafe { pintle_model_info(&mut model, &mut info) }, OK);
    let crc = shipped(BearingMaterial::Babbitt).last_chunk::<4>().copied().unwrap();
    assert_eq!((info.checksum, info.bearing), (u32::from_le_bytes(crc), 0));
    assert!(info.radial_clearance_low_m > 0.0 && info.radial_clearance_low_m < info.radial_clearance_high_m);
}

/// Value of a macro of the header.
fn value(text: &str) -> u32 {
    let text = text.trim_matches(['(', ')']);
    if let Some(shift) = text.strip_prefix("1u << ") {
        return 1 << shift.parse::<u32>().unwrap();
    }
    match text.strip_prefix("0x") {
        Some(digits) => u32::from_str_radix(digits.trim_end_matches('u'), 16).unwrap(),
        None => text.parse().unwrap(),
    }
}

#[test]
fn the_macros_of_the_header_have_the_values_of_the_library() {
    let image = |error: &ImageError| status::of_image(error).cast_unsigned();
    let layer = inference::image::LayerName { network: "", index: 0 };
    let expected = [
        ("PINTLE_INTERFACE_VERSION", pintle_interface_version()),
        ("PINTLE_WINDOW", WINDOW as u32),
        ("PINTLE_IMAGE_ALIGNMENT", 4),
        ("PINTLE_OK", OK.cast_unsigned()),
        ("PINTLE_ERROR_NULL", status::NULL.cast_unsigned()),
        ("PINTLE_ERROR_ALIGNMENT", status::ALIGNMENT.cast_unsigned()),
        ("PINTLE_ERROR_NOT_LOADED", status::NOT_LOADED.cast_unsigned()),
        ("PINTLE_ERROR_IMAGE_LENGTH", image(&ImageError::Length { found: 0, expected: 0 })),
        ("PINTLE_ERROR_IMAGE_MAGIC", image(&ImageError::Magic)),
        ("PINTLE_ERROR_IMAGE_VERSION", image(&ImageError::Version { found: 0, expected: 0 })),
        ("PINTLE_ERROR_IMAGE_TOO_SHORT", image(&ImageError::TooShort)),
        ("PINTLE_ERROR_IMAGE_CRC", image(&ImageError::Crc { found: 0, expected: 0 })),
        ("PINTLE_ERROR_IMAGE_BEARING", image(&ImageError::Bearing { found: 0 })),
        ("PINTLE_ERROR_IMAGE_FIELD", image(&ImageError::Field { name: "", found: 0, expected: [0; 2] })),
        ("PINTLE_ERROR_IMAGE_OVERFLOW", image(&ImageError::Overflow { layer, output: 0, largest: 0 })),
        ("PINTLE_ERROR_IMAGE_SCALE", image(&ImageError::Scale { layer })),
        ("PINTLE_ERROR_IMAGE_ALIGNMENT", image(&ImageError::Alignment)),
        ("PINTLE_ERROR_IMAGE_TRAILING", image(&ImageError::Trailing)),
        ("PINTLE_ERROR_IMAGE_SHAPE", 22),
        ("PINTLE_FLAG_OUTSIDE_CLEARANCE", Flags::OUTSIDE_CLEARANCE.bits()),
        ("PINTLE_FLAG_OUTSIDE_DEFORMATION", Flags::OUTSIDE_DEFORMATION.bits()),
        ("PINTLE_FLAG_OUTSIDE_RATE_RATIO", Flags::OUTSIDE_RATE_RATIO.bits()),
        ("PINTLE_FLAG_OUTSIDE_SLIDING_SPEED", Flags::OUTSIDE_SLIDING_SPEED.bits()),
        ("PINTLE_FLAG_OUTSIDE_FORCE", Flags::OUTSIDE_FORCE.bits()),
        ("PINTLE_FLAG_SATURATED", Flags::SATURATED.bits()),
        ("PINTLE_FLAG_NON_FINITE", Flags::NON_FINITE.bits()),
        ("PINTLE_FLAG_WARMING_UP", Flags::WARMING_UP.bits()),
        ("PINTLE_FLAG_MISSING", Flags::MISSING.bits()),
        ("PINTLE_FLAG_CORRUPTED", Flags::CORRUPTED.bits()),
        ("PINTLE_FLAG_IMPLAUSIBLE_FRICTION", Flags::IMPLAUSIBLE_FRICTION.bits()),
        ("PINTLE_FLAG_OUTSIDE_TRAINING", Flags::OUTSIDE_TRAINING.bits()),
    ];
    let [small, large] = storage::WORDS_BY_POINTER.map(|words| 8 * words);
    assert!(HEADER.contains(&format!(
        "#if UINTPTR_MAX > 0xffffffffu\n#define PINTLE_MODEL_SIZE {large}\n#else\n#define PINTLE_MODEL_SIZE \
         {small}\n#endif"
    )));
    // `cargo xtask c-library --check` measures the stack.
    let mut found: Vec<(&str, u32)> = HEADER
        .lines()
        .filter_map(|line| line.strip_prefix("#define ")?.split_once(' '))
        .filter(|(name, _)| !["PINTLE_MODEL_SIZE", "PINTLE_MODEL_STACK"].contains(name))
        .map(|(name, text)| (name, value(text)))
        .collect();
    let mut expected = expected.to_vec();
    (found.sort_unstable(), expected.sort_unstable());
    assert_eq!(found, expected);
}

#[test]
fn every_status_has_its_own_text() {
    // SAFETY: the texts are constants that end with 0.
    let text = |status| unsafe { CStr::from_ptr(pintle_status_text(status)) }.to_str().unwrap();
    let mut texts: Vec<&str> = (0..4).chain(16..28).map(text).collect();
    assert!(texts.iter().all(|text| *text != "not a status"));
    assert_eq!(text(status::of_image(&ImageError::Magic)), texts[5]);
    assert!(texts[8].contains("checksum"), "{}", texts[8]);
    texts.sort_unstable();
    texts.dedup();
    assert_eq!(texts.len(), 16);
    for status in [-1, 4, 15, 28, i32::MIN, i32::MAX] {
        assert_eq!(text(status), "not a status");
    }
}
