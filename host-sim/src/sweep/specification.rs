//! The file of a sweep (TOML): base bench, parameters with their values, grid or random points.
//!
//! ```toml
//! bench = "bench-b"                 # preset, or a file beside this one
//! bearings = ["babbitt", "plastic"] # optional: every point once a bearing
//! force = "law"                     # law, float-net or quantised-net
//! sampling = "grid"                 # or "random" with count and seed
//!
//! [fixed]                           # optional: parameters that differ from the bench in every run
//! "load.force_n" = 5e3
//!
//! [[parameters]]
//! path = "shaft.mass_kg"
//! values = [100.0, 150.0, 200.0]
//!
//! [[parameters]]
//! path = "bearing.radial_clearance_m"
//! range = { from = 1e-4, to = 1e-3, count = 10, scale = "log" }
//! ```
//!
//! Paths are those of a bench description, units in their names. At most [`MAX_RUNS`] runs.

use crate::cli::error::CliError;
use crate::run::force::ForceSource;
use bench::BearingMaterial;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Maximum number of runs of a sweep.
pub(crate) const MAX_RUNS: usize = 100_000;

/// Choice of the points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Sampling {
    /// Every combination of the values.
    #[default]
    Grid,
    /// `count` independent draws.
    Random,
}

/// Spacing of a range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Scale {
    /// Even steps.
    #[default]
    Linear,
    /// Even ratios.
    Log,
}

/// A range of values.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Range {
    /// First value.
    pub(crate) from: f64,
    /// Last value.
    pub(crate) to: f64,
    /// Number of values of a grid; not used with random points.
    #[serde(default)]
    pub(crate) count: Option<usize>,
    /// Spacing.
    #[serde(default)]
    pub(crate) scale: Scale,
}

/// One varied parameter.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Parameter {
    /// Dotted name in the bench description.
    pub(crate) path: String,
    /// Its values; either these or a range.
    #[serde(default)]
    pub(crate) values: Option<Vec<f64>>,
    /// Its range.
    #[serde(default)]
    pub(crate) range: Option<Range>,
}

/// The whole file.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Specification {
    /// Preset or bench description, relative to this file.
    #[serde(default = "bench_b")]
    pub(crate) bench: String,
    /// Bearings that every point is run with; empty: the bearing of the bench.
    #[serde(default)]
    #[schemars(with = "Vec<String>")]
    pub(crate) bearings: Vec<BearingMaterial>,
    /// Source of the bearing force.
    #[serde(default = "law")]
    pub(crate) force: ForceSource,
    /// Choice of the points.
    #[serde(default)]
    pub(crate) sampling: Sampling,
    /// Number of random points.
    #[serde(default)]
    pub(crate) count: Option<usize>,
    /// Seed of random points.
    #[serde(default = "one")]
    pub(crate) seed: u64,
    /// Parameters that differ from the bench in every run.
    #[serde(default)]
    pub(crate) fixed: BTreeMap<String, f64>,
    /// The varied parameters.
    pub(crate) parameters: Vec<Parameter>,
}

fn bench_b() -> String {
    "bench-b".into()
}

fn law() -> ForceSource {
    ForceSource::Law
}

fn one() -> u64 {
    1
}

/// Values that a parameter takes or is drawn from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Values {
    /// The listed values.
    List(Vec<f64>),
    /// Any value of a range.
    Between {
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
        /// Spacing.
        scale: Scale,
    },
}

impl Specification {
    /// Parses and checks a sweep; `file` names it in messages. The paths are checked later, with
    /// the bench.
    pub(crate) fn parse(file: &str, text: &str) -> Result<Self, CliError> {
        let specification: Self =
            toml::from_str(text).map_err(|e| CliError::Input(format!("{file}: {e}")))?;
        let refuse = |field: &str, found: String, expected: &str| {
            Err(CliError::Input(format!("{file}: {field}: found {found}; expected {expected}")))
        };
        if specification.parameters.is_empty() {
            return refuse(
                "parameters",
                "none".into(),
                "at least one [[parameters]] with path and values or range",
            );
        }
        match (specification.sampling, specification.count) {
            (Sampling::Random, None) => return refuse("count", "none".into(), "the number of random points"),
            (Sampling::Random, Some(n)) if !(1..=MAX_RUNS).contains(&n) => {
                return refuse("count", n.to_string(), &format!("1 to {MAX_RUNS}"));
            }
            (Sampling::Grid, Some(n)) => {
                return refuse("count", n.to_string(), "no count: a grid has one in each range");
            }
            _ => {}
        }
        for (index, parameter) in specification.parameters.iter().enumerate() {
            let path = &parameter.path;
            if specification.parameters.iter().take(index).any(|p| p.path == *path)
                || specification.fixed.contains_key(path)
            {
                return refuse(&format!("parameters.{path}"), "it twice".into(), "each parameter once");
            }
            if let Err((found, expected)) = parameter.values(specification.sampling) {
                return refuse(&format!("parameters.{path}"), found, &expected);
            }
        }
        Ok(specification)
    }
}

impl Parameter {
    /// Returns the values of a grid, or the range for random points. An error contains what was
    /// found and what was expected.
    pub(crate) fn values(&self, sampling: Sampling) -> Result<Values, (String, String)> {
        let range = match (&self.values, &self.range) {
            (Some(list), None) => {
                if list.is_empty() || list.iter().any(|v| !v.is_finite()) {
                    return Err((format!("values = {list:?}"), "one or more finite numbers".into()));
                }
                return Ok(Values::List(list.clone()));
            }
            (None, Some(range)) => *range,
            (Some(_), Some(_)) => return Err(("values and range".into(), "one of them".into())),
            (None, None) => return Err(("neither values nor range".into(), "one of them".into())),
        };
        let Range { from, to, count, scale } = range;
        if !(from.is_finite() && to.is_finite()) {
            return Err((format!("from {from} to {to}"), "finite numbers".into()));
        }
        if scale == Scale::Log && !(from > 0.0 && to > 0.0) {
            return Err((format!("from {from} to {to} on a log scale"), "numbers above 0".into()));
        }
        match (sampling, count) {
            (Sampling::Random, None) => Ok(Values::Between { from, to, scale }),
            (Sampling::Random, Some(n)) => Err((
                format!("range.count = {n}"),
                "no count in a range: random points have one for all".into(),
            )),
            (Sampling::Grid, Some(n)) if (2..=MAX_RUNS).contains(&n) => {
                let at = |i: usize| {
                    // The ends are exactly the numbers of the file, without rounding.
                    if i == 0 {
                        from
                    } else if i == n - 1 {
                        to
                    } else {
                        between(from, to, scale, i as f64 / (n - 1) as f64)
                    }
                };
                Ok(Values::List((0..n).map(at).collect()))
            }
            (Sampling::Grid, count) => Err((
                count.map_or_else(|| "no range.count".into(), |n| format!("range.count = {n}")),
                format!("a count of 2 to {MAX_RUNS}"),
            )),
        }
    }
}

/// Interpolates between two values; `share` is 0 to 1.
pub(crate) fn between(from: f64, to: f64, scale: Scale, share: f64) -> f64 {
    match scale {
        Scale::Linear => from + share * (to - from),
        Scale::Log => from * (to / from).powf(share),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        Specification::parse("s.toml", text).unwrap_err().to_string()
    }

    #[test]
    fn a_range_has_its_ends_and_even_ratios() {
        let range = |scale| Parameter {
            path: "x".into(),
            values: None,
            range: Some(Range { from: 1e-4, to: 1e-2, count: Some(3), scale }),
        };
        let values = |scale| match range(scale).values(Sampling::Grid) {
            Ok(Values::List(list)) => list,
            other => panic!("{other:?}"),
        };
        for (scale, middle) in [(Scale::Linear, 5.05e-3), (Scale::Log, 1e-3)] {
            let found = values(scale);
            assert_eq!((found[0], found[2]), (1e-4, 1e-2));
            assert!((found[1] / middle - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn refusals_name_the_field_what_was_found_and_expected() {
        let one = "[[parameters]]\npath = \"shaft.mass_kg\"\n";
        for (text, expected) in [
            ("".to_owned(), "missing field `parameters`"),
            ("parameters = []".into(), "parameters: found none; expected at least one"),
            ("colour = 3".into(), "unknown field `colour`"),
            (one.into(), "parameters.shaft.mass_kg: found neither values nor range; expected one of them"),
            (format!("{one}values = []"), "expected one or more finite numbers"),
            (format!("{one}values = [nan]"), "found values = [NaN]; expected one or more finite numbers"),
            (
                format!("{one}range = {{ from = 1, to = 2 }}"),
                "found no range.count; expected a count of 2 to 100000",
            ),
            (format!("{one}range = {{ from = 1, to = 2, count = 1 }}"), "found range.count = 1"),
            (
                format!("{one}range = {{ from = 0, to = 2, count = 5, scale = \"log\" }}"),
                "expected numbers above 0",
            ),
            (format!("{one}values = [1]\n{one}values = [2]"), "found it twice"),
            (
                format!("sampling = \"random\"\n{one}values = [1]"),
                "count: found none; expected the number of random",
            ),
            (format!("count = 5\n{one}values = [1]"), "count: found 5; expected no count"),
            (format!("force = \"wishes\"\n{one}values = [1]"), "unknown variant `wishes`"),
        ] {
            let message = error(&text);
            assert!(message.starts_with("s.toml: ") && message.contains(expected), "{text}: {message}");
        }
    }
}
