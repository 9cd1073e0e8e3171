//! Angle of either kind of encoder in nrad, modulo 2^32, continuous across zero.
//!
//! A step has 16 fraction bits of a nanoradian. After a thousand revolutions in one direction the
//! angle is off by 8 urad at most.

use embedded_hal::spi::SpiDevice;

use super::absolute::STEPS;
use super::{As5047p, Incremental, QuadratureCounter, SensorFault};

const BITS: u32 = 16;
/// A revolution, nrad times 2^16: `2 pi 1e9 2^16`.
const REVOLUTION: u64 = 411_774_832_291_321;

/// Encoder of either kind.
pub trait AngleSensor {
    /// Returns the angle in nrad, modulo 2^32, relative to the sensor's zero.
    ///
    /// # Errors
    ///
    /// There is no angle.
    fn angle_nrad(&mut self) -> Result<i32, SensorFault>;
}

/// Absolute encoder, counted across its zero.
#[derive(Debug)]
pub struct Absolute<SPI> {
    encoder: As5047p<SPI>,
    last: Option<u16>,
    position: i32,
}

impl<SPI: SpiDevice> Absolute<SPI> {
    /// Takes an encoder. Its first angle lies within one revolution, 0 to 2 pi.
    pub const fn new(encoder: As5047p<SPI>) -> Self {
        Self { encoder, last: None, position: 0 }
    }

    /// Returns the bus.
    pub fn release(self) -> SPI {
        self.encoder.release()
    }
}

impl<SPI: SpiDevice> AngleSensor for Absolute<SPI> {
    fn angle_nrad(&mut self) -> Result<i32, SensorFault> {
        let step = self.encoder.read()?;
        let last = self.last.replace(step);
        // Shorter direction from the last step; 14 bits.
        let turn = |last: u16| i32::from((step.wrapping_sub(last) << 2).cast_signed() >> 2);
        self.position = last.map_or(i32::from(step), |last| self.position.wrapping_add(turn(last)));
        Ok(nrad(self.position, STEPS))
    }
}

impl<COUNTER: QuadratureCounter> AngleSensor for Incremental<COUNTER> {
    fn angle_nrad(&mut self) -> Result<i32, SensorFault> {
        let position = self.read()?;
        Ok(nrad(position, self.counts_per_revolution()))
    }
}

/// Converts steps to an angle. Overflow is intended: the angle is modulo 2^32.
fn nrad(position: i32, per_revolution: u32) -> i32 {
    let half = u64::from(per_revolution / 2);
    let step = REVOLUTION.wrapping_add(half).checked_div(u64::from(per_revolution)).unwrap_or_default();
    (i64::from(position).wrapping_mul(step.cast_signed()) >> BITS) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_angles_and_wrap_as_they_do() {
        let exact = |position: i32, per_revolution: u32| {
            f64::from(position) * core::f64::consts::TAU * 1e9 / f64::from(per_revolution)
        };
        for per_revolution in [STEPS, 20_000, 1 << 20] {
            for position in [0, 1, -1, 5000, -5000] {
                let off = f64::from(nrad(position, per_revolution)) - exact(position, per_revolution);
                assert!(off.abs() <= 1.0, "{position} of {per_revolution}");
            }
            for position in [per_revolution as i32 * 3, 1_000_000_000, i32::MIN] {
                // Relative to the exact angle modulo 2^32.
                let modulo = exact(position, per_revolution).rem_euclid(4_294_967_296.0);
                let off = (f64::from(nrad(position, per_revolution).cast_unsigned()) - modulo).abs();
                let allowed = 1.0 + f64::from(position.unsigned_abs()) * 8e-6;
                assert!(off.min(4_294_967_296.0 - off) < allowed, "{position} of {per_revolution}: {off}");
            }
        }
    }
}
