//! Inverse of the normal law of the default bench.

use contact::BearingMaterial;

/// Radial clearance of the default bench, m: that of all static states.
pub(crate) const CLEARANCE_M: f64 = 0.5e-3;

/// Static deformation in m under a load in N, by bisection: the force increases with the
/// deformation. None if it exceeds `deepest_m`.
pub(crate) fn static_deformation_m(
    bearing: BearingMaterial,
    radial_clearance_m: f64,
    load_n: f64,
    deepest_m: f64,
) -> Option<f64> {
    // At standstill the floor has no effect.
    let law = bearing.normal_law(radial_clearance_m, 1.0);
    let force_n = |deformation_m| law.force_n(deformation_m, 0.0, 0.0);
    let (mut low, mut high) = (0.0, deepest_m);
    if force_n(high) < load_n {
        return None;
    }
    // 60 halvings end at neighbouring floats.
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
    fn the_static_deformation_carries_the_load() {
        for bearing in BearingMaterial::ALL {
            let depth = static_deformation_m(bearing, 5e-4, 5e3, 1e-3).unwrap();
            let force = bearing.normal_law(5e-4, 1e-3).force_n(depth, 0.0, 0.0);
            assert!((force / 5e3 - 1.0).abs() < 1e-9, "{bearing:?}");
            assert_eq!(static_deformation_m(bearing, 5e-4, 5e3, 0.9 * depth), None);
        }
    }
}
