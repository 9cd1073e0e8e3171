//! How an axis is moved and loaded in a session.
//!
//! The usual motion swings to and fro at a speed that itself rises and falls over two cycles,
//! `A sin(w t + sin(w t/2 + pi/4))`, so that direction and speed are not the same thing. The plain motion is one sine, on which
//! several effects look alike. Strokes go from end to end with rests between, along `35 u^4 - 84 u^5 + 70 u^6 - 20 u^7`, slow and
//! fast by turns.

use std::f64::consts::{FRAC_PI_4, TAU};

/// Position (or angle), speed, acceleration.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moved {
    /// m or rad.
    pub place: f64,
    /// Per s.
    pub speed: f64,
    /// Per s2.
    pub acceleration: f64,
}

/// The motion of a session.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Half of the stroke, m or rad.
    pub amplitude: f64,
    /// Length of a cycle in s.
    pub cycle_s: f64,
    /// Its course.
    pub course: Course,
}

/// Course of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Course {
    /// To and fro at a changing speed.
    Swing,
    /// One sine.
    Plain,
    /// Strokes with rests.
    Strokes,
}

/// Rest before each stroke, as a share of a cycle.
const REST: f64 = 0.08;

/// Shares of two cycles that the strokes take, their rests included: slow forward, fast back, fast forward, slow back.
const SHARES: [f64; 4] = [0.62, 0.38, 0.38, 0.62];

impl Motion {
    /// The motion at a time since the first rest began.
    pub fn at(&self, time_s: f64) -> Moved {
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

/// The load of a session.
#[derive(Clone, Copy, Debug)]
pub struct Load {
    /// Mean in N.
    pub mean_n: f64,
    /// Share of the mean that it swings by.
    pub swing: f64,
    /// Period of the swing in s.
    pub period_s: f64,
    /// Where in the swing the log begins.
    pub phase_rad: f64,
}

impl Load {
    /// The load at a time in N.
    pub fn at(&self, time_s: f64) -> f64 {
        self.mean_n * (1.0 + self.swing * (TAU * time_s / self.period_s + self.phase_rad).sin())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_and_acceleration_are_the_slopes_of_place_and_speed() {
        for course in [Course::Swing, Course::Plain, Course::Strokes] {
            let motion = Motion { amplitude: 0.4, cycle_s: 4.5, course };
            for i in 0..2000 {
                let (t, h) = (f64::from(i) * 0.00913, 1e-5);
                let (a, b, c) = (motion.at(t - h), motion.at(t), motion.at(t + h));
                assert!(((c.place - a.place) / (2.0 * h) - b.speed).abs() < 1e-6, "{t}");
                assert!(((c.speed - a.speed) / (2.0 * h) - b.acceleration).abs() < 1e-3, "{t}");
            }
        }
    }
}
