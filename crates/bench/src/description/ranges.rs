//! Range of every number that a description may give. The bounds are far beyond any machine: they keep overflow, endless
//! runs and logs that no memory holds away from the model, and leave the rest to whoever describes the bench.

use super::{FrictionRig, TransmissionBench};

/// Field, what stands there, and the least and the most that may.
pub(super) type Range = (&'static str, f64, f64, f64);

/// Samples that a log may have.
const MOST_SAMPLES: f64 = 1e7;
/// What stands for "above 0".
const TINY: f64 = 1e-12;
const HUGE: f64 = 1e12;

/// The transmission bench's numbers.
pub(super) fn transmission(b: &TransmissionBench) -> Vec<Range> {
    let mut ranges = vec![
        ("geometry.drive_lever_radius_m", b.geometry.drive_lever_radius_m, 1e-3, 1e3),
        ("geometry.load_lever_radius_m", b.geometry.load_lever_radius_m, 1e-3, 1e3),
        ("shaft.mass_kg", b.shaft.mass_kg, 1e-3, 1e9),
        ("shaft.inertia_kg_m2", b.shaft.inertia_kg_m2, 1e-6, 1e9),
        ("bearing.bearing_radius_m", b.bearing.bearing_radius_m, 1e-4, 1e2),
        ("bearing.radial_clearance_m", b.bearing.radial_clearance_m, TINY, 0.1 * b.bearing.bearing_radius_m),
        ("bearing.length_m", b.bearing.length_m, 1e-4, 1e2),
        ("bearing.youngs_modulus_pa", b.bearing.youngs_modulus_pa, 1e3, 1e15),
        ("bearing.poisson_ratio", b.bearing.poisson_ratio, 0.0, 0.5),
        ("bearing.restitution", b.bearing.restitution, 1e-6, 1.0),
        ("contact.latch_floor_m_s", b.contact.latch_floor_m_s, TINY, 1e3),
        ("friction.coulomb_coefficient", b.friction.coulomb_coefficient, 0.0, 10.0),
        ("friction.static_coefficient", b.friction.static_coefficient, 0.0, 10.0),
        ("friction.level", b.friction.level, 0.0, 10.0),
        ("friction.stribeck_speed_m_s", b.friction.stribeck_speed_m_s, 1e-9, HUGE),
        ("friction.viscous_slope_s_m", b.friction.viscous_slope_s_m, -1e3, 1e3),
        ("friction.viscous_onset_m_s", b.friction.viscous_onset_m_s, 0.0, HUGE),
        ("friction.regularisation_m_s", b.friction.regularisation_m_s, 1e-9, 1e3),
        ("friction.still_speed_m_s", b.friction.still_speed_m_s, 0.0, 1e3),
        ("friction.transition_force_n", b.friction.transition_force_n, 1e-9, HUGE),
        ("friction.bristle_damping_s_m", b.friction.bristle_damping_s_m, 0.0, HUGE),
        ("drive.stroke_m", b.drive.stroke_m, 1e-9, 0.99 * b.geometry.drive_lever_radius_m),
        ("drive.period_s", b.drive.period_s, 1e-3, 1e6),
        ("drive.cycles", f64::from(b.drive.cycles), 1.0, 1e6),
        ("load.force_n", b.load.force_n, -1e7, 1e7),
        ("load.ramp_s", b.load.ramp_s, TINY, HUGE),
        log_rate(b.logging.sample_rate_hz, b.drive.period_s * f64::from(b.drive.cycles)),
    ];
    if let Some(t) = &b.two_plane {
        ranges.extend([
            ("two_plane.slices", f64::from(t.slices), 1.0, 201.0),
            ("two_plane.transverse_inertia_kg_m2", t.transverse_inertia_kg_m2, 1e-6, 1e9),
            ("two_plane.drive_offset_m", t.drive_offset_m, -10.0, 10.0),
            ("two_plane.load_offset_m", t.load_offset_m, -10.0, 10.0),
            ("two_plane.misalignment_y_rad", t.misalignment_y_rad, -0.1, 0.1),
            ("two_plane.misalignment_z_rad", t.misalignment_z_rad, -0.1, 0.1),
            ("two_plane.support_stiffness_nm_rad", t.support_stiffness_nm_rad, 0.0, 1e15),
            ("two_plane.support_damping_nm_s_rad", t.support_damping_nm_s_rad, 0.0, HUGE),
        ]);
    }
    if let Some(f) = &b.fork {
        ranges.extend([
            ("fork.backlash_m", f.backlash_m, 0.0, 0.1 * b.geometry.drive_lever_radius_m),
            ("fork.stiffness_n_m", f.stiffness_n_m, 1.0, 1e15),
            ("fork.damping_s_m", f.damping_s_m, 0.0, 1e6),
        ]);
    }
    if let Some(f) = &b.load_friction {
        ranges.extend([
            ("load_friction.coulomb_n", f.coulomb_n, 0.0, 1e7),
            ("load_friction.viscous_n_s_m", f.viscous_n_s_m, 0.0, 1e9),
            ("load_friction.regularisation_m_s", f.regularisation_m_s, 1e-9, 1e3),
        ]);
    }
    ranges
}

/// The friction rig's numbers.
pub(super) fn rig(r: &FrictionRig) -> Vec<Range> {
    let mut ranges = vec![
        ("axis.inertia", r.axis.inertia, 0.0, 1e9),
        ("axis.friction_radius_m", r.axis.friction_radius_m, 1e-6, 1e3),
        ("axis.load_gain", r.axis.load_gain, -1e3, 1e3),
        ("axis.coulomb_effort", r.axis.coulomb_effort, 0.0, HUGE),
        ("axis.viscous_effort", r.axis.viscous_effort, 0.0, HUGE),
        ("axis.load_coefficient", r.axis.load_coefficient, 0.0, 10.0),
        ("axis.coulomb_asymmetry", r.axis.coulomb_asymmetry, -HUGE, HUGE),
        ("axis.regularisation_m_s", r.axis.regularisation_m_s, TINY, 1e3),
        ("axis.period_s", r.axis.period_s, 1e-3, 1e6),
        ("axis.amplitude", r.axis.amplitude, 1e-9, 1e6),
        ("axis.cycles", f64::from(r.axis.cycles), 1.0, 1e6),
        // A sweep has no rests.
        ("axis.dwell_s", r.axis.dwell_s, 0.0, if r.axis.last_period_s > 0.0 { 0.0 } else { 1e6 }),
        (
            "axis.last_period_s",
            r.axis.last_period_s,
            if r.axis.last_period_s == 0.0 { 0.0 } else { 1e-3 },
            1e6,
        ),
        ("load.force_n", r.load.force_n, -1e7, 1e7),
        ("load.ramp_s", r.load.ramp_s, TINY, HUGE),
        log_rate(r.logging.sample_rate_hz, r.axis.duration_s()),
    ];
    if let Some(s) = &r.surface {
        ranges.extend([
            ("surface.break_away_ratio", s.break_away_ratio, 1.0, 10.0),
            ("surface.break_away_time_s", s.break_away_time_s, 1e-6, HUGE),
            ("surface.break_away_distance_m", s.break_away_distance_m, 1e-9, HUGE),
            ("surface.lag_s", s.lag_s, 0.0, 10.0),
        ]);
    }
    ranges
}

/// The rate of a log, bounded by the samples of so long a run.
fn log_rate(rate_hz: f64, run_s: f64) -> Range {
    ("logging.sample_rate_hz", rate_hz, 1e-6, (MOST_SAMPLES / run_s).min(1e9))
}

/// A number of a message: as written, or by its power of ten where that would be long.
pub(crate) fn shown(value: f64) -> String {
    if value == 0.0 || (1e-3..1e7).contains(&value.abs()) || !value.is_finite() {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
