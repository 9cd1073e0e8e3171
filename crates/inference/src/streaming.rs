//! A network as a stream: one column in, the sums of the newest window out, the work of one column only.

use crate::activation::Activation;
use crate::chain::Chain;
use crate::kernel::{Engine, Native};
use core::marker::PhantomData;

/// A network and the columns that its layers look back at.
///
/// After [`Chain::WINDOW`] columns the sums are those of the newest window without padding; before that, of a window with
/// causal zeros.
#[derive(Clone, Debug)]
pub struct Streaming<'a, N: Chain<'a, A, IN>, A: Activation, const IN: usize, E = Native> {
    network: N,
    pub(crate) stream: N::Stream,
    engine: PhantomData<(&'a (), E)>,
}

impl<'a, N: Chain<'a, A, IN>, A: Activation, const IN: usize, E: Engine> Streaming<'a, N, A, IN, E> {
    /// A stream that has seen nothing.
    pub fn new(network: N) -> Self {
        Self { network, stream: N::stream(), engine: PhantomData }
    }

    /// Takes one column and gives the head's sums and how many activations were clipped.
    #[inline]
    pub fn push(&mut self, column: &[A; IN]) -> (N::Output, u32) {
        N::accept(&mut self.stream, column);
        let clipped = self.network.run::<E>(&mut self.stream, 0..N::UNITS);
        (N::output(&self.stream), clipped)
    }

    /// Whether a bit of the column that left last in any layer was not what it had been: the sums rested on it. Every column is kept twice for that.
    pub fn altered(&self) -> bool {
        N::altered(&self.stream) != 0
    }

    /// Forgets every column.
    pub fn reset(&mut self) {
        self.stream = N::stream();
    }
}
