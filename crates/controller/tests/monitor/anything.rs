//! With any sensor values the monitor continues, and the tracked quantities stay valid.

use crate::run::{Truth, configuration, follow, monitor};
use controller::Monitor;
use controller::monitor::ranges;
use inference::{BearingMaterial, shipped};
use link::track::{MonitorConfiguration, SafeState, SensorStatus};
use link::{EstimateFrame, SensorFrame};
use proptest::prelude::*;
use std::sync::LazyLock;

/// A cycle without a fault.
static SOUND: LazyLock<Vec<SensorFrame>> =
    LazyLock::new(|| Truth::nominal(BearingMaterial::Babbitt).frames(1, 0).0);

fn code() -> impl Strategy<Value = i32> {
    prop_oneof![
        4 => -700_000..700_000_i32,
        2 => any::<i32>(),
        1 => prop_oneof![Just(i32::MIN), Just(i32::MAX), Just(0), Just(-1)],
    ]
}

fn frame() -> impl Strategy<Value = (SensorFrame, SensorStatus)> {
    (any::<u32>(), any::<u32>(), code(), code(), code(), code(), any::<u8>()).prop_map(
        |(sequence, time_us, journal_y_nm, journal_z_nm, shaft_angle_nrad, load_force_mn, status)| {
            let frame = SensorFrame {
                sequence,
                time_us,
                journal_y_nm,
                journal_z_nm,
                shaft_angle_nrad,
                load_force_mn,
            };
            (frame, SensorStatus(status))
        },
    )
}

fn is_finite(estimate: &EstimateFrame) -> bool {
    let all = [
        estimate.normal_force_n,
        estimate.force_y_n,
        estimate.force_z_n,
        estimate.friction_torque_nm,
        estimate.deformation_m,
        estimate.contact_angle_rad,
    ];
    all.iter().all(|value| value.is_finite())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn a_sound_run_after_any_frames_is_tracked_as_without_them(
        frames in proptest::collection::vec(frame(), 1..600),
        follows_on in any::<bool>(),
    ) {
        let mut monitor = monitor(BearingMaterial::Babbitt, |_| {});
        for ((mut frame, status), index) in frames.into_iter().zip(0_u32..) {
            if follows_on {
                frame.sequence = index;
                frame.time_us = index.wrapping_mul(100);
            }
            let estimate = monitor.step(&frame, status);
            prop_assert!(is_finite(&estimate), "{}: {:?}", index, estimate);
        }
        follow(&mut monitor, &SOUND);
        let report = monitor.report();
        prop_assert_eq!(report.safe_state, SafeState::Live);
        let error_nm = f64::from(report.radial_clearance_nm) - 500_000.0;
        prop_assert!(error_nm.abs() < 3_000.0, "{:?}", report);
    }
}

#[test]
fn the_ends_of_every_field_s_range_are_served() {
    let (bench, monitor) = configuration(BearingMaterial::Plastic);
    let (frames, _) = Truth::nominal(BearingMaterial::Plastic).frames(1, 0);
    let serve = |monitor: &MonitorConfiguration| {
        let mut monitor = Monitor::new(shipped(BearingMaterial::Plastic), &bench, monitor, 100).unwrap();
        for frame in frames.iter().take(1_000) {
            assert!(is_finite(&monitor.step(frame, SensorStatus::GOOD)));
        }
        monitor.report()
    };
    let smallest = MonitorConfiguration {
        mass_g: 1_000,
        inertia_g_m2: 1,
        drive_lever_um: 10_000,
        load_lever_um: 0,
        effective_modulus_kpa: 10_000,
        damping_per_mille: 0,
        stiffness_deviation_per_mille: 0,
        inertia_deviation_per_mille: 0,
        mass_deviation_per_mille: 0,
        lever_deviation_ppht: 0,
        clearance_deviation_nm: 0,
        friction_deviation_per_mille: 0,
        friction_level_per_mille: 100,
        stroke_mm: 1,
        drive_period_ms: 50,
        journal_noise_nm: 1,
        angle_noise_nrad: 100,
        journal_noise_limit_nm: 16,
        angle_noise_limit_nrad: 16,
        load_noise_limit_mn: 16,
        load_stuck_samples: 1,
        journal_rail_nm: 1_000,
        load_rail_mn: 1_000,
        envelope_per_mille: 10,
        envelope_floor_n: 0,
        recovery_samples: 10,
        lost_samples: 1,
        wear_limit_nm: 1_000,
        wear_hysteresis_nm: 0,
        ..monitor
    };
    assert!(ranges(&smallest).iter().all(|(_, found, range)| range.contains(found)));
    serve(&smallest);
    let largest = MonitorConfiguration {
        mass_g: 100_000_000,
        inertia_g_m2: 1_000_000_000,
        drive_lever_um: 10_000_000,
        load_lever_um: 10_000_000,
        effective_modulus_kpa: 1_000_000_000,
        damping_per_mille: 10_000,
        lost_samples: u32::MAX - 1,
        recovery_samples: u16::MAX,
        ..monitor
    };
    assert!(ranges(&largest).iter().all(|(_, found, range)| range.contains(found)));
    serve(&largest);
    for (field, found, range) in ranges(&monitor) {
        assert!(range.contains(&found), "{field:?}: {found} of the example");
    }
}
