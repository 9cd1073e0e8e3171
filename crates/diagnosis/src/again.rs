//! Which answers count that a log gives when it is asked again, with stretches held out by turns in place of its second half: those that the first
//! question could not have learnt.

use crate::result::{Cause, Series};
use bench::Channel;
use bench::effects::{Guess, kind};

/// Name of the parameter of a change that is its time in the log, and of one that says how slow an effect is.
const ONSET: &str = "time_s";
const TIME_CONSTANT: &str = "time_constant_s";
/// Time constants after which an effect has come to its end, but for a twentieth.
const SETTLED: f64 = 3.0;
/// Share of a limit from which a reading reaches it.
const REACHED: f64 = 0.99;

/// Whether causes of a second answer contain a change that begins in what the first one, with these series, held out, one that comes to its end later
/// than what was fitted does, or a limit of readings most of which were held out.
pub(crate) fn comes_late(first: &[Series], causes: &[Cause]) -> bool {
    let fitted = |series: &Series| {
        let until = series.held_out.iter().position(|held| *held)?;
        Some((*series.time_s.first()?, *series.time_s.get(until)?))
    };
    let fitted: Vec<(f64, f64)> = first.iter().filter_map(fitted).collect();
    let until_s = fitted.iter().fold(f64::INFINITY, |least, f| least.min(f.1));
    let longest_s = fitted.iter().fold(0.0_f64, |most, f| most.max(f.1 - f.0));
    let ends_late = |channel: Channel, limit: f64| {
        let own = first.iter().filter(|s| s.channel == channel);
        let reaching = own.flat_map(|s| s.measured.iter().zip(&s.held_out));
        let held: Vec<bool> = reaching.filter(|(m, _)| m.abs() >= REACHED * limit).map(|(_, h)| *h).collect();
        2 * held.iter().filter(|held| **held).count() > held.len()
    };
    let is_late = |cause: &Cause| {
        let guess = kind(&cause.effect).map(|kind| kind.guess);
        cause.parameters.iter().any(|p| match (guess, cause.channel) {
            (Some(Guess::Onset(_)), _) => p.name == ONSET && p.value >= until_s,
            (Some(Guess::LargestReading), Some(channel)) => ends_late(channel, 1.0 / p.value),
            _ => p.name == TIME_CONSTANT && SETTLED * p.value >= longest_s,
        })
    };
    causes.iter().any(is_late)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::ParameterEstimate;

    /// Ten seconds of which the second half was held out; it reads 1, from 7 s on 2.
    fn halves() -> Vec<Series> {
        let time_s: Vec<f64> = (0..100).map(|i| 0.1 * f64::from(i)).collect();
        let zero = vec![0.0; time_s.len()];
        vec![Series {
            source: "log".into(),
            channel: Channel::DriveForce,
            phase: None,
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
        let cause = Cause { effect: effect.into(), channel, probability: 1.0, parameters: vec![parameter] };
        comes_late(&halves(), &[cause])
    }

    #[test]
    fn only_what_was_held_out_tells_a_late_onset_a_slow_end_and_a_rare_limit() {
        let onset = |t: f64| is_late("friction-step", None, "time_s", t);
        assert!(onset(6.0) && !onset(4.0));
        let slow = |t: f64| is_late("thermal-friction-drift", None, "time_constant_s", t);
        assert!(slow(2.0) && !slow(1.5));
        let limit =
            |l: f64| is_late("sensor-saturation", Some(Channel::DriveForce), "inverse_limit", 1.0 / l);
        assert!(limit(2.0) && !limit(1.0) && !limit(3.0));
        assert!(!is_late("coulomb-level", None, "coulomb_effort", 6.0) && !comes_late(&halves(), &[]));
    }
}
