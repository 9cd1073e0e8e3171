//! The laws that the networks learn: those of the default bench.

use contact::{Dissipation, FrictionLaw, Material, NormalLaw, Stiffness, effective_modulus_pa};
use inference::Bearing;

/// The hybrid normal law as printed, Zhiying-Qishao dissipation, at one radial clearance in m.
pub fn normal_law(bearing: Bearing, radial_clearance_m: f64, latch_floor_m_s: f64) -> NormalLaw {
    let (material, restitution) = match bearing {
        Bearing::Babbitt => (Material::BABBITT, 0.4),
        Bearing::Plastic => (Material::PLASTIC, 0.8),
    };
    NormalLaw {
        stiffness: Stiffness::HybridAsPrinted {
            effective_modulus_pa: effective_modulus_pa(&material, &Material::STEEL),
            radial_clearance_m,
        },
        dissipation: Dissipation::ZhiyingQishao,
        restitution,
        latch_floor_m_s,
    }
}

/// The dry friction law of the bench.
pub fn friction_law(bearing: Bearing) -> FrictionLaw {
    match bearing {
        Bearing::Babbitt => FrictionLaw::BABBITT_BENCH,
        Bearing::Plastic => FrictionLaw::PLASTIC_BENCH,
    }
}
