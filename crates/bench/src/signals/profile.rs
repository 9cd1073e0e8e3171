//! Motion and load as functions of time: analytic profiles, or curves through a log's samples.

use crate::signals::{Motion, Schedule, white_noise};
use nalgebra::{DMatrix, DVector};

/// Signal over time that drives a plant.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// `(stroke/2)(1 - cos wt)` for a number of cycles, then standstill.
    Cycles {
        /// Stroke.
        stroke: f64,
        /// Period in s.
        period_s: f64,
        /// Cycles.
        cycles: f64,
    },
    /// Motion as in `Cycles`, with a standstill before each half cycle.
    Resting {
        /// Stroke.
        stroke: f64,
        /// Period in s, without the standstills.
        period_s: f64,
        /// Cycles.
        cycles: f64,
        /// Length of a standstill in s.
        dwell_s: f64,
    },
    /// Motion as in `Cycles`, with a frequency that changes linearly from that of the first period
    /// to that of the last.
    Sweep {
        /// Stroke.
        stroke: f64,
        /// Period at the start in s.
        period_s: f64,
        /// Period at the end in s.
        last_period_s: f64,
        /// Cycles.
        cycles: f64,
    },
    /// Constant after a raised-cosine ramp from 0.
    Ramp {
        /// Final value.
        level: f64,
        /// Ramp length in s.
        ramp_s: f64,
    },
    /// Curve through smoothed nodes.
    Curve {
        /// Node times in s, ascending.
        time_s: Vec<f64>,
        /// Smoothed motion at each node.
        nodes: Vec<Motion>,
    },
    /// `(height/2) sin(2 pi t/period)`.
    Sine {
        /// Peak-to-peak height.
        height: f64,
        /// Period in s.
        period_s: f64,
    },
    /// Steps or ramps through points.
    Schedule(Schedule),
    /// Curve that repeats.
    Repeated {
        /// The curve within one period.
        curve: Box<Self>,
        /// Period in s.
        period_s: f64,
    },
    /// Mean and course together, from 0 by a raised-cosine ramp.
    Raised {
        /// Mean.
        mean: f64,
        /// Course about the mean.
        course: Box<Self>,
        /// Ramp length in s; 0: none.
        ramp_s: f64,
    },
    /// Uniformly accelerated motion.
    Accelerated {
        /// Time of `motion` in s.
        at_s: f64,
        /// Motion at that time.
        motion: Motion,
    },
}

impl Profile {
    /// Motion at a time.
    pub fn at(&self, time_s: f64) -> Motion {
        match self {
            Self::Cycles { stroke, period_s, cycles } => {
                if time_s >= period_s * cycles {
                    return Motion::default();
                }
                let w = 2.0 * core::f64::consts::PI / period_s;
                let (sin, cos) = (w * time_s).sin_cos();
                let half = 0.5 * stroke;
                Motion { value: half * (1.0 - cos), rate: half * w * sin, acceleration: half * w * w * cos }
            }
            Self::Resting { stroke, period_s, cycles, dwell_s } => {
                let half = 0.5 * period_s + dwell_s;
                let index = (time_s / half).floor().clamp(0.0, 2.0 * cycles);
                let moving = (time_s - index * half - dwell_s).max(0.0);
                let swing = Self::Cycles { stroke: *stroke, period_s: *period_s, cycles: *cycles };
                let motion = swing.at(0.5 * period_s * index + moving);
                // At standstill only the position counts, also where the cycle would accelerate.
                if moving > 0.0 { motion } else { Motion { value: motion.value, ..Motion::default() } }
            }
            Self::Sweep { stroke, period_s, last_period_s, cycles } => {
                let length_s = sweep_s(*period_s, *last_period_s, *cycles);
                if time_s >= length_s {
                    return Motion::default();
                }
                let chirp = (1.0 / last_period_s - 1.0 / period_s) / length_s;
                let turn = 2.0 * core::f64::consts::PI;
                let (sin, cos) = (turn * time_s * (1.0 / period_s + 0.5 * chirp * time_s)).sin_cos();
                let (w, half) = (turn * (1.0 / period_s + chirp * time_s), 0.5 * stroke);
                Motion {
                    value: half * (1.0 - cos),
                    rate: half * w * sin,
                    acceleration: half * (w * w * cos + turn * chirp * sin),
                }
            }
            Self::Ramp { level, ramp_s } => {
                if time_s >= *ramp_s {
                    return Motion { value: *level, ..Motion::default() };
                }
                let w = core::f64::consts::PI / ramp_s;
                let (sin, cos) = (w * time_s).sin_cos();
                let half = 0.5 * level;
                Motion { value: half * (1.0 - cos), rate: half * w * sin, acceleration: half * w * w * cos }
            }
            Self::Sine { height, period_s } => {
                let w = 2.0 * core::f64::consts::PI / period_s;
                let (sin, cos) = (w * time_s).sin_cos();
                let half = 0.5 * height;
                Motion { value: half * sin, rate: half * w * cos, acceleration: -half * w * w * sin }
            }
            Self::Schedule(schedule) => schedule.at(time_s),
            Self::Accelerated { at_s, motion } => motion.after(time_s - at_s),
            Self::Repeated { curve, period_s } => curve.at(time_s.rem_euclid(*period_s)),
            Self::Raised { mean, course, ramp_s } => {
                let motion = course.at(time_s);
                let sum = Motion { value: mean + motion.value, ..motion };
                if time_s >= *ramp_s {
                    return sum;
                }
                let share = Self::Ramp { level: 1.0, ramp_s: *ramp_s }.at(time_s);
                Motion {
                    value: share.value * sum.value,
                    rate: share.rate * sum.value + share.value * sum.rate,
                    acceleration: share.acceleration * sum.value
                        + 2.0 * share.rate * sum.rate
                        + share.value * sum.acceleration,
                }
            }
            Self::Curve { time_s: times, nodes } => {
                let after = node_after(times, time_s);
                let (Some(&t0), Some(&t1)) = (times.get(after - 1), times.get(after)) else {
                    return nodes.first().copied().unwrap_or_default();
                };
                match (nodes.get(after - 1), nodes.get(after)) {
                    (Some(a), Some(b)) => a.towards(b, t1 - t0, ((time_s - t0) / (t1 - t0)).clamp(0.0, 1.0)),
                    _ => Motion::default(),
                }
            }
        }
    }

    /// Returns a curve through samples. At every sample a polynomial of `order` is fitted to the
    /// values, and to the rates where given, within `half_window_s` with at least `order + 2`
    /// samples. Its value and derivatives become a node.
    ///
    /// Values and rates are weighted by their own white noise.
    pub fn through(
        time_s: &[f64],
        values: &[f64],
        rates: Option<&[f64]>,
        half_window_s: f64,
        order: usize,
    ) -> Self {
        let count = time_s.len().min(values.len());
        let mut nodes = Vec::with_capacity(count);
        // Rows of rates are in units of the value: `rate * half_window`.
        let scale = half_window_s.max(f64::MIN_POSITIVE);
        let rate_weight = rates.map_or(0.0, |r| {
            white_noise::estimate(time_s, values) / (white_noise::estimate(time_s, r) * scale)
        });
        for (i, &centre) in time_s.iter().enumerate().take(count) {
            let min_half_count = (order + 2).div_ceil(2);
            let low =
                time_s.partition_point(|&t| t < centre - half_window_s).min(i.saturating_sub(min_half_count));
            let high = time_s
                .partition_point(|&t| t <= centre + half_window_s)
                .max(i + min_half_count + 1)
                .min(count);
            let low = low.min(high.saturating_sub(order + 2));
            let rows = (high - low) * if rates.is_some() { 2 } else { 1 };
            let mut matrix = DMatrix::zeros(rows, order + 1);
            let mut right = DVector::zeros(rows);
            let base = values[i];
            for (row, k) in (low..high).enumerate() {
                let u = (time_s[k] - centre) / scale;
                let mut power = 1.0;
                for column in 0..=order {
                    matrix[(row, column)] = power;
                    power *= u;
                }
                right[row] = values[k] - base;
                if let Some(rates) = rates {
                    let row = row + high - low;
                    let mut power = 1.0;
                    for column in 1..=order {
                        matrix[(row, column)] = rate_weight * column as f64 * power;
                        power *= u;
                    }
                    right[row] = rate_weight * rates[k] * scale;
                }
            }
            let normal = matrix.transpose() * &matrix;
            let solution = normal.cholesky().map(|c| c.solve(&(matrix.transpose() * right)));
            let get = |k: usize| solution.as_ref().and_then(|s| s.get(k).copied()).unwrap_or_default();
            nodes.push(Motion {
                value: base + get(0),
                rate: get(1) / scale,
                acceleration: 2.0 * get(2) / (scale * scale),
            });
        }
        Self::Curve { time_s: time_s[..count].to_vec(), nodes }
    }
}

/// Length in s of a number of cycles while the frequency changes linearly from one period to
/// another.
pub(crate) fn sweep_s(period_s: f64, last_period_s: f64, cycles: f64) -> f64 {
    2.0 * cycles / (1.0 / period_s + 1.0 / last_period_s)
}

/// Index of the first node after a time, from 1 to the last. Nodes are nearly always evenly spaced.
/// Trying the evenly spaced index first saves the search, which took a third of a simulation.
fn node_after(times: &[f64], time_s: f64) -> usize {
    let last = times.len().max(2) - 1;
    if let (Some(&first), Some(&end)) = (times.first(), times.last()) {
        let guess = ((time_s - first) / (end - first) * last as f64) as usize;
        for before in [guess, guess.saturating_sub(1), guess + 1] {
            if let (Some(&a), Some(&b)) = (times.get(before), times.get(before + 1))
                && a <= time_s
                && time_s < b
            {
                return before + 1;
            }
        }
    }
    times.partition_point(|&t| t <= time_s).clamp(1, last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_node_after_a_time_is_the_searched_one() {
        let times: Vec<f64> = (0..200).filter(|i| i % 7 != 3).map(|i| 0.3 + f64::from(i) * 1e-3).collect();
        for i in 0..3000 {
            let t = 0.25 + f64::from(i) * 1e-4;
            let searched = times.partition_point(|&node| node <= t).clamp(1, times.len() - 1);
            assert_eq!(node_after(&times, t), searched, "{t}");
        }
    }

    #[test]
    fn a_resting_profile_is_the_cycle_with_pauses() {
        let swing = Profile::Cycles { stroke: 2.0, period_s: 4.0, cycles: 2.0 };
        let rests = Profile::Resting { stroke: 2.0, period_s: 4.0, cycles: 2.0, dwell_s: 1.0 };
        for (t, moving) in [(1.5, 0.5), (3.0, 2.0), (4.5, 2.5), (5.9, 3.9), (8.0, 5.0)] {
            let (a, b) = (rests.at(t), swing.at(moving));
            assert!((a.value - b.value).abs() < 1e-12 && (a.rate - b.rate).abs() < 1e-12, "{t}: {a:?} {b:?}");
        }
        for (t, value) in [(0.5, 0.0), (3.5, 2.0), (6.5, 0.0), (9.5, 2.0), (30.0, 0.0)] {
            assert_eq!(rests.at(t), Motion { value, ..Motion::default() }, "{t}");
        }
    }

    #[test]
    fn a_sweep_ends_at_its_start_with_its_last_period() {
        let sweep = Profile::Sweep { stroke: 2.0, period_s: 4.0, last_period_s: 1.0, cycles: 5.0 };
        let end = sweep_s(4.0, 1.0, 5.0);
        assert!((end - 8.0).abs() < 1e-12 && sweep.at(end) == Motion::default());
        assert!(sweep.at(end - 1e-7).value < 1e-9);
        // One second before the end the value is nearly that of one cycle earlier; the frequency
        // still rises.
        assert!(sweep.at(7.0).value < 0.1 && sweep.at(7.5).value > 1.9);
        for i in 1..799 {
            let (t, h) = (0.01 * f64::from(i), 1e-5);
            let (a, b, c) = (sweep.at(t - h), sweep.at(t), sweep.at(t + h));
            assert!(((c.value - a.value) / (2.0 * h) - b.rate).abs() < 1e-6, "{t}");
            assert!(((c.rate - a.rate) / (2.0 * h) - b.acceleration).abs() < 1e-4, "{t}");
        }
    }

    #[test]
    fn a_raised_course_begins_at_zero_with_matching_derivatives() {
        let course = Box::new(Profile::Sine { height: 2.0, period_s: 0.7 });
        let raised = Profile::Raised { mean: 3.0, course: course.clone(), ramp_s: 0.5 };
        assert_eq!(raised.at(0.0).value, 0.0);
        assert_eq!(raised.at(0.6).value, 3.0 + course.at(0.6).value);
        for i in 1..500 {
            let (t, h) = (1e-3 * f64::from(i), 1e-5);
            let (a, b, c) = (raised.at(t - h), raised.at(t), raised.at(t + h));
            assert!(((c.value - a.value) / (2.0 * h) - b.rate).abs() < 1e-5, "{t}");
            // At the end of the ramp the acceleration jumps.
            assert!(i == 499 || ((c.rate - a.rate) / (2.0 * h) - b.acceleration).abs() < 1e-3, "{t}");
        }
    }

    #[test]
    fn a_curve_through_samples_of_a_cycle_follows_its_acceleration() {
        let truth = Profile::Cycles { stroke: 0.172, period_s: 1.0, cycles: 1.0 };
        let time: Vec<f64> = (0..1000).map(|i| i as f64 * 1e-3).collect();
        // Rounded as a log would round them.
        let round = |v: f64| (v * 1e7).round() / 1e7;
        let values: Vec<f64> = time.iter().map(|&t| round(truth.at(t).value)).collect();
        let rates: Vec<f64> = time.iter().map(|&t| round(truth.at(t).rate)).collect();
        let curve = Profile::through(&time, &values, Some(&rates), 0.010, 4);
        for i in 0..9900 {
            let t = i as f64 * 1.00007e-4;
            let (a, b) = (curve.at(t), truth.at(t));
            // The window at the end of a log is one-sided, so rounding has more influence there.
            let bound = if (0.010..0.989).contains(&t) { 2e-3 } else { 2e-2 };
            assert!((a.value - b.value).abs() < 1e-7, "x at {t}");
            assert!(
                (a.acceleration - b.acceleration).abs() < bound,
                "a at {t}: {} {}",
                a.acceleration,
                b.acceleration
            );
        }
    }
}
