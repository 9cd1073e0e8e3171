//! A stream whose work is spread over several ticks, for cores that cannot do it in one.

use crate::activation::Activation;
use crate::chain::Chain;
use crate::kernel::{Engine, Native};
use core::marker::PhantomData;

/// A streaming network that takes a column every `TICKS` ticks and does about the same share of the work in each.
///
/// The sums are those of [`crate::Streaming`], `TICKS - 1` ticks later.
#[derive(Clone, Debug)]
pub struct Interleaved<
    'a,
    N: Chain<'a, A, IN>,
    A: Activation,
    const IN: usize,
    const TICKS: usize,
    E = Native,
> {
    network: N,
    stream: N::Stream,
    ends: [usize; TICKS],
    done: usize,
    tick: usize,
    clipped: u32,
    engine: PhantomData<(&'a (), E, A)>,
}

impl<'a, N: Chain<'a, A, IN>, A: Activation, const IN: usize, const TICKS: usize, E: Engine>
    Interleaved<'a, N, A, IN, TICKS, E>
{
    /// A stream that has seen nothing.
    pub fn new(network: N) -> Self {
        const { assert!(TICKS > 0) };
        let mut ends = [N::UNITS; TICKS];
        let (mut unit, mut macs) = (0usize, 0usize);
        for (tick, end) in ends.iter_mut().enumerate() {
            let share = N::MACS.wrapping_mul(tick.wrapping_add(1)) / TICKS;
            while unit < N::UNITS && share > macs.wrapping_add(N::unit_macs(unit) / 2) {
                macs = macs.wrapping_add(N::unit_macs(unit));
                unit = unit.wrapping_add(1);
            }
            *end = unit;
        }
        if let Some(last) = ends.last_mut() {
            *last = N::UNITS;
        }
        Self {
            network,
            stream: N::stream(),
            ends,
            done: N::UNITS,
            tick: TICKS,
            clipped: 0,
            engine: PhantomData,
        }
    }

    /// Takes the next column; `false`, and the column is not taken, while the work of the one before is not done.
    #[inline]
    #[must_use = "a column that is not taken is lost"]
    pub fn begin(&mut self, column: &[A; IN]) -> bool {
        if self.tick < TICKS {
            return false;
        }
        N::accept(&mut self.stream, column);
        (self.done, self.tick, self.clipped) = (0, 0, 0);
        true
    }

    /// As [`crate::Streaming::altered`], of the column that was taken last.
    pub fn altered(&self) -> bool {
        N::altered(&self.stream) != 0
    }

    /// Does this tick's share; in the last tick of a column, gives the head's sums and how many activations were
    /// clipped. Before the first column and between the last tick and the next column there is nothing to do: `None`.
    #[inline]
    pub fn tick(&mut self) -> Option<(N::Output, u32)> {
        if self.tick >= TICKS {
            return None;
        }
        let end = self.ends.get(self.tick).copied().unwrap_or(N::UNITS);
        let clipped = self.network.run::<E>(&mut self.stream, self.done..end);
        self.clipped = self.clipped.wrapping_add(clipped);
        self.done = end;
        self.tick = self.tick.wrapping_add(1);
        (self.tick == TICKS).then(|| (N::output(&self.stream), self.clipped))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Streaming;
    use crate::bearing::{Bearing, shipped};
    use crate::model::Model;

    #[test]
    fn a_bit_that_flips_in_the_history_is_told_once() {
        let model = Model::<i16>::load(shipped(Bearing::Babbitt)).unwrap();
        let column = [1_000; 8];
        let mut streaming = Streaming::<_, i16, 8>::new(*model.collision());
        let mut interleaved = Interleaved::<_, i16, 8, 3>::new(*model.collision());
        let mut told = |flip: bool| {
            let mut told = [0, 0];
            for number in 0..30 {
                streaming.push(&column);
                assert!(interleaved.begin(&column));
                assert_eq!((0..3).filter_map(|_| interleaved.tick()).count(), 1);
                if flip && number == 9 {
                    streaming.stream.history().bytes()[5] ^= 4;
                    interleaved.stream.history().bytes()[5] ^= 4;
                }
                told[0] += u32::from(streaming.altered());
                told[1] += u32::from(interleaved.altered());
            }
            told
        };
        assert_eq!((told(false), told(true)), ([0, 0], [1, 1]));
    }
}
