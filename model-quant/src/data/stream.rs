//! Generation of rows on all threads, delivered in order and in batches.
//!
//! A batch is 16 blocks. While one is written the next is generated, so at most two
//! batches are in memory: about 5 million numbers each, 20 MB as columns and 60 MB as text. The
//! division into batches and blocks depends on the number of columns alone, so files and sums have
//! the same bytes on any number of threads.

use rayon::prelude::*;
use std::ops::Range;

/// Numbers in a batch.
const BATCH_NUMBERS: u64 = 5 << 20;
/// Blocks of a batch.
const BLOCKS: u64 = 16;

/// Generates `rows` of a table with `columns` columns block by block and passes them to `take` in
/// order.
pub(crate) fn stream<T: Send, E: Send>(
    rows: Range<u64>,
    columns: usize,
    make: impl Fn(Range<u64>) -> T + Sync,
    mut take: impl FnMut(Vec<T>) -> Result<(), E> + Send,
) -> Result<(), E> {
    let block = (BATCH_NUMBERS / BLOCKS / columns.max(1) as u64).max(1);
    let batch = |start: u64| -> Vec<T> {
        let starts = (0..BLOCKS).map(|k| start + k * block).filter(|&start| start < rows.end);
        let starts: Vec<u64> = starts.collect();
        starts.into_par_iter().map(|start| make(start..(start + block).min(rows.end))).collect()
    };
    let mut start = rows.start;
    let mut ready = batch(start);
    while !ready.is_empty() {
        start += BLOCKS * block;
        let (taken, next) = rayon::join(|| take(ready), || batch(start));
        taken?;
        ready = next;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};

    #[test]
    fn every_row_is_delivered_once_in_order_with_bounded_memory() {
        let (made, mut taken, mut max_in_memory) = (AtomicU64::new(0), 0, 0);
        let make = |rows: Range<u64>| {
            made.fetch_add(rows.end - rows.start, Ordering::Relaxed);
            rows
        };
        let result: Result<(), ()> = stream(3..40_000_000, 5, make, |blocks| {
            // The batch being written and the one being generated.
            max_in_memory = max_in_memory.max(made.load(Ordering::Relaxed) - taken);
            for block in blocks {
                assert_eq!(block.start, taken + 3);
                taken = block.end - 3;
            }
            Ok(())
        });
        assert!(result.is_ok());
        assert_eq!(taken + 3, 40_000_000);
        assert!(max_in_memory <= 2 << 20, "{max_in_memory}");
    }

    #[test]
    fn an_empty_range_succeeds_and_an_error_ends_the_stream() {
        let never = |_: Vec<u64>| -> Result<(), ()> { Err(()) };
        assert!(stream(5..5, 4, |rows| rows.start, never).is_ok());
        let mut batches = 0;
        let result = stream(
            0..u64::from(u32::MAX),
            1,
            |rows| rows.start,
            |_| {
                batches += 1;
                if batches < 3 { Ok(()) } else { Err("full") }
            },
        );
        assert_eq!((result, batches), (Err("full"), 3));
    }
}
