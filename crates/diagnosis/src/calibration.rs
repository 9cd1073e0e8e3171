//! What calibration found of everything that the description declares, as it is written to `diagnosis.json`.

use bench::Channel;
use serde::Serialize;

/// A calibrated parameter of the nominal bench.
#[derive(Clone, Debug, Serialize)]
pub struct Calibrated {
    /// Dotted name.
    pub name: String,
    /// Value of the description.
    pub described: f64,
    /// Calibrated value, together with the causes.
    pub value: f64,
    /// Standard deviation that the description declares.
    pub declared_deviation: f64,
    /// Standard deviation after the fit.
    pub deviation: f64,
}

/// What the description declares as a session's own, in one session.
#[derive(Clone, Debug, Serialize)]
pub struct SessionNuisance {
    /// The session's place among the logs, those held out after those to be fitted.
    pub session: usize,
    /// Its log.
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
    /// Standard deviation that the description declares.
    pub declared_deviation: f64,
    /// Estimate in declared standard deviations, from -4 to 4.
    pub deviations_off: f64,
    /// Whether it comes from the start of a log that is held out, with everything else as fitted.
    pub held_out: bool,
}
