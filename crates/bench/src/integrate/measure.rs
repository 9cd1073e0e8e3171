//! What a contact comes to within a step, on the dense output: peak force, depth, work of the normal force.
//!
//! Force, depth and power are read at five even points of the span. The work is Boole's rule over them (of sixth order;
//! the dense output is of fourth). A largest value in the inside is located by golden section, so that it does not depend on
//! where steps and samples fall.

use super::{Impact, IntegrationError, PROBES, SlicedPlant};

const POINTS: usize = PROBES + 1;
/// Boole's weights over the span.
const BOOLE: [f64; POINTS] = [7.0 / 90.0, 32.0 / 90.0, 12.0 / 90.0, 32.0 / 90.0, 7.0 / 90.0];
/// Golden sections of a search: they leave 1e-6 of the bracket, and of a flat top the square of that.
const SECTIONS: usize = 28;

/// States at the points of a span in contact.
pub(super) struct Span<const N: usize> {
    times_s: [f64; POINTS],
    states: [[f64; N]; POINTS],
}

impl<const N: usize> Span<N> {
    pub(super) fn new(
        from: f64,
        to: f64,
        at: &mut impl FnMut(f64) -> Result<[f64; N], IntegrationError>,
    ) -> Result<Self, IntegrationError> {
        let times_s =
            std::array::from_fn(
                |i| if i == PROBES { to } else { from + (to - from) * i as f64 / PROBES as f64 },
            );
        let mut states = [[0.0; N]; POINTS];
        for (state, t) in states.iter_mut().zip(times_s) {
            *state = at(t)?;
        }
        Ok(Self { times_s, states })
    }

    /// Adds the span to the impact of a contact.
    pub(super) fn measure<P: SlicedPlant<N>>(
        &self,
        plant: &P,
        slice: usize,
        latched_m_s: f64,
        at: &mut impl FnMut(f64) -> Result<[f64; N], IntegrationError>,
        impact: &mut Impact,
    ) {
        let mut forces = [0.0; POINTS];
        let mut depths = [0.0; POINTS];
        let mut power = 0.0;
        for (i, (&t, state)) in self.times_s.iter().zip(&self.states).enumerate() {
            let reading = plant.slice_contact(slice, t, state, latched_m_s);
            power += BOOLE[i] * reading.force_n * reading.rate_m_s;
            (forces[i], depths[i]) = (reading.force_n, reading.depth_m);
        }
        let [from, .., to] = self.times_s;
        impact.energy_lost_j += power * (to - from);
        let mut force =
            |t: f64| at(t).map_or(f64::NAN, |s| plant.slice_contact(slice, t, &s, latched_m_s).force_n);
        if let Some((time_s, value)) = highest(&self.times_s, &forces, impact.peak_force_n, &mut force) {
            (impact.peak_force_n, impact.peak_s) = (value, time_s);
        }
        let mut depth = |t: f64| at(t).map_or(f64::NAN, |s| plant.slice_deformation(slice, t, &s).0);
        if let Some((_, value)) = highest(&self.times_s, &depths, impact.max_deformation_m, &mut depth) {
            impact.max_deformation_m = value;
        }
    }
}

/// Time and size of the highest value in a span, if it exceeds `known`.
fn highest(
    times_s: &[f64; POINTS],
    values: &[f64; POINTS],
    known: f64,
    read: &mut impl FnMut(f64) -> f64,
) -> Option<(f64, f64)> {
    let top = (0..POINTS).fold(0, |best, i| if values[i] > values[best] { i } else { best });
    let best = (times_s[top], values[top]);
    // Between points five to a step, a smooth curve rises by far less than a tenth above the highest of them.
    if values[top] * 1.1 < known {
        return None;
    }
    // One-sided slope at an end that is the highest point: does the curve still rise beyond or does it top inside?
    let [a, b, c] = match top {
        0 => [values[0], values[1], values[2]],
        PROBES => [values[PROBES], values[PROBES - 1], values[PROBES - 2]],
        _ => [0.0, 1.0, 0.0],
    };
    let located = if -3.0 * a + 4.0 * b - c > 0.0 {
        let low = times_s[top.saturating_sub(1)];
        let high = times_s[(top + 1).min(PROBES)];
        golden(low, high, read)
    } else {
        best
    };
    let best = if located.1 > best.1 { located } else { best };
    (best.1 > known).then_some(best)
}

/// Largest value of a curve with one top in a bracket.
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
    fn a_top_between_points_is_located_and_one_at_an_end_is_left_to_the_next_span() {
        let times = [0.0, 0.25, 0.5, 0.75, 1.0];
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
