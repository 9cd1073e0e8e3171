//! Parallel work with results in the order of the input.

use crate::cli::error::CliError;
use rayon::prelude::*;

/// Applies `work` to every item on `threads` threads (0: one per core).
pub(crate) fn map<T: Sync, R: Send>(
    threads: usize,
    items: &[T],
    work: impl Fn(usize, &T) -> Result<R, CliError> + Sync,
) -> Result<Vec<R>, CliError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| CliError::Work(format!("threads: {e}")))?;
    // Items are assigned one by one, because runs differ in length.
    pool.install(|| items.par_iter().with_max_len(1).enumerate().map(|(i, item)| work(i, item)).collect())
}
