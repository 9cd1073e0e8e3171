//! Description of the transmission bench.

mod change;
mod courses;
mod life;
mod operation;
mod plant;
mod profile;
mod servo;
mod start;

pub use life::{FilmSection, LifeSection, ThermalSection, WearSection};
pub use profile::{CourseKind, CourseSection};
pub use servo::Servo;
pub use start::Start;
pub(crate) use start::StartState;

use super::plant::plant_description;
use super::{Extension, Load, Logging, is_one, is_zero, one};
use crate::description::law_names::{
    CompleteLawName, DampingName, DissipationName, FrictionName, StiffnessName,
};
use crate::schema::{HUGE, TINY, named_field, section};
use contact::BearingMaterial;
use serde::{Deserialize, Serialize};

section! {
    /// Levers and stroke of the transmission bench.
    Geometry {
        /// Drive crank `R_d`.
        drive_lever_radius_m: f64 [1e-3, 1e3],
        /// Load crank `R_l`.
        load_lever_radius_m: f64 [1e-3, 1e3],
    }
}
section! {
    /// The shaft with all parts that move with it.
    Shaft {
        /// Mass.
        mass_kg: f64 [1e-3, 1e9],
        /// Moment of inertia about its axis.
        inertia_kg_m2: f64 [1e-6, 1e9],
    }
}
section! {
    /// The clearance bearing.
    Bearing {
        /// Material; it selects the trained networks.
        material: BearingMaterial,
        /// Bearing radius `R_B`.
        bearing_radius_m: f64 [1e-4, 1e2],
        /// Radial clearance `D`, at most a tenth of the bearing's radius.
        radial_clearance_m: f64 [TINY, 10.0],
        /// Bearing length.
        length_m: f64 [1e-4, 1e2],
        /// Young's modulus of the bearing.
        youngs_modulus_pa: f64 [1e3, 1e15],
        /// Poisson's ratio of the bearing.
        poisson_ratio: f64 [0.0, 0.5],
        /// Nominal restitution.
        restitution: f64 [1e-6, 1.0],
    }
}
section! {
    /// Normal law of the contact.
    ContactSection {
        /// Stiffness part.
        stiffness: StiffnessName,
        /// Dissipation factor.
        dissipation: DissipationName,
        /// Floor of the latched approach speed; the reference speed with `damping = "reference"`.
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
    }
}
section! {
    /// Friction law of the contact; see `contact::FrictionLaw` and the catalogue of `contact`.
    FrictionSection {
        /// Name of the law; Stribeck's without one. With `coulomb`, `karnopp` and `seven-parameter`
        /// the contact sticks and slides, and the integrator locates the changes.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        law: Option<FrictionName>,
        /// Coefficient at high speed.
        coulomb_coefficient: f64 [0.0, 10.0],
        /// Coefficient at the onset of sliding; the break-away limit of a contact that sticks.
        static_coefficient: f64 [0.0, 10.0],
        /// Stribeck speed.
        stribeck_speed_m_s: f64 [1e-9, HUGE],
        /// Stribeck exponent by name.
        shape: ShapeName,
        /// Slope of the coefficient over the speed; 0 for `brown-mcphee`.
        viscous_slope_s_m: f64 [-1e3, 1e3],
        /// Speed where the slope begins.
        viscous_onset_m_s: f64 [0.0, HUGE],
        /// Width of the regularised sign: sliding speed below which friction rises smoothly. For
        /// `karnopp` the band that counts as standstill; `coulomb` has none.
        regularisation_m_s: f64 [1e-9, 1e3],
        /// Speed up to which Ambrosio's law gives no friction.
        #[serde(default, skip_serializing_if = "is_zero")]
        still_speed_m_s: f64 [0.0, 1e3],
        /// Slope of the friction force over the speed, for `brown-mcphee`.
        #[serde(default, skip_serializing_if = "is_zero")]
        viscous_damping_n_s_m: f64 [0.0, 1e9],
        /// Force over which the viscous part of Brown and McPhee's law develops.
        #[serde(default = "one", skip_serializing_if = "is_one")]
        transition_force_n: f64 [1e-9, HUGE],
        /// Stiffness of the bristles, for `dahl` and `lugre`; of the sticking contact for
        /// `seven-parameter`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        bristle_stiffness_per_m: Option<f64>,
        /// Damping of the bristles, for `lugre`.
        #[serde(default, skip_serializing_if = "is_zero")]
        bristle_damping_s_m: f64 [0.0, HUGE],
        /// Factor on the total coefficient: the "friction level" of `[uncertain]`.
        #[serde(default = "one")]
        level: f64 [0.0, 10.0],
    }
}
section! {
    /// Memory of the friction law `seven-parameter`; no other law uses it.
    FrictionMemory {
        /// Time by which the Stribeck part lags the sliding speed.
        lag_s: f64 [1e-6, 1e6],
        /// Time at standstill after which half of the static excess has recovered.
        rise_s: f64 [1e-9, 1e9],
    }
}
section! {
    /// Motion of the drive: velocity `V sin(wt)`, so a one-sided stroke `(X/2)(1 - cos wt)`. With
    /// `[drive_profile]` stroke and period are typical ones, and a run is as long as the cycles.
    Drive {
        /// Stroke `X`, at most 0.99 of the drive crank.
        stroke_m: f64 [1e-9, 990.0],
        /// Period.
        period_s: f64 [1e-3, 1e6],
        /// Cycles of a run.
        cycles: u32 [1.0, 1e6],
    }
}
section! {
    /// Play between fork and crank; see `plants::transmission::fork`.
    Fork {
        /// Total play, at most a tenth of the drive crank.
        backlash_m: f64 [0.0, 100.0],
        /// Stiffness of fork and pin.
        #[serde(default = "fork_stiffness_n_m")]
        stiffness_n_m: f64 [1.0, 1e15],
        /// Relative gain of the force per closing speed.
        #[serde(default = "one")]
        damping_s_m: f64 [0.0, 1e6],
    }
}
section! {
    /// Friction of the load cylinder against the motion: `coulomb_n tanh(v/v_r) + viscous_n_s_m v`.
    LoadFriction {
        /// Dry friction.
        coulomb_n: f64 [0.0, 1e7],
        /// Viscous friction.
        #[serde(default)]
        viscous_n_s_m: f64 [0.0, 1e9],
        /// Width `v_r` of the regularised sign.
        #[serde(default = "millimetre_per_second")]
        regularisation_m_s: f64 [1e-9, 1e3],
    }
}
section! {
    /// Tilt of the shaft in its bearing; see `plants::two_plane`.
    TwoPlaneSection {
        /// Slices of the bearing along its length.
        #[serde(default = "eleven")]
        slices: u32 [1.0, 201.0],
        /// Moment of inertia about an axis across the shaft.
        #[serde(default = "transverse_inertia_kg_m2")]
        transverse_inertia_kg_m2: f64 [1e-6, 1e9],
        /// Plane of the drive crank from the bearing's middle.
        #[serde(default)]
        drive_offset_m: f64 [-10.0, 10.0],
        /// Plane of the load crank from the bearing's middle.
        #[serde(default)]
        load_offset_m: f64 [-10.0, 10.0],
        /// Slope of the bearing's axis in Y.
        #[serde(default)]
        misalignment_y_rad: f64 [-0.1, 0.1],
        /// Slope of the bearing's axis in Z.
        #[serde(default)]
        misalignment_z_rad: f64 [-0.1, 0.1],
        /// Stiffness of additional supports against tilt.
        #[serde(default)]
        support_stiffness_nm_rad: f64 [0.0, 1e15],
        /// Damping of additional supports against tilt.
        #[serde(default)]
        support_damping_nm_s_rad: f64 [0.0, HUGE],
    }
}

impl Default for TwoPlaneSection {
    fn default() -> Self {
        Self {
            slices: eleven(),
            transverse_inertia_kg_m2: transverse_inertia_kg_m2(),
            drive_offset_m: 0.0,
            load_offset_m: 0.0,
            misalignment_y_rad: 0.0,
            misalignment_z_rad: 0.0,
            support_stiffness_nm_rad: 0.0,
            support_damping_nm_s_rad: 0.0,
        }
    }
}

/// Stribeck exponents that a description may name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShapeName {
    /// Exponent 1.
    Tustin,
    /// Exponent 2.
    Gauss,
}

named_field!(ShapeName { Tustin "tustin", Gauss "gauss" });

/// Stiffness of a steel fork on its pin: 10 kN deform it by 0.1 mm.
fn fork_stiffness_n_m() -> f64 {
    1e8
}

fn millimetre_per_second() -> f64 {
    1e-3
}

fn eleven() -> u32 {
    11
}

/// Transverse inertia of a shaft of 150 kg over 0.9 m. It is an assumption, as is the polar
/// inertia.
fn transverse_inertia_kg_m2() -> f64 {
    10.0
}

plant_description! {
    /// Description of the transmission bench.
    TransmissionBench as TransmissionFile "TransmissionFile", plant "transmission-bench",
    extension Extension {
        /// Always `transmission-bench`.
        plant: String,
        /// Levers.
        geometry: Geometry,
        /// Shaft.
        shaft: Shaft,
        /// Clearance bearing.
        bearing: Bearing,
        /// Normal law.
        contact: ContactSection,
        /// Friction law.
        friction: FrictionSection,
        /// Memory of the friction law `seven-parameter`; without it for the other laws.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        friction_memory: Option<FrictionMemory>,
        /// Drive motion.
        drive: Drive,
        /// Load.
        load: Load,
        /// Course of the drive in place of the sine of `[drive]`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        drive_profile: Option<CourseSection>,
        /// Course that is added to the load.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        load_profile: Option<CourseSection>,
        /// Rudder servo; without it the fork follows the described motion of the drive.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        servo: Option<Servo>,
        /// Start of a run; without it the journal drops through a thousandth of the clearance.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        start: Option<Start>,
        /// Play in the fork; without it the fork is rigid, unless an effect adds a hydraulic
        /// column.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        fork: Option<Fork>,
        /// Tilt of the shaft; without it the bench is planar.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        two_plane: Option<TwoPlaneSection>,
        /// Friction of the load cylinder; without it the cylinder is frictionless.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        load_friction: Option<LoadFriction>,
        /// Wear; only `host-sim life` uses it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        wear: Option<WearSection>,
        /// Thermal and swelling change of the clearance; only `host-sim life` uses it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        thermal: Option<ThermalSection>,
        /// Lubricant film; only `host-sim life` uses it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        film: Option<FilmSection>,
        /// Length of a life and its jumps; only `host-sim life` uses it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        life: Option<LifeSection>,
        /// Log.
        logging: Logging,
    }
}

impl LoadFriction {
    /// Force on the load crank's pin along +Y in N at the pin's speed.
    pub(crate) fn force_n(&self, rate_m_s: f64) -> f64 {
        -self.coulomb_n * (rate_m_s / self.regularisation_m_s).tanh() - self.viscous_n_s_m * rate_m_s
    }
}
