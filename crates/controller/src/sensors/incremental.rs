//! Incremental encoder: a quadrature counter of the microcontroller, checked by the encoder's
//! index.
//!
//! `embedded-hal` 1.0 has no trait for quadrature counters, so [`QuadratureCounter`] defines the
//! minimum. Counters of up to 32 bits are unwrapped. Between two readings the shaft must not turn
//! further than half of the counter's range (16 bits, 1 M counts a revolution, 10 kHz: 330
//! revolutions a second).
//!
//! Two passes of the index in the same direction are complete revolutions apart, two in opposite
//! directions none (within the width of the index). A larger remainder means that counts were lost
//! or added. It is reported once for each such pass. The angle continues from the counts, because
//! it is unknown which of the two is right.

use super::SensorFault;

/// Quadrature counter with a capture of the encoder's index.
pub trait QuadratureCounter {
    /// Width of the counter in bits, 8 to 32.
    const BITS: u32;
    /// Returns the count, modulo 2 to the power of [`Self::BITS`]. It increases with forward
    /// rotation.
    fn count(&mut self) -> u32;
    /// Returns the count captured at an index pulse since the last call, if any.
    fn index(&mut self) -> Option<u32>;
}

/// Incremental encoder.
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
    /// Takes a counter and the counts of a revolution (four per line). Returns `None` if they are 0
    /// or the tolerance is half of them or more.
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

    /// Returns the counts of a revolution.
    pub(crate) const fn counts_per_revolution(&self) -> u32 {
        self.counts_per_revolution
    }

    /// Returns the position in counts since the first reading, modulo 2^32.
    ///
    /// # Errors
    ///
    /// The index was captured at an impossible place.
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
        // Not zero by construction.
        let remainder = index.wrapping_sub(before).unsigned_abs() % self.counts_per_revolution.max(1);
        let off = remainder.min(self.counts_per_revolution.wrapping_sub(remainder));
        if off > self.tolerance { Err(SensorFault::CountsLost) } else { Ok(self.position) }
    }
}

/// Returns the signed difference of two counts, in the shorter direction.
fn difference<COUNTER: QuadratureCounter>(to: u32, from: u32) -> i32 {
    let unused = 32_u32.saturating_sub(COUNTER::BITS).min(31);
    (to.wrapping_sub(from) << unused).cast_signed() >> unused
}
