//! The networks that a controller runs, by bearing.

use inference::{Bearing, Model, shipped};
use link::ModelId;
use link::update::ModelSource;

/// An image and the model over it.
#[derive(Clone, Copy, Debug)]
pub struct Loaded {
    /// The image, where it lies.
    pub image: &'static [u8],
    /// The model, checked.
    pub model: Model<'static>,
}

impl Loaded {
    /// Checks an image; nothing if it is refused or for another bearing.
    #[must_use]
    pub fn built_in(bearing: Bearing) -> Option<Self> {
        let image = shipped(bearing);
        let model = Model::load(image).ok()?;
        (model.header().bearing == bearing).then_some(Self { image, model })
    }
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
        Self { by_bearing: Bearing::ALL.map(Loaded::built_in), source: ModelSource::BuiltIn }
    }

    /// Those of a package, completed by the built-in ones.
    pub(super) fn of_package(package: [Option<Loaded>; 2], source: ModelSource) -> Self {
        let [first, second] = package;
        let [built_in, other] = Bearing::ALL;
        let by_bearing =
            [first.or_else(|| Loaded::built_in(built_in)), second.or_else(|| Loaded::built_in(other))];
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
