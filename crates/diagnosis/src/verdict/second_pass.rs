//! Criterion for a second pass with interleaved hold-out to replace the result of the first pass,
//! which holds out the second half of each log.

use super::causes::Cause;
use super::series::Series;
use super::tuning;
use bench::Channel;
use bench::effects::{Guess, kind};

/// Parameter of an effect: the time at which it begins.
const ONSET: &str = "time_s";
/// Parameter of an effect: the time constant with which it settles.
const TIME_CONSTANT: &str = "time_constant_s";

/// Returns whether one of `causes`, which the second pass names, could not be learnt from the
/// samples that the first pass fitted; `first` is the series of the first pass.
///
/// Such a cause begins after the fitted samples, takes longer to settle than they last, or is a
/// sensor limit that is reached mostly in held-out samples.
pub(crate) fn names_late_cause(first: &[Series], causes: &[Cause]) -> bool {
    // Start and end of the fitted samples.
    let fitted_span = |series: &Series| {
        let end = series.held_out.iter().position(|is_held_out| *is_held_out)?;
        Some((*series.time_s.first()?, *series.time_s.get(end)?))
    };
    let spans: Vec<(f64, f64)> = first.iter().filter_map(fitted_span).collect();
    let first_end_s = spans.iter().fold(f64::INFINITY, |min, (_, end)| min.min(*end));
    let max_s = spans.iter().fold(0.0_f64, |max, (start, end)| max.max(end - start));
    let is_limit_late = |channel: Channel, limit: f64| {
        let own = first.iter().filter(|series| series.channel == channel);
        let readings = own.flat_map(|series| series.measured.iter().zip(&series.held_out));
        let at_limit: Vec<bool> = readings
            .filter(|(reading, _)| reading.abs() >= tuning::LIMIT_REACHED_SHARE * limit)
            .map(|(_, is_held_out)| *is_held_out)
            .collect();
        2 * at_limit.iter().filter(|is_held_out| **is_held_out).count() > at_limit.len()
    };
    let is_late = |cause: &Cause| {
        let guess = kind(&cause.effect).map(|kind| kind.guess);
        cause.parameters.iter().any(|p| match (guess, cause.channel) {
            (Some(Guess::Onset(_)), _) => p.name == ONSET && p.value >= first_end_s,
            (Some(Guess::LargestReading), Some(channel)) => is_limit_late(channel, 1.0 / p.value),
            _ => p.name == TIME_CONSTANT && tuning::SETTLED_TIME_CONSTANTS * p.value >= max_s,
        })
    };
    causes.iter().any(is_late)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::causes::ParameterEstimate;

    /// A log of 10 s with the second half held out; it reads 1, and 2 from 7 s on.
    fn halves() -> Vec<Series> {
        let time_s: Vec<f64> = (0..100).map(|i| 0.1 * f64::from(i)).collect();
        let zero = vec![0.0; time_s.len()];
        vec![Series {
            source: "log".into(),
            channel: Channel::DriveForce,
            phase: None,
            position: zero.clone(),
            measured: time_s.iter().map(|t| if *t < 7.0 { 1.0 } else { 2.0 }).collect(),
            before: zero.clone(),
            after: zero,
            held_out: time_s.iter().map(|t| *t >= 4.95).collect(),
            time_s,
        }]
    }

    fn is_late(effect: &str, channel: Option<Channel>, name: &str, value: f64) -> bool {
        let parameter =
            ParameterEstimate { name: name.into(), value, unit: String::new(), ci95: [value, value] };
        let cause = Cause {
            effect: effect.into(),
            channel,
            of: None,
            probability: 1.0,
            parameters: vec![parameter],
            gain: Vec::new(),
            alternatives: Vec::new(),
        };
        names_late_cause(&halves(), &[cause])
    }

    #[test]
    fn late_onsets_slow_effects_and_late_limits_are_late_causes() {
        let onset = |t: f64| is_late("friction-step", None, "time_s", t);
        assert!(onset(6.0) && !onset(4.0));
        let slow = |t: f64| is_late("thermal-friction-drift", None, "time_constant_s", t);
        assert!(slow(2.0) && !slow(1.5));
        let limit =
            |l: f64| is_late("sensor-saturation", Some(Channel::DriveForce), "inverse_limit", 1.0 / l);
        assert!(limit(2.0) && !limit(1.0) && !limit(3.0));
        assert!(!is_late("coulomb-level", None, "coulomb_effort", 6.0) && !names_late_cause(&halves(), &[]));
    }
}
