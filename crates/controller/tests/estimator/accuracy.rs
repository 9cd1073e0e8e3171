//! Forces of known orbits against the laws.
//!
//! The rate is the delicate part. The journal swings along the clearance circle at 150 mm/s while
//! its deformation moves by less than 1 mm/s; a rate that is the projection of two Cartesian slopes
//! takes a share of the swing for an approach, and the damping then multiplies the force.

use crate::orbit::{Orbit, Truth};
use controller::estimator::WINDOW;
use inference::BearingMaterial;
use link::EstimateFrame;

/// Two periods of the slowest swing and the window before them.
const SAMPLES: u32 = 700;

/// Estimates past the window with the truth beside them.
fn settled(orbit: &Orbit) -> Vec<(EstimateFrame, Truth)> {
    let estimates = orbit.run(SAMPLES).into_iter().zip(0..).skip(WINDOW - 1);
    estimates.map(|(estimate, index)| (estimate, orbit.truth(index))).collect()
}

/// Swings from 30 to 60 Hz with 100 to 200 mm/s, either way of the shaft, either bearing, three
/// depths.
fn swings() -> impl Iterator<Item = Orbit> {
    BearingMaterial::ALL.into_iter().flat_map(|bearing| {
        [(30.0, 1.1, 0.3), (45.0, 1.06, -0.3), (60.0, 1.05, 0.6)].into_iter().flat_map(
            move |(swing_hz, swing_rad, shaft_speed_rad_s)| {
                [0.6, 1.0, 1.7].into_iter().map(move |depth| {
                    let base = Orbit::swinging(bearing);
                    let mean_deformation_m = depth * base.mean_deformation_m;
                    Orbit { swing_hz, swing_rad, shaft_speed_rad_s, mean_deformation_m, ..base }
                })
            },
        )
    })
}

#[test]
fn the_orbits_are_as_hard_as_they_are_meant_to_be() {
    for orbit in swings() {
        let truths: Vec<_> = (0..SAMPLES).map(|index| orbit.truth(index)).collect();
        let most = |pick: fn(&Truth) -> f64| truths.iter().map(pick).fold(0.0, f64::max);
        assert!(most(|t| t.sliding_m_s.abs()) > 0.1, "{orbit:?}");
        assert!(most(|t| t.rate_m_s.abs()) < 1e-3, "{orbit:?}");
        assert!(truths.iter().all(|t| t.deformation_m > 0.0), "{orbit:?}");
    }
}

#[test]
fn the_normal_force_of_a_swinging_journal_is_the_law_s() {
    for orbit in swings() {
        let law = orbit.normal_law();
        let mut worst = 0.0_f64;
        for (estimate, truth) in settled(&orbit) {
            let expected = law.force_n(truth.deformation_m, truth.rate_m_s, orbit.unseen_approach_m_s);
            worst = worst.max((f64::from(estimate.normal_force_n) / expected - 1.0).abs());
        }
        assert!(worst < 0.04, "{orbit:?}: off by {:.1} %", 100.0 * worst);
    }
}

#[test]
fn deformation_and_direction_follow_the_swing() {
    for orbit in swings() {
        for (estimate, truth) in settled(&orbit) {
            let off_m = f64::from(estimate.deformation_m) - truth.deformation_m;
            assert!(off_m.abs() < 50e-9, "{orbit:?}: {off_m} m");
            let angle = truth.normal.1.atan2(truth.normal.0);
            let turn = (f64::from(estimate.contact_angle_rad) - angle).rem_euclid(core::f64::consts::TAU);
            let off = turn.min(core::f64::consts::TAU - turn);
            assert!(off < 1e-4, "{orbit:?}: {off} rad");
        }
    }
}

#[test]
fn friction_opposes_the_sliding_and_has_the_law_s_size() {
    for orbit in swings() {
        let (mut forward, mut backward) = (0, 0);
        for (estimate, truth) in settled(&orbit) {
            // The window follows the swing's speed to 9 to 31 % of its peak: near its turns neither
            // sign nor size is certain.
            if truth.sliding_m_s.abs() < 0.35 * peak_m_s(&orbit) {
                continue;
            }
            let torque = f64::from(estimate.friction_torque_nm);
            assert!(torque * truth.sliding_m_s < 0.0, "{orbit:?}: {torque} N m at {truth:?}");
            forward += usize::from(truth.sliding_m_s > 0.0);
            backward += usize::from(truth.sliding_m_s < 0.0);
            if orbit.swing_hz < 50.0 {
                let normal = f64::from(estimate.normal_force_n);
                let friction = orbit.friction_law().force_n(normal, truth.sliding_m_s);
                let expected = friction * orbit.journal_radius_m();
                assert!((torque / expected - 1.0).abs() < 0.12, "{orbit:?}: {torque} for {expected} N m");
            }
        }
        assert!(forward > 50 && backward > 50, "{orbit:?}: {forward} forward, {backward} backward");
    }
}

#[test]
fn the_components_are_normal_and_friction_along_their_directions() {
    for orbit in swings() {
        let law = orbit.normal_law();
        for (estimate, truth) in settled(&orbit) {
            if truth.sliding_m_s.abs() < 0.35 * peak_m_s(&orbit) {
                continue;
            }
            let normal = law.force_n(truth.deformation_m, truth.rate_m_s, orbit.unseen_approach_m_s);
            let friction = orbit.friction_law().force_n(normal, truth.sliding_m_s);
            let (n_y, n_z) = truth.normal;
            let expected = (-normal * n_y + friction * n_z, -normal * n_z - friction * n_y);
            let off_y = f64::from(estimate.force_y_n) - expected.0;
            let off_z = f64::from(estimate.force_z_n) - expected.1;
            assert!(off_y.hypot(off_z) < 0.05 * normal, "{orbit:?}: {estimate:?} for {expected:?} N");
        }
    }
}

#[test]
fn a_contact_whose_onset_was_seen_is_damped_by_the_speed_of_that_onset() {
    for (bearing, high_m) in [(BearingMaterial::Babbitt, 50e-6), (BearingMaterial::Plastic, 120e-6)] {
        // Apart at first, then in and out at 30 Hz. The configured speed for unseen onsets is far
        // off and must not matter.
        let orbit = Orbit {
            mean_deformation_m: 0.0,
            deformation_swing_m: high_m,
            deformation_phase_rad: -1.8,
            unseen_approach_m_s: 0.5,
            ..Orbit::swinging(bearing)
        };
        let onset_m_s = high_m * core::f64::consts::TAU * orbit.deformation_hz;
        let law = orbit.normal_law();
        let runs: Vec<_> = settled(&orbit)
            .into_iter()
            .map(|(estimate, truth)| {
                let expected = law.force_n(truth.deformation_m, truth.rate_m_s, onset_m_s);
                (f64::from(estimate.normal_force_n), expected)
            })
            .collect();
        let peak = runs.iter().map(|run| run.1).fold(0.0, f64::max);
        for (found, expected) in runs {
            assert!((found - expected).abs() < 0.05 * peak, "{bearing:?}: {found} for {expected} N");
        }
    }
}

#[test]
fn a_gap_has_exactly_no_force() {
    for bearing in BearingMaterial::ALL {
        // A micrometre of gap at least, the whole swing long.
        let apart =
            Orbit { mean_deformation_m: -3e-6, deformation_swing_m: 2e-6, ..Orbit::swinging(bearing) };
        for estimate in apart.run(SAMPLES) {
            assert_eq!(forces(&estimate), [0.0; 4], "{estimate:?}");
        }
        // In and out: none as soon as it is out, whatever the networks remember.
        let bouncing = Orbit { mean_deformation_m: 0.0, deformation_swing_m: 20e-6, ..apart };
        let mut out = 0;
        for (estimate, truth) in settled(&bouncing) {
            if truth.deformation_m < -1e-7 {
                assert_eq!(forces(&estimate), [0.0; 4], "{estimate:?}");
                out += 1;
            }
        }
        assert!(out > 100);
    }
}

/// No sliding speed of an orbit is above this.
fn peak_m_s(orbit: &Orbit) -> f64 {
    let swing_m_s = orbit.swing_rad * core::f64::consts::TAU * orbit.swing_hz * orbit.clearance_m;
    swing_m_s + orbit.shaft_speed_rad_s.abs() * orbit.journal_radius_m()
}

fn forces(estimate: &EstimateFrame) -> [f32; 4] {
    [estimate.normal_force_n, estimate.force_y_n, estimate.force_z_n, estimate.friction_torque_nm]
}
