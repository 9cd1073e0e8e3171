//! Proposal of the next experiment if several effects fit equally: the entry of [`super::menu`]
//! that separates them best.
//!
//! New recordings are diagnosed together with the logs at hand, so the separation is the
//! difference of chi-square over all of them. Each experiment is simulated with each extended
//! bench. If the cause is true, the prediction of a rival differs from the planned recordings by
//! `d`, with the parameters that fit the logs at hand. The rival may change its parameters by `s`.
//! That costs `s' A s` on the logs at hand (`A`: their information and that of the priors), and
//! leaves `|d - J s|^2` on the planned recordings. The separation is the smallest sum,
//! `d'd - d'J (A + J'J)^-1 J'd`, plus the evidence that the rival already lacks.
//!
//! An experiment is rated by its smallest separation over all rivals, in units of the noise or of
//! the read-back error of the motion. The rating is linear in `s`, and depends on the current
//! estimates.

use super::tuning;
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::data::split::Split;
use crate::experiment::menu::{MENU, MenuEntry, Planned};
use crate::fit::linear::{cholesky, dot, gram, project};
use crate::fit::model::{Candidate, Model};
use crate::fit::sensitivities::sensitivities;
use crate::fit::simulation::simulate;
use crate::search::contender::Contender;
use crate::search::stage::Stage;
use bench::signals::Role;
use bench::{Bench, Channel, MeasuredLog};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;

/// Separation of one effect from the cause by an experiment.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Separation {
    /// Effect in kebab-case.
    pub effect: String,
    /// Sensor, for sensor effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// Body or joint, for effects on a part of a mechanism.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Chi-square that remains if all parameters of the effect are adjusted to imitate the cause.
    pub chi_square: f64,
}

/// A recording of an experiment.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Recording {
    /// Lines of TOML that change the description, such as `drive.period_s = 0.5`.
    pub changes: Vec<String>,
    /// The complete changed description to record with.
    pub bench: String,
}

/// An experiment to perform next; its recordings are diagnosed together.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Experiment {
    /// The experiment as a sentence.
    pub words: String,
    /// Recordings; empty if no experiment of the menu separates the effects.
    pub recordings: Vec<Recording>,
    /// Separation of each effect that fits as well as the cause.
    pub separation: Vec<Separation>,
}

/// A cause, the model that it was fitted in, and its scaled parameters.
pub(crate) type Cause<'a> = (&'a Candidate, &'a Model, &'a [f64]);

/// Proposes the experiment that best separates `best` from every contender that fits as well.
pub(crate) fn propose(bench: &Bench, data: &Data, stage: &Stage, best: Cause<'_>) -> Option<Experiment> {
    let others: Vec<&Contender> = stage.equivalents().collect();
    let rate = |entry: &MenuEntry| -> Option<Rated> {
        let plan = entry.plan(bench)?;
        let (separations, read_back) = separations(bench, data, stage, &plan, best)?;
        let min = separations.iter().copied().fold(f64::INFINITY, f64::min);
        min.is_finite().then_some(Rated { instruction: entry.instruction, plan, separations, min, read_back })
    };
    let rated: Vec<Rated> = MENU.par_iter().filter_map(rate).collect();
    let count = rated.len();
    let Rated { instruction, plan, separations, min, .. } = simplest_of_best(rated)?;
    let names = others.iter().map(|o| o.candidate.kind.name).collect::<Vec<_>>().join(", ");
    let best = best.0.kind.name;
    let (words, plan) = if min > tuning::MIN_SEPARATION {
        let logs = if plan.len() > 1 { "these logs" } else { "this log" };
        let gain = format!("this would separate {best} from {names} by a chi-square of {min:.0}");
        (
            format!(
                "record two cycles {instruction}, and diagnose {logs} together with those at hand: {gain}"
            ),
            plan,
        )
    } else {
        (format!("none of {count} experiments with this bench separates {best} from {names}"), Vec::new())
    };
    let recording = |p: Planned| Recording { changes: p.changes, bench: p.description };
    Some(Experiment {
        words,
        recordings: plan.into_iter().map(recording).collect(),
        separation: others
            .iter()
            .zip(separations)
            .map(|(o, chi_square)| Separation {
                effect: o.candidate.kind.name.into(),
                channel: o.candidate.channel,
                of: o.candidate.part(),
                chi_square,
            })
            .collect(),
    })
}

/// An experiment of the menu with its separations.
struct Rated {
    instruction: &'static str,
    plan: Vec<Planned>,
    /// Separation of each equivalent.
    separations: Vec<f64>,
    /// Smallest separation.
    min: f64,
    read_back: f64,
}

/// The first experiment whose smallest separation is nearly the largest, or ample.
///
/// Experiments with a large read-back error count only if no other one separates clearly.
fn simplest_of_best(rated: Vec<Rated>) -> Option<Rated> {
    let has_clear =
        rated.iter().any(|r| r.read_back <= tuning::MAX_READ_BACK && r.min > tuning::CLEAR_SEPARATION);
    let is_acceptable = |r: &Rated| !has_clear || r.read_back <= tuning::MAX_READ_BACK;
    let max = rated.iter().filter(|r| is_acceptable(r)).map(|r| r.min).fold(0.0, f64::max);
    let enough = (tuning::SIMPLER_SHARE * max).min(tuning::AMPLE_SEPARATION);
    rated.into_iter().find(|r| is_acceptable(r) && r.min >= enough)
}

/// Separations of `best` from its equivalents by planned recordings of the measured channels, and
/// the [`read_back_error`] of these recordings.
fn separations(
    bench: &Bench,
    data: &Data,
    stage: &Stage,
    plan: &[Planned],
    best: Cause<'_>,
) -> Option<(Vec<f64>, f64)> {
    let noise = &stage.noise;
    let evidence = stage.contenders.first().map_or(0.0, |c| c.evidence);
    let log = |p: &Planned| {
        let mut log: MeasuredLog = p.log.clone();
        log.channels.retain(|c, _| bench.role(*c) == Role::Input || data.channels.contains(c));
        log
    };
    let logs: Vec<MeasuredLog> = plan.iter().map(log).collect();
    let mut planned = Data::new(bench, &logs, &[], Split::Halves).ok()?;
    // New recordings do not share nuisance parameters with the logs at hand.
    planned.logs.iter_mut().for_each(|log| log.index += data.logs.len());
    let read_back = read_back_error(bench, noise, &planned)?;
    let causes = simulate(&planned, &best.1.at(best.2), None).ok()?;
    let separation = |rival: &Contender| {
        let fit = &rival.fit;
        let rivals = simulate(&planned, &fit.model.at(&fit.z), None).ok()?;
        let difference = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a - b).collect();
        let difference = causes.columns.iter().zip(&rivals.columns).map(difference).collect();
        let difference = noise.stack(&planned, &difference);
        let all: Vec<usize> = (0..fit.z.len()).collect();
        let jacobian = sensitivities(&planned, noise, &fit.model, &fit.z, &rivals, &all).ok()?;
        let shadow = project(&jacobian, &difference);
        let adjustment = cholesky(&(gram(&jacobian) + fit.information()))?.solve(&shadow);
        let remainder = dot(&difference, &difference) - adjustment.dot(&shadow);
        Some((evidence - rival.evidence).max(0.0) + remainder / read_back)
    };
    Some((stage.equivalents().map(separation).collect::<Option<_>>()?, read_back))
}

/// Read-back error of the motion: chi-square per sample between the planned logs of the described
/// bench and their simulation under the smoothed inputs; at least 1, the value for noise alone.
fn read_back_error(bench: &Bench, noise: &NoiseModel, planned: &Data) -> Option<f64> {
    let described = simulate(planned, bench, None).ok()?;
    let residual = noise.stack(planned, &planned.residual(&described.columns));
    Some((dot(&residual, &residual) / residual.len().max(1) as f64).max(1.0))
}
