//! Laws of a mechanism's contacts: an entry of `[[contact]]`, which joints name.

use crate::description::law_names::{
    CompleteLawName, DampingName, DissipationName, FrictionName, StiffnessName,
};
use crate::description::{ContactSection, FrictionSection, ShapeName, is_one, is_zero, one};
use crate::schema::{HUGE, TINY, section};
use ::contact::{BearingMaterial, DEFAULT_LATCH_FLOOR_M_S, Material, StiffnessKind};

section! {
    /// Laws of contacts, by name. The modulus is that of both bodies, unless the journal has its
    /// own. Without friction coefficients a contact is frictionless.
    ContactEntry {
        /// Name, for joints.
        name: String,
        /// Networks that give the forces of this contact in place of the laws: those of a bearing
        /// material. Only for joints of kind `clearance`; the laws remain those of `--force law`
        /// and of the elastic energy.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        network: Option<BearingMaterial>,
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
        /// Friction law; Stribeck's without one. `coulomb`, `karnopp` and `seven-parameter` are
        /// refused: a contact of a mechanism does not stick.
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
