//! Motions that would show or separate parameters: experiments of the menu, of which the described
//! bench is simulated.

use super::parameters::{Information, fisher};
use super::tuning;
use crate::data::logs::Data;
use crate::data::split::Split;
use crate::experiment::menu::{MENU, MenuEntry};
use crate::verdict::identifiability::Identifiability;
use bench::{Bench, MeasuredLog, Role};
use nalgebra::DMatrix;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;

/// A motion that would determine parameters.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct MotionAdvice {
    /// Parameters that it would show or separate, together with the logs at hand.
    pub parameters: Vec<String>,
    /// The motion as a sentence; none of the menu if `changes` is empty.
    pub words: String,
    /// Changes of the description for each recording, lines of TOML.
    pub changes: Vec<Vec<String>>,
}

/// An experiment and the remarks that would remain after it.
struct Tried {
    entry: &'static MenuEntry,
    changes: Vec<Vec<String>>,
    remaining: Vec<Identifiability>,
}

/// Proposes motions for the remarks, as few as possible: the first experiment that resolves most of
/// them, then those for the others.
pub(super) fn advise(
    bench: &Bench,
    information: &Information,
    remarks: &[Identifiability],
) -> Vec<MotionAdvice> {
    // A nuisance parameter belongs to a log at hand: no further log shows it.
    let nuisances: Vec<&str> = information
        .model
        .parameters
        .iter()
        .filter(|p| p.nuisance().is_some())
        .map(crate::fit::parameter::Parameter::name)
        .collect();
    let is_open = |r: &&Identifiability| !r.parameters.iter().any(|name| nuisances.contains(&name.as_str()));
    let mut open: Vec<&Identifiability> = remarks.iter().filter(is_open).collect();
    if open.is_empty() {
        return Vec::new();
    }
    let tried: Vec<Tried> =
        MENU.par_iter().filter_map(|entry| try_entry(bench, information, entry)).collect();
    let mut advice = Vec::new();
    let resolves = |t: &Tried, r: &Identifiability| {
        let concerns =
            |left: &Identifiability| r.parameters.iter().any(|name| left.parameters.contains(name));
        !t.remaining.iter().any(concerns)
    };
    while !open.is_empty() {
        let count = |t: &Tried| open.iter().filter(|r| resolves(t, r)).count();
        let max = tried.iter().map(count).max().unwrap_or_default();
        let Some(best) = tried.iter().find(|t| count(t) == max && max > 0) else { break };
        let (done, left): (Vec<_>, Vec<_>) = open.into_iter().partition(|r| resolves(best, r));
        advice.push(MotionAdvice {
            parameters: names(&done),
            words: format!("record two cycles {}, and use them with these logs", best.entry.instruction),
            changes: best.changes.clone(),
        });
        open = left;
    }
    if !open.is_empty() {
        let words = format!("none of {} motions with this bench would show or separate them", tried.len());
        advice.push(MotionAdvice { parameters: names(&open), words, changes: Vec::new() });
    }
    advice
}

/// Names of the parameters in remarks, each once.
fn names(remarks: &[&Identifiability]) -> Vec<String> {
    let mut names: Vec<String> = remarks.iter().flat_map(|r| r.parameters.iter().cloned()).collect();
    names.sort();
    names.dedup();
    names
}

/// Remarks that would remain with the recordings of an experiment; `None` if the bench cannot
/// perform it, or if its simulation takes too long.
fn try_entry(bench: &Bench, information: &Information, entry: &'static MenuEntry) -> Option<Tried> {
    let plan = entry.plan(bench)?;
    let rows: usize = plan.iter().map(|recording| recording.log.time_s.len()).sum();
    if !bench.is_axis() && rows > tuning::MAX_EXPERIMENT_SAMPLES {
        return None;
    }
    let channels = &information.data.channels;
    let measured = |log: &MeasuredLog| {
        let mut log = log.clone();
        log.channels.retain(|channel, _| bench.role(*channel) == Role::Input || channels.contains(channel));
        log
    };
    let logs: Vec<MeasuredLog> = plan.iter().map(|recording| measured(&recording.log)).collect();
    let mut data = Data::new(bench, &logs, &[], Split::Halves).ok()?;
    data.use_all();
    // The second cycle repeats the first one.
    let (shorter, factor) = match data.first_cycle_view().filter(|_| !bench.is_axis()) {
        Some(shorter) => (shorter, 2.0),
        None => (data, 1.0),
    };
    let mut data = shorter;
    // The recordings do not share nuisance parameters with the logs at hand.
    data.logs.iter_mut().for_each(|log| log.index += information.data.logs.len());
    let further: DMatrix<f64> = factor * fisher(&data, &information.noise, &information.model).ok()?;
    let remaining = information.not_determined(Some(&further));
    Some(Tried { entry, changes: plan.into_iter().map(|recording| recording.changes).collect(), remaining })
}
