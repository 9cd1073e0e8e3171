//! Resolution of a channel: the step between its readings.

use super::finding::{Finding, Severity};
use super::tuning;
use crate::digits::four_digits;
use crate::statistics::range;
use bench::{Bench, Channel, MeasuredLog};

/// Readings in ascending order, without the outermost ones, which include gross errors.
pub(super) fn inner(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let outermost = sorted.len() / tuning::OUTERMOST_DIVISOR;
    sorted.truncate(sorted.len() - outermost);
    sorted.split_off(outermost)
}

/// The step of which nearly all differences of readings are integer multiples; `None` without such
/// a step, or with few equal readings.
pub(crate) fn step(values: &[f64]) -> Option<f64> {
    let sorted = inner(values);
    let min = tuning::MIN_STEP_SHARE * range(&sorted);
    let steps: Vec<f64> =
        sorted.windows(2).filter_map(|w| Some(w.last()? - w.first()?)).filter(|d| *d > min).collect();
    let step = steps.iter().copied().reduce(f64::min)?;
    let is_off_grid = |d: &&f64| (*d / step - (*d / step).round()).abs() > tuning::STEP_TOLERANCE;
    let off_grid = steps.iter().filter(is_off_grid).count();
    let is_coarse = steps.len() * tuning::MIN_REPEATS <= values.len();
    (is_coarse && off_grid * tuning::OFF_GRID_DIVISOR <= steps.len()).then_some(step)
}

/// Reports readings that come in steps.
pub(super) fn report_resolution(bench: &Bench, log: &MeasuredLog, findings: &mut Vec<Finding>) {
    for (&channel, values) in &log.channels {
        // A load may be constant, and a constant has no steps.
        let Some(step) = step(values).filter(|_| channel != Channel::LoadForce) else { continue };
        let declared = bench.sensors().get(&channel).map_or(0.0, bench::signals::Sensor::floor);
        let is_coarse = declared > 0.0 && step > tuning::COARSE_STEPS * declared;
        let severity = if is_coarse { Severity::Doubtful } else { Severity::Note };
        findings.push(
            Finding::new(
                severity,
                &log.source,
                channel.name(),
                "quantised",
                format!("readings come in steps of {} {}", four_digits(step), channel.unit()),
            )
            .cause("the converter's resolution, or too few digits in the file")
            .evidence("step", step)
            .evidence("declared_noise", declared),
        );
    }
}
