//! Units by the suffix of a name.

/// Suffixes with their units; a longer suffix comes before a shorter one that ends alike.
const SUFFIXES: &[(&str, &str)] = &[
    ("_nm_s_rad", "N m s/rad"),
    ("_nm_rad", "N m/rad"),
    ("_n_s_m", "N s/m"),
    ("_n_m", "N/m"),
    ("_kg_m2", "kg m2"),
    ("_rad_s", "rad/s"),
    ("_m_s", "m/s"),
    ("_s_m", "s/m"),
    ("_per_m", "1/m"),
    ("_rpm", "1/min"),
    ("_kg", "kg"),
    ("_pa", "Pa"),
    ("_hz", "Hz"),
    ("_rad", "rad"),
    ("_nm", "N m"),
    ("_n", "N"),
    ("_m", "m"),
    ("_s", "s"),
    ("_k", "K"),
];

/// Unit of a field by its name; empty if the name has no unit.
pub(super) fn of_name(name: &str) -> &'static str {
    SUFFIXES.iter().find(|(suffix, _)| name.ends_with(suffix)).map_or("", |(_, unit)| unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_suffix_gives_the_unit() {
        for (name, unit) in [
            ("friction_radius_m", "m"),
            ("regularisation_m_s", "m/s"),
            ("viscous_slope_s_m", "s/m"),
            ("damping_n_s_m", "N s/m"),
            ("support_damping_nm_s_rad", "N m s/rad"),
            ("inertia_kg_m2", "kg m2"),
            ("bristle_stiffness_per_m", "1/m"),
            ("cycles", ""),
            ("load_gain", ""),
        ] {
            assert_eq!(of_name(name), unit, "{name}");
        }
    }
}
