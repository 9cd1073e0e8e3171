//! Runs the points of a shard on all cores, except those in the journal.

use super::journal::Record;
use super::points::Point;
use crate::cli::error::CliError;
use crate::cli::parallel;
use crate::journal::Journal;
use crate::run::force::{self, ForceSource, SAMPLE_RATE_HZ};
use crate::run::summary::Figures;
use crate::shard::Shard;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Runs the missing points of a shard and returns every record in the order of the points. A run
/// that fails is recorded with its reason.
pub(crate) fn run(
    (points, shard): (&[Point], Shard),
    (source, step_s): (ForceSource, f64),
    threads: usize,
    (journal, mut finished): (Journal, BTreeMap<usize, Record>),
    progress: impl Fn() + Sync,
) -> Result<Vec<Record>, CliError> {
    let is_missing = |index: &usize| shard.contains(*index) && !finished.contains_key(index);
    let missing: Vec<usize> = (0..points.len()).filter(is_missing).collect();
    let journal = Mutex::new(journal);
    let fresh = parallel::map(threads, &missing, |_, &index| {
        let point = points.get(index).ok_or_else(|| CliError::Work(format!("no point {index}")))?;
        let started = Instant::now();
        let outcome = force::run_bench(&point.bench, source, step_s, || {})
            .map(|forced| Figures::from_run(&point.bench, source, &forced, SAMPLE_RATE_HZ))
            .map_err(|e| e.to_string());
        let record = Record { index, outcome, wall_s: started.elapsed().as_secs_f64() };
        journal.lock().unwrap_or_else(PoisonError::into_inner).append(&record)?;
        progress();
        Ok(record)
    })?;
    finished.extend(fresh.into_iter().map(|record| (record.index, record)));
    Ok(finished.into_values().collect())
}
