//! The networks that a controller runs, by bearing.

use inference::{BearingMaterial, Model, shipped};
use link::update::ModelSource;
use link::{MODELS, ModelId};
use model_package::Checked;

/// An image and the model over it.
pub type Loaded = Checked<'static>;

/// Returns the built-in image of a bearing; `None` if it is damaged.
fn built_in(bearing: BearingMaterial) -> Option<Loaded> {
    let image = shipped(bearing);
    let model = Model::load(image).ok()?;
    (model.header().bearing == bearing).then_some(Loaded { image, model })
}

/// Networks of every bearing. A package may hold those of one bearing only; the built-in ones
/// complete it.
#[derive(Clone, Copy, Debug)]
pub struct Models {
    by_bearing: [Option<Loaded>; BearingMaterial::COUNT],
    source: ModelSource,
}

impl Models {
    /// Returns the built-in networks.
    #[must_use]
    pub fn built_in() -> Self {
        Self { by_bearing: BearingMaterial::ALL.map(built_in), source: ModelSource::BuiltIn }
    }

    /// Returns the networks of a package, completed by the built-in ones.
    #[must_use]
    pub fn of_package(package: [Option<Loaded>; BearingMaterial::COUNT], source: ModelSource) -> Self {
        let mut by_bearing = package;
        for (loaded, bearing) in by_bearing.iter_mut().zip(BearingMaterial::ALL) {
            *loaded = loaded.or_else(|| built_in(bearing));
        }
        Self { by_bearing, source }
    }

    /// Returns the networks of a bearing; `None` if their image is damaged.
    #[must_use]
    pub fn of(&self, bearing: BearingMaterial) -> Option<&Loaded> {
        self.by_bearing.get(usize::from(bearing.code()))?.as_ref()
    }

    /// Returns the source of the networks.
    #[must_use]
    pub const fn source(&self) -> ModelSource {
        self.source
    }

    /// Returns the identity of a bearing's networks; zeros if their image is damaged.
    #[must_use]
    pub fn id(&self, bearing: BearingMaterial) -> ModelId {
        match self.of(bearing) {
            Some(Loaded { model, .. }) => {
                ModelId { crc: model.checksum(), training_id: model.header().training_id }
            }
            None => ModelId::NONE,
        }
    }

    /// Returns [`Self::id`] by the bearing's code.
    #[must_use]
    pub fn ids(&self) -> [ModelId; MODELS] {
        const { assert!(BearingMaterial::COUNT <= MODELS) };
        let mut ids = [ModelId::NONE; MODELS];
        for (id, bearing) in ids.iter_mut().zip(BearingMaterial::ALL) {
            *id = self.id(bearing);
        }
        ids
    }
}
