//! What is a session's own: offsets and delays of its outputs, its temperature at the start.
//!
//! A description declares their standard deviations ([`bench::description::Nuisances`]). Each fitted session has a parameter of its
//! own for each of them, with that deviation as its prior, in every fit, so that no effect gets the credit for what a
//! session may bring along. A log that is held out cannot be told by the fitted ones: its nuisances come from its first
//! cycle (the first eighth, without two cycles), with everything else as fitted and the same priors, once for the model before and once
//! for the model after; these samples are then left out of the comparison. So an offset costs neither side anything, and
//! a gain still has to show on samples that no parameter has seen. Temperature shows nothing, and costs nothing, while
//! no friction follows it.

use crate::check::{Finding, Severity};
use crate::digits::four_digits;
use crate::fit::{Fit, Simulation, fit, simulate};
use crate::model::{MOST_DEVIATIONS, Model};
use crate::noise::NoiseModel;
use crate::parameter::{ON_BOUND, Parameter};
use crate::session::Data;
use bench::respond::RespondError;
use bench::{Bench, Channel};
use std::collections::BTreeMap;

/// One bench for all sessions, or one for each.
pub(crate) trait PerSession {
    /// The bench of a session, by its number.
    fn of(&self, session: usize) -> &Bench;
}

impl PerSession for Bench {
    fn of(&self, _: usize) -> &Bench {
        self
    }
}

/// A bench with what it is in the sessions that differ.
#[derive(Clone)]
pub(crate) struct Variants {
    pub(crate) common: Bench,
    /// By the session's number.
    pub(crate) own: BTreeMap<usize, Bench>,
}

impl PerSession for Variants {
    fn of(&self, session: usize) -> &Bench {
        self.own.get(&session).unwrap_or(&self.common)
    }
}

/// What it is that a session has of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Offset(Channel),
    Delay(Channel),
    Temperature,
}

/// A nuisance of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Nuisance {
    pub(crate) session: usize,
    kind: Kind,
    /// With the log's name, for lists of parameters.
    name: String,
}

impl Nuisance {
    /// Everything that is declared for a session, with its standard deviation; of channels, those that its log has.
    pub(crate) fn declared(bench: &Bench, data: &Data, session: usize) -> Vec<(Self, f64)> {
        let declared = bench.nuisances();
        let measured = |c: Channel| {
            let own = data.sessions.iter().position(|s| s.number == session);
            data.blocks.iter().any(|b| Some(b.session) == own && b.channel == c)
        };
        let temperature = (Kind::Temperature, declared.temperature_start_k);
        let offsets =
            declared.offset.iter().filter(|(c, _)| measured(**c)).map(|(c, d)| (Kind::Offset(*c), *d));
        let delays =
            declared.delay_s.iter().filter(|(c, _)| measured(**c)).map(|(c, d)| (Kind::Delay(*c), *d));
        let source = data.sessions.iter().find(|s| s.number == session).map_or("", |s| s.source.as_str());
        let all = offsets.chain(delays).chain([temperature]).filter(|(_, deviation)| *deviation > 0.0);
        all.map(|(kind, deviation)| (Self { session, kind, name: full_name(kind, source) }, deviation))
            .collect()
    }

    /// The field of `[nuisances]`, its channel and the log.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// All fields of `[nuisances]`.
    pub(crate) const FIELDS: [&'static str; 3] = ["offset", "delay_s", "temperature_start_k"];

    /// The field of `[nuisances]`.
    pub(crate) fn field(&self) -> &'static str {
        match self.kind {
            Kind::Offset(_) => "offset",
            Kind::Delay(_) => "delay_s",
            Kind::Temperature => "temperature_start_k",
        }
    }

    pub(crate) fn channel(&self) -> Option<Channel> {
        match self.kind {
            Kind::Offset(channel) | Kind::Delay(channel) => Some(channel),
            Kind::Temperature => None,
        }
    }

    pub(crate) fn unit(&self) -> &'static str {
        match self.kind {
            Kind::Offset(channel) => channel.unit(),
            Kind::Delay(_) => "s",
            Kind::Temperature => "K",
        }
    }

    /// Adds a value of it to its session's bench.
    pub(crate) fn apply(&self, variants: &mut Variants, value: f64) {
        let common = &variants.common;
        let bench = variants.own.entry(self.session).or_insert_with(|| common.clone());
        let sensor = |field: &str, channel: Channel| format!("sensors.{channel}.{field}");
        let place = match self.kind {
            Kind::Offset(channel) => bench.parameter_mut(&sensor("offset", channel)),
            Kind::Delay(channel) => bench.parameter_mut(&sensor("delay_s", channel)),
            Kind::Temperature => return bench.set_temperature_start_k(value),
        };
        if let Some(place) = place {
            *place += value;
        }
    }
}

fn full_name(kind: Kind, source: &str) -> String {
    match kind {
        Kind::Offset(channel) => format!("offset of {channel} in {source}"),
        Kind::Delay(channel) => format!("delay_s of {channel} in {source}"),
        Kind::Temperature => format!("temperature_start_k of {source}"),
    }
}

/// A fitted model on all sessions, and the nuisances of those that were held out, where any are declared.
pub(crate) fn simulate_all(
    data: &Data,
    noise: &NoiseModel,
    model: &Model,
    z: &[f64],
) -> Result<(Simulation, Option<Fit>), RespondError> {
    let mut benches = model.at(z);
    let held_out = match data.settling() {
        Some(settling) => {
            let model = model.settled(z).with_nuisances(&settling);
            let start = vec![0.0; model.parameters.len()];
            if start.is_empty() { None } else { Some(fit(&settling, noise, model, start)?) }
        }
        None => None,
    };
    if let Some(fit) = &held_out {
        benches.own.extend(fit.model.at(&fit.z).own);
    }
    Ok((simulate(data, &benches, None)?, held_out))
}

/// Nuisances that a session pulls as far as calibration may move anything, with everything else as fitted.
///
/// Those of fitted sessions are fitted once more at the floors of the noise: a session that is far off makes the noise of the
/// whole fit so wide that its nuisance rests on the prior.
pub(crate) fn at_bounds(
    data: &Data,
    floors: &NoiseModel,
    (model, z): (&Model, &[f64]),
    held_out: Option<&Fit>,
) -> Result<Vec<Finding>, RespondError> {
    let fitted = data.fitted();
    let (own, start) = (model.settled(z).with_nuisances(&fitted), model.nuisances_of(z));
    let told = if start.is_empty() { None } else { Some(fit(&fitted, floors, own, start)?) };
    let finding = |(p, &z): (&Parameter, &f64)| {
        let nuisance = p.nuisance().filter(|_| z.abs() >= MOST_DEVIATIONS - ON_BOUND)?;
        let source = data.sessions.get(nuisance.session)?.source.as_str();
        let found = format!(
            "{} ends at {} {}, {MOST_DEVIATIONS:.0} of its declared standard deviations",
            nuisance.field(),
            four_digits(p.value(z)),
            p.unit
        );
        let channel = nuisance.channel().map_or("t_s", Channel::name);
        let finding = Finding::new(Severity::Doubtful, source, channel, "nuisance-at-bound", found)
            .cause("the declaration is too narrow, or something else acts in this log alone")
            .evidence("value", p.value(z))
            .evidence("declared_deviation", p.scale);
        Some(finding)
    };
    let fits = told.iter().chain(held_out);
    Ok(fits.flat_map(|f| f.model.parameters.iter().zip(&f.z)).filter_map(finding).collect())
}
