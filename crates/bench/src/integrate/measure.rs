//! Peak force, depth and work of a contact within a step, from the dense output.
//!
//! Force, depth and power are read at start, middle and end of the span. The work is Simpson's rule
//! over them, which has the order of the dense output. The work of compression ends where the rate
//! of the deformation changes its sign. A maximum inside the span is located by
//! golden section, so that it does not depend on the positions of steps and samples.

use super::{ContactReading, Impact, IntegrationError};

const POINTS: usize = 3;
const LAST: usize = POINTS - 1;
/// Golden sections of a search: they reduce the bracket to 1e-6, and the error of a flat top to the
/// square of that.
const SECTIONS: usize = 28;
/// Bisections of the search for the end of a compression, where the power is 0.
const BISECTIONS: usize = 30;

/// A span in contact with the readings at its ends.
pub(super) struct Span {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) start: ContactReading,
    pub(super) end: ContactReading,
}

impl Span {
    /// Adds the span to the impact of a contact. `read` returns the contact at a time within the
    /// span.
    pub(super) fn measure(
        &self,
        read: &mut impl FnMut(f64) -> Result<ContactReading, IntegrationError>,
        impact: &mut Impact,
    ) -> Result<(), IntegrationError> {
        let middle_s = 0.5 * (self.from + self.to);
        let times_s = [self.from, middle_s, self.to];
        let readings = [self.start, read(middle_s)?, self.end];
        let power_w = |r: &ContactReading| r.force_n * r.rate_m_s;
        let [a, b, c] = readings.each_ref().map(power_w);
        let work_j = (a + 4.0 * b + c) * (self.to - self.from) / 6.0;
        impact.energy_lost_j += work_j;
        impact.compression_work_j += match (self.start.rate_m_s > 0.0, self.end.rate_m_s > 0.0) {
            (true, true) => work_j,
            (false, false) => 0.0,
            (compresses_first, _) => {
                let turn_s = self.turn_s(compresses_first, read)?;
                let (from, to) = if compresses_first { (self.from, turn_s) } else { (turn_s, self.to) };
                let middle = power_w(&read(0.5 * (from + to))?);
                // The power at the turn is 0.
                let end = if compresses_first { a } else { c };
                (end + 4.0 * middle) * (to - from) / 6.0
            }
        };
        let mut force = |t: f64| read(t).map_or(f64::NAN, |r| r.force_n);
        let forces = readings.map(|r| r.force_n);
        if let Some((time_s, value)) = highest(&times_s, &forces, impact.peak_force_n, &mut force) {
            (impact.peak_force_n, impact.peak_s) = (value, time_s);
        }
        let mut depth = |t: f64| read(t).map_or(f64::NAN, |r| r.depth_m);
        let depths = readings.map(|r| r.depth_m);
        if let Some((_, value)) = highest(&times_s, &depths, impact.max_deformation_m, &mut depth) {
            impact.max_deformation_m = value;
        }
        Ok(())
    }
}

impl Span {
    /// Time at which the rate of the deformation changes its sign.
    fn turn_s(
        &self,
        compresses_first: bool,
        read: &mut impl FnMut(f64) -> Result<ContactReading, IntegrationError>,
    ) -> Result<f64, IntegrationError> {
        let (mut low, mut high) = (self.from, self.to);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if (read(middle)?.rate_m_s > 0.0) == compresses_first {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(0.5 * (low + high))
    }
}

/// Time and value of the maximum in a span, if it exceeds `known`.
fn highest(
    times_s: &[f64; POINTS],
    values: &[f64; POINTS],
    known: f64,
    read: &mut impl FnMut(f64) -> f64,
) -> Option<(f64, f64)> {
    let top = (0..POINTS).fold(0, |best, i| if values[i] > values[best] { i } else { best });
    let best = (times_s[top], values[top]);
    // Within a step of limited error a curve exceeds the highest of three points by far less than a
    // tenth.
    if values[top] * 1.1 < known {
        return None;
    }
    // One-sided slope at an end that is the highest point: positive if the maximum lies inside the
    // span.
    let [a, b, c] = match top {
        0 => [values[0], values[1], values[2]],
        LAST => [values[LAST], values[LAST - 1], values[LAST - 2]],
        _ => [0.0, 1.0, 0.0],
    };
    let located = if -3.0 * a + 4.0 * b - c > 0.0 {
        let low = times_s[top.saturating_sub(1)];
        let high = times_s[(top + 1).min(LAST)];
        golden(low, high, read)
    } else {
        best
    };
    let best = if located.1 > best.1 { located } else { best };
    (best.1 > known).then_some(best)
}

/// Locates the maximum of a curve with one maximum in a bracket.
fn golden(mut low: f64, mut high: f64, read: &mut impl FnMut(f64) -> f64) -> (f64, f64) {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let (mut left, mut right) = (high - RATIO * (high - low), low + RATIO * (high - low));
    let (mut at_left, mut at_right) = (read(left), read(right));
    for _ in 0..SECTIONS {
        if at_left > at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - RATIO * (high - low);
            at_left = read(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + RATIO * (high - low);
            at_right = read(right);
        }
    }
    if at_left > at_right { (left, at_left) } else { (right, at_right) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_maximum_between_points_is_located_and_one_at_an_end_is_left_to_the_next_span() {
        let times = [0.0, 0.5, 1.0];
        for top in [0.1, 0.3, 0.62, 0.97] {
            let mut curve = |t: f64| 2.0 - (t - top) * (t - top);
            let values = times.map(&mut curve);
            let (t, value) = highest(&times, &values, 0.0, &mut curve).unwrap();
            assert!((t - top).abs() < 1e-5 && (value - 2.0).abs() < 1e-11, "{t} {value} for {top}");
        }
        let mut rising = |t: f64| 1.0 + t;
        let values = times.map(&mut rising);
        assert_eq!(highest(&times, &values, 0.0, &mut rising), Some((1.0, 2.0)));
        assert_eq!(highest(&times, &values, 3.0, &mut rising), None);
    }
}
