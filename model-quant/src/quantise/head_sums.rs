//! Sums of a network's head over windows of fixed-point features, computed by the inference engine.

use inference::chain::{Chain, Sums};
use inference::{Streaming, WINDOW};

/// Runs a network over each window from an empty history; returns the sum after the newest column.
pub(crate) fn head_sums<'a, N: Chain<'a, i16, C, Output = Sums<1>> + Copy, const C: usize>(
    network: N,
    windows: &[[[i16; C]; WINDOW]],
) -> Vec<i32> {
    let mut stream = Streaming::<_, i16, C>::new(network);
    (windows.iter())
        .map(|window| {
            stream.reset();
            let Sums([sum]) = window.map(|column| stream.push(&column).0)[WINDOW - 1];
            sum
        })
        .collect()
}
