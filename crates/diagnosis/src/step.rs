//! One Gauss-Newton step within a trust region and within bounds.

use crate::linear::factor;
use nalgebra::{DMatrix, DVector};

/// The Gauss-Newton step within a ball and within bounds: parameters that would leave stop at the bound, the others
/// are solved again.
pub(crate) fn bounded_step(
    information: &DMatrix<f64>,
    gradient: &DVector<f64>,
    z: &[f64],
    bounds: &[(f64, f64)],
    radius: f64,
) -> Option<DVector<f64>> {
    let n = z.len();
    let mut stopped: Vec<Option<f64>> = vec![None; n];
    for _ in 0..=n {
        let free: Vec<usize> = (0..n).filter(|&i| stopped[i].is_none()).collect();
        let fixed = DVector::from_fn(n, |i, _| stopped[i].unwrap_or_default());
        let pulled = gradient - information * &fixed;
        let matrix = DMatrix::from_fn(free.len(), free.len(), |i, j| information[(free[i], free[j])]);
        let right = DVector::from_fn(free.len(), |i, _| pulled[free[i]]);
        let partial = within(&matrix, &right, radius)?;
        let mut step = fixed;
        for (k, &i) in free.iter().enumerate() {
            step[i] = partial[k];
        }
        let mut left = false;
        for &i in &free {
            let (least, most) = bounds[i];
            let inside = (z[i] + step[i]).clamp(least, most) - z[i];
            if (inside - step[i]).abs() > 1e-12 {
                stopped[i] = Some(inside);
                left = true;
            }
        }
        if !left {
            return Some(step);
        }
    }
    None
}

/// Solution of `(A + l I) s = g` with the least `l` that keeps `s` within the radius.
fn within(matrix: &DMatrix<f64>, right: &DVector<f64>, radius: f64) -> Option<DVector<f64>> {
    let solve = |damping: f64| {
        let mut m = matrix.clone();
        (0..m.nrows()).for_each(|i| m[(i, i)] += damping);
        factor(&m).map(|c| c.solve(right))
    };
    let plain = solve(0.0)?;
    if plain.norm() <= radius {
        return Some(plain);
    }
    // |s| <= |g|/l bounds the damping from above.
    let (mut low, mut high) = (0.0_f64, right.norm() / radius);
    for _ in 0..60 {
        let middle = if low > 0.0 { (low * high).sqrt() } else { 1e-4 * high };
        if solve(middle)?.norm() > radius {
            low = middle;
        } else {
            high = middle;
            if low == 0.0 && middle < 1e-12 * right.norm() {
                break;
            }
        }
        if low > 0.0 && high / low < 1.05 {
            break;
        }
    }
    solve(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_stays_in_the_ball_and_in_the_bounds() {
        let a = DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 3.0]);
        let g = DVector::from_vec(vec![40.0, 10.0]);
        let free = [(f64::NEG_INFINITY, f64::INFINITY); 2];
        let plain = bounded_step(&a, &g, &[0.0, 0.0], &free, 1e9).unwrap();
        assert!((&a * &plain - &g).norm() < 1e-9);
        let short = bounded_step(&a, &g, &[0.0, 0.0], &free, 1.0).unwrap();
        assert!(short.norm() <= 1.0 && short.norm() > 0.9, "{short}");
        let stopped = bounded_step(&a, &g, &[0.0, 0.0], &[(-1.0, 2.0), (-9.0, 9.0)], 1e9).unwrap();
        assert_eq!(stopped[0], 2.0);
        assert!((stopped[1] - (10.0 - 2.0) / 3.0).abs() < 1e-9);
    }
}
