//! Angle of a direction, with the same bits on every machine.

use core::f32::consts::{FRAC_PI_2, PI};

/// Returns the angle of a direction of length 1 from +y towards +z, rad, with an error of 3e-6.
///
/// It is an odd minimax polynomial of the arctangent in the first eighth of the circle, the rest by
/// symmetry: additions, multiplications and one division.
pub(super) fn angle_rad(y: f32, z: f32) -> f32 {
    let (across, along) = (y.abs(), z.abs());
    let is_steep = along > across;
    let (short, long) = if is_steep { (across, along) } else { (along, across) };
    // The longer component of a direction is .7 at least.
    let x = if long > 0.5 { short / long } else { 0.0 };
    let s = x * x;
    let eighth = x
        * (0.999_996_1
            + s * (-0.333_173_7
                + s * (0.198_078_15
                    + s * (-0.132_333_42 + s * (0.079_623_66 + s * (-0.033_604_21 + s * 0.006_811_79))))));
    let steep = if is_steep { FRAC_PI_2 - eighth } else { eighth };
    let half = if y < 0.0 { PI - steep } else { steep };
    if z < 0.0 { -half } else { half }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn angles_are_those_of_the_standard_library(angle in -core::f32::consts::PI..core::f32::consts::PI) {
            let (z, y) = angle.sin_cos();
            prop_assert!((angle_rad(y, z) - angle).abs() < 3e-6);
        }
    }

    #[test]
    fn what_is_no_direction_has_an_angle_too() {
        for (y, z) in [(0.0, 0.0), (f32::NAN, 0.0), (1e30, -1e30)] {
            assert!(angle_rad(y, z).abs() <= PI, "{y} {z}");
        }
    }
}
