//! Angle of either kind of encoder in nrad, modulo 2^32, continuous across zero.
//!
//! A step has 16 fraction bits of a nanoradian. After a thousand revolutions in one direction the
//! angle is off by 8 urad at most.

use super::absolute::{STEPS, angle_steps};
use super::sequence::EncoderAnswers;
use super::{Incremental, QuadratureCounter, SensorFault};

const BITS: u32 = 16;
/// A revolution, nrad times 2^16: `2 pi 1e9 2^16`.
const REVOLUTION: u64 = 411_774_832_291_321;

/// Encoder of either kind.
pub trait AngleSensor {
    /// True if the encoder has frames in the sequence of the bus.
    const IS_ON_BUS: bool;
    /// Returns the angle in nrad, modulo 2^32, relative to the sensor's zero. `answers` are those
    /// of the bus; `None` if the sequence was not completed.
    ///
    /// # Errors
    ///
    /// There is no angle.
    fn angle_nrad(&mut self, answers: Option<&EncoderAnswers>) -> Result<i32, SensorFault>;
}

/// Absolute encoder AS5047P, counted across its zero. Its first angle lies within one revolution, 0
/// to 2 pi.
#[derive(Clone, Debug, Default)]
pub struct Absolute {
    last: Option<u16>,
    position: i32,
}

impl AngleSensor for Absolute {
    const IS_ON_BUS: bool = true;

    fn angle_nrad(&mut self, answers: Option<&EncoderAnswers>) -> Result<i32, SensorFault> {
        let step = angle_steps(answers.ok_or(SensorFault::Bus)?)?;
        let last = self.last.replace(step);
        // Shorter direction from the last step; 14 bits.
        let turn = |last: u16| i32::from((step.wrapping_sub(last) << 2).cast_signed() >> 2);
        self.position = last.map_or(i32::from(step), |last| self.position.wrapping_add(turn(last)));
        Ok(nrad(self.position, STEPS))
    }
}

impl<COUNTER: QuadratureCounter> AngleSensor for Incremental<COUNTER> {
    const IS_ON_BUS: bool = false;

    fn angle_nrad(&mut self, _answers: Option<&EncoderAnswers>) -> Result<i32, SensorFault> {
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
