//! Description of the transmission bench.

use super::{BearingMaterial, Extension, Load, Logging, Nuisances, is_one, is_zero, one};
use crate::channel::Channel;
use crate::effects::Effect;
use crate::law_names::{DampingName, DissipationName, FrictionName, StiffnessName, WholeName};
use crate::log_format::{Columns, TextFormat};
use crate::sensor::Sensor;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

section! {
    /// Levers and stroke of the transmission bench.
    Geometry {
        /// Drive crank `R_d` in m.
        drive_lever_radius_m: f64,
        /// Load crank `R_l` in m.
        load_lever_radius_m: f64,
    }
}
section! {
    /// The shaft with everything that moves with it.
    Shaft {
        /// Mass in kg.
        mass_kg: f64,
        /// Moment of inertia about its axis in kg m2.
        inertia_kg_m2: f64,
    }
}
section! {
    /// The clearance bearing.
    Bearing {
        /// Material name, for the choice of the trained networks.
        material: BearingMaterial,
        /// Bearing radius `R_B` in m.
        bearing_radius_m: f64,
        /// Radial clearance `D` in m.
        radial_clearance_m: f64,
        /// Bearing length in m.
        length_m: f64,
        /// Young's modulus of the bearing in Pa.
        youngs_modulus_pa: f64,
        /// Poisson's ratio of the bearing.
        poisson_ratio: f64,
        /// Nominal restitution.
        restitution: f64,
    }
}
section! {
    /// Normal law of the contact.
    ContactSection {
        /// Stiffness part.
        stiffness: StiffnessName,
        /// Dissipation factor.
        dissipation: DissipationName,
        /// Floor of the latched approach speed in m/s; the reference speed where `damping` is `reference`.
        latch_floor_m_s: f64,
        /// What the rate is compared with.
        #[serde(default, skip_serializing_if = "DampingName::is_latched")]
        damping: DampingName,
        /// A law with a damping of its own in place of stiffness and dissipation.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        law: Option<WholeName>,
        /// `K` in N/m^n, for laws that do not compute it from the joint.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        coefficient: Option<f64>,
        /// `n`, for laws that leave it open.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        exponent: Option<f64>,
        /// Damping in N s/m of `kelvin-voigt`, full damping of `adams-impact`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        damping_n_s_m: Option<f64>,
        /// Depth of full damping in m of `adams-impact`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        full_damping_depth_m: Option<f64>,
    }
}
section! {
    /// Friction law of the contact; see `contact::FrictionLaw` and the catalogue of `contact`.
    FrictionSection {
        /// Another law than Stribeck's.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        law: Option<FrictionName>,
        /// Coefficient at high speed.
        coulomb_coefficient: f64,
        /// Coefficient at the onset of sliding.
        static_coefficient: f64,
        /// Stribeck speed in m/s.
        stribeck_speed_m_s: f64,
        /// Stribeck exponent by name.
        shape: ShapeName,
        /// Slope over speed in s/m.
        viscous_slope_s_m: f64,
        /// Speed where the slope begins, m/s.
        viscous_onset_m_s: f64,
        /// Width of the regularised sign in m/s.
        regularisation_m_s: f64,
        /// Speed in m/s up to which Ambrosio's law gives no friction.
        #[serde(default, skip_serializing_if = "is_zero")]
        still_speed_m_s: f64,
        /// Force in N over which the viscous part of Brown and McPhee's law develops.
        #[serde(default = "one", skip_serializing_if = "is_one")]
        transition_force_n: f64,
        /// Stiffness of the bristles in 1/m, for `dahl` and `lugre`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        bristle_stiffness_per_m: Option<f64>,
        /// Damping of the bristles in s/m, for `lugre`.
        #[serde(default, skip_serializing_if = "is_zero")]
        bristle_damping_s_m: f64,
        /// Factor on the whole coefficient: what "friction level" means in `[uncertain]`.
        #[serde(default = "one")]
        level: f64,
    }
}
section! {
    /// Motion of the drive: `V sin(wt)`, so a one-sided stroke `(X/2)(1 - cos wt)`.
    Drive {
        /// Stroke `X` in m.
        stroke_m: f64,
        /// Period in s.
        period_s: f64,
        /// Cycles of a run.
        cycles: u32,
    }
}
section! {
    /// Play between fork and crank; see `transmission::fork`.
    Fork {
        /// Whole play in m.
        backlash_m: f64,
        /// Stiffness of fork and pin in N/m.
        #[serde(default = "fork_stiffness_n_m")]
        stiffness_n_m: f64,
        /// Relative gain of the force per closing speed, s/m.
        #[serde(default = "one")]
        damping_s_m: f64,
    }
}
section! {
    /// Friction of the load cylinder: `coulomb_n tanh(v/v_r) + viscous_n_s_m v`, against the motion.
    LoadFriction {
        /// Dry friction in N.
        coulomb_n: f64,
        /// Viscous friction in N s/m.
        #[serde(default)]
        viscous_n_s_m: f64,
        /// Width `v_r` of the regularised sign in m/s.
        #[serde(default = "millimetre_per_second")]
        regularisation_m_s: f64,
    }
}
section! {
    /// Tilt of the shaft in its bearing; see `two_plane`.
    TwoPlaneSection {
        /// Slices of the bearing along its length.
        #[serde(default = "eleven")]
        slices: u32,
        /// Moment of inertia about an axis across the shaft, kg m2.
        #[serde(default = "transverse_inertia_kg_m2")]
        transverse_inertia_kg_m2: f64,
        /// Plane of the drive crank from the bearing's middle, m.
        #[serde(default)]
        drive_offset_m: f64,
        /// Plane of the load crank from the bearing's middle, m.
        #[serde(default)]
        load_offset_m: f64,
        /// Slope of the bearing's axis in Y, rad.
        #[serde(default)]
        misalignment_y_rad: f64,
        /// Slope of the bearing's axis in Z, rad.
        #[serde(default)]
        misalignment_z_rad: f64,
        /// Stiffness of further supports against tilt, N m/rad.
        #[serde(default)]
        support_stiffness_nm_rad: f64,
        /// Their damping, N m s/rad.
        #[serde(default)]
        support_damping_nm_s_rad: f64,
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

/// A steel fork on its pin: 10 kN press it by 0.1 mm.
fn fork_stiffness_n_m() -> f64 {
    1e8
}

fn millimetre_per_second() -> f64 {
    1e-3
}

fn eleven() -> u32 {
    11
}

/// A shaft of 150 kg over 0.9 m: an assumption, as the bench's polar inertia is.
fn transverse_inertia_kg_m2() -> f64 {
    10.0
}

/// Description of the transmission bench.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TransmissionBench {
    /// Always `transmission-bench`.
    pub plant: String,
    /// Levers.
    pub geometry: Geometry,
    /// Shaft.
    pub shaft: Shaft,
    /// Clearance bearing.
    pub bearing: Bearing,
    /// Normal law.
    pub contact: ContactSection,
    /// Friction law.
    pub friction: FrictionSection,
    /// Drive motion.
    pub drive: Drive,
    /// Load.
    pub load: Load,
    /// Play in the fork; none: the fork is rigid, or the hydraulic column of an effect.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fork: Option<Fork>,
    /// Tilt of the shaft; none: the planar bench.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub two_plane: Option<TwoPlaneSection>,
    /// Friction of the load cylinder; none: frictionless.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_friction: Option<LoadFriction>,
    /// Log.
    pub logging: Logging,
    /// Sensors by channel.
    #[serde(default)]
    pub sensors: BTreeMap<Channel, Sensor>,
    /// Standard deviation of what calibration may move, by parameter name.
    #[serde(default)]
    pub uncertain: BTreeMap<String, f64>,
    /// What is a session's own.
    #[serde(default, skip_serializing_if = "Nuisances::is_empty")]
    pub nuisances: Nuisances,
    /// How a foreign log is read.
    #[serde(default, skip_serializing_if = "TextFormat::is_default")]
    pub log: TextFormat,
    /// Where a foreign log's signals come from.
    #[serde(default, skip_serializing_if = "Columns::is_empty")]
    pub columns: Columns,
    /// Extensions beyond the nominal model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<Effect>,
    /// What effects switch on; never in a file.
    #[serde(skip)]
    pub extension: Extension,
}
