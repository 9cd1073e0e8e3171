//! Simulation of a bench under the inputs of all logs.

use super::nuisance::BenchPerLog;
use crate::data::logs::{Columns, Data};
use bench::Bench;
use bench::simulate::{RespondError, Response, Truth, apply_sensors};
use rayon::prelude::*;
use std::sync::Arc;

/// Simulated outputs of all logs, with the plants' motions for reuse.
pub(crate) struct Simulation {
    /// Resolved benches without sensors, one per log. A motion depends on nothing else, apart from
    /// its time resolution.
    plants: Vec<Bench>,
    /// Motion of each plant, before its sensors.
    truths: Vec<Arc<Truth>>,
    pub(crate) columns: Columns,
}

fn without_sensors(resolved: &Bench) -> Bench {
    let mut bench = resolved.clone();
    bench.sensors_mut().clear();
    bench
}

/// Simulates one bench for all logs, or one for each; reuses the motions of `known` for logs whose
/// plant is the same.
pub(crate) fn simulate(
    data: &Data,
    benches: &impl BenchPerLog,
    known: Option<&Simulation>,
) -> Result<Simulation, RespondError> {
    let resolved: Vec<Bench> = data.logs.iter().map(|log| benches.for_log(log.index).resolved()).collect();
    let plants: Vec<Bench> = resolved.iter().map(without_sensors).collect();
    let truth_of = |i: usize| {
        let (bench, inputs) = (&resolved[i], &data.logs[i].inputs);
        let same = known.filter(|k| k.plants.get(i) == plants.get(i)).and_then(|k| k.truths.get(i));
        let same = same.filter(|truth| truth.is_fine_enough_for(bench, inputs));
        let simulate_plant = || Truth::simulate(bench, inputs).map(Arc::new);
        same.map_or_else(simulate_plant, |truth| Ok(Arc::clone(truth)))
    };
    let truths = (0..resolved.len()).into_par_iter().map(truth_of).collect::<Result<Vec<_>, _>>()?;
    let logs = data.logs.iter().zip(&resolved).zip(&truths);
    let responses: Vec<Response> =
        logs.map(|((log, bench), truth)| apply_sensors(bench, &log.inputs, truth)).collect();
    Ok(Simulation { plants, truths, columns: data.columns(&responses) })
}
