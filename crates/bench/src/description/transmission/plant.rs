//! The transmission bench as one of the plants: its facts, ranges and parameters.

use super::TransmissionBench;
use crate::description::plant::{HUGE, TINY, load_ranges, log_rate};
use crate::description::{DriveChannels, Field, Load, Plant, PlantDescription, Range, Refusal};
use crate::signals::Channel;

/// Omissions of the planar model.
const PLANAR_LIMITS: &[&str] = &[
    "The shaft moves in its plane and does not tilt: only the two-plane bench has edge loading.",
    "Levers, shaft and frame are rigid; their bending is not modelled.",
    "The bearing runs dry: no lubricant film, no squeeze film and no seal, unless an effect adds it.",
    "The clearance circle is round and does not wear during a run.",
    "Contact is one point of the circle with a force law, without a pressure distribution.",
    "Sustained contact is damped by the latched approach speed of the last onset or its floor.",
    "Temperature is constant: friction and clearance do not depend on it.",
    "The load does not depend on the motion; its cylinder is frictionless unless described.",
    "With play in the fork, the damping of a hydraulic column in series is not modelled.",
];

/// Omissions of the model with tilt.
const TWO_PLANE_LIMITS: &[&str] = &[
    "Levers, shaft and frame are rigid; the shaft tilts but does not bend.",
    "Drive and load act at fixed offsets along the shaft and add no moments; the tilt is small.",
    "Slices of the bearing do not support each other: the bearing body is an elastic foundation.",
    "The ends of the bearing are as stiff as its middle.",
    "Gyroscopic moments of the slow shaft are not modelled.",
    "The drive is rigid: no hydraulic column, no play in the fork.",
    "The controller measures the journal in the bearing's middle only, not contact at the ends.",
    "As on the planar bench: dry, round, no wear during a run, constant temperature.",
];

impl PlantDescription for TransmissionBench {
    fn period_s(&self) -> f64 {
        self.drive.period_s
    }

    fn stroke(&self) -> f64 {
        self.drive.stroke_m
    }

    fn duration_s(&self) -> f64 {
        Self::duration_s(self)
    }

    fn cycles_field(&self) -> &'static str {
        "drive.cycles"
    }

    fn set_cycles(&mut self, cycles: u32) {
        self.drive.cycles = cycles;
    }

    fn ranges(&self) -> Vec<Range> {
        [self.mechanical_ranges(), self.friction_ranges(), self.operating_ranges(), self.optional_ranges()]
            .concat()
    }

    fn limits(&self) -> &'static [&'static str] {
        if self.two_plane.is_some() { TWO_PLANE_LIMITS } else { PLANAR_LIMITS }
    }

    fn refusal(&self) -> Option<Refusal> {
        (self.two_plane.is_some() && self.fork.is_some()).then(|| {
            (
                "two_plane".into(),
                "combined with a compliant drive".into(),
                "no `[fork]`: its fork is rigid".into(),
            )
        })
    }

    fn plant_parameter_mut(&mut self, name: &str) -> Option<&mut f64> {
        Some(match name {
            "geometry.drive_lever_radius_m" => &mut self.geometry.drive_lever_radius_m,
            "geometry.load_lever_radius_m" => &mut self.geometry.load_lever_radius_m,
            "shaft.mass_kg" => &mut self.shaft.mass_kg,
            "shaft.inertia_kg_m2" => &mut self.shaft.inertia_kg_m2,
            "bearing.radial_clearance_m" => &mut self.bearing.radial_clearance_m,
            "bearing.youngs_modulus_pa" => &mut self.bearing.youngs_modulus_pa,
            "bearing.restitution" => &mut self.bearing.restitution,
            "contact.latch_floor_m_s" => &mut self.contact.latch_floor_m_s,
            "friction.level" => &mut self.friction.level,
            "load.force_n" => &mut self.load.force_n,
            _ => return None,
        })
    }

    fn period_mut(&mut self) -> Option<Field<'_>> {
        Some(("drive.period_s", &mut self.drive.period_s))
    }

    fn stroke_mut(&mut self) -> Option<Field<'_>> {
        Some(("drive.stroke_m", &mut self.drive.stroke_m))
    }

    fn load(&self) -> Option<&Load> {
        Some(&self.load)
    }

    fn load_mut(&mut self) -> Option<&mut Load> {
        Some(&mut self.load)
    }

    fn has_thermal_friction(&self) -> bool {
        self.extension.thermal.is_some()
    }

    fn set_temperature_start_k(&mut self, rise_k: f64) {
        self.extension.temperature_start_k = rise_k;
    }

    fn effect_plant(&self) -> Option<Plant> {
        Some(if self.two_plane.is_some() { Plant::TwoPlane } else { Plant::Planar })
    }

    fn sample_rate_hz(&self) -> f64 {
        self.logging.sample_rate_hz
    }

    fn drive_channels(&self) -> Option<DriveChannels> {
        Some(DriveChannels { position: Channel::DriveDisplacement, speed: Channel::DriveVelocity })
    }

    fn simulates(&self, channel: Channel) -> bool {
        !matches!(channel, Channel::DriveTorque | Channel::BearingTemperature)
    }

    fn steady_span_s(
        &self,
        (start_s, end_s): (f64, f64),
        (start_margin_s, end_margin_s): (f64, f64),
    ) -> (f64, f64) {
        (start_s + self.load.ramp_s + start_margin_s, end_s - end_margin_s)
    }
}

impl TransmissionBench {
    /// Ranges of levers, shaft, bearing and contact.
    fn mechanical_ranges(&self) -> Vec<Range> {
        let (geometry, shaft, bearing) = (&self.geometry, &self.shaft, &self.bearing);
        vec![
            ("geometry.drive_lever_radius_m", geometry.drive_lever_radius_m, 1e-3, 1e3),
            ("geometry.load_lever_radius_m", geometry.load_lever_radius_m, 1e-3, 1e3),
            ("shaft.mass_kg", shaft.mass_kg, 1e-3, 1e9),
            ("shaft.inertia_kg_m2", shaft.inertia_kg_m2, 1e-6, 1e9),
            ("bearing.bearing_radius_m", bearing.bearing_radius_m, 1e-4, 1e2),
            ("bearing.radial_clearance_m", bearing.radial_clearance_m, TINY, 0.1 * bearing.bearing_radius_m),
            ("bearing.length_m", bearing.length_m, 1e-4, 1e2),
            ("bearing.youngs_modulus_pa", bearing.youngs_modulus_pa, 1e3, 1e15),
            ("bearing.poisson_ratio", bearing.poisson_ratio, 0.0, 0.5),
            ("bearing.restitution", bearing.restitution, 1e-6, 1.0),
            ("contact.latch_floor_m_s", self.contact.latch_floor_m_s, TINY, 1e3),
        ]
    }

    /// Ranges of the friction law.
    fn friction_ranges(&self) -> Vec<Range> {
        let friction = &self.friction;
        vec![
            ("friction.coulomb_coefficient", friction.coulomb_coefficient, 0.0, 10.0),
            ("friction.static_coefficient", friction.static_coefficient, 0.0, 10.0),
            ("friction.level", friction.level, 0.0, 10.0),
            ("friction.stribeck_speed_m_s", friction.stribeck_speed_m_s, 1e-9, HUGE),
            ("friction.viscous_slope_s_m", friction.viscous_slope_s_m, -1e3, 1e3),
            ("friction.viscous_onset_m_s", friction.viscous_onset_m_s, 0.0, HUGE),
            ("friction.regularisation_m_s", friction.regularisation_m_s, 1e-9, 1e3),
            ("friction.still_speed_m_s", friction.still_speed_m_s, 0.0, 1e3),
            ("friction.transition_force_n", friction.transition_force_n, 1e-9, HUGE),
            ("friction.bristle_damping_s_m", friction.bristle_damping_s_m, 0.0, HUGE),
        ]
    }

    /// Ranges of drive, load and log.
    fn operating_ranges(&self) -> Vec<Range> {
        let drive = &self.drive;
        let mut ranges = vec![
            ("drive.stroke_m", drive.stroke_m, 1e-9, 0.99 * self.geometry.drive_lever_radius_m),
            ("drive.period_s", drive.period_s, 1e-3, 1e6),
            ("drive.cycles", f64::from(drive.cycles), 1.0, 1e6),
        ];
        ranges.extend(load_ranges(&self.load));
        ranges.push(log_rate(&self.logging, self.duration_s()));
        ranges
    }

    /// Ranges of the sections that a description may leave out.
    fn optional_ranges(&self) -> Vec<Range> {
        let mut ranges = Vec::new();
        if let Some(tilt) = &self.two_plane {
            ranges.extend([
                ("two_plane.slices", f64::from(tilt.slices), 1.0, 201.0),
                ("two_plane.transverse_inertia_kg_m2", tilt.transverse_inertia_kg_m2, 1e-6, 1e9),
                ("two_plane.drive_offset_m", tilt.drive_offset_m, -10.0, 10.0),
                ("two_plane.load_offset_m", tilt.load_offset_m, -10.0, 10.0),
                ("two_plane.misalignment_y_rad", tilt.misalignment_y_rad, -0.1, 0.1),
                ("two_plane.misalignment_z_rad", tilt.misalignment_z_rad, -0.1, 0.1),
                ("two_plane.support_stiffness_nm_rad", tilt.support_stiffness_nm_rad, 0.0, 1e15),
                ("two_plane.support_damping_nm_s_rad", tilt.support_damping_nm_s_rad, 0.0, HUGE),
            ]);
        }
        if let Some(fork) = &self.fork {
            ranges.extend([
                ("fork.backlash_m", fork.backlash_m, 0.0, 0.1 * self.geometry.drive_lever_radius_m),
                ("fork.stiffness_n_m", fork.stiffness_n_m, 1.0, 1e15),
                ("fork.damping_s_m", fork.damping_s_m, 0.0, 1e6),
            ]);
        }
        if let Some(friction) = &self.load_friction {
            ranges.extend([
                ("load_friction.coulomb_n", friction.coulomb_n, 0.0, 1e7),
                ("load_friction.viscous_n_s_m", friction.viscous_n_s_m, 0.0, 1e9),
                ("load_friction.regularisation_m_s", friction.regularisation_m_s, 1e-9, 1e3),
            ]);
        }
        ranges
    }
}
