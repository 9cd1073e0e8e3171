//! Axes of a chart, linear or logarithmic: their span, ticks at round numbers, and labels.

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use std::ops::Range;

/// Approximate number of ticks on an axis.
const TICKS: f64 = 7.0;
/// Smallest span of a logarithmic axis, in decades.
const MIN_DECADES: f64 = 0.7;

/// Axis of a chart.
#[derive(Clone, Debug)]
pub struct Axis {
    low: f64,
    high: f64,
    logarithmic: bool,
    step: f64,
}

impl Axis {
    /// Creates a linear axis around the finite ones of some values.
    pub fn linear(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = span(values).unwrap_or((0.0, 1.0));
        let step = 10_f64.powf(((high - low) / TICKS).log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .into_iter()
            .map(|m| m * step)
            .find(|s| (high - low) / s <= TICKS + 2.0)
            .unwrap_or(step);
        Self { low, high, logarithmic: false, step }
    }

    /// Creates a logarithmic axis around the positive ones of some values.
    pub fn logarithmic(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = span(values.filter(|v| *v > 0.0).map(f64::log10)).unwrap_or((0.0, 1.0));
        // On much less than a decade, tiny differences would look steep.
        let widen = 0.5 * (MIN_DECADES - (high - low)).max(0.0);
        let (low, high) = (low - widen, high + widen);
        Self { low, high, logarithmic: true, step: 1.0 }
    }

    /// Returns the coordinate of a value on the axis; `None` if it has none.
    pub fn place(&self, value: f64) -> Option<f64> {
        let place = if self.logarithmic { value.log10() } else { value };
        place.is_finite().then_some(place)
    }

    fn ticks(&self) -> Vec<f64> {
        let within = |v: &f64| (self.low..=self.high).contains(v);
        if self.logarithmic {
            let decades = self.low.floor() as i32..=self.high.ceil() as i32;
            let multiples: &[f64] = match self.high - self.low {
                wide if wide > 3.0 => &[1.0],
                middle if middle > 1.2 => &[1.0, 2.0, 5.0],
                _ => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0],
            };
            return decades
                .flat_map(|d| multiples.iter().map(move |m| f64::from(d) + m.log10()))
                .filter(within)
                .collect();
        }
        let (from, to) = ((self.low / self.step).ceil() as i64, (self.high / self.step).floor() as i64);
        (from..=to).map(|i| i as f64 * self.step).collect()
    }

    /// Formats a tick label with as many decimals as the ticks need.
    fn label(&self, place: f64) -> String {
        if self.logarithmic {
            let value = 10_f64.powf(place);
            // Two digits: enough for 1.5.
            let digits = (1.0 - (place + 1e-9).floor()).clamp(0.0, 9.0) as usize;
            return if (-4.0..6.0).contains(&place) {
                format!("{value:.digits$}")
            } else {
                format!("{value:.0e}")
            };
        }
        if self.step < 1e-5 || self.step >= 1e6 {
            return format!("{place:.1e}");
        }
        let digits = (-self.step.log10().floor()).clamp(0.0, 9.0) as usize;
        let text = format!("{place:.digits$}");
        if text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.')) { "0".into() } else { text }
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        from + (f64::from(to - from) * (value - self.low) / (self.high - self.low)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks() }
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        self.label(*value)
    }
}

/// Returns the span of the finite values with a margin; `None` if there are none.
fn span(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    if low > high {
        return None;
    }
    let margin = if high > low { 0.04 * (high - low) } else { 0.5 * high.abs().max(1e-9) };
    Some((low - margin, high + margin))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_labels_carry_what_they_need() {
        let axis = Axis::linear([0.0, 1.0].into_iter());
        let labels: Vec<String> = axis.ticks().into_iter().map(|t| axis.label(t)).collect();
        assert_eq!(labels, ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        let axis = Axis::linear([-2500.0, 14_000.0].into_iter());
        let labels: Vec<String> = axis.ticks().into_iter().map(|t| axis.label(t)).collect();
        assert_eq!(labels, ["-2000", "0", "2000", "4000", "6000", "8000", "10000", "12000", "14000"]);
        let axis = Axis::logarithmic([0.1, 1.0].into_iter());
        let labels: Vec<String> = axis.ticks().into_iter().map(|t| axis.label(t)).collect();
        assert_eq!(labels, ["0.10", "0.15", "0.20", "0.30", "0.40", "0.50", "0.70", "1.0"]);
    }

    #[test]
    fn no_values_and_equal_values_still_make_an_axis() {
        for values in [vec![], vec![f64::NAN], vec![3.0, 3.0], vec![0.0]] {
            for axis in [Axis::linear(values.clone().into_iter()), Axis::logarithmic(values.into_iter())] {
                assert!(axis.high > axis.low && axis.ticks().len() < 100);
            }
        }
    }
}
