//! Numbers of a column, in single precision as long as it holds them exactly: short numbers, such
//! as counts, would otherwise take several times the memory of their text.

/// Numbers, NaN where missing.
pub(super) enum Numbers {
    Single(Vec<f32>),
    Double(Vec<f64>),
}

impl Default for Numbers {
    fn default() -> Self {
        Self::Single(Vec::new())
    }
}

impl Numbers {
    pub(super) fn push(&mut self, value: f64) {
        let single = value as f32;
        let is_exact = value.is_nan() || f64::from(single).to_bits() == value.to_bits();
        match self {
            Self::Double(values) => values.push(value),
            Self::Single(values) if is_exact => values.push(single),
            Self::Single(_) => {
                let mut values = self.values();
                values.push(value);
                *self = Self::Double(values);
            }
        }
    }

    /// Numbers in double precision.
    pub(super) fn values(&self) -> Vec<f64> {
        match self {
            Self::Single(values) => values.iter().copied().map(f64::from).collect(),
            Self::Double(values) => values.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn numbers_are_kept_to_the_bit(
            numbers in prop::collection::vec(prop_oneof![
                (-9..9_i32).prop_map(f64::from),
                prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO,
            ], 0..20),
        ) {
            let mut kept = Numbers::default();
            numbers.iter().for_each(|number| kept.push(*number));
            let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&kept.values()), bits(&numbers));
        }
    }
}
