//! A value with its derivatives at one time.

/// Value with its first and second derivative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Value.
    pub value: f64,
    /// First derivative.
    pub rate: f64,
    /// Second derivative.
    pub acceleration: f64,
}

impl Motion {
    /// Motion after a time in s at the same second derivative.
    #[must_use]
    pub fn after(&self, time_s: f64) -> Self {
        Self {
            value: self.value + time_s * (self.rate + 0.5 * time_s * self.acceleration),
            rate: self.rate + time_s * self.acceleration,
            acceleration: self.acceleration,
        }
    }

    /// Interpolates towards the motion `h` later, at a `share` of the way. Each quantity uses its
    /// own two values, with the next derivative as the slope.
    ///
    /// One curve for all three would turn noise of a nanometre on neighbouring values into an
    /// acceleration of `60 * 1e-9/h^2`. A plant takes the three quantities as given; none has to be
    /// the exact derivative of another.
    pub(crate) fn towards(&self, later: &Self, h: f64, share: f64) -> Self {
        Self {
            value: cubic(self.value, self.rate, later.value, later.rate, h, share),
            rate: cubic(self.rate, self.acceleration, later.rate, later.acceleration, h, share),
            acceleration: self.acceleration + share * (later.acceleration - self.acceleration),
        }
    }
}

/// Cubic Hermite interpolation.
fn cubic(p0: f64, m0: f64, p1: f64, m1: f64, h: f64, s: f64) -> f64 {
    let (s2, r) = (s * s, 1.0 - s);
    p0 * (1.0 + 2.0 * s) * r * r + m0 * h * s * r * r + p1 * s2 * (3.0 - 2.0 * s) - m1 * h * s2 * r
}
