//! The networks that a controller runs, by bearing.

use inference::{Bearing, Model, shipped};
use link::ModelId;
use link::update::ModelSource;
use model_package::Checked;

/// An image and the model over it.
pub type Loaded = Checked<'static>;

/// The image built in for a bearing; nothing if it is damaged.
fn built_in(bearing: Bearing) -> Option<Loaded> {
    let image = shipped(bearing);
    let model = Model::load(image).ok()?;
    (model.header().bearing == bearing).then_some(Loaded { image, model })
}

/// The networks of every bearing. A package may hold those of one bearing only: the others are the built-in ones.
#[derive(Clone, Copy, Debug)]
pub struct Models {
    by_bearing: [Option<Loaded>; 2],
    source: ModelSource,
}

impl Models {
    /// Those built into the firmware.
    #[must_use]
    pub fn built_in() -> Self {
        Self { by_bearing: Bearing::ALL.map(built_in), source: ModelSource::BuiltIn }
    }

    /// Those of a package, completed by the built-in ones.
    #[must_use]
    pub fn of_package(package: [Option<Loaded>; 2], source: ModelSource) -> Self {
        let [first, second] = package;
        let [babbitt, plastic] = Bearing::ALL;
        let by_bearing = [first.or_else(|| built_in(babbitt)), second.or_else(|| built_in(plastic))];
        Self { by_bearing, source }
    }

    /// The networks of a bearing; nothing if their image is damaged.
    #[must_use]
    pub fn of(&self, bearing: Bearing) -> Option<&Loaded> {
        let [babbitt, plastic] = &self.by_bearing;
        match bearing {
            Bearing::Babbitt => babbitt.as_ref(),
            Bearing::Plastic => plastic.as_ref(),
        }
    }

    /// Where they come from.
    #[must_use]
    pub const fn source(&self) -> ModelSource {
        self.source
    }

    /// What the host is told of a bearing's networks; zeros where their image is damaged.
    #[must_use]
    pub fn id(&self, bearing: Bearing) -> ModelId {
        match self.of(bearing) {
            Some(Loaded { model, .. }) => {
                ModelId { crc: model.check_sum(), training_id: model.header().training_id }
            }
            None => ModelId { crc: 0, training_id: 0 },
        }
    }

    /// [`Self::id`] of every bearing.
    #[must_use]
    pub fn ids(&self) -> [ModelId; 2] {
        Bearing::ALL.map(|bearing| self.id(bearing))
    }
}
