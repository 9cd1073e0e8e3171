//! Order of the axes of a network's input.

/// Order of the input's axes after the batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Layout {
    /// Columns, then the values of a column, as in Keras.
    ColumnsFirst,
    /// Values of a column, then columns, as in PyTorch.
    ChannelsFirst,
}
