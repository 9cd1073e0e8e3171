//! Pressure transmitter on a 4 to 20 mA loop, as the force of a piston.
//!
//! ```text
//! current = (code - zero) * gain            over the loop's resistor, nA
//! F       = (current - 4 mA)/16 mA * range * area
//! ```
//!
//! Below 3.6 mA the wire is broken or the transmitter reports a failure (NAMUR NE 43); above 21 mA
//! likewise. Between 3.6 and 4 mA and between 20 and 21 mA it measures beyond its nominal range. A
//! cylinder with pressure on both sides has a transmitter on each, and the force is the difference
//! ([`super::Sampler`]).

use super::SensorFault;
use super::scale::linear;
use fixed::types::{I16F16, I44F20};

const MIN_NA: i64 = 3_600_000;
const ZERO_NA: i64 = 4_000_000;
const SPAN_NA: u64 = 16_000_000;
const MAX_NA: i64 = 21_000_000;

/// Transmitter and its piston.
#[derive(Clone, Copy, Debug)]
pub struct Transmitter {
    zero_code: u16,
    /// Current of a code, nA.
    gain_na: I16F16,
    /// Force of a nanoampere, mN.
    force_mn: I44F20,
}

impl Transmitter {
    /// Creates a transmitter from the zero code of its current and the current of a code (nA), the
    /// pressure at full scale and the area of the piston. Returns `None` if pressure times area is
    /// above 10 MN.
    #[must_use]
    pub fn new(zero_code: u16, gain_na: I16F16, range_pa: u32, area_mm2: u32) -> Option<Self> {
        // Pa mm2 are uN.
        let span_un = u64::from(range_pa).checked_mul(u64::from(area_mm2))?;
        if span_un > 10_000_000_000_000 {
            return None;
        }
        let force = (span_un << I44F20::FRAC_NBITS) / (1000 * SPAN_NA);
        Some(Self { zero_code, gain_na, force_mn: I44F20::from_bits(force.cast_signed()) })
    }

    /// Returns the force of a code, mN.
    ///
    /// # Errors
    ///
    /// No intact loop carries this current.
    pub(crate) fn force_mn(&self, code: u16) -> Result<i64, SensorFault> {
        let current_na = linear(code, self.zero_code, self.gain_na);
        if current_na < MIN_NA {
            Err(SensorFault::BrokenWire)
        } else if current_na > MAX_NA {
            Err(SensorFault::ShortCircuit)
        } else {
            // At most 2^24 times 2^30.
            let force_mn = self.force_mn.wrapping_mul_int(current_na.wrapping_sub(ZERO_NA));
            Ok(force_mn.wrapping_to_num())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0 to 5.12 V over 240 ohm: 325.5 nA a code. 250 bar on 20 cm2: 50 kN.
    fn transmitter() -> Transmitter {
        Transmitter::new(0, I16F16::lit("325.520833"), 25_000_000, 2_000).unwrap()
    }

    fn code(milliampere: f64) -> u16 {
        (milliampere * 1e6 / 325.520_833).round() as u16
    }

    #[test]
    fn four_to_twenty_milliamperes_are_zero_to_the_full_force() {
        for (current, force_n) in
            [(4.0, 0.0), (12.0, 25_000.0), (20.0, 50_000.0), (3.8, -625.0), (20.5, 51_562.5)]
        {
            let found = transmitter().force_mn(code(current)).unwrap();
            // Half a code is 0.5 N.
            assert!((found as f64 * 1e-3 - force_n).abs() < 0.6, "{current} mA: {found}");
        }
    }

    #[test]
    fn a_broken_wire_and_a_short_circuit_are_named() {
        for (current, expected) in [
            (0.0, Err(SensorFault::BrokenWire)),
            (3.59, Err(SensorFault::BrokenWire)),
            (3.61, Ok(())),
            (20.99, Ok(())),
            (21.01, Err(SensorFault::ShortCircuit)),
        ] {
            assert_eq!(transmitter().force_mn(code(current)).map(|_| ()), expected, "{current} mA");
        }
        assert_eq!(transmitter().force_mn(u16::MAX), Err(SensorFault::ShortCircuit));
    }

    #[test]
    fn a_force_beyond_every_rudder_is_refused() {
        assert!(Transmitter::new(0, I16F16::DELTA, u32::MAX, u32::MAX).is_none());
        assert!(Transmitter::new(0, I16F16::DELTA, 40_000_000, 250_000).is_some());
    }
}
