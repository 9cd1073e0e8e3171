//! Description of the slider-crank with a clearance joint.

use super::common::plant_description;
use super::law_names::{DissipationName, StiffnessName};
use super::plant::TINY;
use super::{PlantDescription, Range};
use serde::{Deserialize, Serialize};

section! {
    /// The crank and its prescribed motion.
    Crank {
        /// Length in m.
        length_m: f64,
        /// Speed in revolutions per minute.
        speed_rpm: f64,
        /// Length of a run in revolutions.
        revolutions: f64,
    }
}
section! {
    /// The rod, its centre of mass at its middle.
    Rod {
        /// Length in m.
        length_m: f64,
        /// Mass in kg.
        mass_kg: f64,
        /// Moment of inertia about the centre of mass in kg m2.
        inertia_kg_m2: f64,
    }
}
section! {
    /// The slider.
    Slider {
        /// Mass in kg.
        mass_kg: f64,
    }
}
section! {
    /// The clearance joint between rod and slider.
    Joint {
        /// Bearing radius in m.
        bearing_radius_m: f64,
        /// Journal radius in m, below the bearing's.
        journal_radius_m: f64,
        /// Young's modulus of both bodies in Pa.
        youngs_modulus_pa: f64,
        /// Poisson's ratio of both bodies.
        poisson_ratio: f64,
        /// Nominal restitution.
        restitution: f64,
        /// Stiffness part; without one that of Hertz for a sphere in a sphere.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        stiffness: Option<StiffnessName>,
        /// Length of the bearing in m; every stiffness part except Hertz' needs it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        length_m: Option<f64>,
        /// Dissipation factor.
        dissipation: DissipationName,
        /// Floor of the latched approach speed in m/s.
        latch_floor_m_s: f64,
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
    "One clearance joint, without friction; every other joint is ideal.",
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

    fn ranges(&self) -> Vec<Range> {
        let (min, max) = (1e-9, 1e9);
        let (crank, rod, joint) = (&self.crank, &self.rod, &self.joint);
        vec![
            ("rod.length_m", rod.length_m, 1e-6, 1e6),
            ("crank.length_m", crank.length_m, min, rod.length_m),
            ("crank.speed_rpm", crank.speed_rpm, 1e-3, 1e7),
            ("crank.revolutions", crank.revolutions, 1e-6, 1000.0),
            ("rod.mass_kg", rod.mass_kg, min, max),
            ("rod.inertia_kg_m2", rod.inertia_kg_m2, TINY, max),
            ("slider.mass_kg", self.slider.mass_kg, min, max),
            ("joint.bearing_radius_m", joint.bearing_radius_m, 1e-6, 1e3),
            ("joint.journal_radius_m", joint.journal_radius_m, min, 0.9999 * joint.bearing_radius_m),
            ("joint.youngs_modulus_pa", joint.youngs_modulus_pa, 1e3, 1e15),
            ("joint.poisson_ratio", joint.poisson_ratio, 0.0, 0.5),
            ("joint.restitution", joint.restitution, 1e-6, 1.0),
            ("joint.latch_floor_m_s", joint.latch_floor_m_s, TINY, 1e3),
        ]
    }

    fn limits(&self) -> &'static [&'static str] {
        LIMITS
    }
}
