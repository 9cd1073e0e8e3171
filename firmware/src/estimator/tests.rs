//! What one tick carries over to the next is summed up: one that is another at the next tick is flagged, and not gone on with.

use crate::estimator::{Estimator, flags_of};
use inference::{Bearing, Flags, shipped};
use link::{Configuration, EstimateFrame, SensorFrame};

/// A journal in lasting contact that swings by 2 um at 5 Hz along z: slowly enough for observer and window to agree.
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
    let configuration = Configuration {
        bearing: Bearing::Babbitt.code(),
        radial_clearance_nm: 500_000,
        journal_radius_nm: 69_500_000,
        sample_period_us: 100,
        latch_floor_um_s: 1_000,
        unseen_approach_um_s: 3_000,
    };
    Estimator::new(shipped(Bearing::Babbitt), configuration).unwrap()
}

fn run(altered_at: u32) -> Vec<EstimateFrame> {
    let mut estimator = estimator();
    let step = |index| {
        estimator.carried = estimator.carried.spoilt(index == altered_at);
        estimator.step(&frame(index))
    };
    (0..1_500).map(step).collect()
}

#[test]
fn a_gap_in_the_samples_alters_nothing() {
    let gap = |index: u32| frame(if index < 1_000 { index } else { index + 5 });
    let mut estimator = estimator();
    let told = (0..1_200).any(|index| flags_of(&estimator.step(&gap(index))).contains(Flags::ALTERED));
    assert!(!told);
}

#[test]
fn what_was_altered_between_two_ticks_is_flagged_once_and_begun_anew() {
    let (sound, altered) = (run(u32::MAX), run(1_000));
    let flagged = |estimates: &[EstimateFrame]| -> Vec<u32> {
        let marked = estimates.iter().filter(|estimate| flags_of(estimate).contains(Flags::ALTERED));
        marked.map(|estimate| estimate.sequence).collect()
    };
    assert_eq!(flagged(&sound), []);
    assert_eq!(flagged(&altered), [1_000]);
    assert_eq!(sound[..1_000], altered[..1_000]);
    // The window is in charge at once: off by what the observer makes of the swing, and by nothing once that is back.
    let off = |from: usize| {
        let pairs = sound.iter().zip(&altered).skip(from);
        pairs.fold(0.0, |most, (a, b)| f32::max(most, (a.normal_force_n - b.normal_force_n).abs()))
    };
    let full_scale = sound.iter().fold(0.0, |most, estimate| f32::max(most, estimate.normal_force_n));
    assert!(off(1_000) < 0.05 * full_scale, "{} of {full_scale} N", off(1_000));
    assert!(off(1_450) < 0.002 * full_scale, "{} of {full_scale} N", off(1_450));
}
