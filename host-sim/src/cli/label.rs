//! Names of quantities in words.

/// Suffixes of identifiers, the longer ones of two first, and their units.
const UNITS: [(&str, &str); 20] = [
    ("_n_m_rad", "N m/rad"),
    ("_m_s2", "m/s2"),
    ("_rad_s", "rad/s"),
    ("_mm_s", "mm/s"),
    ("_m_s", "m/s"),
    ("_n_s_m", "N s/m"),
    ("_nm", "N m"),
    ("_kn", "kN"),
    ("_kg", "kg"),
    ("_mm", "mm"),
    ("_um", "um"),
    ("_us", "us"),
    ("_pa", "Pa"),
    ("_hz", "Hz"),
    ("_rad", "rad"),
    ("_share", "share of time"),
    ("_n", "N"),
    ("_j", "J"),
    ("_m", "m"),
    ("_s", "s"),
];

/// Name of a quantity in words, with its unit: `peak_contact_force_n` is `peak contact force, N`.
pub(crate) fn label(name: &str) -> String {
    let (stem, unit) = UNITS
        .iter()
        .find_map(|(suffix, unit)| name.strip_suffix(suffix).map(|stem| (stem, *unit)))
        .unwrap_or((name, ""));
    let parts: Vec<&str> = stem.split('_').collect();
    let text = match parts.as_slice() {
        ["oscillation", low, high, "hz"] => format!("oscillation {low} to {high} Hz"),
        parts => parts.join(" "),
    };
    if unit.is_empty() { text } else { format!("{text}, {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_named_in_words_with_their_unit() {
        assert_eq!(label("peak_friction_torque_nm"), "peak friction torque, N m");
        assert_eq!(label("oscillation_300_1000_hz_n"), "oscillation 300 to 1000 Hz, N");
        assert_eq!(label("without_contact_share"), "without contact, share of time");
        assert_eq!(label("contacts"), "contacts");
        assert_eq!(label("shaft_speed_rad_s"), "shaft speed, rad/s");
        assert_eq!(label("max_deformation_m"), "max deformation, m");
        assert_eq!(label("t_s"), "t, s");
    }
}
