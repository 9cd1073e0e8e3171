//! Comparison of runs: their figures side by side, and their logs as curves with differences.

mod read;
pub(crate) mod report;

use bench::statistics::rms;
use read::StoredRun;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;

pub(crate) use read::read;

/// Result of a comparison.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct Comparison {
    /// Folders of the runs; the first is the reference.
    pub(crate) runs: Vec<String>,
    /// Figures that all runs have.
    pub(crate) figures: Vec<FigureRow>,
    /// Texts of run.json that differ: materials, laws, options.
    pub(crate) texts: Vec<TextRow>,
    /// Columns of the logs.
    pub(crate) columns: Vec<ColumnRow>,
    /// Figures and columns that not all runs have.
    pub(crate) missing: Vec<String>,
}

/// A figure of all runs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct FigureRow {
    /// Name, as in run.json.
    pub(crate) name: String,
    /// Values in the order of the runs.
    pub(crate) values: Vec<f64>,
    /// Differences from the first run.
    pub(crate) differences: Vec<f64>,
}

/// A text of all runs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct TextRow {
    /// Name, as in run.json.
    pub(crate) name: String,
    /// Texts in the order of the runs.
    pub(crate) values: Vec<String>,
}

/// A column of all logs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct ColumnRow {
    /// Name, as in log.csv.
    pub(crate) name: String,
    /// Differences from the first run in the order of the runs, that of the first included; none
    /// for a run without a value at a time within the log of the first.
    pub(crate) differences: Vec<Option<Difference>>,
}

/// Difference of a column from that of the first run.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub(crate) struct Difference {
    /// Number of values that were compared.
    pub(crate) samples: usize,
    /// Root mean square.
    pub(crate) rms: f64,
    /// Largest magnitude.
    pub(crate) max: f64,
    /// Time of the largest magnitude, s.
    pub(crate) time_s: f64,
}

/// Compares runs with the first one.
pub(crate) fn compare(paths: &[PathBuf], runs: &[StoredRun]) -> Comparison {
    let Some((first, others)) = runs.split_first() else {
        return Comparison { runs: vec![], figures: vec![], texts: vec![], columns: vec![], missing: vec![] };
    };
    let mut missing = Vec::new();
    let figures = first.figures.iter().filter_map(|(name, reference)| {
        let of_others: Option<Vec<f64>> = others.iter().map(|run| run.figure(name)).collect();
        let Some(of_others) = of_others else {
            missing.push(name.clone());
            return None;
        };
        let values: Vec<f64> = [*reference].into_iter().chain(of_others).collect();
        let differences = values.iter().map(|value| value - reference).collect();
        Some(FigureRow { name: name.clone(), values, differences })
    });
    let figures = figures.collect();
    let columns = first.columns.iter().filter_map(|(name, _)| {
        let differences: Option<Vec<Option<Difference>>> =
            runs.iter().map(|run| Some(largest(&difference(first, run, name)?))).collect();
        match differences {
            Some(differences) => Some(ColumnRow { name: name.clone(), differences }),
            None => {
                missing.push(name.clone());
                None
            }
        }
    });
    let columns = columns.collect();
    let only_in_others = others.iter().flat_map(|run| {
        let figures = run.figures.iter().map(|(name, _)| name).filter(|name| first.figure(name).is_none());
        let columns = run.columns.iter().map(|(name, _)| name).filter(|name| first.column(name).is_none());
        figures.chain(columns).cloned()
    });
    missing.extend(only_in_others);
    missing.sort_unstable();
    missing.dedup();
    let runs = paths.iter().map(|path| path.display().to_string()).collect();
    Comparison { runs, figures, texts: texts(first, others), columns, missing }
}

/// Texts that all runs have and that differ.
fn texts(first: &StoredRun, others: &[StoredRun]) -> Vec<TextRow> {
    let row = |(name, reference): &(String, String)| {
        let of_others: Option<Vec<String>> = others.iter().map(|run| run.text(name).cloned()).collect();
        let values: Vec<String> = [reference.clone()].into_iter().chain(of_others?).collect();
        let is_changed = values.iter().any(|value| value != reference);
        is_changed.then(|| TextRow { name: name.clone(), values })
    };
    first.texts.iter().filter_map(row).collect()
}

/// Difference of a run's column from that of the first run at the times of the run, interpolated
/// linearly between the samples of the first; `None` if a run does not have the column.
fn difference(first: &StoredRun, run: &StoredRun, name: &str) -> Option<Vec<(f64, f64)>> {
    let (reference, found) = (first.column(name)?, run.column(name)?);
    let (times, mut below) = (&first.times_s, 0);
    let at = |(&time, &value): (&f64, &f64)| {
        while times.get(below + 1).is_some_and(|next| *next <= time) {
            below += 1;
        }
        let (from, start) = (*times.get(below)?, *reference.get(below)?);
        if from == time {
            return Some((time, value - start));
        }
        let (to, end) = (*times.get(below + 1)?, *reference.get(below + 1)?);
        (from < time).then(|| (time, value - start - (end - start) * (time - from) / (to - from)))
    };
    Some(run.times_s.iter().zip(found).filter_map(at).filter(|point| point.1.is_finite()).collect())
}

/// Summary of differences; `None` if there are none.
fn largest(points: &[(f64, f64)]) -> Option<Difference> {
    let by_size = |a: &&(f64, f64), b: &&(f64, f64)| a.1.abs().total_cmp(&b.1.abs());
    let (time_s, value) = points.iter().max_by(by_size).copied()?;
    let rms = rms(points.iter().map(|point| point.1));
    Some(Difference { samples: points.len(), rms, max: value.abs(), time_s })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(times_s: &[f64], values: &[f64], peak: f64) -> StoredRun {
        StoredRun {
            figures: vec![("peak_n".into(), peak)],
            texts: vec![],
            times_s: times_s.to_vec(),
            columns: vec![("force_n".into(), values.to_vec())],
        }
    }

    #[test]
    fn differences_are_taken_at_equal_times() {
        let first = run(&[0.0, 1.0, 2.0], &[0.0, 10.0, 20.0], 20.0);
        let second = run(&[0.0, 0.5, 1.5, 2.0, 2.5], &[0.0, 5.0, 18.0, 20.0, 99.0], 20.5);
        let compared = compare(&["a".into(), "b".into()], &[first, second]);
        let difference = compared.columns[0].differences[1].unwrap();
        assert_eq!((difference.max, difference.time_s), (3.0, 1.5), "2.5 s lies after the first log");
        assert_eq!(difference.samples, 4);
        assert!((difference.rms - (9.0_f64 / 4.0).sqrt()).abs() < 1e-12);
        assert_eq!(compared.figures[0].differences, [0.0, 0.5]);
    }

    #[test]
    fn a_value_that_is_no_number_does_not_enter_the_difference() {
        let first = run(&[0.0, 1.0], &[0.0, f64::NAN], 1.0);
        let compared = compare(&["a".into(), "b".into()], &[first, run(&[0.0, 1.0], &[2.0, 3.0], 1.0)]);
        assert_eq!(compared.columns[0].differences[1].unwrap().max, 2.0);
    }

    #[test]
    fn logs_without_a_common_time_or_value_are_not_called_equal() {
        let first = run(&[0.0, 1.0], &[1.0, 1.0], 1.0);
        let later = run(&[10.0, 11.0], &[1.0, 1.0], 1.0);
        let empty = run(&[0.0, 1.0], &[f64::NAN, f64::NAN], 1.0);
        let compared = compare(&["a".into(), "b".into(), "c".into()], &[first, later, empty]);
        assert!(compared.columns[0].differences[1..].iter().all(Option::is_none));
        let (_, rows) = report::columns(&compared);
        assert_eq!(rows[0][1..], ["reference", "no common values", "no common values"]);
    }

    #[test]
    fn texts_that_differ_are_listed() {
        let [mut first, mut second] = [1.0, 2.0].map(|peak| run(&[0.0], &[0.0], peak));
        first.texts = vec![("force".into(), "law".into()), ("plant".into(), "bench".into())];
        second.texts = vec![("force".into(), "network".into()), ("plant".into(), "bench".into())];
        let compared = compare(&["a".into(), "b".into()], &[first, second]);
        assert_eq!(compared.texts.len(), 1);
        assert_eq!(compared.texts[0].values, ["law", "network"]);
    }

    #[test]
    fn quantities_of_one_run_alone_are_listed() {
        let mut second = run(&[0.0], &[0.0], 1.0);
        second.figures.push(("estimate_n".into(), 3.0));
        second.columns[0].0 = "torque_nm".into();
        let compared = compare(&["a".into(), "b".into()], &[run(&[0.0], &[0.0], 1.0), second]);
        assert_eq!(compared.missing, ["estimate_n", "force_n", "torque_nm"]);
        assert_eq!((compared.figures.len(), compared.columns.len()), (1, 0));
    }
}
