//! Description of a planar mechanism: bodies, joints, laws of contacts, springs and loads.

mod check;
mod plant;

use super::common::plant_description;
use super::law_names::{CompleteLawName, DampingName, DissipationName, FrictionName, StiffnessName};
use super::{ContactSection, FrictionSection, ShapeName, is_one, is_zero, one};
use crate::schema::{HUGE, TINY, named_field, section};
use contact::{DEFAULT_LATCH_FLOOR_M_S, Material, StiffnessKind};
use serde::{Deserialize, Serialize};

/// Name of the ground in a joint, a spring or a load.
pub const GROUND: &str = "ground";

/// Kind of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum JointKind {
    /// Both bodies share a point and turn about it.
    Revolute,
    /// The second body slides along an axis of the first and keeps its angle to it.
    Prismatic,
    /// A point of the second body slides along an axis of the first; the angle is free.
    Slot,
    /// A massless rod connects a point of the first body with a point of the second.
    Rod,
    /// Both bodies are one.
    Weld,
    /// Revolute joint with clearance: bearing on the first body, journal on the second.
    Clearance,
    /// Prismatic joint with clearance: guide on the first body, slider on the second.
    Guide,
}

named_field!(JointKind {
    Revolute "revolute",
    Prismatic "prismatic",
    Slot "slot",
    Rod "rod",
    Weld "weld",
    Clearance "clearance",
    Guide "guide",
});

section! {
    /// Length, gravity and error control of a run.
    RunSection {
        /// Length of a run.
        duration_s: f64 [1e-9, 1e6],
        /// Acceleration of gravity along x and y.
        #[serde(default)]
        gravity_m_s2: [f64; 2] [-1e6, 1e6, "m/s2"],
        /// Rows of the log.
        #[serde(default = "rows")]
        samples: u32 [1.0, 1e7],
        /// Relative tolerance of each step.
        #[serde(default = "tolerance")]
        tolerance: f64 [1e-12, 1e-2],
        /// Largest step, which also limits how late a grazing contact is noticed.
        #[serde(default = "largest_step_s")]
        largest_step_s: f64 [1e-9, 1e3],
        /// Rate at which errors of the constraints are reduced (Baumgarte); one over the largest
        /// step without it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        stabilisation_per_s: Option<f64> [0.0, 1e7, "1/s"],
        /// Rates at the start satisfy the joints with clearance too, as if they were ideal. Without
        /// it only ideal joints and drives change the described rates.
        #[serde(default = "yes")]
        closed_start: bool,
    }
}
section! {
    /// Rigid bodies: uniform bars with `from_m` and `to_m`, others with `at_m` and `inertia_kg_m2`.
    BodySection {
        /// Name, for joints, springs and loads.
        name: String,
        /// Mass.
        mass_kg: f64 [1e-9, 1e9],
        /// Moment of inertia about the centre of mass; that of a uniform bar without it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inertia_kg_m2: Option<f64> [TINY, 1e9],
        /// Centre of mass at the start.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at_m: Option<[f64; 2]> [-1e6, 1e6],
        /// Angle at the start, of a body with `at_m`.
        #[serde(default, skip_serializing_if = "is_zero")]
        angle_rad: f64 [-1e3, 1e3],
        /// First end of a bar at the start.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        from_m: Option<[f64; 2]> [-1e6, 1e6],
        /// Second end of a bar at the start; the bar's angle is that from first to second.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        to_m: Option<[f64; 2]> [-1e6, 1e6],
        /// Velocity of the centre of mass at the start, before the joints correct it.
        #[serde(default, skip_serializing_if = "is_zero_pair")]
        velocity_m_s: [f64; 2] [-1e6, 1e6],
        /// Angular speed at the start, before the joints correct it.
        #[serde(default, skip_serializing_if = "is_zero")]
        speed_rad_s: f64 [-1e7, 1e7],
    }
}
section! {
    /// Joints and drives. Points are those at the start, in the axes of the ground. A drive
    /// prescribes the angle between the bodies (`revolute`) or the displacement (`prismatic`) as
    /// `drive_speed t + drive_amplitude sin(wt) + (drive_stroke/2)(1 - cos wt)`, `w` = 2 pi over
    /// `drive_period_s`.
    JointSection {
        /// Kind.
        kind: JointKind,
        /// First body, or `ground`.
        first: String,
        /// Second body, or `ground`.
        second: String,
        /// Point of the joint: the pin, the centre of the bearing, the middle of a slider, the end
        /// of a rod on the first body.
        at_m: [f64; 2] [-1e6, 1e6],
        /// End of a rod on the second body.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        to_m: Option<[f64; 2]> [-1e6, 1e6],
        /// Direction of the axis of `prismatic`, `slot` and `guide` at the start.
        #[serde(default, skip_serializing_if = "is_zero")]
        axis_rad: f64 [-1e3, 1e3],
        /// Constant speed of a drive.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        drive_speed: Option<f64> [-1e7, 1e7, "rad/s or m/s"],
        /// Amplitude of a drive's sine.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        drive_amplitude: Option<f64> [-1e6, 1e6, "rad or m"],
        /// One-sided stroke of a drive.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        drive_stroke: Option<f64> [-1e6, 1e6, "rad or m"],
        /// Period of sine and stroke.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        drive_period_s: Option<f64> [1e-6, 1e9],
        /// Total play of a drive, at the radius of its flanks.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        backlash_m: Option<f64> [0.0, 1e3],
        /// Radius of the flanks of a drive with backlash; 1 for a displacement.
        #[serde(default = "one", skip_serializing_if = "is_one")]
        flank_radius_m: f64 [1e-6, 1e6],
        /// Law of the contact of `clearance`, `guide` and backlash.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        contact: Option<String>,
        /// Radial clearance, or that of a guide on each side.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        clearance_m: Option<f64> [TINY, 1e3],
        /// Bearing radius; larger than the clearance.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        bearing_radius_m: Option<f64> [1e-6, 1e3],
        /// Position of the journal's centre from the bearing's at the start.
        #[serde(default, skip_serializing_if = "is_zero_pair")]
        offset_m: [f64; 2] [-1e3, 1e3],
        /// Length of a bearing, for laws that need it, or of a slider.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        length_m: Option<f64> [1e-6, 1e6],
        /// Height of a slider across its guide.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        height_m: Option<f64> [0.0, 1e6],
    }
}
section! {
    /// Laws of contacts, by name. The modulus is that of both bodies, unless the journal has its
    /// own. Without friction coefficients a contact is frictionless.
    ContactEntry {
        /// Name, for joints.
        name: String,
        /// Stiffness part; with `hertz` and no coefficient that of a sphere in a sphere.
        #[serde(default = "hertz")]
        stiffness: StiffnessName,
        /// Dissipation factor.
        dissipation: DissipationName,
        /// Nominal restitution.
        restitution: f64 [1e-6, 1.0],
        /// Floor of the latched approach speed; the reference speed with `damping = "reference"`.
        #[serde(default = "latch_floor_m_s")]
        latch_floor_m_s: f64 [TINY, 1e3],
        /// Reference of the deformation rate.
        #[serde(default, skip_serializing_if = "DampingName::is_latched")]
        damping: DampingName,
        /// Law with its own damping; replaces stiffness and dissipation.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        law: Option<CompleteLawName>,
        /// `K` in N/m^n, for laws that do not compute it from the joint.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        coefficient: Option<f64>,
        /// `n`, for laws with a free exponent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        exponent: Option<f64>,
        /// Damping: constant for `kelvin-voigt`, full damping for `adams-impact`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        damping_n_s_m: Option<f64>,
        /// Depth at which `adams-impact` has its full damping.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        full_damping_depth_m: Option<f64>,
        /// Young's modulus of the bearing.
        #[serde(default = "steel_modulus_pa")]
        youngs_modulus_pa: f64 [1e3, 1e15],
        /// Poisson's ratio of the bearing.
        #[serde(default = "steel_ratio")]
        poisson_ratio: f64 [0.0, 0.5],
        /// Young's modulus of the journal; that of the bearing without it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        journal_modulus_pa: Option<f64> [1e3, 1e15],
        /// Poisson's ratio of the journal; that of the bearing without it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        journal_poisson_ratio: Option<f64> [0.0, 0.5],
        /// Friction law; Stribeck's without one. As on the transmission bench `coulomb`, `karnopp`
        /// and `seven-parameter` cannot be integrated.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        friction: Option<FrictionName>,
        /// Friction coefficient at high speed.
        #[serde(default, skip_serializing_if = "is_zero")]
        coulomb_coefficient: f64 [0.0, 10.0],
        /// Friction coefficient at the onset of sliding; that at high speed without it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        static_coefficient: Option<f64> [0.0, 10.0],
        /// Stribeck speed.
        #[serde(default = "stribeck_speed_m_s")]
        stribeck_speed_m_s: f64 [1e-9, HUGE],
        /// Stribeck exponent by name.
        #[serde(default = "tustin")]
        shape: ShapeName,
        /// Slope over speed.
        #[serde(default, skip_serializing_if = "is_zero")]
        viscous_slope_s_m: f64 [-1e3, 1e3],
        /// Speed where the slope begins.
        #[serde(default, skip_serializing_if = "is_zero")]
        viscous_onset_m_s: f64 [0.0, HUGE],
        /// Width of the regularised sign: sliding speed below which friction rises smoothly.
        #[serde(default = "regularisation_m_s")]
        regularisation_m_s: f64 [1e-9, 1e3],
        /// Speed up to which Ambrosio's law gives no friction.
        #[serde(default, skip_serializing_if = "is_zero")]
        still_speed_m_s: f64 [0.0, 1e3],
        /// Viscous damping of Brown and McPhee's law, a force over the speed.
        #[serde(default, skip_serializing_if = "is_zero")]
        viscous_damping_n_s_m: f64 [0.0, 1e9],
        /// Force over which the viscous part of Brown and McPhee's law develops.
        #[serde(default = "one", skip_serializing_if = "is_one")]
        transition_force_n: f64 [1e-9, HUGE],
        /// Stiffness of the bristles, for `dahl` and `lugre`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        bristle_stiffness_per_m: Option<f64>,
        /// Damping of the bristles, for `lugre`.
        #[serde(default, skip_serializing_if = "is_zero")]
        bristle_damping_s_m: f64 [0.0, HUGE],
    }
}
section! {
    /// Springs with dampers: between two points, or torsional without points.
    SpringSection {
        /// First body, or `ground`.
        first: String,
        /// Second body, or `ground`.
        second: String,
        /// Point on the first body at the start.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        from_m: Option<[f64; 2]> [-1e6, 1e6],
        /// Point on the second body at the start.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        to_m: Option<[f64; 2]> [-1e6, 1e6],
        /// Stiffness.
        #[serde(default, skip_serializing_if = "is_zero")]
        stiffness: f64 [0.0, HUGE, "N/m or N m/rad"],
        /// Damping.
        #[serde(default, skip_serializing_if = "is_zero")]
        damping: f64 [0.0, HUGE, "N s/m or N m s/rad"],
        /// Free length; the length at the start without it. A torsional spring is free at the
        /// start.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        free_length_m: Option<f64> [0.0, 1e6],
    }
}
section! {
    /// Forces and torques on bodies, constant in the axes of the ground.
    LoadSection {
        /// Body.
        body: String,
        /// Point at the start; the centre of mass without it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at_m: Option<[f64; 2]> [-1e6, 1e6],
        /// Force along x and y.
        #[serde(default, skip_serializing_if = "is_zero_pair")]
        force_n: [f64; 2] [-1e9, 1e9],
        /// Torque.
        #[serde(default, skip_serializing_if = "is_zero")]
        torque_nm: f64 [-1e9, 1e9],
        /// Length of the raised-cosine ramp at the start.
        #[serde(default, skip_serializing_if = "is_zero")]
        ramp_s: f64 [0.0, 1e6],
    }
}

plant_description! {
    /// Description of a mechanism.
    MechanismBench as MechanismFile "MechanismFile", plant "mechanism", extension () {
        /// Always `mechanism`.
        plant: String,
        /// Length, gravity and error control of a run.
        run: RunSection,
        /// Rigid bodies: uniform bars with `from_m` and `to_m`, others with `at_m` and
        /// `inertia_kg_m2`.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        body: Vec<BodySection>,
        /// Joints and drives. Points are those at the start, in the axes of the ground. A drive
        /// prescribes the angle between the bodies (`revolute`) or the displacement (`prismatic`):
        /// `drive_speed t + drive_amplitude sin(wt) + (drive_stroke/2)(1 - cos wt)`, `w` = 2 pi
        /// over `drive_period_s`.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        joint: Vec<JointSection>,
        /// Laws of contacts, by name. The modulus is that of both bodies, unless the journal has
        /// its own. Without friction coefficients a contact is frictionless.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        contact: Vec<ContactEntry>,
        /// Springs with dampers: between two points, or torsional without points.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        spring: Vec<SpringSection>,
        /// Forces and torques on bodies, constant in the axes of the ground.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        load: Vec<LoadSection>,
    }
}

impl ContactEntry {
    /// Parameters of the normal law, as the transmission bench has them.
    pub(crate) fn contact_section(&self) -> ContactSection {
        ContactSection {
            stiffness: self.stiffness,
            dissipation: self.dissipation,
            latch_floor_m_s: self.latch_floor_m_s,
            damping: self.damping,
            law: self.law,
            coefficient: self.coefficient,
            exponent: self.exponent,
            damping_n_s_m: self.damping_n_s_m,
            full_damping_depth_m: self.full_damping_depth_m,
        }
    }

    /// Parameters of the friction law; none for a frictionless contact.
    pub(crate) fn friction_section(&self) -> Option<FrictionSection> {
        let static_coefficient = self.static_coefficient.unwrap_or(self.coulomb_coefficient);
        let is_frictionless =
            static_coefficient == 0.0 && self.viscous_slope_s_m == 0.0 && self.viscous_damping_n_s_m == 0.0;
        (!is_frictionless || self.friction.is_some()).then(|| FrictionSection {
            law: self.friction,
            coulomb_coefficient: self.coulomb_coefficient,
            static_coefficient,
            stribeck_speed_m_s: self.stribeck_speed_m_s,
            shape: self.shape,
            viscous_slope_s_m: self.viscous_slope_s_m,
            viscous_onset_m_s: self.viscous_onset_m_s,
            regularisation_m_s: self.regularisation_m_s,
            still_speed_m_s: self.still_speed_m_s,
            viscous_damping_n_s_m: self.viscous_damping_n_s_m,
            transition_force_n: self.transition_force_n,
            bristle_stiffness_per_m: self.bristle_stiffness_per_m,
            bristle_damping_s_m: self.bristle_damping_s_m,
            level: 1.0,
        })
    }

    /// Materials of bearing and journal.
    pub(crate) fn materials(&self) -> [Material; 2] {
        let bearing =
            Material { youngs_modulus_pa: self.youngs_modulus_pa, poisson_ratio: self.poisson_ratio };
        let journal = Material {
            youngs_modulus_pa: self.journal_modulus_pa.unwrap_or(self.youngs_modulus_pa),
            poisson_ratio: self.journal_poisson_ratio.unwrap_or(self.poisson_ratio),
        };
        [bearing, journal]
    }
}

impl JointSection {
    /// Returns whether the joint prescribes a motion.
    pub(crate) const fn is_driven(&self) -> bool {
        self.drive_speed.is_some() || self.drive_amplitude.is_some() || self.drive_stroke.is_some()
    }

    /// Direction of the axis at the start.
    pub(crate) fn axis(&self) -> [f64; 2] {
        [self.axis_rad.cos(), self.axis_rad.sin()]
    }
}

fn rows() -> u32 {
    4000
}

fn tolerance() -> f64 {
    1e-9
}

fn largest_step_s() -> f64 {
    1e-3
}

fn yes() -> bool {
    true
}

fn hertz() -> StiffnessName {
    StiffnessName(StiffnessKind::Hertz)
}

fn latch_floor_m_s() -> f64 {
    DEFAULT_LATCH_FLOOR_M_S
}

fn steel_modulus_pa() -> f64 {
    Material::STEEL.youngs_modulus_pa
}

fn steel_ratio() -> f64 {
    Material::STEEL.poisson_ratio
}

fn stribeck_speed_m_s() -> f64 {
    1e-2
}

fn tustin() -> ShapeName {
    ShapeName::Tustin
}

fn regularisation_m_s() -> f64 {
    1e-3
}

fn is_zero_pair(value: &[f64; 2]) -> bool {
    *value == [0.0; 2]
}
