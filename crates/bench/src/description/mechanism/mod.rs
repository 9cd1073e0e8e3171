//! Description of a planar mechanism: bodies, joints, laws of contacts, springs and loads.

mod check;
mod contact;
mod measured;
mod part;
mod plant;
mod quantity;

pub use self::contact::ContactEntry;
pub use self::measured::MeasuredEntry;
pub(crate) use self::part::Part;
pub(crate) use self::quantity::Quantity;

use super::plant::plant_description;
use super::{is_one, is_zero, one};
use crate::schema::{HUGE, TINY, named_field, section};
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
        /// Channels of a recorded log. A mechanism without them has no log.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        measured: Vec<MeasuredEntry>,
    }
}

impl JointSection {
    /// Returns whether the joint prescribes a motion.
    pub(crate) const fn is_driven(&self) -> bool {
        self.drive_speed.is_some() || self.drive_amplitude.is_some() || self.drive_stroke.is_some()
    }

    /// Returns whether the joint has a drive without backlash.
    pub(crate) const fn has_stiff_drive(&self) -> bool {
        self.is_driven() && self.backlash_m.is_none()
    }

    /// Direction of the axis at the start.
    pub(crate) fn axis(&self) -> [f64; 2] {
        [self.axis_rad.cos(), self.axis_rad.sin()]
    }
}

/// Appends a number to names that occur before, so that all differ.
pub(crate) fn distinct(names: Vec<String>) -> Vec<String> {
    let mut all: Vec<String> = Vec::with_capacity(names.len());
    for name in names {
        let numbered = (2..).map(|n| format!("{name}_again_{n}"));
        let free = std::iter::once(name.clone()).chain(numbered).find(|name| !all.contains(name));
        all.push(free.unwrap_or(name));
    }
    all
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

fn is_zero_pair(value: &[f64; 2]) -> bool {
    *value == [0.0; 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_repeat_get_a_number() {
        let names = ["a_b", "a_b", "c", "a_b"].map(str::to_owned).to_vec();
        assert_eq!(distinct(names), ["a_b", "a_b_again_2", "c", "a_b_again_3"]);
    }
}
