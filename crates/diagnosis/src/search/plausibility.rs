//! Candidates that no log can show, or that no bench can have.

use super::tuning;
use crate::data::logs::{Data, Log};
use crate::fit::least_squares::Fit;
use bench::effects::Guess;

/// Returns whether a bench can be as a fit says, and the logs can show the shape of its last
/// effect.
pub(super) fn is_plausible(data: &Data, fit: &Fit) -> bool {
    fit.model.is_possible(&fit.z) && shows_shape(data, fit)
}

/// Returns whether the logs can show the shape of the last effect of a fit.
///
/// * An onset has a cycle of one log before it, or [`tuning::ONSET_MARGIN_SHARE`] of the log if
///   that is less. The start of a log depends on a past that it does not contain, and an onset
///   there would imitate it.
/// * A pulsation over time is not one of the first [`tuning::MOTION_HARMONICS`] multiples of the
///   motion's own frequency, where it would imitate any effect of the motion.
fn shows_shape(data: &Data, fit: &Fit) -> bool {
    let Some(guess) = fit.model.effects.last().map(|c| c.kind.guess) else { return true };
    let own = fit.model.effect_parameters(fit.model.effects.len() - 1);
    let shape = own.into_iter().find(|&i| fit.model.parameters[i].is_shape());
    let Some(shape) = shape.map(|i| fit.model.parameters[i].value(fit.z[i])) else { return true };
    match guess {
        Guess::Onset(_) => data.logs.iter().any(|log| has_start_before(log, shape)),
        Guess::Frequency => data.logs.iter().any(|log| !is_harmonic(log, shape)),
        _ => true,
    }
}

/// Returns whether a log begins long enough before a time.
fn has_start_before(log: &Log, time_s: f64) -> bool {
    let times = log.inputs.time_s();
    let share = (tuning::ONSET_MARGIN_SHARE * times.len() as f64) as usize;
    let start = log.phase.as_ref().and_then(|p| p.first()).copied().unwrap_or_default();
    let cycle = log.phase.as_ref().and_then(|p| p.iter().position(|p| *p >= start + 1.0));
    times.get(cycle.map_or(share, |cycle| cycle.min(share))).is_some_and(|first| time_s >= *first)
}

/// Returns whether a frequency is one of the first multiples of that of a log's motion, within half
/// the log's resolution.
fn is_harmonic(log: &Log, frequency_hz: f64) -> bool {
    let times = log.inputs.time_s();
    let ends = |values: &[f64]| Some(values.last()? - values.first()?);
    let (Some(span_s), Some(cycles)) = (ends(times), log.phase.as_deref().and_then(ends)) else {
        return false;
    };
    let in_cycles = frequency_hz * span_s / cycles;
    let multiple = in_cycles.round();
    (1.0..=tuning::MOTION_HARMONICS).contains(&multiple) && (in_cycles - multiple).abs() < 0.5 / cycles
}

#[cfg(test)]
mod tests {
    use crate::fixtures::{calibrated, plain};

    #[test]
    fn friction_that_drives_the_axis_at_an_end_of_the_stroke_is_impossible() {
        // A level of 980 N m at the neutral position, 1.333 rad from the other end of the stroke.
        let (_, noise, base) = calibrated(0.0);
        let model = base.model.with_effect(plain("position-friction"), &noise);
        let is_possible = |slope: f64| {
            let mut z = base.z.clone();
            z.push(slope / model.parameters[z.len()].value(1.0));
            model.is_possible(&z)
        };
        assert!(is_possible(-700.0) && is_possible(5000.0));
        assert!(!is_possible(-800.0));
    }
}
