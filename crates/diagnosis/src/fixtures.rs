//! Fits from which several tests start.

use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::data::split::Split;
use crate::fit::least_squares::{Fit, fit};
use crate::fit::model::{Candidate, Model};
use crate::fit::simulation::simulate;
use bench::Bench;
use bench::effects::{Effect, kind};
use bench::simulate::record;

/// An effect of the plant without guesses.
pub(crate) fn plain(name: &str) -> Candidate {
    Candidate { kind: kind(name).unwrap(), channel: None, of: None, guess: None }
}

/// Data, noise and calibrated fit of a rig with `effort` N m more dry friction than described;
/// calibration absorbs 4 N m.
pub(crate) fn calibrated(effort: f64) -> (Data, NoiseModel, Fit) {
    let mut bench = Bench::open("friction-rig").unwrap();
    if let Some(rig) = bench.axis_mut() {
        rig.common.uncertain = [("axis.coulomb_effort".to_owned(), 1.0)].into();
    }
    let mut truth = bench.clone();
    let parameters = [("coulomb_effort".to_owned(), effort)].into();
    truth.effects_mut().push(Effect { name: "coulomb-level".into(), channel: None, of: None, parameters });
    fitted(&bench, &truth)
}

/// The four-bar of the examples with its own record, data, noise and calibrated fit.
pub(crate) fn four_bar() -> (Bench, (Data, NoiseModel, Fit)) {
    let text = include_str!("../../../examples/four-bar-log.toml");
    let bench = Bench::parse("four-bar-log.toml", text).unwrap();
    let fitted = fitted(&bench, &bench);
    (bench, fitted)
}

fn fitted(bench: &Bench, truth: &Bench) -> (Data, NoiseModel, Fit) {
    let data = Data::new(bench, &[record(truth, 3).unwrap()], &[], Split::Halves).unwrap();
    let described = simulate(&data, bench, None).unwrap();
    let noise = NoiseModel::from_nominal_residual(bench, &data, &data.residual(&described.columns));
    let model = Model::nominal(bench, &data);
    let start = vec![0.0; model.parameters.len()];
    let base = fit(&data, &noise, model, start).unwrap();
    (data, noise, base)
}
