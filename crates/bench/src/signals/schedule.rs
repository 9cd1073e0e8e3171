//! Schedules: points of time and value that repeat, as steps or as ramps.
//!
//! A step is a cycloid over the transition after its time: `S(q) = q - sin(2 pi q)/(2 pi)`. Ramps
//! are straight lines whose corners are rounded over the transition after them: the acceleration
//! there is a raised cosine, and the course lags the lines by half the transition. Both have two
//! continuous derivatives and begin at standstill at the first point. After the period the course
//! returns to the first value and repeats.

use super::Motion;
use core::f64::consts::TAU;

/// Course between two points of a schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// Constant, with a step at each point.
    Steps,
    /// Straight, with a corner at each point.
    Ramps,
}

/// A repeated schedule.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    course: Course,
    period_s: f64,
    transition_s: f64,
    first: f64,
    /// Times of the steps or corners within a period, from 0, with the change of value or slope
    /// there. That at 0 acts from the second period on.
    changes: Vec<(f64, f64)>,
    /// Slope at the end of a period.
    last_slope: f64,
}

impl Schedule {
    /// Schedule through points with ascending times from 0, before `period_s`. Gaps between points,
    /// also to the end of the period, are not shorter than the transition.
    pub fn new(course: Course, points: &[[f64; 2]], period_s: f64, transition_s: f64) -> Self {
        let first = points.first().map_or(0.0, |[_, value]| *value);
        let closed = points.iter().copied().chain([[period_s, first]]).collect::<Vec<_>>();
        let legs = closed.windows(2).map(|pair| match pair {
            [[t0, v0], [t1, v1]] => (v1 - v0) / (t1 - t0),
            _ => 0.0,
        });
        let (levels, last_slope) = match course {
            Course::Steps => (points.iter().map(|[_, value]| *value).collect::<Vec<_>>(), 0.0),
            Course::Ramps => {
                let slopes: Vec<f64> = legs.collect();
                let last = slopes.last().copied().unwrap_or_default();
                (slopes, last)
            }
        };
        let mut before = levels.last().copied().unwrap_or_default();
        let changes = points
            .iter()
            .zip(&levels)
            .map(|([time_s, _], level)| (*time_s, level - core::mem::replace(&mut before, *level)))
            .collect();
        Self { course, period_s, transition_s, first, changes, last_slope }
    }

    /// Motion at a time; at standstill on the first value before 0.
    pub fn at(&self, time_s: f64) -> Motion {
        if time_s < 0.0 {
            return Motion { value: self.first, ..Motion::default() };
        }
        let passed = (time_s / self.period_s).floor();
        let within_s = time_s - passed * self.period_s;
        let mut motion = Motion { value: self.first, ..Motion::default() };
        let is_first = passed < 1.0;
        if !is_first {
            motion.value -= 0.5 * self.transition_s * self.last_slope;
            motion.value += self.last_slope * within_s;
            motion.rate = self.last_slope;
        }
        for &(change_s, change) in self.changes.iter().take_while(|(change_s, _)| *change_s <= within_s) {
            let change = if !is_first || change_s > 0.0 {
                change
            } else if self.course == Course::Ramps {
                // The first slope, from standstill.
                change + self.last_slope
            } else {
                continue;
            };
            let [value, rate, acceleration] = self.response(within_s - change_s);
            motion.value += change * value;
            motion.rate += change * rate;
            motion.acceleration += change * acceleration;
        }
        if !is_first && self.course == Course::Steps {
            // The step at 0 begins at the last value of the period before.
            motion.value -= self.changes.first().map_or(0.0, |(_, change)| *change);
        }
        motion
    }

    /// Response to a change of size 1 some time ago, with its derivatives.
    fn response(&self, since_s: f64) -> [f64; 3] {
        let width = self.transition_s;
        let q = since_s / width;
        let (sin, cos) = (TAU * q).sin_cos();
        match self.course {
            Course::Steps if q >= 1.0 => [1.0, 0.0, 0.0],
            Course::Steps => [q - sin / TAU, (1.0 - cos) / width, TAU * sin / (width * width)],
            Course::Ramps if q >= 1.0 => [since_s - 0.5 * width, 1.0, 0.0],
            Course::Ramps => {
                [width * (0.5 * q * q + (cos - 1.0) / (TAU * TAU)), q - sin / TAU, (1.0 - cos) / width]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [[f64; 2]; 4] = [[0.0, 1.0], [1.0, 3.0], [2.5, -2.0], [3.2, 0.5]];

    #[test]
    fn steps_and_ramps_are_where_their_points_say() {
        let steps = Schedule::new(Course::Steps, &POINTS, 4.0, 0.25);
        let ramps = Schedule::new(Course::Ramps, &POINTS, 4.0, 0.25);
        for cycle in 0..3 {
            let start = 4.0 * f64::from(cycle);
            for (t, expected) in
                [(0.9, 1.0), (1.0, 1.0), (1.125, 2.0), (1.3, 3.0), (2.5, 3.0), (3.0, -2.0), (3.9, 0.5)]
            {
                let found = steps.at(start + t).value;
                assert!((found - expected).abs() < 1e-12, "{cycle} {t}: {found}");
            }
            // Half the transition late.
            for (t, expected) in [(0.5, 2.0), (0.85, 2.7), (1.75, 0.5), (3.6, 0.75)] {
                let motion = ramps.at(start + t + 0.125);
                assert!((motion.value - expected).abs() < 1e-12, "{cycle} {t}: {motion:?}");
                assert!(motion.acceleration.abs() < 1e-12, "{motion:?}");
            }
        }
        assert_eq!(steps.at(0.0), Motion { value: 1.0, ..Motion::default() });
        assert_eq!(ramps.at(0.0), Motion { value: 1.0, ..Motion::default() });
    }

    #[test]
    fn every_course_has_two_continuous_derivatives_that_belong_to_it() {
        for course in [Course::Steps, Course::Ramps] {
            let schedule = Schedule::new(course, &POINTS, 4.0, 0.25);
            let h = 1e-5;
            let mut before = schedule.at(h);
            for i in 1..9_000 {
                let t = h + f64::from(i) * 1e-3;
                let (a, here, b) = (schedule.at(t - h), schedule.at(t), schedule.at(t + h));
                let (rate, acceleration) = ((b.value - a.value) / (2.0 * h), (b.rate - a.rate) / (2.0 * h));
                assert!((rate - here.rate).abs() < 1e-5, "{course:?} {t}: {rate} {here:?}");
                assert!(
                    (acceleration - here.acceleration).abs() < 0.2,
                    "{course:?} {t}: {acceleration} {here:?}"
                );
                // The largest jerk, of the step by 5, is 12,633.
                assert!((here.acceleration - before.acceleration).abs() < 13.0, "{course:?} {t}");
                before = here;
            }
        }
    }

    #[test]
    fn a_point_alone_is_a_constant() {
        for course in [Course::Steps, Course::Ramps] {
            let constant = Schedule::new(course, &[[0.0, 2.0]], 1.0, 0.1);
            for t in [0.0, 0.5, 1.0, 7.3] {
                assert_eq!(constant.at(t), Motion { value: 2.0, ..Motion::default() }, "{course:?}");
            }
        }
    }
}
