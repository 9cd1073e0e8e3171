//! Names of layers in messages.

use core::fmt;

/// A layer of a network, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerName {
    /// Name of the network.
    pub network: &'static str,
    /// Position of the layer in its network, from 0.
    pub index: u8,
}

impl LayerName {
    /// Returns the name of the next layer.
    pub fn next(self) -> Self {
        Self { index: self.index.saturating_add(1), ..self }
    }
}

impl fmt::Display for LayerName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "layer {} of the {} network", self.index, self.network)
    }
}
