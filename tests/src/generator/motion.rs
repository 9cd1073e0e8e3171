//! Motion and load of an axis in a record.
//!
//! The usual motion is a swing, `A sin(w t + sin(w t/2 + pi/4))`. Its speed rises and falls over
//! two cycles, so that direction and speed are independent. The plain motion is one sine, on which
//! several effects look alike. Strokes go from end to end along `35 u^4 - 84 u^5 + 70 u^6 - 20
//! u^7`, alternately slow and fast, with standstill between them. A described course follows a
//! bench description: sines from one end of the stroke to the other, forwards or backwards first,
//! with standstill before each or with a linearly changing frequency.

use std::f64::consts::{FRAC_PI_4, TAU};

/// Position (or angle), speed and acceleration.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moved {
    /// Position, m or rad.
    pub place: f64,
    /// Speed, m/s or rad/s.
    pub speed: f64,
    /// Acceleration, m/s2 or rad/s2.
    pub acceleration: f64,
}

/// The motion of a record.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Half of the stroke, m or rad.
    pub amplitude: f64,
    /// Length of a cycle, s.
    pub cycle_s: f64,
    /// Course.
    pub course: Course,
}

/// Course of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Course {
    /// Swing at a changing speed.
    Swing,
    /// One sine.
    Plain,
    /// Strokes with standstill.
    Strokes,
    /// Course of a bench description.
    Described {
        /// Standstill before each half cycle, as a share of a cycle.
        standstill: f64,
        /// Rise of the frequency over one cycle's length, as a share of the first frequency.
        rise: f64,
    },
}

/// Standstill before each stroke, as a share of a cycle.
const REST: f64 = 0.08;

/// Shares of two cycles that the strokes take, with their standstill: slow forward, fast back, fast
/// forward, slow back.
const SHARES: [f64; 4] = [0.62, 0.38, 0.38, 0.62];

impl Motion {
    /// Returns the motion at a time since the first standstill began.
    pub fn at(&self, time_s: f64) -> Moved {
        if let Course::Described { standstill, rise } = self.course {
            return self.described(standstill, rise, time_s / self.cycle_s);
        }
        if self.course != Course::Strokes {
            let (rate, depth) = (TAU / self.cycle_s, f64::from(u8::from(self.course == Course::Swing)));
            let (bend, slope) = (0.5 * rate * time_s + FRAC_PI_4).sin_cos();
            let (sine, cosine) = (rate * time_s + depth * bend).sin_cos();
            let (turn, turning) = (rate * (1.0 + 0.5 * depth * slope), -0.25 * depth * rate * rate * bend);
            return Moved {
                place: self.amplitude * sine,
                speed: self.amplitude * turn * cosine,
                acceleration: self.amplitude * (turning * cosine - turn * turn * sine),
            };
        }
        let mut within = (time_s / self.cycle_s).rem_euclid(SHARES.iter().sum());
        for (i, share) in SHARES.iter().enumerate() {
            if within < *share {
                let from = if i % 2 == 0 { -self.amplitude } else { self.amplitude };
                if within < REST {
                    return Moved { place: from, ..Moved::default() };
                }
                let (u, length) = ((within - REST) / (share - REST), (share - REST) * self.cycle_s);
                let way = -2.0 * from;
                return Moved {
                    place: from + way * u.powi(4) * (35.0 - u * (84.0 - u * (70.0 - 20.0 * u))),
                    speed: way / length * 140.0 * (u * (1.0 - u)).powi(3),
                    acceleration: way / (length * length) * 420.0 * (u * (1.0 - u)).powi(2) * (1.0 - 2.0 * u),
                };
            }
            within -= share;
        }
        Moved::default()
    }
}

impl Motion {
    /// Returns a described course at a time in cycles since its beginning.
    fn described(&self, standstill: f64, rise: f64, time: f64) -> Moved {
        let half = 0.5 + standstill;
        let index = (time / half).floor().max(0.0);
        let moving = if standstill > 0.0 {
            0.5 * index + (time - half * index - standstill).max(0.0)
        } else {
            time.max(0.0)
        };
        // Turns, turns per cycle length, and the derivative of the latter.
        let (turns, pace) = (moving * (1.0 + 0.5 * rise * moving), 1.0 + rise * moving);
        let (sine, cosine) = (TAU * turns).sin_cos();
        let at_rest = time <= 0.0 || standstill > 0.0 && time - half * index <= standstill;
        let (rate, bend) =
            if at_rest { (0.0, 0.0) } else { (TAU / self.cycle_s * pace, TAU * rise / self.cycle_s.powi(2)) };
        Moved {
            place: -self.amplitude * cosine,
            speed: self.amplitude * rate * sine,
            acceleration: self.amplitude * (rate * rate * cosine + bend * sine),
        }
    }
}

/// The load of a record.
#[derive(Clone, Copy, Debug)]
pub struct Load {
    /// Mean, N.
    pub mean_n: f64,
    /// Amplitude of the swing as a share of the mean.
    pub swing: f64,
    /// Period of the swing, s.
    pub period_s: f64,
    /// Phase of the swing at the start of the log, rad.
    pub phase_rad: f64,
    /// Length of the raised-cosine ramp at the start of the log, s; 0: no ramp.
    pub ramp_s: f64,
}

impl Load {
    /// Returns the load at a time, N.
    pub fn at(&self, time_s: f64) -> f64 {
        let full = self.mean_n * (1.0 + self.swing * (TAU * time_s / self.period_s + self.phase_rad).sin());
        if time_s >= self.ramp_s {
            full
        } else {
            full * (0.25 * TAU * time_s.max(0.0) / self.ramp_s).sin().powi(2)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_and_acceleration_are_the_slopes_of_place_and_speed() {
        let described = |standstill, rise| Course::Described { standstill, rise };
        let courses =
            [Course::Swing, Course::Plain, Course::Strokes, described(0.0, 0.0), described(0.0, 0.3)];
        for course in courses {
            let motion = Motion { amplitude: 0.4, cycle_s: 4.5, course };
            // After the start, because a described course begins with a jump in acceleration.
            for i in 1..2000 {
                let (t, h) = (f64::from(i) * 0.00913, 1e-5);
                let (a, b, c) = (motion.at(t - h), motion.at(t), motion.at(t + h));
                assert!(((c.place - a.place) / (2.0 * h) - b.speed).abs() < 1e-6, "{t}");
                assert!(((c.speed - a.speed) / (2.0 * h) - b.acceleration).abs() < 1e-3, "{t}");
            }
        }
    }

    #[test]
    fn a_described_course_rests_at_its_ends_and_a_load_comes_on() {
        let course = Course::Described { standstill: 0.25, rise: 0.0 };
        let motion = Motion { amplitude: 0.4, cycle_s: 4.0, course };
        for (t, place) in [(0.5, -0.4), (2.0, 0.0), (3.5, 0.4), (5.0, 0.0), (6.5, -0.4)] {
            assert!((motion.at(t).place - place).abs() < 1e-12, "{t}: {:?}", motion.at(t));
        }
        assert!(
            motion.at(0.5).acceleration == 0.0 && motion.at(3.5).speed == 0.0 && motion.at(5.0).speed < -0.6
        );
        let load = Load { mean_n: 8.0, swing: 0.0, period_s: 7.3, phase_rad: 0.0, ramp_s: 2.0 };
        let at = [-1.0, 0.0, 1.0, 2.0, 9.0].map(|t| load.at(t));
        assert!(at[0] == 0.0 && at[1] == 0.0 && (at[2] - 4.0).abs() < 1e-12 && at[3] == 8.0 && at[4] == 8.0);
    }
}
