//! Archard's law on the circumferential profiles of bearing and journal: `dh = k p ds`.
//!
//! `k` is the specific wear rate in m3/(N m) (Archard, J. Appl. Phys. 24 (1953) 981, with `k` his
//! coefficient over the hardness), `p` the pressure of [`Foundation`] and `s` the sliding distance.
//! The bearing wears in its own frame, the journal in one that turns with the shaft. Wear of
//! clearance joints in multibody models: Flores, Mech. Mach. Theory 44 (2009) 1211.
//!
//! A step over many cycles is implicit: the wear of the step relieves the pressure that causes it,
//! as if the lining were softer by `k s`. Explicit steps are unstable as soon as they wear more
//! than the lining yields, which for Babbitt are some ten cycles.

use super::foundation::{CELLS, Foundation, Unbalanced};
use std::f64::consts::TAU;

/// Wear depths of bearing and journal in m, by cell of the circumference.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Depth of the bearing, from +Y towards +Z.
    pub bearing_m: Vec<f64>,
    /// Depth of the journal, in a frame that turns with the shaft.
    pub journal_m: Vec<f64>,
}

impl Profile {
    /// Creates a profile without wear.
    pub(crate) fn unworn() -> Self {
        Self { bearing_m: vec![0.0; CELLS], journal_m: vec![0.0; CELLS] }
    }

    /// Largest depth of either surface in m.
    pub fn largest_depth_m(&self) -> f64 {
        self.bearing_m.iter().chain(&self.journal_m).copied().fold(0.0, f64::max)
    }

    /// Largest difference of a cell from another profile in m.
    pub(crate) fn difference_m(&self, other: &Self) -> f64 {
        let surfaces = [(&self.bearing_m, &other.bearing_m), (&self.journal_m, &other.journal_m)];
        let pairs = surfaces.into_iter().flat_map(|(a, b)| a.iter().zip(b));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// Gap of every cell of the bearing at the centred journal, m, at an angle of the shaft.
    pub fn gap_m(&self, clearance_m: f64, shaft_angle_rad: f64, gap_m: &mut [f64]) {
        let turned = journal_cell(0, shaft_angle_rad);
        let journal = self.journal_m.iter().cycle().skip(turned);
        for ((gap, bearing), journal) in gap_m.iter_mut().zip(&self.bearing_m).zip(journal) {
            *gap = clearance_m + bearing + journal;
        }
    }
}

/// Cell of the journal that faces a cell of the bearing.
fn journal_cell(cell: usize, shaft_angle_rad: f64) -> usize {
    let turned = (shaft_angle_rad.rem_euclid(TAU) / TAU * CELLS as f64).round() as usize;
    (cell + 2 * CELLS - turned) % CELLS
}

/// Load of the contact over a short time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Normal force of the journal on the bearing, N along Y and Z.
    pub force_n: [f64; 2],
    /// Angle of the shaft, rad.
    pub shaft_angle_rad: f64,
    /// Sliding distance, m, not negative.
    pub sliding_m: f64,
}

/// Wear of a bearing and its journal.
#[derive(Clone, Debug)]
pub struct Wear {
    /// Elastic foundation.
    pub foundation: Foundation,
    /// Specific wear rate of the bearing, m3/(N m).
    pub bearing_m3_nm: f64,
    /// Specific wear rate of the journal, m3/(N m).
    pub journal_m3_nm: f64,
}

impl Wear {
    /// Wears a profile by a number of equal cycles, whose loads follow each other.
    ///
    /// # Errors
    ///
    /// The pressure does not balance a load.
    pub fn advance(
        &self,
        profile: &Profile,
        clearance_m: f64,
        loads: &[Load],
        cycles: f64,
    ) -> Result<Profile, Unbalanced> {
        let mut worn = profile.clone();
        let (mut gap_m, mut pressure_pa) = (vec![0.0; CELLS], vec![0.0; CELLS]);
        for load in loads {
            let distance_m = load.sliding_m * cycles;
            worn.gap_m(clearance_m, load.shaft_angle_rad, &mut gap_m);
            let relief = (self.bearing_m3_nm + self.journal_m3_nm) * distance_m;
            self.foundation.pressure_pa(&gap_m, load.force_n, relief, &mut pressure_pa)?;
            for (cell, pressure) in pressure_pa.iter().enumerate().filter(|(_, p)| **p > 0.0) {
                worn.bearing_m[cell] += self.bearing_m3_nm * pressure * distance_m;
                worn.journal_m[journal_cell(cell, load.shaft_angle_rad)] +=
                    self.journal_m3_nm * pressure * distance_m;
            }
        }
        Ok(worn)
    }

    /// Worn volume of both surfaces in m3.
    pub fn volume_m3(&self, profile: &Profile) -> f64 {
        let depth_m: f64 = profile.bearing_m.iter().chain(&profile.journal_m).sum();
        depth_m * self.foundation.cell_area_m2()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const RADIUS_M: f64 = 0.07;
    const LENGTH_M: f64 = 0.14;
    const FORCE_N: f64 = 8e3;
    const RATE: f64 = 6e-14;

    fn wear(modulus: f64, bearing_m3_nm: f64, journal_m3_nm: f64) -> Wear {
        Wear { foundation: Foundation::new(modulus, RADIUS_M, LENGTH_M), bearing_m3_nm, journal_m3_nm }
    }

    fn load(shaft_angle_rad: f64, sliding_m: f64) -> Load {
        Load { force_n: [0.0, -FORCE_N], shaft_angle_rad, sliding_m }
    }

    /// Without clearance the pressure is `2 F/(pi R L) cos`, worn or not: the bearing wears by
    /// `(4/pi) k F s/(2 R L)` at its bottom and by the worn volume `(4/pi) k F s`.
    #[test]
    fn a_bearing_without_clearance_wears_as_the_cosine_of_the_angle() {
        let wear = wear(7e11, RATE, 0.0);
        let (clearance_m, distance_m) = (1e-12, 1e4);
        let mut profile = Profile::unworn();
        for _ in 0..10 {
            profile = wear.advance(&profile, clearance_m, &[load(0.0, 0.1)], distance_m).unwrap();
        }
        let bottom_m = 4.0 / PI * RATE * FORCE_N * distance_m / (2.0 * RADIUS_M * LENGTH_M);
        let found = |degrees: usize| profile.bearing_m[CELLS * degrees / 360];
        assert!((found(270) / bottom_m - 1.0).abs() < 2e-3, "{} {bottom_m}", found(270));
        assert!((found(330) / (0.5 * bottom_m) - 1.0).abs() < 5e-3, "{}", found(330));
        assert_eq!(found(90), 0.0);
        let volume = 4.0 / PI * RATE * FORCE_N * distance_m;
        assert!((wear.volume_m3(&profile) / volume - 1.0).abs() < 2e-3);
    }

    /// Rigid bodies with clearance: `k F s = R L D (a/cos a - sin a)`, `cos a = D/(D + h)`. Each
    /// cell wears as the journal reaches it, so `p = (dh/ds) cos/k` within the half-angle `a`.
    #[test]
    fn a_bearing_with_clearance_wears_into_the_pocket_of_the_closed_form() {
        let wear = wear(9e12, RATE, 0.0);
        let clearance_m = 0.5e-3;
        let (mut profile, mut distance_m) = (Profile::unworn(), 0.0);
        let mut step_m = 1.0;
        for depth_um in [20.0, 100.0, 400.0] {
            let half_angle = (clearance_m / (clearance_m + depth_um * 1e-6_f64)).acos();
            let shape = half_angle / half_angle.cos() - half_angle.sin();
            let expected_m = RADIUS_M * LENGTH_M * clearance_m * shape / (RATE * FORCE_N);
            while distance_m < expected_m {
                let sliding_m = f64::min(step_m, expected_m - distance_m);
                profile = wear.advance(&profile, clearance_m, &[load(0.0, sliding_m)], 1.0).unwrap();
                distance_m += sliding_m;
                step_m = 0.02 * distance_m.max(50.0);
            }
            let found_um = profile.bearing_m[CELLS * 3 / 4] * 1e6;
            assert!((found_um / depth_um - 1.0).abs() < 0.03, "{found_um} {depth_um}");
            let cells = profile.bearing_m.iter().filter(|h| **h > 0.01 * found_um * 1e-6).count();
            let found_angle = 0.5 * cells as f64 * TAU / CELLS as f64;
            assert!((found_angle / half_angle - 1.0).abs() < 0.05, "{found_angle} {half_angle}");
        }
    }

    /// A turning journal under a constant load: its circumference wears evenly, and the volume is
    /// `k F s` times the ratio of the total pressure to the load.
    #[test]
    fn a_turning_journal_wears_evenly() {
        let wear = wear(7e11, 0.0, RATE);
        let loads: Vec<Load> =
            (0..CELLS).map(|i| load(TAU * i as f64 / CELLS as f64, TAU * RADIUS_M / CELLS as f64)).collect();
        let (turns, clearance_m) = (100.0, 0.5e-3);
        let worn = wear.advance(&Profile::unworn(), clearance_m, &loads, turns).unwrap();
        let mean_m = worn.journal_m.iter().sum::<f64>() / CELLS as f64;
        assert!(worn.journal_m.iter().all(|h| (h / mean_m - 1.0).abs() < 0.05));
        assert!(worn.bearing_m.iter().all(|h| *h == 0.0));
        // The contact is narrow: the sum of the pressures is the load, up to the cosine.
        let plain_m = RATE * FORCE_N * turns / LENGTH_M;
        assert!((0.99..1.06).contains(&(mean_m / plain_m)), "{}", mean_m / plain_m);
    }

    #[test]
    fn a_profile_turns_with_the_shaft() {
        let mut profile = Profile::unworn();
        profile.journal_m[0] = 1e-5;
        profile.bearing_m[1] = 3e-5;
        let mut gap_m = vec![0.0; CELLS];
        profile.gap_m(1e-3, PI / 2.0, &mut gap_m);
        let close = |cell: usize, depth_m: f64| (gap_m[cell] - 1e-3 - depth_m).abs() < 1e-15;
        assert!(close(CELLS / 4, 1e-5) && close(1, 3e-5) && close(0, 0.0));
    }

    /// Steps that are a thousand times too long for an explicit method give the same pocket.
    #[test]
    fn a_long_step_is_stable() {
        let wear = wear(9e12, RATE, 0.0);
        let worn = |steps: usize| {
            let mut profile = Profile::unworn();
            for _ in 0..steps {
                profile = wear.advance(&profile, 0.5e-3, &[load(0.0, 4e4 / steps as f64)], 1.0).unwrap();
            }
            profile
        };
        let (coarse, fine) = (worn(20), worn(200));
        let depth_m = fine.largest_depth_m();
        assert!(coarse.difference_m(&fine) < 0.1 * depth_m, "{}", coarse.difference_m(&fine) / depth_m);
    }
}
