//! Statistics of samples: the one home of mean, root mean square, median and quantile.
//!
//! `statrs` computes running means and interpolated medians. Their last digits differ from these,
//! which the published results come from.

use std::borrow::Borrow;

/// Mean; 0 without values.
pub fn mean<I>(values: I) -> f64
where
    I: IntoIterator<Item: Borrow<f64>, IntoIter: ExactSizeIterator>,
{
    let values = values.into_iter();
    let count = values.len().max(1) as f64;
    values.map(|value| *value.borrow()).sum::<f64>() / count
}

/// Root mean square; 0 without values.
pub fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0_usize), |(sum, n), v| (sum + v * v, n + 1));
    (sum / count.max(1) as f64).sqrt()
}

/// Median, the upper one of an even number of values; `None` without values.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Quantile, interpolated between neighbours; 0 without values.
pub(crate) fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted_quantile(&sorted, share)
}

/// Quantile of ascending values, interpolated between neighbours; 0 without values.
pub(super) fn sorted_quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let place = share.clamp(0.0, 1.0) * last as f64;
    let below = place.floor() as usize;
    let at = |i: usize| sorted.get(i.min(last)).copied().unwrap_or_default();
    at(below) + (place - below as f64) * (at(below + 1) - at(below))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values_have_known_statistics() {
        let values = [4.0, 1.0, 3.0, 2.0];
        assert_eq!((mean(values), mean(&values), rms(values)), (2.5, 2.5, 7.5_f64.sqrt()));
        assert_eq!((median(values), median([5.0, -1.0, 3.0])), (Some(3.0), Some(3.0)));
        assert_eq!((quantile(&values, 0.5), quantile(&values, 1.0)), (2.5, 4.0));
    }

    #[test]
    fn no_values_have_no_statistics() {
        assert_eq!((mean([0.0; 0]), rms([]), median([]), quantile(&[], 0.5)), (0.0, 0.0, None, 0.0));
    }
}
