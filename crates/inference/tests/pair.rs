//! The networks of the shipped images in series: flags, history, gaps, bearings.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::image::write::seal;
use inference::image::{CRC_LENGTH, HEADER_LENGTH, LayerShape, SHAPE_LENGTH};
use inference::kernel::Portable;
use inference::model::{CHANNELS, HEAD_COLUMNS};
use inference::{BearingMaterial, ContactState, Estimate, Flags, Model, Pair, Sample, WINDOW, shipped};
use proptest::prelude::*;

fn model(bearing: BearingMaterial) -> Model<'static> {
    Model::load(shipped(bearing)).expect("shipped image")
}

/// Returns a sample of a press and release with sliding in both directions.
fn sample(step: usize) -> Sample {
    let phase = step as f64 * 0.3;
    Sample {
        radial_clearance_nm: 500_000,
        deformation_pm: (4e7 * phase.sin()) as i32,
        deformation_rate_nm_s: (1e6 * phase.cos()) as i32,
        approach_speed_nm_s: 1_000_000,
        sliding_speed_nm_s: (1e8 * (0.37 * phase).cos()) as i32,
    }
}

fn run(pair: &mut Pair<'_>, steps: core::ops::Range<usize>) -> Vec<Estimate> {
    steps.map(|step| pair.step(&sample(step))).collect()
}

prop_compose! {
    fn any_sample()(
        radial_clearance_nm in any::<u32>(),
        deformation_pm in prop_oneof![any::<i32>(), -1_000_000..300_000_000i32],
        deformation_rate_nm_s in prop_oneof![any::<i32>(), -5_000_000..5_000_000i32],
        approach_speed_nm_s in any::<u32>(),
        sliding_speed_nm_s in any::<i32>(),
    ) -> Sample {
        Sample {
            radial_clearance_nm,
            deformation_pm,
            deformation_rate_nm_s,
            approach_speed_nm_s,
            sliding_speed_nm_s,
        }
    }
}

proptest! {
    #[test]
    fn any_samples_give_valid_estimates_equal_on_both_engines(
        samples in proptest::collection::vec(any_sample(), 1..20),
    ) {
        for bearing in BearingMaterial::ALL {
            let mut native: Pair = Pair::new(model(bearing));
            let mut portable: Pair<'_, i16, Portable> = Pair::new(model(bearing));
            for sample in &samples {
                let estimate = native.step(sample);
                prop_assert_eq!(estimate, portable.step(sample));
                prop_assert!(estimate.normal_force_mn >= 0);
                prop_assert!(estimate.friction_force_mn.signum() * sample.sliding_speed_nm_s.signum() <= 0);
                if sample.deformation_pm <= 0 {
                    prop_assert_eq!((estimate.normal_force_mn, estimate.friction_force_mn), (0, 0));
                }
            }
        }
    }

    #[test]
    fn any_numbers_give_valid_estimates(
        clearance in any::<f32>(), deformation in any::<f32>(), rate in any::<f32>(),
        approach in any::<f32>(), sliding in any::<f32>(),
    ) {
        let state = ContactState {
            radial_clearance_m: clearance,
            deformation_m: deformation,
            deformation_rate_m_s: rate,
            approach_speed_m_s: approach,
            sliding_speed_m_s: sliding,
        };
        let mut pair: Pair = Pair::new(model(BearingMaterial::Babbitt));
        let estimate = pair.push(&state);
        prop_assert!(estimate.normal_force_n() >= 0.0);
        prop_assert_eq!(estimate.flags.contains(Flags::NON_FINITE), !state.is_finite());
        if deformation.is_nan() || deformation <= 0.0 {
            prop_assert_eq!((estimate.normal_force_mn, estimate.friction_force_mn), (0, 0));
        }
    }
}

#[test]
fn reset_clears_the_history_and_flags_the_start() {
    let mut pair: Pair = Pair::new(model(BearingMaterial::Babbitt));
    let first = run(&mut pair, 0..20);
    let warm = run(&mut pair, 0..20);
    assert_ne!(first, warm, "the history matters");
    pair.reset();
    assert_eq!(run(&mut pair, 0..20), first);
    for (index, estimate) in first.iter().enumerate() {
        assert_eq!(estimate.flags.contains(Flags::WARMING_UP), index + 1 < WINDOW, "sample {index}");
    }
}

/// Permutes the weights of the friction network's convolutions within each row.
fn reorder_friction(image: &mut [u8], by: usize) {
    let mut at = HEADER_LENGTH;
    for layer in 0.. {
        let Some(shape) = image[at..].first_chunk().and_then(LayerShape::from_bytes) else { break };
        let end = at + shape.length();
        // Four layers per network. In a convolution a block of four outputs has biases before its
        // weights and multipliers after them.
        if (4..7).contains(&layer) {
            let blocks = image[at + SHAPE_LENGTH..end].chunks_exact_mut(16 * (shape.groups() + 2));
            for block in blocks {
                block[16..16 * (shape.groups() + 1)].rotate_right(4 * by % (16 * shape.groups()));
            }
        }
        at = end;
    }
    seal(image);
}

/// Collision estimates are independent of the start after one window, friction estimates after two,
/// as `WARMING_UP` documents. The trained networks hardly depend on forces that old; with permuted
/// weights they do.
#[test]
fn estimates_are_independent_of_the_start_when_the_flag_ends() {
    // In contact from the first sample, so that the first estimates affect the later ones.
    let press = |mut pair: Pair<'_>| -> Vec<Estimate> {
        (0..20)
            .map(|step| pair.step(&Sample { deformation_pm: 20_000_000 + 1_000_000 * step, ..sample(3) }))
            .collect()
    };
    let mut longest = 0;
    for (bearing, order) in
        BearingMaterial::ALL.into_iter().flat_map(|bearing| (0..20).map(move |by| (bearing, by)))
    {
        let mut words = vec![0u32; shipped(bearing).len() / 4];
        let image: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
        image.copy_from_slice(shipped(bearing));
        reorder_friction(image, order);
        let model = Model::load(image).expect("reordered image");
        let fresh = press(Pair::new(model));
        let mut warm: Pair = Pair::new(model);
        run(&mut warm, 0..4);
        let warm = press(warm);
        let last = |differ: fn(&Estimate, &Estimate) -> bool| {
            fresh.iter().zip(&warm).rposition(|(a, b)| differ(a, b)).map_or(0, |last| last + 1)
        };
        assert!(last(|a, b| a.normal_force_mn != b.normal_force_mn) < WINDOW, "{order}");
        let friction = last(|a, b| a.friction_force_mn != b.friction_force_mn);
        assert!(friction < 2 * WINDOW - 1, "{order}: {friction}");
        longest = longest.max(friction);
    }
    assert!(longest >= WINDOW, "{longest}");
}

#[test]
fn speeds_beyond_the_range_of_a_sample_are_flagged() {
    let slow = ContactState {
        radial_clearance_m: 0.5e-3,
        deformation_m: 2e-5,
        deformation_rate_m_s: 1.0,
        approach_speed_m_s: 1.0,
        sliding_speed_m_s: 0.0,
    };
    let flags =
        |state: ContactState| Pair::<'_, i16>::new(model(BearingMaterial::Babbitt)).push(&state).flags;
    assert!(!flags(slow).intersects(Flags::OUTSIDE_TRAINING));
    // The ratios are -50 (outside) and 0.01, but would be -1 and 0.25 after saturation of the
    // integers.
    for (rate, approach) in [(-100.0, 2.0), (-100.0, 4.2), (1.0, 100.0)] {
        let state = ContactState { deformation_rate_m_s: rate, approach_speed_m_s: approach, ..slow };
        assert!(flags(state).contains(Flags::OUTSIDE_RATE_RATIO), "{state:?}");
        assert!(!flags(ContactState { deformation_m: -1e-5, ..state }).intersects(Flags::OUTSIDE_TRAINING));
    }
}

#[test]
fn a_bad_or_missing_sample_gives_zero_is_flagged_and_restarts_the_history() {
    let mut pair: Pair = Pair::new(model(BearingMaterial::Babbitt));
    let fresh = run(&mut pair, 0..12);
    let bad = pair.push(&ContactState { deformation_m: f32::NAN, ..ContactState::default() });
    assert!(bad.flags.contains(Flags::NON_FINITE | Flags::WARMING_UP));
    assert_eq!(run(&mut pair, 0..12), fresh);
    let missing = pair.skip();
    assert!(missing.flags.contains(Flags::MISSING | Flags::WARMING_UP));
    assert!(!missing.flags.contains(Flags::NON_FINITE));
    assert_eq!(run(&mut pair, 0..12), fresh);
    assert_eq!((bad.normal_force_mn, missing.normal_force_mn), (0, 0));
}

#[test]
fn bearings_switch_between_two_samples() {
    let mut pair: Pair = Pair::new(model(BearingMaterial::Babbitt));
    let babbitt = run(&mut pair, 0..30);
    pair.switch(model(BearingMaterial::Plastic));
    let switched = run(&mut pair, 30..60);
    let mut plastic: Pair = Pair::new(model(BearingMaterial::Plastic));
    assert_eq!(run(&mut plastic, 30..60), switched);
    assert!(switched[0].flags.contains(Flags::WARMING_UP));
    pair.switch(model(BearingMaterial::Babbitt));
    assert_eq!(run(&mut pair, 0..30), babbitt);
    assert_eq!(pair.model().header().bearing, BearingMaterial::Babbitt);
}

#[test]
fn each_input_outside_the_training_range_has_its_flag() {
    let model = model(BearingMaterial::Plastic);
    let header = model.header();
    let inside = Sample {
        radial_clearance_nm: 500_000,
        deformation_pm: 100_000_000,
        deformation_rate_nm_s: 100_000,
        approach_speed_nm_s: 0,
        sliding_speed_nm_s: -100_000_000,
    };
    let flags = |sample: Sample| {
        let mut pair: Pair = Pair::new(model);
        (0..WINDOW).map(|_| pair.step(&sample).flags).last().unwrap_or_default()
    };
    assert!(!flags(inside).intersects(Flags::OUTSIDE_TRAINING));
    let floor = i64::from(header.latch_floor_nm_s);
    let rate = ((floor * i64::from(header.rate_ratio_high_q16)) >> 16) as i32;
    let (deformation, speed) = (header.deformation_high_pm as i32, header.sliding_speed_high_nm_s as i32);
    for (sample, flag) in [
        (Sample { radial_clearance_nm: header.clearance_high_nm + 1, ..inside }, Flags::OUTSIDE_CLEARANCE),
        (Sample { radial_clearance_nm: header.clearance_low_nm - 1, ..inside }, Flags::OUTSIDE_CLEARANCE),
        (Sample { radial_clearance_nm: 0, ..inside }, Flags::OUTSIDE_CLEARANCE),
        (Sample { deformation_pm: deformation + 1, ..inside }, Flags::OUTSIDE_DEFORMATION),
        (Sample { deformation_rate_nm_s: rate + 1, ..inside }, Flags::OUTSIDE_RATE_RATIO),
        (Sample { deformation_rate_nm_s: -rate - 1, ..inside }, Flags::OUTSIDE_RATE_RATIO),
        (Sample { sliding_speed_nm_s: speed + 1, ..inside }, Flags::OUTSIDE_SLIDING_SPEED),
        (Sample { sliding_speed_nm_s: -speed - 1, ..inside }, Flags::OUTSIDE_SLIDING_SPEED),
        (Sample { deformation_pm: i32::MAX, ..inside }, Flags::OUTSIDE_FORCE | Flags::OUTSIDE_DEFORMATION),
    ] {
        assert!(flags(sample).contains(flag), "{sample:?} has {:?}", flags(sample));
    }
    for sample in [
        Sample { deformation_pm: deformation, ..inside },
        Sample { deformation_rate_nm_s: rate, ..inside },
        Sample { sliding_speed_nm_s: speed, ..inside },
        // A gap has no rate ratio: its force is 0 whatever the rate.
        Sample { deformation_pm: -1, deformation_rate_nm_s: i32::MAX, ..inside },
    ] {
        assert!(!flags(sample).intersects(Flags::OUTSIDE_TRAINING), "{sample:?} has {:?}", flags(sample));
    }
}

#[test]
fn a_coefficient_of_one_is_flagged_as_implausible() {
    let coefficient_times = |power: u32| {
        let mut words = vec![0u32; shipped(BearingMaterial::Babbitt).len() / 4];
        let image: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
        image.copy_from_slice(shipped(BearingMaterial::Babbitt));
        // The friction network's head is the last layer: scale, one bias, groups of two weights.
        let groups = HEAD_COLUMNS * CHANNELS / 2;
        let at = image.len() - CRC_LENGTH - 4 * (groups + 2);
        let shift = &mut image[at..][..4];
        let found = u32::from_le_bytes(shift.try_into().expect("four bytes"));
        shift.copy_from_slice(&(found - power).to_le_bytes());
        seal(image);
        let mut pair: Pair = Pair::new(Model::load(image).expect("changed image"));
        (0..2 * WINDOW as i32).map(|_| pair.step(&sample(3))).last().expect("estimates")
    };
    let sound = coefficient_times(0);
    let share = f64::from(sound.friction_force_mn.abs()) / f64::from(sound.normal_force_mn);
    assert!(share > 0.0 && !sound.flags.contains(Flags::IMPLAUSIBLE_FRICTION), "{share}");
    let needed = (1.0 / share).log2().ceil() as u32;
    assert!(!coefficient_times(needed - 1).flags.contains(Flags::IMPLAUSIBLE_FRICTION));
    assert!(coefficient_times(needed).flags.contains(Flags::IMPLAUSIBLE_FRICTION));
}

#[test]
fn a_single_clipped_activation_is_counted_and_flagged() {
    let mut words = vec![0u32; shipped(BearingMaterial::Babbitt).len() / 4];
    let image: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
    image.copy_from_slice(shipped(BearingMaterial::Babbitt));
    // The first multiplier follows the layer's shape, four biases and four times 12 groups of
    // weights; it gives the first output the largest factor.
    let at = HEADER_LENGTH + SHAPE_LENGTH + 13 * 16;
    image[at..at + 4].copy_from_slice(&i32::MAX.to_le_bytes());
    seal(image);
    let mut pair: Pair = Pair::new(Model::load(image).expect("changed image"));
    let estimates: Vec<Estimate> = (0..60).map(|step| pair.step(&sample(step))).collect();
    for estimate in &estimates {
        assert_eq!(estimate.flags.contains(Flags::SATURATED), estimate.saturated > 0, "{estimate:?}");
    }
    assert!(
        estimates.iter().any(|estimate| estimate.saturated == 1),
        "one output at most is clipped in the first layer"
    );
}
