//! The transmission bench as one of the plants: its facts, ranges and parameters.

use super::TransmissionBench;
use crate::description::plant::log_rate;
use crate::description::{DriveChannels, Field, Load, Plant, PlantDescription, Range, Refusal};
use crate::schema::TINY;
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
    "With a servo, the flow does not depend on the pressure, and the cylinder does not leak.",
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

    fn dependent_ranges(&self) -> Vec<Range> {
        let (bearing, drive) = (&self.bearing, &self.drive);
        let lever_m = self.geometry.drive_lever_radius_m;
        let mut ranges = vec![
            ("bearing.radial_clearance_m", bearing.radial_clearance_m, TINY, 0.1 * bearing.bearing_radius_m),
            ("drive.stroke_m", drive.stroke_m, 1e-9, 0.99 * lever_m),
            log_rate(&self.logging, self.duration_s()),
        ];
        if let Some(fork) = &self.fork {
            ranges.push(("fork.backlash_m", fork.backlash_m, 0.0, 0.1 * lever_m));
        }
        if let Some(start) = &self.start {
            ranges.extend(start.ranges(bearing.radial_clearance_m));
        }
        ranges.extend(self.life_ranges());
        ranges
    }

    fn limits(&self) -> &'static [&'static str] {
        if self.two_plane.is_some() { TWO_PLANE_LIMITS } else { PLANAR_LIMITS }
    }

    fn refusals(&self) -> Vec<Refusal> {
        let is_compliant = self.two_plane.is_some() && (self.fork.is_some() || self.servo.is_some());
        let (found, expected) = match self.servo {
            None => ("combined with a compliant drive", "no `[fork]`: its fork is rigid"),
            Some(_) => ("combined with a compliant drive", "no `[servo]`: its fork is rigid"),
        };
        let compliant = is_compliant.then(|| ("two_plane".into(), found.into(), expected.into()));
        compliant.into_iter().chain(self.course_refusals()).collect()
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
        // Another course does not follow the period.
        self.drive_profile.is_none().then_some(("drive.period_s", &mut self.drive.period_s))
    }

    fn stroke_mut(&mut self) -> Option<Field<'_>> {
        self.drive_profile.is_none().then_some(("drive.stroke_m", &mut self.drive.stroke_m))
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
    /// Ranges of a life that depend on other fields.
    fn life_ranges(&self) -> Vec<Range> {
        let (bearing, life) = (&self.bearing, self.life.as_ref());
        let largest_m = 0.1 * bearing.bearing_radius_m;
        let limit = life.and_then(|life| life.limit_clearance_m);
        let limit = limit.map(|m| ("life.limit_clearance_m", m, bearing.radial_clearance_m, largest_m));
        // A film thicker than half of the clearance leaves the journal hardly any path.
        let film = self.film.as_ref();
        let film = film.map(|f| ("film.min_film_m", f.min_film_m, 1e-8, 0.5 * bearing.radial_clearance_m));
        limit.into_iter().chain(film).collect()
    }
}
