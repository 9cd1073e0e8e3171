//! Work on all cores with the outcome in the order of the input, whatever the number of threads.

use crate::error::CliError;
use rayon::prelude::*;

/// Applies `work` to every item on `threads` threads (0: one a core).
pub(crate) fn map<T: Sync, R: Send>(
    threads: usize,
    items: &[T],
    work: impl Fn(usize, &T) -> Result<R, CliError> + Sync,
) -> Result<Vec<R>, CliError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| CliError::Work(format!("threads: {e}")))?;
    // Items are handed out one by one: runs differ in length, and a thread that got the long half would be waited for.
    pool.install(|| items.par_iter().with_max_len(1).enumerate().map(|(i, item)| work(i, item)).collect())
}
