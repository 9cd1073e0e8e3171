//! Parameters of normal laws, with which each carries bench B.

/// Lines of a description with the parameters of a normal law.
pub(crate) fn parameters(fields: &[&str], coefficient: &str) -> String {
    let line = |field: &&str| {
        let value = match *field {
            "coefficient" => coefficient,
            "exponent" => "1.1",
            "damping_n_s_m" => "2e4",
            "full_damping_depth_m" => "1e-5",
            other => panic!("no value for {other}"),
        };
        format!("{field} = {value}\n")
    };
    fields.iter().map(line).collect()
}
