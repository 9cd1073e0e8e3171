//! One Gauss-Newton step within a trust region and within bounds.

use super::linear::cholesky;
use super::tuning;
use nalgebra::{DMatrix, DVector};

/// The Gauss-Newton step within a ball and within bounds. Parameters that would leave their bounds
/// stop there, and the step of the others is computed anew. `None` without a solution.
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
        let remaining = gradient - information * &fixed;
        let matrix = DMatrix::from_fn(free.len(), free.len(), |i, j| information[(free[i], free[j])]);
        let right = DVector::from_fn(free.len(), |i, _| remaining[free[i]]);
        let partial = step_within(&matrix, &right, radius)?;
        let mut step = fixed;
        for (k, &i) in free.iter().enumerate() {
            step[i] = partial[k];
        }
        let mut is_outside = false;
        for &i in &free {
            let (min, max) = bounds[i];
            let inside = (z[i] + step[i]).clamp(min, max) - z[i];
            if (inside - step[i]).abs() > tuning::STEP_ROUNDING {
                stopped[i] = Some(inside);
                is_outside = true;
            }
        }
        if !is_outside {
            return Some(step);
        }
    }
    None
}

/// Solution of `(A + l I) s = g` with the smallest `l` that keeps `s` within the radius.
fn step_within(matrix: &DMatrix<f64>, right: &DVector<f64>, radius: f64) -> Option<DVector<f64>> {
    let solve = |damping: f64| {
        let mut m = matrix.clone();
        (0..m.nrows()).for_each(|i| m[(i, i)] += damping);
        cholesky(&m).map(|c| c.solve(right))
    };
    let plain = solve(0.0)?;
    if plain.norm() <= radius {
        return Some(plain);
    }
    // |s| <= |g|/l bounds the damping from above. The damping is bisected in its logarithm.
    let (mut low, mut high) = (0.0_f64, right.norm() / radius);
    for _ in 0..tuning::MAX_DAMPING_STEPS {
        let middle = if low > 0.0 { (low * high).sqrt() } else { tuning::DAMPING_STEP * high };
        if solve(middle)?.norm() > radius {
            low = middle;
        } else {
            high = middle;
            if low == 0.0 && middle < tuning::MIN_DAMPING * right.norm() {
                break;
            }
        }
        if low > 0.0 && high / low < tuning::DAMPING_RATIO {
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
