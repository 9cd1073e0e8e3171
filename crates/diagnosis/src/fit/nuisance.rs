//! Nuisance parameters of each log: offsets and delays of its outputs, its temperature at the
//! start.
//!
//! A description declares their standard deviations ([`bench::description::Nuisances`]). Every fit
//! gives each fitted log a parameter for each of them, with that deviation as its prior. So a
//! difference between logs is not taken for an effect.
//!
//! The nuisance parameters of a held-out log cannot be learnt from other logs. They are fitted on
//! its first cycle, or on its first eighth if it has fewer than two cycles, with everything else
//! fixed: once for the model before the extension and once for the model after it. These samples
//! are not compared. So an offset favours neither model, and a gain must show on samples that no
//! parameter was fitted to. A start temperature matters only if friction depends on temperature.

use crate::data::logs::Data;
use bench::{Bench, Channel};
use std::collections::BTreeMap;

/// One bench for all logs, or one for each.
pub(crate) trait BenchPerLog {
    /// The bench of a log, by [`crate::data::logs::Log::index`].
    fn for_log(&self, log: usize) -> &Bench;
}

impl BenchPerLog for Bench {
    fn for_log(&self, _: usize) -> &Bench {
        self
    }
}

/// A bench with variants for the logs that differ.
#[derive(Clone)]
pub(crate) struct Variants {
    pub(crate) common: Bench,
    /// Benches of the logs that differ, by [`crate::data::logs::Log::index`].
    pub(crate) own: BTreeMap<usize, Bench>,
}

impl BenchPerLog for Variants {
    fn for_log(&self, log: usize) -> &Bench {
        self.own.get(&log).unwrap_or(&self.common)
    }
}

/// Kind of a nuisance parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Offset(Channel),
    Delay(Channel),
    Temperature,
}

/// A nuisance parameter of one log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Nuisance {
    pub(crate) log: usize,
    kind: Kind,
    /// Name with the name of the log, for lists of parameters.
    name: String,
}

impl Nuisance {
    /// Nuisance parameters declared for a log with their standard deviations; sensors that the log
    /// lacks are omitted.
    pub(crate) fn declared(bench: &Bench, data: &Data, log: usize) -> Vec<(Self, f64)> {
        let declared = bench.nuisances();
        let measured = |c: Channel| {
            let own = data.logs.iter().position(|l| l.index == log);
            data.blocks.iter().any(|b| Some(b.log) == own && b.channel == c)
        };
        let temperature = (Kind::Temperature, declared.temperature_start_k);
        let offsets =
            declared.offset.iter().filter(|(c, _)| measured(**c)).map(|(c, d)| (Kind::Offset(*c), *d));
        let delays =
            declared.delay_s.iter().filter(|(c, _)| measured(**c)).map(|(c, d)| (Kind::Delay(*c), *d));
        let source = data.logs.iter().find(|l| l.index == log).map_or("", |l| l.source.as_str());
        let all = offsets.chain(delays).chain([temperature]).filter(|(_, deviation)| *deviation > 0.0);
        all.map(|(kind, deviation)| (Self { log, kind, name: full_name(kind, source) }, deviation)).collect()
    }

    /// Name: the field of `[nuisances]`, the channel and the log.
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

    /// Adds `value` to the parameter in the bench of its log.
    pub(crate) fn apply(&self, variants: &mut Variants, value: f64) {
        let common = &variants.common;
        let bench = variants.own.entry(self.log).or_insert_with(|| common.clone());
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
