//! A state that is corrupted between two ticks is flagged and restarted.

use crate::estimator::latch::LatchState;
use crate::estimator::observer::Radial;
use crate::estimator::{Estimator, flags_of};
use crate::flags::ONSET_NOT_SEEN;
use inference::image::write::seal;
use inference::{BearingMaterial, Flags, Model, shipped};
use link::{BenchConfiguration, EstimateFrame, SensorFrame};

/// A journal in sustained contact that swings by 2 um at 5 Hz along z: slow enough for observer and
/// window to agree.
fn frame(index: u32) -> SensorFrame {
    let swing = (f64::from(index) * 0.0005 * core::f64::consts::TAU).sin();
    SensorFrame {
        sequence: index,
        time_us: 100 * index,
        journal_y_nm: 3_000,
        journal_z_nm: -530_000 - (2_000.0 * swing) as i32,
        shaft_angle_nrad: 30_000 * index.cast_signed(),
        load_force_mn: 0,
    }
}

fn estimator() -> Estimator {
    let configuration = BenchConfiguration {
        bearing: BearingMaterial::Babbitt.code(),
        radial_clearance_nm: 500_000,
        journal_radius_nm: 69_500_000,
        sample_period_us: 100,
        latch_floor_um_s: 1_000,
        unseen_approach_um_s: 3_000,
    };
    Estimator::new(shipped(BearingMaterial::Babbitt), configuration).unwrap()
}

fn run(corrupted_at: u32, corrupt: fn(&mut Estimator)) -> Vec<EstimateFrame> {
    let mut estimator = estimator();
    let step = |index| {
        if index == corrupted_at {
            corrupt(&mut estimator);
        }
        estimator.step(&frame(index))
    };
    (0..1_500).map(step).collect()
}

fn flagged(estimates: &[EstimateFrame]) -> Vec<u32> {
    let marked = estimates.iter().filter(|estimate| flags_of(estimate).contains(Flags::CORRUPTED));
    marked.map(|estimate| estimate.sequence).collect()
}

#[test]
fn a_gap_in_the_samples_is_not_flagged_as_corruption() {
    let gap = |index: u32| frame(if index < 1_000 { index } else { index + 5 });
    let mut estimator = estimator();
    let estimates: Vec<_> = (0..1_200).map(|index| estimator.step(&gap(index))).collect();
    assert!(flagged(&estimates).is_empty());
}

#[test]
fn a_state_corrupted_between_two_ticks_is_flagged_once_and_restarted() {
    let intact = run(u32::MAX, |_| {});
    let corrupted = run(1_000, |estimator| {
        estimator.conditioner.value_mut().observer = estimator.config.observer.start()
    });
    assert!(flagged(&intact).is_empty());
    assert_eq!(flagged(&corrupted), [1_000]);
    assert_eq!(intact[..1_000], corrupted[..1_000]);
    // The window replaces the observer at once: the difference is what the observer adds to the
    // swing, and 0 once it has settled.
    let error = |from: usize| {
        let pairs = intact.iter().zip(&corrupted).skip(from);
        pairs.fold(0.0, |max, (a, b)| f32::max(max, (a.normal_force_n - b.normal_force_n).abs()))
    };
    let full_scale = intact.iter().fold(0.0, |max, estimate| f32::max(max, estimate.normal_force_n));
    assert!(error(1_000) < 0.05 * full_scale, "{} of {full_scale} N", error(1_000));
    assert!(error(1_450) < 0.002 * full_scale, "{} of {full_scale} N", error(1_450));
}

#[test]
fn a_latch_corrupted_between_two_ticks_is_flagged_once_and_its_onset_counts_as_unseen() {
    for bit in [0, 40, LatchState::BITS - 1] {
        let mut estimator = estimator();
        let step = |index| {
            if index == 1_000 {
                estimator.latch.value_mut().flip(bit);
            }
            estimator.step(&frame(index))
        };
        let estimates: Vec<_> = (0..1_100).map(step).collect();
        assert_eq!(flagged(&estimates), [1_000], "bit {bit}");
        assert!(flags_of(&estimates[1_000]).contains(ONSET_NOT_SEEN), "bit {bit}");
    }
}

#[test]
fn every_bit_of_the_latch_that_flips_before_its_update_is_detected() {
    let contact = |deformation| Radial { deformation, rate_nm_s: 50_000_000 };
    let mut intact = estimator();
    intact.update_latch(contact(-1), true);
    assert_eq!(intact.update_latch(contact(1), true), (50_000_000, true, false));
    for bit in 0..LatchState::BITS {
        let mut flipped = intact.clone();
        flipped.latch.value_mut().flip(bit);
        assert_eq!(flipped.update_latch(contact(1), true), (3_000_000, false, true), "bit {bit}");
        assert_eq!(flipped.update_latch(contact(1), true), (3_000_000, false, false), "bit {bit}");
    }
}

#[test]
fn a_latch_that_restarts_with_the_samples_is_not_flagged() {
    let mut estimator = estimator();
    estimator.restart();
    assert!(!estimator.latch.is_corrupted());
}

#[test]
fn the_prediction_takes_the_floor_of_another_model() {
    // Position of the floor in the header.
    const FLOOR: core::ops::Range<usize> = 48..52;
    let mut image = shipped(BearingMaterial::Babbitt).to_vec();
    let floor = u32::from_le_bytes(image[FLOOR].try_into().unwrap());
    image[FLOOR].copy_from_slice(&(2 * floor).to_le_bytes());
    seal(&mut image);
    let words: Vec<u64> = image
        .chunks(8)
        .map(|bytes| {
            let mut word = [0; 8];
            word[..bytes.len()].copy_from_slice(bytes);
            u64::from_ne_bytes(word)
        })
        .collect();
    let aligned: &'static [u64] = words.leak();
    let model = Model::load(&bytemuck::cast_slice(aligned)[..image.len()]).unwrap();
    let mut estimator = estimator();
    assert_eq!(estimator.config.setup.image_floor_nm_s, floor);
    estimator.switch(model);
    assert_eq!(estimator.config.setup.image_floor_nm_s, 2 * floor);
}
