//! A network as a stream: each new column gives the sums of the newest window for the work of one
//! column.

use crate::chain::Chain;
use crate::kernel::{Engine, Native};
use crate::weights::LayerInput;
use core::marker::PhantomData;

/// A network with the columns that its layers depend on.
///
/// After [`Chain::WINDOW`] columns the sums are those of the newest window without padding; before
/// that, of a window with causal zeros.
#[derive(Clone, Debug)]
pub struct Streaming<'a, N: Chain<'a, A, IN>, A: LayerInput, const IN: usize, E = Native> {
    network: N,
    pub(crate) stream: N::Stream,
    engine: PhantomData<(&'a (), E)>,
}

impl<'a, N: Chain<'a, A, IN>, A: LayerInput, const IN: usize, E: Engine> Streaming<'a, N, A, IN, E> {
    /// Creates a stream with an empty history.
    pub fn new(network: N) -> Self {
        Self { network, stream: N::stream(), engine: PhantomData }
    }

    /// Appends a column; returns the head's sums and the number of clipped activations.
    #[inline]
    pub fn push(&mut self, column: &[A; IN]) -> (N::Output, u32) {
        N::accept(&mut self.stream, column);
        let clipped = self.network.run::<E>(&mut self.stream);
        (N::output(&self.stream), clipped)
    }

    /// Clears the history.
    pub fn reset(&mut self) {
        self.stream = N::stream();
    }
}
