//! How a non-negative quantity is spread over a stream: extremes, mean, quantiles, without keeping its values.
//!
//! Counts by the upper 16 bits of an f32, 128 classes to an octave, and a straight line inside a class: a quantile is right to
//! .8 % and mostly to a tenth of that. Sums are taken in the order of the blocks, so a result is the same on any number
//! of threads. About 130 kB.

/// Classes of the non-negative finite numbers.
const CLASSES: usize = 0x7f80;
/// Bits of an f32 below the class.
const CLASS_SHIFT: u32 = 16;

/// Spread of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    counts: Vec<u32>,
    count: u64,
    sum: f64,
    low: f64,
    high: f64,
}

impl Default for Spread {
    fn default() -> Self {
        Self { counts: vec![0; CLASSES], count: 0, sum: 0.0, low: f64::INFINITY, high: 0.0 }
    }
}

impl Spread {
    /// Adds a value; negative ones count as 0.
    pub fn add(&mut self, value: f64) {
        let value = value.max(0.0);
        if let Some(count) = self.counts.get_mut((((value as f32).to_bits()) >> CLASS_SHIFT) as usize) {
            *count += 1;
        }
        self.count += 1;
        self.sum += value;
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }

    /// Adds another spread.
    pub fn join(&mut self, other: &Self) {
        for (count, more) in self.counts.iter_mut().zip(&other.counts) {
            *count += more;
        }
        self.count += other.count;
        self.sum += other.sum;
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
    }

    /// Number of values.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Smallest value; infinite without any.
    pub fn low(&self) -> f64 {
        self.low
    }

    /// Largest value.
    pub fn high(&self) -> f64 {
        self.high
    }

    /// Mean.
    pub fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }

    /// The value that a share of all values lies below.
    pub fn quantile(&self, share: f64) -> f64 {
        let wanted = share * self.count as f64;
        let mut below = 0.0;
        for (class, &count) in self.counts.iter().enumerate() {
            let count = f64::from(count);
            if count > 0.0 && below + count >= wanted {
                // The class of 0 and of what is next to nothing: no straight line between such.
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
    fn quantiles_of_an_exponential_are_those_of_theory_and_halves_join_to_the_whole() {
        let mut halves = [Spread::default(), Spread::default()];
        let mut whole = Spread::default();
        for i in 0..100_000_u32 {
            let value = -(1.0 - (f64::from(i) + 0.5) / 1e5).ln();
            whole.add(value);
            halves[(i % 2) as usize].add(value);
        }
        for share in [0.01_f64, 0.25, 0.5, 0.99] {
            let theory = -(1.0 - share).ln();
            assert!((whole.quantile(share) / theory - 1.0).abs() < 2e-3, "{}", whole.quantile(share));
        }
        assert!((whole.mean() - 1.0).abs() < 1e-4);
        let [mut joined, other] = halves;
        joined.join(&other);
        assert_eq!((joined.count(), joined.low(), joined.high()), (100_000, whole.low(), whole.high()));
        assert_eq!(joined.quantile(0.3), whole.quantile(0.3));
    }

    #[test]
    fn what_is_mostly_0_has_a_quantile_of_0() {
        let mut spread = Spread::default();
        (0..100).for_each(|i| spread.add(if i < 60 { 0.0 } else { 8.0 }));
        assert_eq!([0.01, 0.5, 0.99].map(|share| spread.quantile(share)), [0.0, 0.0, 8.0]);
        spread.add(-3.0);
        assert_eq!((spread.low(), spread.count()), (0.0, 101));
    }

    proptest! {
        #[test]
        fn a_quantile_is_near_the_sorted_value(mut values in prop::collection::vec(1e-6..1e9f64, 1..200), share in 0.0..1.0f64) {
            let mut spread = Spread::default();
            values.iter().for_each(|&v| spread.add(v));
            values.sort_by(f64::total_cmp);
            let rank = ((share * values.len() as f64).ceil() as usize).clamp(1, values.len());
            let found = spread.quantile(share);
            prop_assert!((found / values[rank - 1] - 1.0).abs() < 0.009, "{} {}", found, values[rank - 1]);
        }
    }
}
