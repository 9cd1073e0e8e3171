//! What to measure next when several effects fit equally: the experiment of [`crate::menu`] that tells them apart best.
//!
//! Each experiment is simulated with every one of the extended benches. The separation of a pair is the chi-square that is left
//! after the first of the two has adjusted everything it may to imitate the second; what counts of an experiment is its
//! smallest separation from the cause, in units of the noise or of what reading the motion back from a log leaves. Linear in that adjustment, and no better than the estimates it starts from.

use crate::fit::{sensitivities, simulate};
use crate::linear::{dot, factor, gram, project};
use crate::menu::{MENU, Planned};
use crate::model::{Candidate, Model};
use crate::noise::NoiseModel;
use crate::result::{Experiment, Recording, Separation};
use crate::session::Data;
use bench::channel::Role;
use bench::{Bench, MeasuredLog};
use rayon::prelude::*;

/// Share of the best experiment's separation at which a plainer one is preferred.
const PLAINER: f64 = 0.8;

/// Trouble from which an experiment is only proposed where no other separates by more than [`ENOUGH`]: its own simulation would
/// look wrong.
const MOST_TROUBLE: f64 = 1.3;
const ENOUGH: f64 = 30.0;
/// Separation below which an experiment would leave the answer as it is.
const LEAST_SEPARATION: f64 = 12.0;

/// A candidate with its fitted scaled parameters, the uncertain ones first.
pub(crate) type Fitted<'a> = (Candidate, &'a [f64]);

/// The experiment that separates `best` from every one of `others` most.
pub(crate) fn propose(
    bench: &Bench,
    data: &Data,
    noise: &NoiseModel,
    best: Fitted<'_>,
    others: &[Fitted<'_>],
) -> Option<Experiment> {
    let tried: Vec<_> = MENU
        .par_iter()
        .filter_map(|experiment| {
            let plan = experiment.plan(bench)?;
            let (separations, trouble) = separations(bench, data, noise, &plan, best, others)?;
            let least = separations.iter().copied().fold(f64::INFINITY, f64::min);
            least.is_finite().then_some((experiment.words, plan, separations, least, trouble))
        })
        .collect();
    let clear = tried.iter().any(|t| t.4 <= MOST_TROUBLE && t.3 > ENOUGH);
    let sound = |trouble: f64| !clear || trouble <= MOST_TROUBLE;
    let most = tried.iter().filter(|t| sound(t.4)).map(|t| t.3).fold(0.0, f64::max);
    let (words, plan, separations, least, _) =
        tried.into_iter().find(|t| sound(t.4) && t.3 >= PLAINER * most)?;
    let names = others.iter().map(|(c, _)| c.kind.name).collect::<Vec<_>>().join(", ");
    let best = best.0.kind.name;
    let (words, plan) = if least > LEAST_SEPARATION {
        let gain = format!("that would set {best} apart from {names} by a chi-square of {least:.0}");
        (format!("record two cycles {words}: {gain}"), plan)
    } else {
        let tried = MENU.len();
        (format!("none of {tried} experiments with this bench sets {best} apart from {names}"), Vec::new())
    };
    let recording = |p: Planned| Recording { changes: p.changes, bench: p.description };
    Some(Experiment {
        words,
        recordings: plan.into_iter().map(recording).collect(),
        separation: others
            .iter()
            .zip(separations)
            .map(|((c, _), chi_square)| Separation {
                effect: c.kind.name.into(),
                channel: c.channel,
                chi_square,
            })
            .collect(),
    })
}

/// Separation of `best` from each of `others` on planned recordings, with the channels that the logs have, and their [`trouble`].
fn separations(
    bench: &Bench,
    data: &Data,
    noise: &NoiseModel,
    plan: &[Planned],
    best: Fitted<'_>,
    others: &[Fitted<'_>],
) -> Option<(Vec<f64>, f64)> {
    let log = |p: &Planned| {
        let mut log: MeasuredLog = p.log.clone();
        log.channels.retain(|c, _| c.role() == Role::Input || data.channels.contains(c));
        log
    };
    let logs: Vec<MeasuredLog> = plan.iter().map(log).collect();
    let planned = Data::new(bench, &logs, &[]).ok()?;
    let trouble = trouble(bench, noise, &planned)?;
    let model = |c: &Candidate| Model::nominal(bench, &data.channels).with(*c, noise);
    let own = model(&best.0);
    let here = simulate(&planned, &own.at(best.1), None).ok()?;
    let all: Vec<usize> = (0..own.parameters.len()).collect();
    let jacobian = sensitivities(&planned, noise, &own, best.1, &here, &all).ok()?;
    let mut information = gram(&jacobian);
    for (i, p) in own.parameters.iter().enumerate() {
        information[(i, i)] += p.precision;
    }
    let information = factor(&information)?;
    let apart = |(candidate, z): &Fitted<'_>| {
        let there = simulate(&planned, &model(candidate).at(z), None).ok()?;
        let difference = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a - b).collect();
        let apart = there.columns.iter().zip(&here.columns).map(difference).collect();
        let apart = noise.stack(&planned, &apart);
        let shadow = project(&jacobian, &apart);
        Some((dot(&apart, &apart) - information.solve(&shadow).dot(&shadow)) / trouble)
    };
    Some((others.iter().map(apart).collect::<Option<_>>()?, trouble))
}

/// What reading the motion back from a log costs: chi-square over samples of a log of the bench as described, which its own
/// simulation under the smoothed inputs would leave at 1.
fn trouble(bench: &Bench, noise: &NoiseModel, planned: &Data) -> Option<f64> {
    let described = simulate(planned, bench, None).ok()?;
    let residual = noise.stack(planned, &planned.residual(&described.columns));
    Some((dot(&residual, &residual) / residual.len().max(1) as f64).max(1.0))
}
