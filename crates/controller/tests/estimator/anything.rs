//! For any sensor values and any configuration, the estimate is finite, the normal force is not
//! negative, and no deviation is 0.
//!
//! Tests run with overflow checks: an overflow in the tick would fail them.

use controller::Estimator;
use controller::configuration::BENCH_B;
use inference::{BearingMaterial, shipped};
use link::track::MonitorConfiguration;
use link::{BenchConfiguration, ContactSource, EstimateFrame, SensorFrame};
use proptest::prelude::*;

/// Codes of every size: near the clearance, anywhere, and the ends of the range.
fn code() -> impl Strategy<Value = i32> {
    prop_oneof![
        4 => -700_000..700_000_i32,
        1 => any::<i32>(),
        1 => prop_oneof![Just(i32::MIN), Just(i32::MAX), Just(0), Just(-1)],
    ]
}

fn frame() -> impl Strategy<Value = SensorFrame> {
    (any::<u32>(), any::<u32>(), code(), code(), code(), code()).prop_map(
        |(sequence, time_us, journal_y_nm, journal_z_nm, shaft_angle_nrad, load_force_mn)| SensorFrame {
            sequence,
            time_us,
            journal_y_nm,
            journal_z_nm,
            shaft_angle_nrad,
            load_force_mn,
        },
    )
}

fn configuration() -> impl Strategy<Value = (BenchConfiguration, MonitorConfiguration)> {
    let ends = |low: u32, high: u32| prop_oneof![2 => low..=high, 1 => Just(low), 1 => Just(high)];
    let bench = (
        0..2_u8,
        ends(1_000, 5_000_000),
        ends(1_000_000, 1_000_000_000),
        ends(50, 1_000),
        ends(100, 100_000),
        any::<bool>(),
    );
    let shaft = (ends(1_000, 100_000_000), ends(1, 1_000_000_000), ends(10_000, 10_000_000));
    let contact = (ends(10_000, 1_000_000_000), 0..=10_000_u16, ends(0, 1_000_000));
    (bench, shaft, contact).prop_map(|(bench, shaft, contact)| {
        let (bearing, radial_clearance_nm, journal_radius_nm, sample_period_us, floor, is_law) = bench;
        let bench = BenchConfiguration {
            bearing,
            radial_clearance_nm,
            journal_radius_nm,
            sample_period_us,
            latch_floor_um_s: floor,
            contact: if is_law { ContactSource::Law } else { ContactSource::Network },
        };
        let (mass_g, inertia_g_m2, drive_lever_um) = shaft;
        let (effective_modulus_kpa, damping_per_mille, clearance_deviation_nm) = contact;
        let monitor = MonitorConfiguration {
            mass_g,
            inertia_g_m2,
            drive_lever_um,
            effective_modulus_kpa,
            damping_per_mille,
            clearance_deviation_nm,
            stroke_mm: 20,
            ..BENCH_B.monitor
        };
        (bench, monitor)
    })
}

/// Independent frames, or consecutive frames, which fill the window so that rates are computed.
fn sequence() -> impl Strategy<Value = (Vec<SensorFrame>, bool)> {
    (prop::collection::vec(frame(), 1..240), any::<bool>())
}

/// Deviations may be infinite, but not 0; everything else is finite.
fn is_sound(estimate: &EstimateFrame) -> bool {
    let deviations = [
        estimate.normal_force_sd_n,
        estimate.force_sd_n,
        estimate.friction_torque_sd_nm,
        estimate.clearance_sd_m,
        estimate.stiffness_sd,
        estimate.friction_sd,
    ];
    let forces = [
        estimate.normal_force_n,
        estimate.force_y_n,
        estimate.force_z_n,
        estimate.friction_torque_nm,
        estimate.deformation_m,
        estimate.contact_angle_rad,
        estimate.network_force_n,
        estimate.law_force_n,
        estimate.clearance_m,
        estimate.stiffness_factor,
        estimate.friction_factor,
    ];
    forces.iter().all(|value| value.is_finite())
        && estimate.normal_force_n >= 0.0
        && deviations.iter().all(|deviation| *deviation > 0.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn any_frames_give_finite_estimates(
        (frames, joined) in sequence(),
        (configuration, monitor) in configuration(),
    ) {
        let bearing = BearingMaterial::from_code(configuration.bearing).unwrap();
        let mut estimator = Estimator::new(shipped(bearing), &configuration, &monitor).unwrap();
        for (mut frame, index) in frames.into_iter().zip(0_u32..) {
            if joined {
                // A regular clock and small steps, wrapped around the range of codes: only jumps
                // restart the window.
                frame.sequence = index;
                frame.time_us = index.wrapping_mul(configuration.sample_period_us);
                frame.journal_y_nm %= 20_000;
                let clearance_nm = i32::try_from(configuration.radial_clearance_nm).unwrap();
                frame.journal_z_nm = clearance_nm + frame.journal_z_nm % 20_000;
                frame.shaft_angle_nrad %= 400_000;
            }
            let estimate = estimator.step(&frame);
            prop_assert!(is_sound(&estimate), "{frame:?}: {estimate:?}");
            prop_assert_eq!((estimate.sequence, estimate.time_us), (frame.sequence, frame.time_us));
        }
    }
}
