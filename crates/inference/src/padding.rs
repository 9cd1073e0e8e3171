//! Padding of a window: a value, and types that select it.

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
