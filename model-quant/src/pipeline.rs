//! The training of both networks of a bearing, as the command line runs it.

use crate::checkpoint::Checkpoint;
use crate::draw::{Draw, Purpose};
use crate::features::FloatFeatures;
use crate::ranges::header;
use crate::recipe::Recipe;
use crate::rows::{Row, rows};
use crate::shapes;
use crate::train::{Loss, Progress, Source, Training, Windows};
use crate::window::{self, Window};
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
    /// Both, in the order of a checkpoint.
    pub const ALL: [Self; 2] = [Self::Collision, Self::Friction];

    /// Lower-case name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Collision => "collision",
            Self::Friction => "friction",
        }
    }
}

/// Drawn rows, each with a history drawn anew whenever it is asked for.
struct Drawn<'a> {
    network: Network,
    features: FloatFeatures,
    rows: &'a [Row],
}

impl Windows {
    /// Adds a window.
    pub fn push<const C: usize>(&mut self, window: &Window<C>) {
        self.columns.extend(window.columns.as_flattened());
        self.targets.push(window.target);
    }
}

impl Source for Drawn<'_> {
    fn count(&self) -> u64 {
        self.rows.len() as u64
    }

    fn add(&self, row: u64, draw: &mut Draw, windows: &mut Windows) {
        let Some(row) = self.rows.get(row as usize) else { return };
        match self.network {
            Network::Collision => windows.push(&window::collision(&self.features, row, draw)),
            Network::Friction => windows.push(&window::friction(&self.features, row, draw)),
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
    let [collision, friction] = Network::ALL.map(|network| {
        let source = |rows| Drawn { network, features, rows };
        let shape = match network {
            Network::Collision => shapes::collision(),
            Network::Friction => shapes::friction(),
        };
        let (training, validation) = (source(&training), source(&validation));
        let mut training =
            Training::new(recipe, shape, (&training, &validation), Loss::Clamped, network as u64);
        while !training.is_done() {
            report(network, training.epoch());
        }
        training.finish()
    });
    Checkpoint { recipe: recipe.clone(), bearing, collision, friction }
}
