//! Description of the slider-crank with a clearance joint.

use super::law_names::{DissipationName, StiffnessName};
use super::plant::plant_description;
use super::{FrictionSection, PlantDescription, Range};
use crate::schema::{TINY, section};

section! {
    /// The crank and its prescribed motion.
    Crank {
        /// Length, at most that of the rod.
        length_m: f64 [1e-9, 1e6],
        /// Speed.
        speed_rpm: f64 [1e-3, 1e7],
        /// Length of a run in revolutions.
        revolutions: f64 [1e-6, 1e3],
    }
}
section! {
    /// The rod, its centre of mass at its middle.
    Rod {
        /// Length.
        length_m: f64 [1e-6, 1e6],
        /// Mass.
        mass_kg: f64 [1e-9, 1e9],
        /// Moment of inertia about the centre of mass.
        inertia_kg_m2: f64 [TINY, 1e9],
    }
}
section! {
    /// The slider.
    Slider {
        /// Mass.
        mass_kg: f64 [1e-9, 1e9],
    }
}
section! {
    /// The clearance joint between rod and slider.
    Joint {
        /// Bearing radius.
        bearing_radius_m: f64 [1e-6, 1e3],
        /// Journal radius, at most 0.9999 of the bearing's.
        journal_radius_m: f64 [1e-9, 1e3],
        /// Young's modulus of both bodies.
        youngs_modulus_pa: f64 [1e3, 1e15],
        /// Poisson's ratio of both bodies.
        poisson_ratio: f64 [0.0, 0.5],
        /// Nominal restitution.
        restitution: f64 [1e-6, 1.0],
        /// Stiffness part; without one that of Hertz for a sphere in a sphere.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        stiffness: Option<StiffnessName>,
        /// Length of the bearing; every stiffness part except Hertz' needs it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        length_m: Option<f64>,
        /// Dissipation factor.
        dissipation: DissipationName,
        /// Floor of the latched approach speed.
        latch_floor_m_s: f64 [TINY, 1e3],
    }
}

plant_description! {
    /// Description of a slider-crank.
    SliderCrankBench as SliderCrankFile "SliderCrankFile", plant "slider-crank", extension () {
        /// Always `slider-crank`.
        plant: String,
        /// Crank.
        crank: Crank,
        /// Rod.
        rod: Rod,
        /// Slider.
        slider: Slider,
        /// Clearance joint.
        joint: Joint,
        /// Friction law of the clearance joint, one without bristles; without it the joint is
        /// frictionless.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        friction: Option<FrictionSection>,
    }
}

impl SliderCrankBench {
    /// Length of a run in s.
    pub fn duration_s(&self) -> f64 {
        60.0 * self.crank.revolutions / self.crank.speed_rpm
    }
}

/// Omissions of the model.
const LIMITS: &[&str] = &[
    "The crank's speed is prescribed; impacts do not act on the drive.",
    "One clearance joint, with friction only if the description names a law; every other joint is \
     ideal.",
    "No gravity; rod and slider are rigid.",
    "Beyond about two revolutions trajectories decorrelate: only statistics can be compared.",
];

impl PlantDescription for SliderCrankBench {
    fn period_s(&self) -> f64 {
        60.0 / self.crank.speed_rpm
    }

    fn stroke(&self) -> f64 {
        2.0 * self.crank.length_m
    }

    fn duration_s(&self) -> f64 {
        Self::duration_s(self)
    }

    fn cycles_field(&self) -> &'static str {
        "crank.revolutions"
    }

    fn set_cycles(&mut self, cycles: u32) {
        self.crank.revolutions = f64::from(cycles);
    }

    fn dependent_ranges(&self) -> Vec<Range> {
        let (crank, rod, joint) = (&self.crank, &self.rod, &self.joint);
        vec![
            ("crank.length_m", crank.length_m, 1e-9, rod.length_m),
            ("joint.journal_radius_m", joint.journal_radius_m, 1e-9, 0.9999 * joint.bearing_radius_m),
        ]
    }

    fn limits(&self) -> &'static [&'static str] {
        LIMITS
    }
}
