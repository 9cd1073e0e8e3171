//! The training of both networks of a bearing, as the command line runs it.

use crate::checkpoint::Checkpoint;
use crate::draw::{Draw, Purpose};
use crate::features::FloatFeatures;
use crate::ranges::header;
use crate::recipe::Recipe;
use crate::rows::{Row, rows};
use crate::shapes;
use crate::train::{Progress, Task, train};
use crate::window;
use inference::Bearing;

/// One of the two networks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Network {
    /// State of the contact to normal force.
    Collision,
    /// Normal force and sliding speed to friction.
    Friction,
}

impl Network {
    /// Lower-case name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Collision => "collision",
            Self::Friction => "friction",
        }
    }
}

/// Trains both networks; `report` is called after every epoch.
pub fn train_both(
    bearing: Bearing,
    recipe: &Recipe,
    report: &mut dyn FnMut(Network, Progress),
) -> Checkpoint {
    let features = FloatFeatures::of(&header(bearing, recipe.range));
    let set = |purpose, count| rows(bearing, recipe.range, recipe.seed, purpose, count);
    let training = set(Purpose::TrainingRows, recipe.rows);
    let validation = set(Purpose::ValidationRows, recipe.validation_rows);
    let (training, validation) = (training.as_slice(), validation.as_slice());
    let collision = train(
        recipe,
        &Task {
            rows: training,
            validation,
            shape: shapes::collision(),
            window: |row: &Row, draw: &mut Draw| window::collision(&features, row, draw),
            lane: 0,
        },
        &mut |progress| report(Network::Collision, progress),
    );
    let friction = train(
        recipe,
        &Task {
            rows: training,
            validation,
            shape: shapes::friction(),
            window: |row: &Row, draw: &mut Draw| window::friction(&features, row, draw),
            lane: 1,
        },
        &mut |progress| report(Network::Friction, progress),
    );
    Checkpoint { recipe: recipe.clone(), bearing, collision, friction }
}
