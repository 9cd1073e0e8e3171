//! Estimates of all parameters that the description declares uncertain, for all logs or for one.

use super::explanation::Explanation;
use crate::data::logs::Data;
use crate::fit::parameter::Parameter;
use bench::Channel;
use schemars::JsonSchema;
use serde::Serialize;

/// A calibrated parameter of the nominal bench.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct CalibratedParameter {
    /// Dotted name in the description.
    pub name: String,
    /// Described value.
    pub described: f64,
    /// Calibrated value, fitted together with the causes.
    pub value: f64,
    /// Declared standard deviation.
    pub declared_deviation: f64,
    /// Standard deviation after the fit.
    pub deviation: f64,
}

/// A nuisance parameter of one log.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LogNuisance {
    /// Position among all logs, held-out logs after fitted ones.
    #[serde(rename = "session")]
    pub log: usize,
    /// Name of the log.
    pub source: String,
    /// Field of `[nuisances]`: `offset`, `delay_s` or `temperature_start_k`.
    pub name: &'static str,
    /// Sensor, for offsets and delays.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// Estimate.
    pub value: f64,
    /// Unit.
    pub unit: String,
    /// Standard deviation after the fit.
    pub deviation: f64,
    /// Declared standard deviation.
    pub declared_deviation: f64,
    /// Estimate in declared standard deviations, from -4 to 4.
    pub deviations_off: f64,
    /// True if the log is held out: then the value is estimated from its start, with everything
    /// else fixed as fitted.
    pub held_out: bool,
}

/// Calibrated parameters of the bench, in the order of the model.
pub(crate) fn calibrated_parameters(explanation: &Explanation) -> Vec<CalibratedParameter> {
    let uncertain = explanation
        .model
        .parameters
        .iter()
        .zip(&explanation.z)
        .zip(&explanation.deviations)
        .filter(|((p, _), _)| p.is_nominal());
    uncertain
        .map(|((p, &z), d)| CalibratedParameter {
            name: p.name().into(),
            described: p.centre,
            value: p.value(z),
            declared_deviation: p.scale,
            deviation: d * p.scale,
        })
        .collect()
}

/// Nuisance parameters of all logs, fitted logs first.
pub(crate) fn log_nuisances(data: &Data, explanation: &Explanation) -> Vec<LogNuisance> {
    let source = |index: usize| data.logs.iter().find(|log| log.index == index).map(|log| log.source.clone());
    let estimate = |p: &Parameter, z: f64, deviation: f64, held_out: bool| {
        let nuisance = p.nuisance()?;
        Some(LogNuisance {
            log: nuisance.log,
            source: source(nuisance.log)?,
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
    let fitted = explanation.model.parameters.iter().zip(&explanation.z).zip(&explanation.deviations);
    let mut out: Vec<LogNuisance> = fitted.filter_map(|((p, &z), &d)| estimate(p, z, d, false)).collect();
    if let Some(fit) = &explanation.held_out {
        let deviations = fit.linear_standard_deviations();
        let calibrated = fit.model.parameters.iter().zip(&fit.z).zip(&deviations);
        out.extend(calibrated.filter_map(|((p, &z), &d)| estimate(p, z, d, true)));
    }
    out
}
