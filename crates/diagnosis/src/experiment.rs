//! What to measure next when several effects fit equally: the experiment of [`crate::menu`] that tells them apart best.
//!
//! The new recordings are diagnosed together with the logs at hand, so separation is that of all of them. Each experiment is simulated
//! with every one of the extended benches. Taken the cause for true, a rival that fits the logs at hand differs from the planned recordings by `d`, and
//! may move everything that it was fitted with by `s`: at the cost `s' A s` on the logs at hand (`A`: their information and the priors'), down to
//! `|d - J s|^2` on the planned ones. The least sum, `d'd - d'J (A + J'J)^-1 J'd`, and how far the rival is behind already, is the separation.
//! What counts of an experiment is its smallest one, in units of the noise or of what reading the motion back from a log leaves. Linear in
//! that adjustment, and no better than the estimates it starts from.

use crate::fit::{sensitivities, simulate};
use crate::linear::{dot, factor, gram, project};
use crate::menu::{MENU, Planned};
use crate::model::{Candidate, Model};
use crate::noise::NoiseModel;
use crate::result::{Experiment, Recording, Separation};
use crate::select::{Contender, Stage};
use crate::session::{Data, Split};
use bench::channel::Role;
use bench::{Bench, MeasuredLog};
use rayon::prelude::*;

/// Share of the best experiment's separation at which a plainer one is preferred, and the separation from which it is in any case.
const PLAINER: f64 = 0.8;
const PLENTY: f64 = 200.0;

/// Trouble from which an experiment is only proposed where no other separates by more than [`ENOUGH`]: its own simulation would
/// look wrong.
const MOST_TROUBLE: f64 = 1.3;
const ENOUGH: f64 = 30.0;
/// Separation below which an experiment may well leave the answer as it is: a chi-square scatters by twice its root, and nine
/// times in ten so much is above what two candidates that fit equally may differ by ([`crate::select`]).
const LEAST_SEPARATION: f64 = 17.0;

/// The last cause of a model with the model that it was fitted in and its scaled parameters.
pub(crate) type Cause<'a> = (Candidate, &'a Model, &'a [f64]);

/// The experiment that separates `best` from every contender that fits as well most.
pub(crate) fn propose(bench: &Bench, data: &Data, stage: &Stage, best: Cause<'_>) -> Option<Experiment> {
    let others: Vec<&Contender> = stage.equals().collect();
    let tried: Vec<_> = MENU
        .par_iter()
        .filter_map(|experiment| {
            let plan = experiment.plan(bench)?;
            let (separations, trouble) = separations(bench, data, stage, &plan, best)?;
            let least = separations.iter().copied().fold(f64::INFINITY, f64::min);
            least.is_finite().then_some((experiment.words, plan, separations, least, trouble))
        })
        .collect();
    let count = tried.len();
    let clear = tried.iter().any(|t| t.4 <= MOST_TROUBLE && t.3 > ENOUGH);
    let sound = |trouble: f64| !clear || trouble <= MOST_TROUBLE;
    let most = tried.iter().filter(|t| sound(t.4)).map(|t| t.3).fold(0.0, f64::max);
    let (words, plan, separations, least, _) =
        tried.into_iter().find(|t| sound(t.4) && t.3 >= (PLAINER * most).min(PLENTY))?;
    let names = others.iter().map(|o| o.candidate.kind.name).collect::<Vec<_>>().join(", ");
    let best = best.0.kind.name;
    let (words, plan) = if least > LEAST_SEPARATION {
        let logs = if plan.len() > 1 { "these logs" } else { "this log" };
        let gain = format!("that would set {best} apart from {names} by a chi-square of {least:.0}");
        (format!("record two cycles {words}, and diagnose {logs} together with those at hand: {gain}"), plan)
    } else {
        (format!("none of {count} experiments with this bench sets {best} apart from {names}"), Vec::new())
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
                chi_square,
            })
            .collect(),
    })
}

/// Separation of `best` from each of its equals on the logs at hand and planned recordings together, with the channels that the
/// logs have, and the [`trouble`] of the recordings.
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
        log.channels.retain(|c, _| c.role() == Role::Input || data.channels.contains(c));
        log
    };
    let logs: Vec<MeasuredLog> = plan.iter().map(log).collect();
    let mut planned = Data::new(bench, &logs, &[], Split::Halves).ok()?;
    // They have none of the nuisances of the sessions at hand.
    planned.sessions.iter_mut().for_each(|s| s.number += data.sessions.len());
    let trouble = trouble(bench, noise, &planned)?;
    let here = simulate(&planned, &best.1.at(best.2), None).ok()?;
    let apart = |rival: &Contender| {
        let fit = &rival.fit;
        let there = simulate(&planned, &fit.model.at(&fit.z), None).ok()?;
        let difference = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a - b).collect();
        let apart = here.columns.iter().zip(&there.columns).map(difference).collect();
        let apart = noise.stack(&planned, &apart);
        let all: Vec<usize> = (0..fit.z.len()).collect();
        let jacobian = sensitivities(&planned, noise, &fit.model, &fit.z, &there, &all).ok()?;
        let shadow = project(&jacobian, &apart);
        let moved = factor(&(gram(&jacobian) + fit.information()))?.solve(&shadow);
        let left = dot(&apart, &apart) - moved.dot(&shadow);
        Some((evidence - rival.evidence).max(0.0) + left / trouble)
    };
    Some((stage.equals().map(apart).collect::<Option<_>>()?, trouble))
}

/// What reading the motion back from a log costs: chi-square over samples of a log of the bench as described, which its own
/// simulation under the smoothed inputs would leave at 1.
fn trouble(bench: &Bench, noise: &NoiseModel, planned: &Data) -> Option<f64> {
    let described = simulate(planned, bench, None).ok()?;
    let residual = noise.stack(planned, &planned.residual(&described.columns));
    Some((dot(&residual, &residual) / residual.len().max(1) as f64).max(1.0))
}
