//! Options of a quantisation: widths of weights and activations, and storage of the weights.

use serde::Serialize;

/// Widths of weights and of activations between the layers. Features always have 16 bits, sums and
/// biases 32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Weights of 8 bits, activations of 16 (default)
    #[default]
    W8a16,
    /// Weights and activations of 8 bits: compact
    W8a8,
    /// Weights of up to 16 bits, as many as the 32-bit sums allow, activations of 16: the reference
    W16a16,
}

impl Mode {
    /// Every mode.
    pub const ALL: [Self; 3] = [Self::W8a16, Self::W8a8, Self::W16a16];

    /// Name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::W8a16 => "w8a16",
            Self::W8a8 => "w8a8",
            Self::W16a16 => "w16a16",
        }
    }

    /// Returns true if weights have 8 bits and so lie on the grid of the training.
    pub(crate) const fn has_narrow_weights(self) -> bool {
        !matches!(self, Self::W16a16)
    }
}

/// Storage of 8-bit weights with 16-bit activations; it does not change the estimates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Packing {
    /// Widened to 16 bits: fewer instructions (default)
    #[default]
    Speed,
    /// 8 bits: half the flash
    Flash,
}

impl Packing {
    /// Name on the command line.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Flash => "flash",
        }
    }
}

/// All options of a quantisation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    /// Widths of weights and activations.
    pub mode: Mode,
    /// Storage of the weights.
    pub packing: Packing,
}
