//! The runs of a sweep on all cores; what the journal has is not run again.

use super::journal::{Journal, Record};
use super::points::Point;
use crate::error::CliError;
use crate::force::{self, ForceSource, SAMPLE_RATE_HZ};
use crate::parallel;
use crate::summary::Figures;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Runs what is missing; gives every record in the order of the points. A run that fails is recorded with its reason.
pub fn run(
    points: &[Point],
    (source, step_s): (ForceSource, f64),
    threads: usize,
    (journal, mut finished): (Journal, BTreeMap<usize, Record>),
    progress: impl Fn() + Sync,
) -> Result<Vec<Record>, CliError> {
    let missing: Vec<usize> = (0..points.len()).filter(|i| !finished.contains_key(i)).collect();
    let journal = Mutex::new(journal);
    let fresh = parallel::map(threads, &missing, |_, &index| {
        let point = points.get(index).ok_or_else(|| CliError::Work(format!("no point {index}")))?;
        let started = Instant::now();
        let outcome = force::run_bench(&point.bench, source, step_s, || {})
            .map(|forced| Figures::of(&point.bench, source, &forced, SAMPLE_RATE_HZ))
            .map_err(|e| e.to_string());
        let record = Record { index, outcome, wall_s: started.elapsed().as_secs_f64() };
        journal.lock().unwrap_or_else(PoisonError::into_inner).add(&record)?;
        progress();
        Ok(record)
    })?;
    finished.extend(fresh.into_iter().map(|record| (record.index, record)));
    Ok(finished.into_values().collect())
}
