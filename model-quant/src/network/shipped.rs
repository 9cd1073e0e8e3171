//! Checked-in trainings of the shipped models: checkpoints and histories in `model-quant/models`.

use inference::BearingMaterial;

/// Checked-in files of a bearing's training.
#[derive(Clone, Copy)]
pub(crate) struct ShippedTraining {
    /// Bytes of the checkpoint.
    pub checkpoint: &'static [u8],
    /// Path and text of the history.
    pub history: (&'static str, &'static str),
}

/// Embeds the files of a bearing's training by their name.
macro_rules! embedded {
    ($name:literal) => {
        ShippedTraining {
            checkpoint: include_bytes!(concat!("../../models/", $name, ".float")),
            history: (
                concat!("models/", $name, ".history.json"),
                include_str!(concat!("../../models/", $name, ".history.json")),
            ),
        }
    };
}

/// Returns the shipped training of a bearing.
pub(crate) fn shipped_training(bearing: BearingMaterial) -> ShippedTraining {
    const SHIPPED: [ShippedTraining; BearingMaterial::COUNT] = contact::embed_for_each_material!(embedded);
    SHIPPED[bearing as usize]
}

/// Returns the bytes of the shipped checkpoint of a bearing.
pub fn shipped_checkpoint(bearing: BearingMaterial) -> &'static [u8] {
    shipped_training(bearing).checkpoint
}

/// Returns the names of the bearing materials for an error.
pub(crate) fn bearing_names() -> String {
    BearingMaterial::ALL.map(|material| format!("`{}`", material.name())).join(" or ")
}
