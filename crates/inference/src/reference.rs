//! The same network written a second time, plainly: one window in, one accumulator out.
//!
//! Direct loops over output, tap and channel in 64-bit arithmetic, no history. It is the oracle that the streaming
//! kernels are tested against, position by position, and is not used on the controller.

use crate::layer::Convolution;
use crate::layout::{CHANNELS, HEAD_COLUMNS, HIDDEN_TAPS, KERNEL, WINDOW};
use crate::network::Network;

/// Reads a column; a column from before the start is zero.
fn at<const C: usize>(columns: &[[i16; C]], position: Option<usize>, channel: usize) -> i64 {
    position.and_then(|p| columns.get(p)?.get(channel)).copied().map_or(0, i64::from)
}

/// One column of a convolution over `columns`, whose newest column is at `position`.
fn convolve<const C: usize, const TAPS: usize>(
    layer: &Convolution<'_, TAPS>,
    columns: &[[i16; C]],
    position: usize,
) -> [i16; CHANNELS] {
    core::array::from_fn(|output| {
        let mut sum = i64::from(layer.bias(output).unwrap_or(0));
        for tap in 0..KERNEL {
            let source = (position + tap).checked_sub(KERNEL - 1);
            for channel in 0..C {
                let weight = layer.weight(output, tap * C + channel).unwrap_or(0);
                sum += i64::from(weight) * at(columns, source, channel);
            }
        }
        let scaled = i128::from(sum.max(0)) * i128::from(layer.multiplier(output).unwrap_or(0));
        ((scaled + (1 << 31)) >> 32).min(i128::from(i16::MAX)) as i16
    })
}

fn head<const TAPS: usize>(network: &Network<'_, TAPS>, columns: &[[i16; CHANNELS]], position: usize) -> i64 {
    let mut sum = i64::from(network.head.bias());
    for column in 0..HEAD_COLUMNS {
        let source = (position + column).checked_sub(HEAD_COLUMNS - 1);
        for channel in 0..CHANNELS {
            let weight = network.head.weight(column * CHANNELS + channel).unwrap_or(0);
            sum += i64::from(weight) * at(columns, source, channel);
        }
    }
    sum
}

/// 'Valid' evaluation of the last [`WINDOW`] columns, oldest first: what a warm stream gives after the newest one.
pub fn window<const C: usize, const TAPS: usize>(
    network: &Network<'_, TAPS>,
    columns: &[[i16; C]; WINDOW],
) -> i64 {
    const REACH: usize = KERNEL - 1;
    let first: [_; WINDOW - REACH] = core::array::from_fn(|p| convolve(&network.first, columns, p + REACH));
    let second: [_; WINDOW - 2 * REACH] =
        core::array::from_fn(|p| convolve(&network.second, &first, p + REACH));
    let third: [_; HEAD_COLUMNS] = core::array::from_fn(|p| convolve(&network.third, &second, p + REACH));
    head(network, &third, HEAD_COLUMNS - 1)
}

/// Causal evaluation over a whole history of up to `N` columns with zero padding before every layer; gives the
/// accumulator at every position.
pub fn whole_history<const C: usize, const TAPS: usize, const N: usize>(
    network: &Network<'_, TAPS>,
    columns: &[[i16; C]; N],
) -> [i64; N] {
    let first: [_; N] = core::array::from_fn(|p| convolve(&network.first, columns, p));
    let second: [_; N] = core::array::from_fn(|p| convolve(&network.second, &first, p));
    let third: [_; N] = core::array::from_fn(|p| convolve(&network.third, &second, p));
    core::array::from_fn(|p| head(network, &third, p))
}

const _: () = assert!(WINDOW == 3 * (KERNEL - 1) + HEAD_COLUMNS && HIDDEN_TAPS == KERNEL * CHANNELS);
