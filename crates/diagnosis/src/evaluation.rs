//! Evaluation of a described bench: simulates it under the inputs of logs and compares. Nothing is
//! fitted, and no reading is corrected.
//!
//! Rows without a time or a reading are left out, and copies of logs. The start transient of a
//! transmission bench is not compared.

use crate::check::{Finding, check, clean};
use crate::data::logs::{Columns, Data, simulated_outputs};
use crate::data::noise::NoiseModel;
use crate::data::split::{Split, Use};
use crate::fit::simulation::simulate;
use crate::result::DiagnosisError;
use crate::verdict::series::{Series, series};
use bench::{Bench, Channel, MeasuredLog};
use schemars::JsonSchema;
use serde::Serialize;

/// Error of one channel over all logs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ChannelComparison {
    /// Channel.
    pub channel: Channel,
    /// Unit of all values.
    pub unit: &'static str,
    /// Rms of measured minus simulated values.
    pub rms: f64,
    /// Rms of the sensor's noise.
    pub noise_rms: f64,
    /// Origin of the noise: `declared`, `repeats`, `differences` or `input`.
    pub noise_source: &'static str,
    /// Mean of measured minus simulated values.
    pub mean: f64,
    /// Largest magnitude of measured minus simulated values.
    pub max: f64,
    /// Rms of the measured values.
    pub measured_rms: f64,
    /// Compared samples.
    pub samples: usize,
}

/// Error of one channel of one log.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LogComparison {
    /// Name of the log.
    pub log: String,
    /// Channel.
    pub channel: Channel,
    /// Rms of measured minus simulated values.
    pub rms: f64,
    /// Mean of measured minus simulated values.
    pub mean: f64,
    /// Compared samples.
    pub samples: usize,
}

/// A described bench compared with logs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Evaluation {
    /// Errors by channel.
    pub channels: Vec<ChannelComparison>,
    /// Errors by log and channel.
    pub logs: Vec<LogComparison>,
    /// Findings about the logs. Their corrections were not applied.
    pub checks: Vec<Finding>,
    /// Measured values and errors over time.
    #[serde(skip)]
    pub series: Vec<Series>,
}

/// Sums over samples.
#[derive(Default)]
struct Sums {
    samples: usize,
    sum: f64,
    squares: f64,
    max: f64,
    measured_squares: f64,
}

impl Sums {
    fn add(&mut self, measured: f64, error: f64) {
        self.samples += 1;
        self.sum += error;
        self.squares += error * error;
        self.max = self.max.max(error.abs());
        self.measured_squares += measured * measured;
    }

    fn mean(&self, sum: f64) -> f64 {
        sum / self.samples.max(1) as f64
    }
}

/// Compares logs with the described bench.
pub fn evaluate(bench: &Bench, logs: &[MeasuredLog]) -> Result<Evaluation, DiagnosisError> {
    if logs.is_empty() {
        return Err(DiagnosisError::NoLog);
    }
    let mut checks = check(bench, logs, &[])?.findings;
    for finding in &mut checks {
        // The corrections belong to a diagnosis. Rows are left out by their own count below.
        finding.applied = None;
    }
    let clean = clean(bench, logs)?;
    let data = Data::with_outputs(bench, (&clean, &[]), Split::Halves, simulated_outputs)?;
    let simulation = simulate(&data, bench, None)?;
    let residual = data.residual(&simulation.columns);
    let noise = NoiseModel::from_nominal_residual(bench, &data, &residual);
    let channels = data.channels.iter().map(|&channel| {
        let sums = sums(&data, &residual, |block| block.channel == channel);
        let floor = noise.channel(channel);
        ChannelComparison {
            channel,
            unit: channel.unit(),
            rms: sums.mean(sums.squares).sqrt(),
            noise_rms: floor.floor,
            noise_source: floor.source.name(),
            mean: sums.mean(sums.sum),
            max: sums.max,
            measured_rms: sums.mean(sums.measured_squares).sqrt(),
            samples: sums.samples,
        }
    });
    let by_log = data.blocks.iter().map(|block| {
        let sums = sums(&data, &residual, |other| (other.log, other.channel) == (block.log, block.channel));
        LogComparison {
            log: data.logs.get(block.log).map_or_else(String::new, |log| log.source.clone()),
            channel: block.channel,
            rms: sums.mean(sums.squares).sqrt(),
            mean: sums.mean(sums.sum),
            samples: sums.samples,
        }
    });
    Ok(Evaluation {
        channels: channels.collect(),
        logs: by_log.collect(),
        checks,
        series: series(&data, &residual, &residual),
    })
}

/// Sums over the compared samples of some blocks.
fn sums(data: &Data, residual: &Columns, includes: impl Fn(&crate::data::logs::Block) -> bool) -> Sums {
    let mut sums = Sums::default();
    for (block, errors) in data.blocks.iter().zip(residual).filter(|(block, _)| includes(block)) {
        let samples = block.measured.iter().zip(errors).zip(data.uses(block));
        for ((measured, error), _) in samples.filter(|(_, used)| **used != Use::Skip) {
            sums.add(*measured, *error);
        }
    }
    sums
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]
mod tests {
    use super::*;
    use bench::simulate::record;

    fn rig() -> Bench {
        Bench::open("friction-rig").unwrap()
    }

    #[test]
    fn the_error_of_the_right_description_is_the_noise_and_of_a_wrong_one_the_difference() {
        let bench = rig();
        let log = record(&bench, 5).unwrap();
        let right = evaluate(&bench, std::slice::from_ref(&log)).unwrap();
        let torque = right.channels.iter().find(|c| c.channel == Channel::DriveTorque).unwrap();
        assert!((torque.rms / torque.noise_rms - 1.0).abs() < 0.1, "{torque:?}");
        assert_eq!((torque.noise_source, torque.samples), ("declared", log.time_s.len()));
        let mut wrong = bench.clone();
        wrong.axis_mut().unwrap().axis.coulomb_effort += 10.0;
        let off = evaluate(&wrong, &[log]).unwrap();
        let torque = off.channels.iter().find(|c| c.channel == Channel::DriveTorque).unwrap();
        assert!((torque.rms / 10.0 - 1.0).abs() < 0.1, "{torque:?}");
        // An uncertain level is not calibrated.
        assert!(torque.max > 9.0, "{torque:?}");
    }

    #[test]
    fn a_wrong_unit_is_a_finding_and_stays_in_the_error() {
        let bench = rig();
        let mut log = record(&bench, 5).unwrap();
        log.channels.get_mut(&Channel::DriveTorque).unwrap().iter_mut().for_each(|v| *v *= 1e3);
        let evaluation = evaluate(&bench, &[log]).unwrap();
        let torque = evaluation.channels.iter().find(|c| c.channel == Channel::DriveTorque).unwrap();
        assert!(torque.rms > 0.9 * torque.measured_rms, "{torque:?}");
        let finding = evaluation.checks.iter().find(|f| f.kind == "unit").unwrap();
        assert!(finding.applied.is_none() && finding.correction.is_some(), "{finding:?}");
    }

    #[test]
    fn each_log_has_its_own_error() {
        let bench = rig();
        let mut other = bench.clone();
        other.axis_mut().unwrap().axis.coulomb_effort += 10.0;
        let named =
            |name: &str, bench: &Bench| MeasuredLog { source: name.into(), ..record(bench, 5).unwrap() };
        let logs = [named("a", &bench), named("b", &other)];
        let evaluation = evaluate(&bench, &logs).unwrap();
        let rms = |name: &str| {
            let own = evaluation.logs.iter().filter(|l| l.log == name && l.channel == Channel::DriveTorque);
            own.map(|l| l.rms).next().unwrap()
        };
        assert!(rms("b") > 9.0 && rms("a") < 2.1, "{:?}", evaluation.logs);
        assert!(matches!(evaluate(&bench, &[]), Err(DiagnosisError::NoLog)));
    }
}
