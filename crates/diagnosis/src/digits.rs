//! Numbers in text.

/// Four significant digits, with a power of ten for very small and very large numbers.
pub fn four_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let exponent = value.abs().log10().floor();
    if (-3.0..5.0).contains(&exponent) {
        format!("{value:.*}", (3.0 - exponent).max(0.0) as usize)
    } else {
        format!("{value:.3e}")
    }
}

/// A range in four significant digits; a single number if both ends print the same.
pub(crate) fn four_digit_range(from: f64, to: f64) -> String {
    match (four_digits(from), four_digits(to)) {
        (from, to) if from == to => from,
        (from, to) => format!("{from} to {to}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits_and_a_power_of_ten_only_if_needed() {
        let texts = [2.061, -0.001_234_56, 12_345.6, 1.5e-7, 123_456.0, 0.0].map(four_digits);
        assert_eq!(texts, ["2.061", "-0.001235", "12346", "1.500e-7", "1.235e5", "0"]);
        assert_eq!(four_digit_range(0.1, 0.25), "0.1000 to 0.2500");
        assert_eq!(four_digit_range(-0.400_01, -0.399_98), "-0.4000");
    }
}
