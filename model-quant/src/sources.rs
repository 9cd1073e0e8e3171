//! The windows that the networks of a bearing are trained on.

use crate::dataset::collision::CollisionSet;
use crate::dataset::grid::ROWS;
use crate::dataset::split::Split;
use crate::draw::{Draw, Purpose};
use crate::features::FloatFeatures;
use crate::pipeline::Network;
use crate::ranges::header;
use crate::recipe::{Recipe, TrainingSet};
use crate::rows::{Row, row, rows};
use crate::train::{Source, Windows};
use crate::window::{self, Window};
use inference::Bearing;

/// Rows of a bearing.
enum Rows {
    /// Drawn once and kept.
    Kept(Vec<Row>),
    /// Made whenever one is asked for: a part of the full set.
    Made { set: Box<CollisionSet>, split: Split, count: u64 },
}

/// The sources of both networks of a bearing.
pub struct Sources<'a> {
    bearing: Bearing,
    recipe: &'a Recipe,
    features: FloatFeatures,
    training: Rows,
    validation: Rows,
}

/// The windows of one network over one part.
pub struct Part<'a> {
    sources: &'a Sources<'a>,
    network: Network,
    rows: &'a Rows,
}

impl Windows {
    /// Adds a window.
    pub fn push<const C: usize>(&mut self, window: &Window<C>) {
        self.columns.extend(window.columns.as_flattened());
        self.targets.push(window.target);
    }
}

impl<'a> Sources<'a> {
    /// The rows of a recipe.
    pub fn new(bearing: Bearing, recipe: &'a Recipe) -> Self {
        let features = FloatFeatures::of(&header(bearing, recipe.range));
        let [training, validation] = match recipe.set {
            TrainingSet::Drawn => {
                let drawn =
                    |purpose, count| Rows::Kept(rows(bearing, recipe.range, recipe.seed, purpose, count));
                [
                    drawn(Purpose::TrainingRows, recipe.rows),
                    drawn(Purpose::ValidationRows, recipe.validation_rows),
                ]
            }
            TrainingSet::Full => {
                let made = |split: Split, count: u64| {
                    let set = Box::new(CollisionSet::new(bearing, recipe.range, recipe.seed));
                    Rows::Made { set, split, count: split.rows_of(ROWS).min(count) }
                };
                [made(Split::Training, u64::MAX), made(Split::Validation, recipe.validation_rows as u64)]
            }
        };
        Self { bearing, recipe, features, training, validation }
    }

    /// Training and validation windows of a network.
    pub fn of(&self, network: Network) -> (Part<'_>, Part<'_>) {
        let part = |rows| Part { sources: self, network, rows };
        (part(&self.training), part(&self.validation))
    }
}

impl Part<'_> {
    fn row(&self, index: u64) -> Option<Row> {
        let Sources { bearing, recipe, .. } = self.sources;
        match self.rows {
            Rows::Kept(rows) => rows.get(usize::try_from(index).ok()?).copied(),
            Rows::Made { set, split, .. } if self.network == Network::Collision => {
                Some(set.row(*split, index))
            }
            // The collision set says nothing about sliding speeds.
            Rows::Made { split, .. } => {
                let purpose =
                    if *split == Split::Training { Purpose::TrainingRows } else { Purpose::ValidationRows };
                Some(row(*bearing, recipe.range, recipe.seed, purpose, index))
            }
        }
    }
}

impl Source for Part<'_> {
    fn count(&self) -> u64 {
        match self.rows {
            Rows::Kept(rows) => rows.len() as u64,
            Rows::Made { count, .. } => *count,
        }
    }

    fn add(&self, index: u64, draw: &mut Draw, windows: &mut Windows) {
        let Some(row) = self.row(index) else { return };
        let features = &self.sources.features;
        match self.network {
            Network::Collision => windows.push(&window::collision(features, &row, draw)),
            Network::Friction => windows.push(&window::friction(features, &row, draw)),
        }
    }
}
