//! Incremental encoder: a quadrature counter of the microcontroller, with the encoder's index as its check.
//!
//! `embedded-hal` 1.0 has no trait for quadrature counters; [`QuadratureCounter`] is the least that is needed. Counters of any width up to 32
//! bits are unwrapped: between two readings the shaft must not turn further than half of the counter's range (16 bits of 1 M counts
//! a revolution at 10 kHz: 330 revolutions a second).
//!
//! Between two passes of the index in the same direction lie whole revolutions, in opposite ones none (give or take the index' width).
//! More of a remainder than the tolerance means that counts were lost or added; it is reported once for each such pass, and the angle
//! goes on from the counts as they are: which of the two is right cannot be known.

use super::SensorFault;

/// A quadrature counter with the capture of the encoder's index.
pub trait QuadratureCounter {
    /// Width of the counter in bits, 8 to 32.
    const BITS: u32;
    /// The count, counting up forward, modulo 2 to the power of [`Self::BITS`].
    fn count(&mut self) -> u32;
    /// The count captured at an index pulse since the last call, if there was one.
    fn index(&mut self) -> Option<u32>;
}

/// The encoder.
#[derive(Debug)]
pub struct Incremental<COUNTER> {
    counter: COUNTER,
    counts_per_revolution: u32,
    tolerance: u32,
    last: Option<u32>,
    position: i32,
    /// Position of the last index.
    index: Option<i32>,
}

impl<COUNTER: QuadratureCounter> Incremental<COUNTER> {
    /// Takes a counter of an encoder with so many counts (four a line) a revolution. None if that is 0 or the tolerance is half of it
    /// or more.
    pub fn new(counter: COUNTER, counts_per_revolution: u32, tolerance: u32) -> Option<Self> {
        (counts_per_revolution > 0 && tolerance < counts_per_revolution / 2).then_some(Self {
            counter,
            counts_per_revolution,
            tolerance,
            last: None,
            position: 0,
            index: None,
        })
    }

    /// Counts of a revolution.
    pub const fn counts_per_revolution(&self) -> u32 {
        self.counts_per_revolution
    }

    /// The position in counts since the first reading, modulo 2^32.
    ///
    /// # Errors
    ///
    /// The index came at a place where it cannot be.
    pub fn read(&mut self) -> Result<i32, SensorFault> {
        let count = self.counter.count();
        let last = self.last.replace(count).unwrap_or(count);
        self.position = self.position.wrapping_add(difference::<COUNTER>(count, last));
        let Some(captured) = self.counter.index() else {
            return Ok(self.position);
        };
        let index = self.position.wrapping_sub(difference::<COUNTER>(count, captured));
        let Some(before) = self.index.replace(index) else {
            return Ok(self.position);
        };
        // Above 0 by construction.
        let remainder = index.wrapping_sub(before).unsigned_abs() % self.counts_per_revolution.max(1);
        let off = remainder.min(self.counts_per_revolution.wrapping_sub(remainder));
        if off > self.tolerance { Err(SensorFault::CountsLost) } else { Ok(self.position) }
    }
}

/// From one count of the counter to another, the short way round.
fn difference<COUNTER: QuadratureCounter>(to: u32, from: u32) -> i32 {
    let unused = 32_u32.saturating_sub(COUNTER::BITS).min(31);
    (to.wrapping_sub(from) << unused).cast_signed() >> unused
}
