//! Change of the radial clearance with temperature and water uptake.
//!
//! Free expansion of shaft and housing; the lining is bonded to the housing and grows inwards:
//! `dD = a_h T_h (R_B + t) - (a_l T_l + w) t - a_s T_s R_J` with the expansions `a`, the rises of
//! temperature `T`, the lining's thickness `t` and its relative swelling `w`. Water enters from the
//! bore by Fick's law: a sheet with one sealed side, `w(t)/w_inf = 1 - sum 8/((2n+1)^2 pi^2)
//! exp(-(2n+1)^2 pi^2 C t/(4 t_l^2))` (Crank, The Mathematics of Diffusion, 1975, section 4.3).
//! Constraint of the lining along its length is neglected: it would add `2 nu/(1 - nu)` of its
//! strain at most.

use std::f64::consts::PI;

/// Terms of the series. The first neglected one is below 1e-4 for a share above 0.005.
const TERMS: u32 = 200;

/// Radii and thickness in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radii {
    /// Bore of the lining.
    pub bearing_m: f64,
    /// Shaft.
    pub journal_m: f64,
    /// Thickness of the lining.
    pub lining_m: f64,
}

/// A relative growth of shaft, housing and lining: expansion times rise of temperature, and
/// swelling.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Growth {
    /// Growth of the shaft.
    pub shaft: f64,
    /// Growth of the housing.
    pub housing: f64,
    /// Growth of the lining's thickness.
    pub lining: f64,
}

/// Change of the radial clearance in m.
pub(crate) fn clearance_change_m(radii: &Radii, growth: &Growth) -> f64 {
    growth.housing * (radii.bearing_m + radii.lining_m)
        - growth.lining * radii.lining_m
        - growth.shaft * radii.journal_m
}

/// Share of the saturation swelling after a time in s, at a diffusivity in m2/s, for a lining of a
/// thickness in m that is wet on one side.
pub(crate) fn uptake_share(time_s: f64, diffusivity_m2_s: f64, thickness_m: f64) -> f64 {
    let depth = diffusivity_m2_s * time_s / (thickness_m * thickness_m);
    if depth < 1e-3 {
        // The sheet is as good as infinitely thick.
        return 2.0 * (depth.max(0.0) / PI).sqrt();
    }
    let term = |n: u32| {
        let odd = f64::from(2 * n + 1) * PI;
        8.0 / (odd * odd) * (-odd * odd * depth / 4.0).exp()
    };
    1.0 - (0..TERMS).map(term).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADII: Radii = Radii { bearing_m: 70e-3, journal_m: 69.5e-3, lining_m: 7.6e-3 };

    #[test]
    fn one_material_at_one_temperature_keeps_its_shape() {
        let growth = Growth { shaft: 1e-3, housing: 1e-3, lining: 1e-3 };
        assert!((clearance_change_m(&RADII, &growth) - 1e-3 * 0.5e-3).abs() < 1e-15);
    }

    #[test]
    fn each_part_changes_the_clearance_by_its_own_size() {
        let change =
            |shaft, housing, lining| clearance_change_m(&RADII, &Growth { shaft, housing, lining }) * 1e6;
        // 40 K: steel 12e-6/K, plastic 90e-6/K.
        assert!((change(40.0 * 12e-6, 0.0, 0.0) + 33.36).abs() < 1e-9);
        assert!((change(0.0, 40.0 * 12e-6, 0.0) - 37.248).abs() < 1e-9);
        assert!((change(0.0, 0.0, 40.0 * 90e-6) + 27.36).abs() < 1e-9);
    }

    /// Crank, table 4.1 and figure 4.6: half of the uptake at `C t/l^2 = 0.197`, and `2 sqrt(C
    /// t/(pi l^2))` before.
    #[test]
    fn water_enters_by_ficks_law() {
        let share = |depth: f64| uptake_share(depth * 4e-4 / 1e-12, 1e-12, 0.02);
        assert!((share(0.1968) - 0.5).abs() < 1e-3, "{}", share(0.1968));
        for depth in [1.1e-3, 0.01, 0.05] {
            assert!((share(depth) / (2.0 * (depth / PI).sqrt()) - 1.0).abs() < 1e-3, "{depth}");
        }
        assert!((share(9.99e-4) / share(1.001e-3) - 1.0).abs() < 2e-3, "no step where the series begins");
        assert!(share(0.0) == 0.0 && share(10.0) > 0.999_999);
    }
}
