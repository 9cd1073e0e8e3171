//! Windows that the networks of a bearing are trained on.

use crate::data::collision::CollisionSet;
use crate::data::draw::{Draw, Purpose};
use crate::data::features::FloatFeatures;
use crate::data::ranges::header;
use crate::data::rows::{Row, draw_row, draw_rows};
use crate::data::split::Split;
use crate::data::window::{self, Window};
use crate::network::NetworkKind;
use crate::network::recipe::{Recipe, TrainingSet};
use crate::train::{Source, Windows};
use inference::BearingMaterial;

/// Rows of a bearing.
enum Rows {
    /// Drawn once and stored.
    InMemory(Vec<Row>),
    /// Generated on demand: a part of the full set.
    Generated { set: Box<CollisionSet>, split: Split, count: u64 },
}

/// Windows of both networks of a bearing.
pub struct Sources<'a> {
    bearing: BearingMaterial,
    recipe: &'a Recipe,
    features: FloatFeatures,
    training: Rows,
    validation: Rows,
}

/// Windows of one network over one part of the rows.
pub struct PartWindows<'a> {
    sources: &'a Sources<'a>,
    network: NetworkKind,
    rows: &'a Rows,
}

impl Windows {
    /// Adds a window.
    pub(crate) fn push<const C: usize>(&mut self, window: &Window<C>) {
        self.columns.extend(window.columns.as_flattened());
        self.targets.push(window.target);
    }
}

impl<'a> Sources<'a> {
    /// Prepares the rows of a recipe.
    pub fn new(bearing: BearingMaterial, recipe: &'a Recipe) -> Self {
        let features = FloatFeatures::from_header(&header(bearing, recipe.range));
        let [training, validation] = match recipe.set {
            TrainingSet::Drawn => {
                let drawn = |purpose, count| {
                    Rows::InMemory(draw_rows(bearing, recipe.range, recipe.seed, purpose, count))
                };
                [
                    drawn(Purpose::TrainingRows, recipe.rows),
                    drawn(Purpose::ValidationRows, recipe.validation_rows),
                ]
            }
            TrainingSet::Full => {
                let made = |split: Split, count: u64| {
                    let set = Box::new(CollisionSet::new(bearing, recipe.range, recipe.seed));
                    let count = split.row_count(set.rows()).min(count);
                    Rows::Generated { set, split, count }
                };
                [made(Split::Training, u64::MAX), made(Split::Validation, recipe.validation_rows as u64)]
            }
        };
        Self { bearing, recipe, features, training, validation }
    }

    /// Returns training and validation windows of a network.
    pub fn parts_for(&self, network: NetworkKind) -> (PartWindows<'_>, PartWindows<'_>) {
        let part = |rows| PartWindows { sources: self, network, rows };
        (part(&self.training), part(&self.validation))
    }
}

impl PartWindows<'_> {
    fn row(&self, index: u64) -> Option<Row> {
        let Sources { bearing, recipe, .. } = self.sources;
        match self.rows {
            Rows::InMemory(rows) => rows.get(usize::try_from(index).ok()?).copied(),
            Rows::Generated { set, split, .. } if self.network == NetworkKind::Collision => {
                Some(set.row(*split, index))
            }
            // With the range `paper` the collision set has no sliding speeds.
            Rows::Generated { split, .. } => {
                let purpose =
                    if *split == Split::Training { Purpose::TrainingRows } else { Purpose::ValidationRows };
                Some(draw_row(*bearing, recipe.range, recipe.seed, purpose, index))
            }
        }
    }
}

impl Source for PartWindows<'_> {
    fn count(&self) -> u64 {
        match self.rows {
            Rows::InMemory(rows) => rows.len() as u64,
            Rows::Generated { count, .. } => *count,
        }
    }

    fn add(&self, index: u64, draw: &mut Draw, windows: &mut Windows) {
        let Some(row) = self.row(index) else { return };
        let features = &self.sources.features;
        match self.network {
            NetworkKind::Collision => windows.push(&window::draw_collision_window(features, &row, draw)),
            NetworkKind::Friction => windows.push(&window::draw_friction_window(features, &row, draw)),
        }
    }
}
