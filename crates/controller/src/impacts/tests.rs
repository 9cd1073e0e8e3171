//! Tests of the records of impacts.

use super::*;
use proptest::prelude::*;

/// Sample period, us.
const PERIOD_US: u32 = 100;

fn estimate(index: u32, force_n: f32, deformation_m: f32) -> EstimateFrame {
    EstimateFrame {
        sequence: index,
        time_us: index.wrapping_mul(PERIOD_US),
        normal_force_n: force_n,
        normal_force_sd_n: 10.0,
        deformation_m,
        ..EstimateFrame::default()
    }
}

fn record_of(found: Option<Found>) -> Option<ImpactRecord> {
    match found? {
        Found::Impact(record) => Some(record),
        Found::Corruption => None,
    }
}

/// Steps a tracker through forces; a force of 0 is a gap of 2 um, the stiffness 1 N/nm.
fn records(forces: &[f32]) -> (ImpactTracker, Vec<ImpactRecord>) {
    let mut tracker = ImpactTracker::default();
    let records = forces.iter().zip(0_u32..).filter_map(|(&force_n, index)| {
        let deformation_m = if force_n > 0.0 { force_n * 1e-9 } else { -2e-6 };
        let rate_m_s = match (force_n > 0.0, index < 3) {
            (true, _) => 0.0,
            (false, true) => 0.02,
            (false, false) => -0.01,
        };
        record_of(tracker.step(&estimate(index, force_n, deformation_m), rate_m_s))
    });
    let records = records.collect();
    (tracker, records)
}

#[test]
fn a_contact_between_two_separations_is_an_impact() {
    let (_, found) = records(&[0.0, 0.0, 1_000.0, 3_000.0, 2_000.0, 0.0, 0.0]);
    let [record] = found[..] else { panic!("{found:?}") };
    assert_eq!((record.onset_sequence, record.end), (2, ImpactEnd::Separation));
    // From -2 um to 1 um: a third of the period before the sample. From 2 um to -2 um: the middle.
    assert_eq!((record.onset_us, record.duration_us), (167, 283));
    // The parabola through 1, 3 and 2 kN.
    assert!((record.peak_force_n - 3_041.67).abs() < 0.01, "{record:?}");
    assert_eq!((record.peak_us, record.peak_force_sd_n), (316, 10.0));
    assert_eq!((record.approach_speed_m_s, record.separation_speed_m_s), (0.02, 0.01));
    assert_eq!(record.speed_ratio(), Some(0.5));
    // An elastic contact returns its energy.
    assert!(record.energy_lost_j.abs() < 1e-9, "{record:?}");
}

#[test]
fn a_contact_at_the_start_or_below_three_deviations_is_no_impact() {
    assert!(records(&[3_000.0, 2_000.0, 0.0, 0.0, 29.0, 0.0]).1.is_empty());
    assert_eq!(records(&[0.0, 31.0, 0.0]).1.len(), 1);
}

#[test]
fn a_contact_that_lasts_ends_as_settled_and_the_next_impact_needs_a_separation() {
    let lasting = vec![400.0; 2 * (SETTLED_US / PERIOD_US) as usize];
    let forces = [&[0.0, 400.0, 500.0][..], &lasting, &[0.0, 700.0, 0.0]].concat();
    let (_, found) = records(&forces);
    let ends: Vec<_> = found.iter().map(|record| (record.end, record.peak_force_n)).collect();
    assert_eq!(ends, [(ImpactEnd::Settled, 500.0), (ImpactEnd::Separation, 700.0)]);
    assert!((SETTLED_US..SETTLED_US + PERIOD_US).contains(&found[0].duration_us), "{found:?}");
    assert_eq!(found[0].speed_ratio(), None);
}

#[test]
fn an_untrusted_estimate_ends_the_record_and_so_does_the_run() {
    for flag in [HELD, TRIPPED, NOT_STARTED, TIME_FAULT, IMPLAUSIBLE_POSITION] {
        let (mut tracker, found) = records(&[0.0, 500.0, 600.0]);
        assert!(found.is_empty());
        let mut held = estimate(3, 600.0, 6e-7);
        held.flags = flag.bits();
        let record = record_of(tracker.step(&held, 0.0)).unwrap();
        assert_eq!((record.end, record.flags), (ImpactEnd::Interrupted, flag.bits()));
        assert!(tracker.step(&estimate(4, 900.0, 9e-7), 0.0).is_none());
        assert!(tracker.step(&estimate(5, 0.0, -1e-6), 0.0).is_none(), "not seen to begin");
    }
    let (mut tracker, _) = records(&[0.0, 500.0, 600.0]);
    assert_eq!(record_of(tracker.finish()).map(|record| record.end), Some(ImpactEnd::Interrupted));
    assert_eq!(tracker.finish(), None);
}

#[test]
fn a_force_that_no_bearing_has_does_not_raise_the_peak() {
    for impossible in [-4e4, f32::NEG_INFINITY, f32::NAN] {
        let mut tracker = ImpactTracker::default();
        let forces = [(0.0, -1e-6), (impossible, 1e-6), (600.0, 1e-6), (500.0, 1e-6), (0.0, -1e-6)];
        let found = forces.into_iter().zip(0..);
        let found =
            found.filter_map(|((force, depth), i)| record_of(tracker.step(&estimate(i, force, depth), 0.0)));
        let peaks: Vec<f32> = found.map(|record| record.peak_force_n).collect();
        assert!(peaks.len() == 1 && (600.0..=675.0).contains(&peaks[0]), "{peaks:?}");
    }
}

#[test]
fn the_flags_of_a_contact_are_combined() {
    let mut tracker = ImpactTracker::default();
    tracker.step(&EstimateFrame { flags: 8, ..estimate(0, 0.0, -1e-6) }, 0.01);
    tracker.step(&EstimateFrame { flags: 1, ..estimate(1, 500.0, 1e-6) }, 0.0);
    tracker.step(&EstimateFrame { flags: 2, ..estimate(2, 400.0, 1e-6) }, 0.0);
    let record = record_of(tracker.step(&estimate(3, 0.0, -1e-6), -0.01)).unwrap();
    assert_eq!(record.flags, 3);
}

#[test]
fn a_flipped_bit_of_the_state_loses_the_open_impact_and_nothing_else() {
    let (mut tracker, _) = records(&[0.0, 500.0, 600.0]);
    tracker.state.value_mut().contact.peak_us ^= 1 << 30;
    let found = tracker.step(&estimate(3, 500.0, 5e-7), 0.0);
    assert_eq!(found, Some(Found::Corruption));
    let next = [0.0, 800.0, 0.0].into_iter().zip(4..).filter_map(|(force, index)| {
        let deformation_m = if force > 0.0 { 1e-6 } else { -1e-6 };
        let found = tracker.step(&estimate(index, force, deformation_m), 0.0);
        assert_ne!(found, Some(Found::Corruption));
        found
    });
    assert_eq!(next.count(), 1);
}

/// Values of an estimate that a tracker may meet.
fn any_sample() -> impl Strategy<Value = (f32, f32, f32, f32, u32, u32)> {
    let value = prop_oneof![-2e-6_f32..2e-6, any::<f32>(), Just(f32::NAN)];
    let force = prop_oneof![0.0_f32..1e4, any::<f32>(), Just(f32::INFINITY), Just(f32::NAN)];
    let flags = prop_oneof![8 => Just(0_u32), 1 => any::<u32>(), 1 => Just(HELD.bits())];
    (force, 0.0_f32..50.0, value, -1.0_f32..1.0, flags, 50..1_000_u32)
}

proptest! {
    #[test]
    fn every_record_lies_within_its_time_and_the_records_follow_each_other(
        samples in prop::collection::vec(any_sample(), 1..400),
        start_us in any::<u32>(),
    ) {
        let mut tracker = ImpactTracker::default();
        let (mut passed_us, mut last_end_us, mut largest_n) = (0_u32, 0_u32, 0.0_f32);
        let mut check = |found: Option<Found>, passed_us: u32, largest_n: f32| {
            prop_assert_ne!(found, Some(Found::Corruption));
            let Some(record) = record_of(found) else { return Ok(()) };
            let onset_us = record.onset_us.wrapping_sub(start_us);
            prop_assert!(onset_us >= last_end_us.saturating_sub(1), "{record:?} after {last_end_us}");
            last_end_us = onset_us + record.duration_us;
            prop_assert!(last_end_us <= passed_us, "{record:?} ends after {passed_us}");
            let to_peak_us = record.peak_us.wrapping_sub(record.onset_us).cast_signed();
            prop_assert!(to_peak_us >= -1_000 && to_peak_us <= record.duration_us.cast_signed() + 1_000);
            prop_assert!(record.peak_force_n <= 1.125 * largest_n * (1.0 + 1e-6), "{record:?}");
            Ok(())
        };
        for (&(force, sd, deformation, rate, flags, step_us), index) in samples.iter().zip(0_u32..) {
            passed_us += step_us;
            if force > largest_n {
                largest_n = force;
            }
            let estimate = EstimateFrame {
                normal_force_sd_n: sd,
                time_us: start_us.wrapping_add(passed_us),
                flags,
                ..estimate(index, force, deformation)
            };
            check(tracker.step(&estimate, rate), passed_us, largest_n)?;
        }
        check(tracker.finish(), passed_us, largest_n)?;
        prop_assert_eq!(tracker.finish(), None);
    }
}
