//! How an axis is moved and loaded in a session: strokes of least jerk with rests, a load that swings.
//!
//! A stroke goes from one end to the other along `10 u^3 - 15 u^4 + 6 u^5`; slow and fast ones change places from cycle
//! to cycle, so that direction and speed are not the same thing. The plain motion is one sine, on which several
//! effects look alike.

use std::f64::consts::TAU;

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
    /// Rest before each stroke, as a share of a cycle.
    pub rest: f64,
    /// Whether it is one sine.
    pub plain: bool,
}

/// Shares of two cycles that the strokes take, their rests included: slow forward, fast back, fast forward, slow back.
const SHARES: [f64; 4] = [0.62, 0.38, 0.38, 0.62];

impl Motion {
    /// The motion at a time since the first rest began.
    pub fn at(&self, time_s: f64) -> Moved {
        if self.plain {
            let rate = TAU / self.cycle_s;
            let (sine, cosine) = (rate * time_s).sin_cos();
            let place = self.amplitude * sine;
            return Moved {
                place,
                speed: self.amplitude * rate * cosine,
                acceleration: -rate * rate * place,
            };
        }
        let mut within = (time_s / self.cycle_s).rem_euclid(SHARES.iter().sum());
        for (i, share) in SHARES.iter().enumerate() {
            if within < *share {
                let from = if i % 2 == 0 { -self.amplitude } else { self.amplitude };
                if within < self.rest {
                    return Moved { place: from, ..Moved::default() };
                }
                let (u, length) = ((within - self.rest) / (share - self.rest), (share - self.rest) * self.cycle_s);
                let way = -2.0 * from;
                return Moved {
                    place: from + way * u * u * u * (10.0 + u * (6.0 * u - 15.0)),
                    speed: way / length * 30.0 * u * u * (1.0 - u) * (1.0 - u),
                    acceleration: way / (length * length) * 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u),
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
        for (plain, rest) in [(false, 0.08), (false, 0.0), (true, 0.0)] {
            let motion = Motion { amplitude: 0.4, cycle_s: 4.5, rest, plain };
            for i in 0..2000 {
                let (t, h) = (f64::from(i) * 0.00913, 1e-5);
                let (a, b, c) = (motion.at(t - h), motion.at(t), motion.at(t + h));
                assert!(((c.place - a.place) / (2.0 * h) - b.speed).abs() < 1e-6, "{t}");
                // Jerk jumps at the ends of a stroke.
                assert!(((c.speed - a.speed) / (2.0 * h) - b.acceleration).abs() < 1e-3, "{t}");
            }
        }
    }
}
