//! Comparison of the networks' normal force with the analytic law at the same contact.
//!
//! Deformation, rate, clearance and approach speed are the inputs of both: the comparison tests the
//! networks, not the estimate. The share covers the legitimate differences: the error of the
//! networks, the earlier samples that they depend on, and a configured modulus that is not the
//! trained one. An estimate with a flag about training range or warming up is not compared.

use crate::integrity::words;
use inference::Flags;
use link::track::MonitorConfiguration;

/// Flags with which the networks are not used for the estimate, nor compared.
pub(super) const UNUSABLE: Flags = Flags::from_bits(
    Flags::OUTSIDE_TRAINING.bits()
        | Flags::SATURATED.bits()
        | Flags::NON_FINITE.bits()
        | Flags::WARMING_UP.bits()
        | Flags::CORRUPTED.bits()
        | Flags::IMPLAUSIBLE_FRICTION.bits()
        | Flags::MISSING.bits(),
);

/// The envelope of one bench.
#[derive(Clone, Debug)]
pub(super) struct Envelope {
    share: f32,
    floor_n: f32,
}
words!(Envelope { share, floor_n });

impl Envelope {
    /// Prepares the envelope of a configuration.
    pub(super) fn new(monitor: &MonitorConfiguration) -> Self {
        Self {
            share: f32::from(monitor.envelope_per_mille) * 1e-3,
            floor_n: f32::from(monitor.envelope_floor_n),
        }
    }

    /// Returns true if the networks' normal force is outside the envelope of the law's; also if
    /// either is not a number.
    pub(super) fn is_outside(&self, network_n: f32, law_n: f32) -> bool {
        let larger = if network_n > law_n { network_n } else { law_n };
        let is_inside = (network_n - law_n).abs() <= self.share * larger + self.floor_n;
        !is_inside
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::configuration::BENCH_B;

    #[test]
    fn the_envelope_has_the_configured_width_around_the_law() {
        let monitor =
            MonitorConfiguration { envelope_per_mille: 100, envelope_floor_n: 50, ..BENCH_B.monitor };
        let envelope = Envelope::new(&monitor);
        for law_n in [0.0, 100.0, 10_000.0] {
            let width = 0.1 * law_n + 50.0;
            assert!(
                !envelope.is_outside(law_n + width, law_n) && envelope.is_outside(law_n + 1.2 * width, law_n)
            );
            assert!(!envelope.is_outside(law_n - 0.99 * width, law_n));
            assert!(envelope.is_outside(law_n - 1.01 * width, law_n), "{law_n}");
        }
        assert!(envelope.is_outside(f32::NAN, 1.0) && envelope.is_outside(1.0, f32::NAN));
    }
}
