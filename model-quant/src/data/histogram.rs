//! Streaming statistics of a non-negative quantity: extremes, mean and quantiles without storing
//! its values.
//!
//! A histogram counts values by the upper 16 bits of their f32, 128 classes an octave, with linear
//! interpolation inside a class. A quantile is correct to .8 % and mostly to a tenth of that. Sums
//! are added in the order of the blocks, so a result is the same on any number of threads. Size:
//! about 130 kB.

/// Number of classes of the non-negative finite numbers.
const CLASSES: usize = 0x7f80;
/// Bits of an f32 below the class.
const CLASS_SHIFT: u32 = 16;

/// Distribution of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    counts: Vec<u32>,
    count: u64,
    sum: f64,
    low: f64,
    high: f64,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { counts: vec![0; CLASSES], count: 0, sum: 0.0, low: f64::INFINITY, high: 0.0 }
    }
}

impl Histogram {
    /// Adds a value; negative ones count as 0.
    pub(crate) fn add(&mut self, value: f64) {
        let value = value.max(0.0);
        if let Some(count) = self.counts.get_mut((((value as f32).to_bits()) >> CLASS_SHIFT) as usize) {
            *count += 1;
        }
        self.count += 1;
        self.sum += value;
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }

    /// Adds another distribution.
    pub(crate) fn join(&mut self, other: &Self) {
        for (count, more) in self.counts.iter_mut().zip(&other.counts) {
            *count += more;
        }
        self.count += other.count;
        self.sum += other.sum;
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
    }

    /// Smallest value; infinite without any.
    pub(crate) fn low(&self) -> f64 {
        self.low
    }

    /// Largest value.
    pub(crate) fn high(&self) -> f64 {
        self.high
    }

    /// Mean.
    pub(crate) fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }

    /// Value below which the given share of all values lies.
    pub(crate) fn quantile(&self, share: f64) -> f64 {
        let wanted = share * self.count as f64;
        let mut below = 0.0;
        for (class, &count) in self.counts.iter().enumerate() {
            let count = f64::from(count);
            if count > 0.0 && below + count >= wanted {
                // The class of 0 and subnormal numbers is not interpolated.
                if class == 0 {
                    return self.low;
                }
                let edge = |class: usize| f64::from(f32::from_bits((class as u32) << CLASS_SHIFT));
                let inside = edge(class) + (edge(class + 1) - edge(class)) * (wanted - below) / count;
                return inside.clamp(self.low, self.high);
            }
            below += count;
        }
        self.high
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn quantiles_of_an_exponential_match_theory_and_halves_add_up() {
        let mut halves = [Histogram::default(), Histogram::default()];
        let mut complete = Histogram::default();
        for i in 0..100_000_u32 {
            let value = -(1.0 - (f64::from(i) + 0.5) / 1e5).ln();
            complete.add(value);
            halves[(i % 2) as usize].add(value);
        }
        for share in [0.01_f64, 0.25, 0.5, 0.99] {
            let theory = -(1.0 - share).ln();
            assert!((complete.quantile(share) / theory - 1.0).abs() < 2e-3, "{}", complete.quantile(share));
        }
        assert!((complete.mean() - 1.0).abs() < 1e-4);
        let [mut joined, other] = halves;
        joined.join(&other);
        assert_eq!((joined.count, joined.low(), joined.high()), (100_000, complete.low(), complete.high()));
        assert_eq!(joined.quantile(0.3), complete.quantile(0.3));
    }

    #[test]
    fn a_quantile_among_zeros_is_0() {
        let mut histogram = Histogram::default();
        (0..100).for_each(|i| histogram.add(if i < 60 { 0.0 } else { 8.0 }));
        assert_eq!([0.01, 0.5, 0.99].map(|share| histogram.quantile(share)), [0.0, 0.0, 8.0]);
        histogram.add(-3.0);
        assert_eq!((histogram.low(), histogram.count), (0.0, 101));
    }

    proptest! {
        #[test]
        fn a_quantile_is_near_the_sorted_value(
            mut values in prop::collection::vec(1e-6..1e9f64, 1..200),
            share in 0.0..1.0f64,
        ) {
            let mut histogram = Histogram::default();
            values.iter().for_each(|&v| histogram.add(v));
            values.sort_by(f64::total_cmp);
            let rank = ((share * values.len() as f64).ceil() as usize).clamp(1, values.len());
            let found = histogram.quantile(share);
            prop_assert!((found / values[rank - 1] - 1.0).abs() < 0.009, "{} {}", found, values[rank - 1]);
        }
    }
}
