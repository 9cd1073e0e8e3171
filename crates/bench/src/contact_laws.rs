//! Contact and friction laws by the names that a description gives them.

use crate::description::{
    BearingMaterial, ContactSection, DissipationName, ShapeName, StiffnessName, TransmissionBench,
};
use contact::{
    Dissipation, FrictionLaw, Material, NormalLaw, Stiffness, StribeckShape, effective_modulus_pa,
};

/// The normal law of a transmission bench's description: bearing on steel shaft.
pub(crate) fn normal_law(bench: &TransmissionBench) -> NormalLaw {
    let bearing = Material {
        youngs_modulus_pa: bench.bearing.youngs_modulus_pa,
        poisson_ratio: bench.bearing.poisson_ratio,
    };
    let effective_modulus_pa = effective_modulus_pa(&bearing, &Material::STEEL);
    let radial_clearance_m = bench.bearing.radial_clearance_m;
    let ContactSection { stiffness, dissipation, latch_floor_m_s } = bench.contact;
    NormalLaw {
        stiffness: match stiffness {
            StiffnessName::HybridAsPrinted => {
                Stiffness::HybridAsPrinted { effective_modulus_pa, radial_clearance_m }
            }
            StiffnessName::LiuTimesLength => Stiffness::LiuTimesLength {
                effective_modulus_pa,
                radial_clearance_m,
                length_m: bench.bearing.length_m,
            },
        },
        dissipation: dissipation.law(),
        restitution: bench.bearing.restitution,
        latch_floor_m_s,
    }
}

impl TransmissionBench {
    /// The friction law of the description, without its level.
    pub fn friction_law(&self) -> FrictionLaw {
        let f = &self.friction;
        FrictionLaw {
            coulomb_coefficient: f.coulomb_coefficient,
            static_coefficient: f.static_coefficient,
            stribeck_speed_m_s: f.stribeck_speed_m_s,
            shape: match f.shape {
                ShapeName::Tustin => StribeckShape::Tustin,
                ShapeName::Gauss => StribeckShape::Gauss,
            },
            viscous_slope_s_m: f.viscous_slope_s_m,
            viscous_onset_m_s: f.viscous_onset_m_s,
            regularisation_m_s: f.regularisation_m_s,
        }
    }
}

impl DissipationName {
    /// The law of the name.
    pub const fn law(self) -> Dissipation {
        match self {
            Self::None => Dissipation::None,
            Self::HuntCrossley => Dissipation::HuntCrossley,
            Self::LankaraniNikravesh => Dissipation::LankaraniNikravesh,
            Self::ZhiyingQishao => Dissipation::ZhiyingQishao,
        }
    }
}

impl BearingMaterial {
    /// The name in descriptions and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Babbitt => "babbitt",
            Self::Plastic => "plastic",
        }
    }
}
