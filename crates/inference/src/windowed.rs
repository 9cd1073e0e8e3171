//! A network over a window of `P` columns at once, or moved on by one column.

use crate::activation::Activation;
use crate::chain::{Chain, forget_oldest};
use crate::kernel::{Engine, Native};
use core::marker::PhantomData;

/// What a convolution sees beyond the ends of a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Padding {
    /// Zeros before the oldest column: as many outputs as inputs, none of them knows the future.
    Causal,
    /// Zeros on both sides (one more behind for even kernels): as many outputs as inputs, each in the middle of what it sees.
    Same,
    /// Nothing: fewer outputs than inputs.
    Valid,
}

impl Padding {
    /// Zero columns before the oldest.
    pub const fn before(self, kernel: usize) -> usize {
        match self {
            Self::Causal => kernel.saturating_sub(1),
            Self::Same => kernel.saturating_sub(1) / 2,
            Self::Valid => 0,
        }
    }

    /// Outputs of a convolution over so many columns.
    pub const fn outputs(self, columns: usize, kernel: usize) -> usize {
        match self {
            Self::Causal | Self::Same => columns,
            Self::Valid => columns.saturating_sub(kernel.saturating_sub(1)),
        }
    }

    /// Further outputs at the old end that a move of the window changes: those that see padding.
    pub(crate) const fn stale_left(self, kernel: usize) -> usize {
        self.before(kernel)
    }

    /// Further outputs at the new end that a move of the window changes.
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
/// The head takes the newest columns of the last convolution. A window with too few columns for it does not compile.
#[derive(Clone, Debug)]
pub struct Windowed<'a, N: Chain<'a, A, IN>, A: Activation, const IN: usize, const P: usize, D, E = Native> {
    network: N,
    window: N::Window<P>,
    kind: PhantomData<(&'a (), D, E)>,
}

impl<'a, N: Chain<'a, A, IN>, A: Activation, const IN: usize, const P: usize, D: Pad, E: Engine>
    Windowed<'a, N, A, IN, P, D, E>
{
    /// A window of zeros, its layers computed.
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

    /// Takes a whole window, oldest column first, and gives the head's sums and how many activations were clipped.
    pub fn evaluate(&mut self, columns: &[[A; IN]; P]) -> (N::Output, u32) {
        *N::columns(&mut self.window) = *columns;
        self.network.evaluate::<E, P>(&mut self.window, D::PADDING, P)
    }

    /// Drops the oldest column, takes a new one, and computes what that changes: the same sums as [`Self::evaluate`] over the
    /// moved window. The count of clipped activations is of those that were computed.
    pub fn slide(&mut self, newest: &[A; IN]) -> (N::Output, u32) {
        let columns = N::columns(&mut self.window);
        forget_oldest(columns);
        if let Some(last) = columns.last_mut() {
            *last = *newest;
        }
        self.network.slide::<E, P>(&mut self.window, D::PADDING, P, [0, 1])
    }
}
