//! Comparison of targets for the collision network: the force, its root, and its root over the
//! deformation.
//!
//! Network, rows, seed and epochs are the same for each target. The output has mean absolute errors
//! of the normal force by band of the law's force, and the largest force at states without contact
//! before it is set to 0. `cargo run --release -p model-quant --example companding
//! [babbitt|plastic] [epochs]`

use inference::{BearingMaterial, ContactState};
use model_quant::data::draw::{Draw, Purpose};
use model_quant::data::features::FloatFeatures;
use model_quant::data::ranges::{RangeKind, header};
use model_quant::data::rows::{Row, draw_rows};
use model_quant::data::window::draw_history;
use model_quant::network::NetworkKind;
use model_quant::network::recipe::{InstructionSet, Recipe};
use model_quant::train::{Loss, Source, Training, Windows};
use std::process::ExitCode;

/// Stream of the histories of the test rows: no training has this number.
const TEST_STREAM: u64 = 2 << 40;
const BANDS_N: [f64; 5] = [100.0, 1000.0, 5000.0, 14_000.0, 40_000.0];

/// Conversion of a force to a target and of an output to a force.
#[derive(Clone, Copy)]
enum Target {
    Plain,
    Root,
    RootOverDeformation,
}

impl Target {
    fn for_row(self, features: &FloatFeatures, row: &Row) -> f64 {
        let factor = f64::from(features.collision(&row.state).root_force_factor);
        match self {
            Self::Plain => row.normal_force_n,
            Self::Root => row.normal_force_n.sqrt(),
            Self::RootOverDeformation if factor > 0.0 => row.normal_force_n.sqrt() / factor,
            Self::RootOverDeformation => 0.0,
        }
    }

    fn force_n(self, features: &FloatFeatures, state: &ContactState, output: f32) -> f64 {
        let output = f64::from(output.max(0.0));
        match self {
            Self::Plain => output,
            Self::Root => output * output,
            Self::RootOverDeformation => {
                (output * f64::from(features.collision(state).root_force_factor)).powi(2)
            }
        }
    }
}

struct Part<'a> {
    features: FloatFeatures,
    rows: &'a [Row],
    target: Target,
}

impl Source for Part<'_> {
    fn count(&self) -> u64 {
        self.rows.len() as u64
    }

    fn add(&self, row: u64, draw: &mut Draw, windows: &mut Windows) {
        let row = &self.rows[row as usize];
        let columns =
            draw_history(&self.features, row, draw).map(|state| self.features.collision(&state).inputs);
        windows.columns.extend(columns.as_flattened());
        windows.targets.push(self.target.for_row(&self.features, row) as f32);
    }
}

/// Bearing and number of epochs from the command line, or the defaults.
fn arguments() -> Result<(BearingMaterial, usize), String> {
    let mut given = std::env::args().skip(1);
    let bearing = given.next().map_or(Ok(BearingMaterial::Babbitt), |name| {
        BearingMaterial::from_name(&name).ok_or(format!(
            "found `{name}`, expected one of {:?}",
            BearingMaterial::ALL.map(BearingMaterial::name)
        ))
    })?;
    let epochs = given.next().map_or(Ok(60), |text| {
        let epochs = text.parse().ok().filter(|epochs| (1..=100_000).contains(epochs));
        epochs.ok_or(format!("found `{text}`, expected 1 to 100000 epochs"))
    })?;
    Ok((bearing, epochs))
}

fn main() -> ExitCode {
    match arguments() {
        Ok((bearing, epochs)) => {
            compare(bearing, epochs);
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

fn compare(bearing: BearingMaterial, epochs: usize) {
    let features = FloatFeatures::from_header(&header(bearing, RangeKind::Bench));
    let recipe = Recipe {
        epochs,
        grid_epochs: 0,
        rows: 1 << 16,
        instruction_set: InstructionSet::best(),
        ..Recipe::standard(bearing)
    };
    let drawn = |purpose, count| draw_rows(bearing, RangeKind::Bench, recipe.seed, purpose, count);
    let training = drawn(Purpose::TrainingRows, recipe.rows);
    let validation = drawn(Purpose::ValidationRows, 4096);
    let test = drawn(Purpose::TestRows, 8192);
    println!("{}, {epochs} epochs over {} rows; mean absolute errors in N", bearing.name(), recipe.rows);
    println!("| target | to 100 N | to 1 kN | to 5 kN | to 14 kN | above | largest without contact, N |");
    println!("|---|---|---|---|---|---|---|");
    for (name, target) in [
        ("force", Target::Plain),
        ("root of the force", Target::Root),
        ("root over the deformation", Target::RootOverDeformation),
    ] {
        let part = |rows| Part { features, rows, target };
        let (training, validation) = (part(training.as_slice()), part(validation.as_slice()));
        let mut fit = Training::new(
            &recipe,
            NetworkKind::Collision.shape(),
            (&training, &validation),
            Loss::Clamped,
            0,
        );
        while !fit.is_done() {
            fit.epoch();
        }
        let network = fit.finish().float;
        let mut sums = [(0.0, 0usize); BANDS_N.len()];
        let mut without_contact = 0.0_f64;
        for (index, row) in test.iter().enumerate() {
            let mut draw = Draw::new(recipe.seed, Purpose::FixedHistories, TEST_STREAM | index as u64);
            let states = draw_history(&features, row, &mut draw);
            let found = |states: &[ContactState]| {
                let columns: Vec<f32> = states.iter().flat_map(|s| features.collision(s).inputs).collect();
                target.force_n(&features, &states[states.len() - 1], network.evaluate(&columns)[0])
            };
            let band =
                BANDS_N.iter().position(|&up_to| row.normal_force_n <= up_to).unwrap_or(BANDS_N.len() - 1);
            sums[band].0 += (found(&states) - row.normal_force_n).abs();
            sums[band].1 += 1;
            let gap = states.map(|state| ContactState { deformation_m: -state.deformation_m.abs(), ..state });
            without_contact = without_contact.max(found(&gap));
        }
        let errors: Vec<String> =
            sums.iter().map(|(sum, count)| format!("{:.1}", sum / (*count).max(1) as f64)).collect();
        println!("| {name} | {} | {without_contact:.1} |", errors.join(" | "));
    }
}
