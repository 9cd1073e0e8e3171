//! A network over a complete window of `P` columns, or over one that moved by a column.

use crate::chain::{Chain, forget_oldest};
use crate::kernel::{Engine, Native};
use crate::padding::{Pad, Padding};
use crate::weights::LayerInput;
use core::marker::PhantomData;

/// A network over a window of `P` columns.
///
/// The head takes the newest columns of the last convolution. A window with too few columns for it
/// does not compile.
#[derive(Clone, Debug)]
pub struct Windowed<'a, N: Chain<'a, A, IN>, A: LayerInput, const IN: usize, const P: usize, D, E = Native> {
    network: N,
    window: N::Window<P>,
    kind: PhantomData<(&'a (), D, E)>,
}

impl<'a, N: Chain<'a, A, IN>, A: LayerInput, const IN: usize, const P: usize, D: Pad, E: Engine>
    Windowed<'a, N, A, IN, P, D, E>
{
    /// Creates a window of zeros and computes its layers.
    pub fn new(network: N) -> Self {
        const {
            let least = match D::PADDING {
                Padding::Valid => N::WINDOW,
                Padding::Causal | Padding::Same => N::HEAD_COLUMNS,
            };
            assert!(P >= least, "the window has fewer columns than the head takes");
        };
        let mut windowed = Self { network, window: N::window(), kind: PhantomData };
        windowed.evaluate(&[[A::default(); IN]; P]);
        windowed
    }

    /// Replaces the complete window, oldest column first; returns the head's sums and the number of
    /// clipped activations.
    pub fn evaluate(&mut self, columns: &[[A; IN]; P]) -> (N::Output, u32) {
        *N::columns(&mut self.window) = *columns;
        self.network.evaluate::<E, P>(&mut self.window, D::PADDING, P)
    }

    /// Drops the oldest column, appends a new one and computes what changes: the same sums as
    /// [`Self::evaluate`] over the moved window. Only activations that were computed are counted as
    /// clipped.
    pub fn slide(&mut self, newest: &[A; IN]) -> (N::Output, u32) {
        let columns = N::columns(&mut self.window);
        forget_oldest(columns);
        if let Some(last) = columns.last_mut() {
            *last = *newest;
        }
        self.network.slide::<E, P>(&mut self.window, D::PADDING, P, [0, 1])
    }
}
