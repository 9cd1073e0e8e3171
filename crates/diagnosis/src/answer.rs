//! The parts of the result, from the model that the selection ended with.

use crate::calibration::{Calibrated, SessionNuisance};
use crate::noise::NoiseModel;
use crate::parameter::Parameter;
use crate::repeats::repeats;
use crate::result::{Cause, Noise, ParameterEstimate, Ranked, Series};
use crate::select::{Contender, Stage};
use crate::session::{Block, Columns, Data, Use};
use crate::spread::NINETY_FIVE;
use crate::verdict::End;

/// The causes; `known` is the share of all that is not unknown.
pub(crate) fn estimates(end: &End, known: f64) -> Vec<Cause> {
    let cause = |which: usize| {
        let (candidate, probability) = end.causes[which];
        let parameters = end.model.of_effect(which).into_iter().map(|i| {
            let (p, half) = (&end.model.parameters[i], NINETY_FIVE * end.deviations[i]);
            ParameterEstimate {
                name: p.name().into(),
                value: p.value(end.z[i]),
                unit: p.unit.clone(),
                ci95: [p.value(end.z[i] - half), p.value(end.z[i] + half)],
            }
        });
        Cause {
            effect: candidate.kind.name.into(),
            channel: candidate.channel,
            probability: known * probability,
            parameters: parameters.collect(),
        }
    };
    (0..end.causes.len()).map(cause).collect()
}

pub(crate) fn calibrated(end: &End) -> Vec<Calibrated> {
    let uncertain =
        end.model.parameters.iter().zip(&end.z).zip(&end.deviations).filter(|((p, _), _)| p.is_nominal());
    uncertain
        .map(|((p, &z), d)| Calibrated {
            name: p.name().into(),
            described: p.centre,
            value: p.value(z),
            declared_deviation: p.scale,
            deviation: d * p.scale,
        })
        .collect()
}

/// What each session has of its own, the fitted ones first.
pub(crate) fn nuisances(data: &Data, end: &End) -> Vec<SessionNuisance> {
    let source = |number: usize| data.sessions.iter().find(|s| s.number == number).map(|s| s.source.clone());
    let of = |p: &Parameter, z: f64, deviation: f64, held_out: bool| {
        let nuisance = p.nuisance()?;
        Some(SessionNuisance {
            session: nuisance.session,
            source: source(nuisance.session)?,
            name: nuisance.field(),
            channel: nuisance.channel(),
            value: p.value(z),
            unit: p.unit.clone(),
            deviation: deviation * p.scale,
            declared_deviation: p.scale,
            deviations_off: z,
            held_out,
        })
    };
    let fitted = end.model.parameters.iter().zip(&end.z).zip(&end.deviations);
    let mut out: Vec<SessionNuisance> = fitted.filter_map(|((p, &z), &d)| of(p, z, d, false)).collect();
    if let Some(fit) = &end.held_out {
        let deviations = fit.deviations();
        let settled = fit.model.parameters.iter().zip(&fit.z).zip(&deviations);
        out.extend(settled.filter_map(|((p, &z), &d)| of(p, z, d, true)));
    }
    out
}

pub(crate) fn noises(data: &Data, noise: &NoiseModel, before: &Columns) -> Vec<Noise> {
    let of = |&channel: &bench::Channel| {
        let n = noise.of(channel);
        let repeated = repeats(data, before, channel);
        Noise {
            channel,
            floor: n.floor,
            declared: n.declared,
            source: n.source.name(),
            declared_floor: (n.stated > 0.0).then_some(n.stated),
            measured_floor: n.seen,
            repeats: repeated.map_or(0, |r| r.cycles),
            repeatable_share: repeated.map(|r| r.repeatable_share),
            finding: n.finding(channel),
            excess: n.excess,
            correlation_samples: n.correlation,
        }
    };
    data.channels.iter().map(of).collect()
}

/// The candidates of a stage; `known` is the share of all that is not unknown.
pub(crate) fn ranking(stage: &Stage, known: f64) -> Vec<Ranked> {
    let refitted = stage.contenders.iter().map(|c: &Contender| Ranked {
        effect: c.candidate.kind.name.into(),
        channel: c.candidate.channel,
        evidence: c.evidence,
        probability: known * c.probability,
        refitted: true,
    });
    let searched = stage.others.iter().map(|(candidate, evidence)| Ranked {
        effect: candidate.kind.name.into(),
        channel: candidate.channel,
        evidence: *evidence,
        probability: 0.0,
        refitted: false,
    });
    refitted.chain(searched).collect()
}

pub(crate) fn series(data: &Data, before: &Columns, after: &Columns) -> Vec<Series> {
    let kept = |uses: &[Use], values: &[f64]| -> Vec<f64> {
        values.iter().zip(uses).filter(|(_, u)| **u != Use::Skip).map(|(v, _)| *v).collect()
    };
    let of = |((block, before), after): ((&Block, &Vec<f64>), &Vec<f64>)| {
        let session = &data.sessions[block.session];
        Series {
            source: session.source.clone(),
            channel: block.channel,
            time_s: kept(&session.uses, session.inputs.time_s()),
            phase: session.phase.as_ref().map(|p| kept(&session.uses, p)),
            measured: kept(&session.uses, &block.measured),
            before: kept(&session.uses, before),
            after: kept(&session.uses, after),
            held_out: session.uses.iter().filter(|u| **u != Use::Skip).map(|u| *u == Use::Held).collect(),
        }
    };
    data.blocks.iter().zip(before).zip(after).map(of).collect()
}
