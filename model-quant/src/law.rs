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

/// The deformation in m at rest that carries a load in N under the normal law, by bisection: the force grows with it. None
/// if it is deeper than `deepest_m`.
pub fn depth_m(bearing: Bearing, radial_clearance_m: f64, load_n: f64, deepest_m: f64) -> Option<f64> {
    // At rest the floor does not matter.
    let law = normal_law(bearing, radial_clearance_m, 1.0);
    let force_n = |deformation_m| law.force_n(deformation_m, 0.0, 0.0);
    let (mut low, mut high) = (0.0, deepest_m);
    if force_n(high) < load_n {
        return None;
    }
    // Halved until neighbouring floats are left.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if force_n(middle) < load_n {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_depth_carries_the_load() {
        for bearing in Bearing::ALL {
            let depth = depth_m(bearing, 5e-4, 5e3, 1e-3).unwrap();
            let force = normal_law(bearing, 5e-4, 1e-3).force_n(depth, 0.0, 0.0);
            assert!((force / 5e3 - 1.0).abs() < 1e-9, "{bearing:?}");
            assert_eq!(depth_m(bearing, 5e-4, 5e3, 0.9 * depth), None);
        }
    }
}
