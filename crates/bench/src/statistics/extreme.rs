//! Largest value to expect in more cycles than were run: a Gumbel distribution of the largest value
//! of a cycle, fitted by L-moments (J. R. M. Hosking, J. Royal Statistical Society B 52, 1990).
//!
//! The cycles count as independent. Largest values whose tail is not exponential (bounded by the
//! motion, or heavier) are over- or underestimated.

use super::samples::mean;

/// Euler-Mascheroni constant.
const EULER: f64 = 0.577_215_664_901_532_9;

/// Expected largest of `cycles` cycles from the largest values of some cycles.
pub(crate) fn largest_in(cycles: f64, peaks: &[f64]) -> f64 {
    let mut sorted = peaks.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (count, mean) = (sorted.len() as f64, mean(&sorted));
    if sorted.len() < 2 {
        return mean;
    }
    let first = sorted.iter().enumerate().map(|(i, v)| i as f64 / (count - 1.0) * v).sum::<f64>() / count;
    let scale = ((2.0 * first - mean) / core::f64::consts::LN_2).max(0.0);
    // The maximum of N Gumbel values is a Gumbel value, shifted by the scale times ln N.
    mean - EULER * scale + scale * (cycles.ln() + EULER)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_a_gumbel_distribution_give_its_expected_maximum() {
        let (location, scale, count) = (1000.0, 50.0, 20_000);
        let peaks: Vec<f64> = (0..count)
            .map(|i| location - scale * (-((f64::from(i) + 0.5) / f64::from(count)).ln()).ln())
            .collect();
        let expected = location + scale * (1000.0_f64.ln() + EULER);
        assert!((largest_in(1000.0, &peaks) / expected - 1.0).abs() < 1e-4);
        assert!((largest_in(1.0, &peaks) - (location + EULER * scale)).abs() < 0.1);
    }

    #[test]
    fn equal_peaks_have_no_larger_one() {
        assert_eq!(largest_in(1000.0, &[7.0; 5]), 7.0);
        assert_eq!(largest_in(1000.0, &[7.0]), 7.0);
    }
}
