//! Pressure between journal and bearing on an elastic foundation (Winkler), for any worn profile.
//!
//! The lining is a bed of independent springs between rigid bodies: `p = K (u.n - g)` where it is
//! positive, with the displacement `u` of the journal's centre, the direction `n` of a cell and its
//! gap `g` at the centred journal. `K = (1 - nu) E/((1 + nu)(1 - 2 nu) t)` for a lining of
//! thickness `t` that is bonded to a rigid housing (Johnson, Contact Mechanics, 1985, section 4.3).
//! Wear of clearance joints with this model: Mukras et al., Wear 268 (2010) 643. Both components of
//! the force are balanced, so an asymmetric profile moves the journal sideways.
//!
//! Lengths in m, forces in N. Small clearance: the gap is taken along the radius. Springs do not
//! support each other, so the pressure has no peaks at the edge of a worn pocket.

use nalgebra::{Matrix2, Vector2};
use std::f64::consts::TAU;

/// Cells around the circumference: 0.5 degrees each.
pub(crate) const CELLS: usize = 720;
/// Iterations of the balance. It usually takes fewer than ten.
const MAX_ITERATIONS: usize = 100;
/// Halvings of a step that does not decrease the energy.
const MAX_HALVINGS: usize = 40;
/// Residual of the balance, relative to the force.
const BALANCED: f64 = 1e-9;

/// The balance of forces was not found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the contact pressure does not balance a force of {force_n:e} N; expected a gap all around")]
pub struct Unbalanced {
    /// Force in N.
    pub force_n: f64,
}

/// Stiffness of a lining in N/m3 by its modulus in Pa, Poisson's ratio below 0.5 and thickness in
/// m.
pub(crate) fn layer_modulus_n_m3(youngs_modulus_pa: f64, poisson_ratio: f64, thickness_m: f64) -> f64 {
    let nu = poisson_ratio;
    (1.0 - nu) * youngs_modulus_pa / ((1.0 + nu) * (1.0 - 2.0 * nu) * thickness_m)
}

/// Angle of a cell in rad, from +Y towards +Z.
pub fn cell_angle_rad(cell: usize) -> f64 {
    TAU * cell as f64 / CELLS as f64
}

/// Elastic foundation of a bearing.
#[derive(Clone, Debug)]
pub struct Foundation {
    modulus_n_m3: f64,
    cell_area_m2: f64,
    normals: Vec<Vector2<f64>>,
}

impl Foundation {
    /// Creates the foundation of a bearing with radius and length in m.
    pub fn new(modulus_n_m3: f64, radius_m: f64, length_m: f64) -> Self {
        let normal = |cell| {
            let (sine, cosine) = cell_angle_rad(cell).sin_cos();
            Vector2::new(cosine, sine)
        };
        Self {
            modulus_n_m3,
            cell_area_m2: TAU * radius_m * length_m / CELLS as f64,
            normals: (0..CELLS).map(normal).collect(),
        }
    }

    /// Area of a cell in m2.
    pub(crate) fn cell_area_m2(&self) -> f64 {
        self.cell_area_m2
    }

    /// Displacement in the direction of a force at which rigid surfaces touch.
    pub(crate) fn rigid_displacement_m(&self, gap_m: &[f64], direction: [f64; 2]) -> f64 {
        let direction = Vector2::from(direction);
        let reach = |cell: usize| self.normals[cell].dot(&direction).max(1e-3);
        self.facing(&direction).map(|cell| gap_m[cell] / reach(cell)).fold(f64::INFINITY, f64::min)
    }

    /// Computes the pressure in Pa of every cell under a force in N.
    ///
    /// `compliance_m_pa` is added to that of the springs: a step of wear that is implicit in the
    /// pressure.
    ///
    /// # Errors
    ///
    /// No displacement balances the force: a profile without any gap, or numbers that are not
    /// finite.
    pub(crate) fn pressure_pa(
        &self,
        gap_m: &[f64],
        force_n: [f64; 2],
        compliance_m_pa: f64,
        pressure_pa: &mut [f64],
    ) -> Result<(), Unbalanced> {
        pressure_pa.fill(0.0);
        let force = Vector2::from(force_n);
        let size_n = force.norm();
        if size_n == 0.0 {
            return Ok(());
        }
        let modulus = self.modulus_n_m3 / (1.0 + self.modulus_n_m3 * compliance_m_pa);
        let direction = force / size_n;
        let displacement = self.balance(gap_m, &force, modulus).ok_or(Unbalanced { force_n: size_n })?;
        for cell in self.facing(&direction) {
            let depth_m = displacement.dot(&self.normals[cell]) - gap_m[cell];
            pressure_pa[cell] = modulus * depth_m.max(0.0);
        }
        Ok(())
    }

    /// Finds the displacement that balances a force: the minimum of a convex energy by Newton's
    /// method with halved steps.
    fn balance(&self, gap_m: &[f64], force: &Vector2<f64>, modulus: f64) -> Option<Vector2<f64>> {
        let spring_n_m = modulus * self.cell_area_m2;
        let direction = force.normalize();
        let touch_m = self.rigid_displacement_m(gap_m, [direction.x, direction.y]);
        let mut at = direction * (touch_m + force.norm() / spring_n_m);
        let (mut energy, mut residual, mut slope) = self.energy(gap_m, force, spring_n_m, &at);
        for _ in 0..MAX_ITERATIONS {
            if residual.norm() <= BALANCED * force.norm() {
                return Some(at);
            }
            // One cell alone gives no stiffness across its direction.
            let slope_safe = slope + Matrix2::identity() * (1e-9 * slope.trace().max(spring_n_m));
            let step = slope_safe.try_inverse()? * residual;
            let mut share = 1.0;
            let better = (0..MAX_HALVINGS).find_map(|_| {
                let trial = at - step * share;
                let found = self.energy(gap_m, force, spring_n_m, &trial);
                share *= 0.5;
                (found.0 < energy || found.1.norm() < 0.5 * residual.norm()).then_some((trial, found))
            });
            // Rounding of the energy hides the last decrease.
            let Some((trial, found)) = better else {
                return (residual.norm() <= 1e-6 * force.norm()).then_some(at);
            };
            (at, (energy, residual, slope)) = (trial, found);
        }
        None
    }

    /// Energy, its gradient (the force that is not balanced) and the stiffness at a displacement.
    fn energy(
        &self,
        gap_m: &[f64],
        force: &Vector2<f64>,
        spring_n_m: f64,
        at: &Vector2<f64>,
    ) -> (f64, Vector2<f64>, Matrix2<f64>) {
        let (mut energy, mut gradient, mut slope) = (-force.dot(at), -*force, Matrix2::zeros());
        for cell in self.facing(&force.normalize()) {
            let normal = &self.normals[cell];
            let depth_m = at.dot(normal) - gap_m[cell];
            if depth_m > 0.0 {
                energy += 0.5 * spring_n_m * depth_m * depth_m;
                gradient += normal * (spring_n_m * depth_m);
                slope += normal * normal.transpose() * spring_n_m;
            }
        }
        (energy, gradient, slope)
    }

    /// Cells within a right angle of a direction.
    fn facing(&self, direction: &Vector2<f64>) -> impl Iterator<Item = usize> + use<> {
        let turns = direction.y.atan2(direction.x).rem_euclid(TAU) / TAU;
        let middle = (turns * CELLS as f64).round() as usize;
        (0..=CELLS / 2).map(move |offset| (middle + CELLS - CELLS / 4 + offset) % CELLS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS_M: f64 = 0.07;
    const LENGTH_M: f64 = 0.14;
    const CLEARANCE_M: f64 = 0.5e-3;

    fn resultant(foundation: &Foundation, pressure_pa: &[f64]) -> Vector2<f64> {
        let area = foundation.cell_area_m2();
        pressure_pa.iter().zip(&foundation.normals).map(|(p, n)| n * (p * area)).sum()
    }

    /// Force of a round gap: `K R L u (a - sin a cos a)` with `cos a = D/u`.
    fn round_force_n(modulus: f64, half_angle: f64) -> f64 {
        let displacement_m = CLEARANCE_M / half_angle.cos();
        modulus * RADIUS_M * LENGTH_M * displacement_m * (half_angle - half_angle.sin() * half_angle.cos())
    }

    #[test]
    fn a_round_gap_has_the_half_angle_and_the_force_of_the_closed_form() {
        let modulus = layer_modulus_n_m3(2.5e9, 0.4, 7.6e-3);
        let foundation = Foundation::new(modulus, RADIUS_M, LENGTH_M);
        let gap_m = [CLEARANCE_M; CELLS];
        for degrees in [10.0_f64, 30.0, 60.0, 80.0] {
            let half_angle = degrees.to_radians();
            let force_n = round_force_n(modulus, half_angle);
            let mut pressure_pa = [0.0; CELLS];
            foundation.pressure_pa(&gap_m, [0.0, -force_n], 0.0, &mut pressure_pa).unwrap();
            let cells = pressure_pa.iter().filter(|p| **p > 0.0).count() as f64;
            let found = 0.5 * cells * TAU / CELLS as f64;
            assert!((found - half_angle).abs() < 1.1 * TAU / CELLS as f64, "{degrees}: {found}");
            let peak = pressure_pa.iter().copied().fold(0.0, f64::max);
            let expected = modulus * CLEARANCE_M * (1.0 / half_angle.cos() - 1.0);
            assert!((peak / expected - 1.0).abs() < 5e-3, "{degrees}: {peak} {expected}");
        }
    }

    #[test]
    fn both_components_of_the_force_are_balanced_on_an_asymmetric_profile() {
        let foundation = Foundation::new(7e11, RADIUS_M, LENGTH_M);
        let mut gap_m = [CLEARANCE_M; CELLS];
        gap_m[20..140].iter_mut().for_each(|gap| *gap += 50e-6);
        let force = [8e3 * 0.6, 8e3 * 0.8];
        let mut pressure_pa = [0.0; CELLS];
        foundation.pressure_pa(&gap_m, force, 0.0, &mut pressure_pa).unwrap();
        let found = resultant(&foundation, &pressure_pa);
        assert!((found - Vector2::from(force)).norm() < 1e-5 * 8e3, "{found}");
    }

    #[test]
    fn a_force_on_one_cell_is_balanced() {
        let foundation = Foundation::new(9e12, RADIUS_M, LENGTH_M);
        let mut pressure_pa = [0.0; CELLS];
        foundation.pressure_pa(&[CLEARANCE_M; CELLS], [0.0, 1e-3], 0.0, &mut pressure_pa).unwrap();
        let found = resultant(&foundation, &pressure_pa);
        assert!((found.y - 1e-3).abs() < 1e-8 && pressure_pa.iter().filter(|p| **p > 0.0).count() <= 2);
    }

    #[test]
    fn the_lining_is_stiffer_than_a_free_bar_of_its_thickness() {
        let stiffness = layer_modulus_n_m3(2.5e9, 0.4, 0.01);
        assert!((stiffness / (0.6 / (1.4 * 0.2) * 2.5e9 / 0.01) - 1.0).abs() < 1e-12);
        assert!((layer_modulus_n_m3(1e9, 0.0, 0.01) / 1e11 - 1.0).abs() < 1e-12);
    }
}
