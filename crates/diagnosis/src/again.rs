//! Which answers count that a log gives when it is asked again, with stretches held out by turns in place of its second half: those that the first
//! question could not have learnt.

use crate::result::{Cause, Diagnosis, Series, Verdict};
use bench::Channel;
use bench::effects::{Guess, kind};

/// Name of the parameter of a change that is its time in the log, and of one that says how slow an effect is.
const ONSET: &str = "time_s";
const TIME_CONSTANT: &str = "time_constant_s";
/// Time constants after which an effect has come to its end, but for a twentieth.
const SETTLED: f64 = 3.0;
/// Share of a limit from which a reading reaches it.
const REACHED: f64 = 0.99;

/// Whether a second answer names a change that begins in what the first one held out, one that comes to its end later than what was fitted does, or a limit of
/// readings most of which were held out.
pub(crate) fn comes_late(first: &Diagnosis, second: &Diagnosis) -> bool {
    let fitted = |series: &Series| {
        let until = series.held_out.iter().position(|held| *held)?;
        Some((*series.time_s.first()?, *series.time_s.get(until)?))
    };
    let fitted: Vec<(f64, f64)> = first.series.iter().filter_map(fitted).collect();
    let until_s = fitted.iter().fold(f64::INFINITY, |least, f| least.min(f.1));
    let longest_s = fitted.iter().fold(0.0_f64, |most, f| most.max(f.1 - f.0));
    let ends_late = |channel: Channel, limit: f64| {
        let own = first.series.iter().filter(|s| s.channel == channel);
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
    matches!(second.verdict, Verdict::Named | Verdict::Ambiguous) && second.causes.iter().any(is_late)
}
