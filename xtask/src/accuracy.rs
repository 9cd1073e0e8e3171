//! Accuracy of the estimate in worlds that differ from their description: the published campaign,
//! its golden figures and the documents that quote them.
//!
//! The campaign takes minutes, so a run of all tests repeats a part of it: `host-sim`'s test
//! `accuracy` compares its first draws with the golden figures.

use crate::document::Block;
use crate::run::{ChoreError, output_of, root, target_folder, write_atomically};
use crate::workspace;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// File with the golden figures.
const FILE: &str = "tests/golden/accuracy-worlds.json";
/// Place of the table for every reader.
const README: Block = Block { file: "README.md", name: "accuracy" };
/// Place of the complete table.
const FIGURES: Block = Block { file: "docs/figures.md", name: "accuracy" };
/// Drawn worlds of an operating point.
const WORLDS: &str = "20";
/// Estimator of the product.
const ESTIMATOR: &str = "network";
/// Error in percent of full scale that a single wrong parameter may cause.
const GOAL_PERCENT: f64 = 0.6;

/// Errors of the estimator in one world, as `host-sim accuracy --worlds --json` prints them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Case {
    world: String,
    set: String,
    #[serde(default, skip_serializing)]
    estimator: String,
    bearing: String,
    clearance_mm: f64,
    load_kn: f64,
    rms_n: f64,
    max_n: f64,
    full_scale_n: f64,
    torque_rms_nm: f64,
    torque_full_scale_nm: f64,
    inside_2sd: Option<f64>,
}

impl Case {
    fn force_percent(&self) -> f64 {
        100.0 * self.rms_n / self.full_scale_n
    }

    fn torque_percent(&self) -> f64 {
        100.0 * self.torque_rms_nm / self.torque_full_scale_nm
    }

    fn is_of(&self, parameter: &str) -> bool {
        self.world.trim_end_matches(['+', '-']) == parameter
    }
}

/// Result of the campaign.
#[derive(Deserialize)]
struct Outcome {
    cases: Vec<Case>,
}

/// Runs the campaign. Writes golden figures and documents with `is_blessed`, else compares.
pub(crate) fn measure(is_blessed: bool) -> Result<(), ChoreError> {
    let out = target_folder().join("accuracy");
    let mut command = workspace::program("host-sim")?;
    command.args(["accuracy", "--worlds", WORLDS, "--json", "--out"]).arg(out);
    let text = output_of(&mut command)?;
    let found: Outcome = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    let cases: Vec<Case> = found.cases.into_iter().filter(|case| case.estimator == ESTIMATOR).collect();
    let text = lines(&cases);
    if is_blessed {
        write_atomically(path(), text)?;
        return write_documents();
    }
    let golden = std::fs::read_to_string(path()).map_err(|error| wrong(error.to_string()))?;
    if golden == text {
        return Ok(());
    }
    let what = format!("accuracy in drawn worlds ({FILE}; if intended: cargo xtask accuracy --bless)");
    Err(ChoreError::Differs { what, found: text, expected: golden })
}

/// Writes the golden figures into the documents.
pub(crate) fn write_documents() -> Result<(), ChoreError> {
    let cases = golden()?;
    README.write(&short_table(&cases))?;
    FIGURES.write(&table(&cases))
}

fn golden() -> Result<Vec<Case>, ChoreError> {
    let text = std::fs::read_to_string(path()).map_err(|error| wrong(error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))
}

fn path() -> PathBuf {
    root().join(FILE)
}

fn wrong(found: String) -> ChoreError {
    ChoreError::File {
        file: path(),
        found,
        expected: "figures as `cargo xtask accuracy --bless` writes them",
    }
}

/// Cases as JSON, one on a line.
fn lines(cases: &[Case]) -> String {
    let line = |case: &Case| serde_json::to_string(case).unwrap_or_default();
    format!("[\n{}\n]\n", cases.iter().map(line).collect::<Vec<_>>().join(",\n"))
}

/// Figures of some of the cases, in percent of full scale.
struct Summary {
    count: usize,
    least: f64,
    /// The larger of two in the middle, as `host-sim accuracy` prints it.
    median: f64,
    worst: f64,
}

impl Summary {
    fn new<'c>(cases: impl Iterator<Item = &'c Case>, percent: fn(&Case) -> f64) -> Self {
        let mut found: Vec<f64> = cases.map(percent).collect();
        found.sort_by(f64::total_cmp);
        let value = |value: Option<&f64>| value.copied().unwrap_or(f64::NAN);
        let median = value(found.get(found.len() / 2));
        Self { count: found.len(), least: value(found.first()), median, worst: value(found.last()) }
    }
}

fn of_set<'c>(cases: &'c [Case], set: &'static str) -> impl Iterator<Item = &'c Case> {
    cases.iter().filter(move |case| case.set == set)
}

/// Table and sentences of the README.
fn short_table(cases: &[Case]) -> String {
    let drawn = Summary::new(of_set(cases, "drawn"), Case::force_percent);
    let torque = Summary::new(of_set(cases, "drawn"), Case::torque_percent);
    let clearance = Summary::new(cases.iter().filter(|c| c.is_of("clearance")), Case::force_percent);
    let exact = Summary::new(of_set(cases, "exact"), Case::force_percent);
    let covered = of_set(cases, "drawn").filter_map(|case| case.inside_2sd).sum::<f64>() / drawn.count as f64;
    let single = Summary::new(of_set(cases, "drawn"), |case| 100.0 * case.max_n / case.full_scale_n);
    format!(
        "| what is not known exactly | rms error of the force at 10 kHz, % of full scale |\n|---|---|\n\
         | all parameters that are declared uncertain, drawn {} times | {:.2} % in the median, {:.1} % at \
         worst (friction torque: {:.1} %, {:.1} %) |\n\
         | clearance: it differs by 10 um from the configured one | {:.1} % at worst |\n\
         | nothing: every parameter is exact | {:.1} to {:.1} % |\n\n\
         Every estimate carries its standard deviation: two of them cover {:.0} % of all samples in the \
         drawn\nworlds. The largest single error, {:.0} % of full scale, is flagged.",
        drawn.count,
        drawn.median,
        drawn.worst,
        torque.median,
        torque.worst,
        clearance.worst,
        exact.least,
        exact.worst,
        100.0 * covered,
        single.worst,
    )
}

/// Table of the page of figures.
fn table(cases: &[Case]) -> String {
    let single = || of_set(cases, "single-parameter").filter(|case| !case.is_of("mass"));
    let drawn = Summary::new(of_set(cases, "drawn"), Case::force_percent);
    let torque = Summary::new(of_set(cases, "drawn"), Case::torque_percent);
    let clearance = Summary::new(cases.iter().filter(|c| c.is_of("clearance")), Case::force_percent);
    let others = Summary::new(single().filter(|case| !case.is_of("clearance")), Case::force_percent);
    let mass = Summary::new(cases.iter().filter(|c| c.is_of("mass")), Case::force_percent);
    let exact = Summary::new(of_set(cases, "exact"), Case::force_percent);
    let exact_torque = Summary::new(of_set(cases, "exact"), Case::torque_percent);
    format!(
        "| what is not known exactly | rms error | how measured |\n|---|---|---|\n\
         | all parameters that are declared uncertain, drawn at random together: {WORLDS} worlds at each of \
         {} operating points | {:.2} % in the median, {:.2} % at worst; friction torque {:.2} and {:.1} % | \
         `host-sim accuracy --worlds {WORLDS}` (simulator of `tests/worlds`) |\n\
         | radial clearance: 10 um larger or smaller than configured | at most {:.2} % | the same |\n\
         | stiffness, inertia, friction or lever: one declared standard deviation off, each alone | at most \
         {:.2} %; at most {GOAL_PERCENT} % in {} of the {} runs with one wrong parameter | the same |\n\
         | mass: 2 % off | at most {:.2} % | the same |\n\
         | nothing: exact parameters | {:.2} to {:.2} %; friction torque {:.2} to {:.2} % | the same |",
        exact.count,
        drawn.median,
        drawn.worst,
        torque.median,
        torque.worst,
        clearance.worst,
        others.worst,
        single().filter(|case| case.force_percent() <= GOAL_PERCENT).count(),
        single().count(),
        mass.worst,
        exact.least,
        exact.worst,
        exact_torque.least,
        exact_torque.worst,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documents_quote_the_golden_figures() {
        let cases = golden().unwrap();
        assert_eq!(lines(&cases), std::fs::read_to_string(path()).unwrap());
        README.check(&short_table(&cases)).unwrap();
        FIGURES.check(&table(&cases)).unwrap();
    }

    #[test]
    fn a_summary_has_the_median_of_an_even_and_an_odd_number_of_cases() {
        let case = |rms_n: f64| Case {
            world: "draw-1".into(),
            set: "drawn".into(),
            estimator: String::new(),
            bearing: "babbitt".into(),
            clearance_mm: 0.5,
            load_kn: 10.0,
            rms_n,
            max_n: 1.0,
            full_scale_n: 100.0,
            torque_rms_nm: 0.0,
            torque_full_scale_nm: 1.0,
            inside_2sd: None,
        };
        let summary = |forces: &[f64]| {
            let cases: Vec<Case> = forces.iter().map(|force| case(*force)).collect();
            let found = Summary::new(cases.iter(), Case::force_percent);
            (found.count, found.least, found.median, found.worst)
        };
        assert_eq!(summary(&[4.0, 1.0, 2.0]), (3, 1.0, 2.0, 4.0));
        assert_eq!(summary(&[4.0, 1.0, 2.0, 3.0]), (4, 1.0, 3.0, 4.0));
        assert!(summary(&[]).2.is_nan());
    }
}
