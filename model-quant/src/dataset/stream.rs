//! Rows made on all threads and taken in their order, a batch at a time.
//!
//! A batch is 16 blocks; while one is written the next is made, so two batches are in memory and no more: about
//! 5 million numbers each, 20 MB as columns and 60 MB as text. The division into batches and blocks depends on the number of
//! columns alone, so files and sums are the same bytes on any number of threads.

use rayon::prelude::*;
use std::ops::Range;

/// Numbers in a batch.
const BATCH_NUMBERS: u64 = 5 << 20;
/// Blocks of a batch.
const BLOCKS: u64 = 16;

/// Makes `rows` of a table with `columns` columns block by block and hands them over in order.
pub fn stream<T: Send, E: Send>(
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
    fn every_row_comes_once_and_in_order_and_few_are_held() {
        let (made, mut taken, mut most) = (AtomicU64::new(0), 0, 0);
        let make = |rows: Range<u64>| {
            made.fetch_add(rows.end - rows.start, Ordering::Relaxed);
            rows
        };
        let result: Result<(), ()> = stream(3..40_000_000, 5, make, |blocks| {
            // The batch in hand and the one being made.
            most = most.max(made.load(Ordering::Relaxed) - taken);
            for block in blocks {
                assert_eq!(block.start, taken + 3);
                taken = block.end - 3;
            }
            Ok(())
        });
        assert!(result.is_ok());
        assert_eq!(taken + 3, 40_000_000);
        assert!(most <= 2 << 20, "{most}");
    }

    #[test]
    fn nothing_to_do_is_done_and_an_error_ends_it() {
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
