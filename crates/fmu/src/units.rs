//! Units as powers of base units, which a model description states.

/// Base units by their attribute in a model description.
const BASES: [&str; 5] = ["kg", "m", "s", "K", "rad"];

/// Symbols with their factor and powers of [`BASES`].
const SYMBOLS: [(&str, f64, [i32; 5]); 11] = [
    ("kg", 1.0, [1, 0, 0, 0, 0]),
    ("m", 1.0, [0, 1, 0, 0, 0]),
    ("s", 1.0, [0, 0, 1, 0, 0]),
    ("K", 1.0, [0, 0, 0, 1, 0]),
    ("rad", 1.0, [0, 0, 0, 0, 1]),
    ("N", 1.0, [1, 1, -2, 0, 0]),
    ("Pa", 1.0, [1, -1, -2, 0, 0]),
    ("Hz", 1.0, [0, 0, -1, 0, 0]),
    ("W", 1.0, [1, 2, -3, 0, 0]),
    ("min", 60.0, [0, 0, 1, 0, 0]),
    ("1", 1.0, [0; 5]),
];

/// Attributes of the base unit of a unit such as `N m s/rad` or `kg m2`; none for one that is
/// unknown.
pub(crate) fn base_attributes(unit: &str) -> Option<String> {
    let (mut factor, mut powers) = (1.0, [0; 5]);
    for (part, sign) in unit.split('/').zip([1, -1, -1]) {
        for symbol in part.split_whitespace() {
            let digits = symbol.trim_start_matches(|c: char| !c.is_ascii_digit());
            let (name, power) = match digits.parse::<i32>() {
                Ok(power) if digits.len() < symbol.len() => (&symbol[..symbol.len() - digits.len()], power),
                _ => (symbol, 1),
            };
            let (_, own, exponents) = SYMBOLS.iter().find(|(known, ..)| *known == name)?;
            factor *= f64::powi(*own, sign * power);
            for (total, exponent) in powers.iter_mut().zip(exponents) {
                *total += sign * power * exponent;
            }
        }
    }
    let mut text = String::new();
    for (base, power) in BASES.iter().zip(powers).filter(|(_, power)| *power != 0) {
        text.push_str(&format!(" {base}=\"{power}\""));
    }
    if factor != 1.0 {
        text.push_str(&format!(" factor=\"{factor}\""));
    }
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compound_units_become_powers_of_base_units() {
        for (unit, expected) in [
            ("m", Some(" m=\"1\"")),
            ("N m s/rad", Some(" kg=\"1\" m=\"2\" s=\"-1\" rad=\"-1\"")),
            ("kg m2", Some(" kg=\"1\" m=\"2\"")),
            ("m/s2", Some(" m=\"1\" s=\"-2\"")),
            ("1/min", Some(" s=\"-1\" factor=\"0.016666666666666666\"")),
            ("N s/m", Some(" kg=\"1\" s=\"-1\"")),
            ("furlong", None),
        ] {
            assert_eq!(base_attributes(unit).as_deref(), expected, "{unit}");
        }
    }
}
