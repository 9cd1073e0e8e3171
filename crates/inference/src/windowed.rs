//! A network over a complete window of `P` columns, or over one that moved by a column.

use crate::activation::Activation;
use crate::chain::{Chain, forget_oldest};
use crate::kernel::{Engine, Native};
use core::marker::PhantomData;

/// Columns that a convolution sees outside a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Padding {
    /// Zeros before the oldest column: as many outputs as inputs, none depends on later columns.
    Causal,
    /// Zeros on both sides (one more after the newest for even kernels): as many outputs as inputs,
    /// each centred on its inputs.
    Same,
    /// No padding: fewer outputs than inputs.
    Valid,
}

impl Padding {
    /// Number of zero columns before the oldest.
    pub const fn before(self, kernel: usize) -> usize {
        match self {
            Self::Causal => kernel.saturating_sub(1),
            Self::Same => kernel.saturating_sub(1) / 2,
            Self::Valid => 0,
        }
    }

    /// Number of outputs of a convolution over this number of columns.
    pub const fn outputs(self, columns: usize, kernel: usize) -> usize {
        match self {
            Self::Causal | Self::Same => columns,
            Self::Valid => columns.saturating_sub(kernel.saturating_sub(1)),
        }
    }

    /// Number of outputs at the old end that a move of the window changes because they see padding.
    pub(crate) const fn stale_left(self, kernel: usize) -> usize {
        self.before(kernel)
    }

    /// Number of outputs at the new end that a move of the window changes because they see padding.
    pub(crate) const fn stale_right(self, kernel: usize) -> usize {
        match self {
            Self::Causal | Self::Valid => 0,
            Self::Same => kernel / 2,
        }
    }
}

/// A padding as a type.
pub trait Pad {
    /// The padding.
    const PADDING: Padding;
}

/// [`Padding::Causal`].
#[derive(Clone, Copy, Debug)]
pub struct Causal;
/// [`Padding::Same`].
#[derive(Clone, Copy, Debug)]
pub struct Same;
/// [`Padding::Valid`].
#[derive(Clone, Copy, Debug)]
pub struct Valid;

impl Pad for Causal {
    const PADDING: Padding = Padding::Causal;
}
impl Pad for Same {
    const PADDING: Padding = Padding::Same;
}
impl Pad for Valid {
    const PADDING: Padding = Padding::Valid;
}

/// A network over a window of `P` columns.
///
/// The head takes the newest columns of the last convolution. A window with too few columns for it
/// does not compile.
#[derive(Clone, Debug)]
pub struct Windowed<'a, N: Chain<'a, A, IN>, A: Activation, const IN: usize, const P: usize, D, E = Native> {
    network: N,
    window: N::Window<P>,
    kind: PhantomData<(&'a (), D, E)>,
}

impl<'a, N: Chain<'a, A, IN>, A: Activation, const IN: usize, const P: usize, D: Pad, E: Engine>
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
