//! Flags that the controller adds to an estimate: sensors, supervision, deadline, limits. They are
//! bits 15 to 31 of [`Flags`]; bits 0 to 14 belong to the networks.

use inference::Flags;

/// The model does not fit the samples: the innovations are larger than sensors and declared
/// uncertainty explain. The deviations of force and torque are wider then.
pub const MODEL_MISFIT: Flags = Flags::from_bits(1 << 15);
/// The journal is further outside the clearance than any bearing deforms
/// (`MAX_DEFORMATION_NM` in `estimator/plausibility.rs`).
pub const IMPLAUSIBLE_POSITION: Flags = Flags::from_bits(1 << 16);
/// A sensor moved further since the last sample than the machine can; the sample is predicted.
pub const JUMP: Flags = Flags::from_bits(1 << 17);
/// A sensor has shown the same code for the configured number of samples.
pub const STUCK: Flags = Flags::from_bits(1 << 18);
/// The sequence number did not follow: samples were lost or repeated. After lost ones the motion
/// starts anew; a repeated one is ignored.
pub const SEQUENCE_GAP: Flags = Flags::from_bits(1 << 19);
/// The time did not advance by the sample period (tolerance: half of it); the motion starts anew.
pub const TIME_FAULT: Flags = Flags::from_bits(1 << 20);
/// No sample has been complete yet: the estimate is unknown and its deviations are infinite.
pub const NOT_STARTED: Flags = Flags::from_bits(1 << 21);
/// The start still dominates the uncertainty, as the deviations of the estimate show.
pub const CONVERGING: Flags = Flags::from_bits(1 << 22);
/// A channel has no value: its driver reports a fault, or the frame does not contain it.
pub const SENSOR_MISSING: Flags = Flags::from_bits(1 << 23);
/// A channel is at the end of its range.
pub const SENSOR_SATURATED: Flags = Flags::from_bits(1 << 24);
/// The short-term deviation of a channel is above its limit.
pub const NOISY: Flags = Flags::from_bits(1 << 25);
/// The journal swings along the clearance faster than the load can drive it: the position or the
/// load is wrong. Not checked while the load is known to be faulty.
pub const IMPLAUSIBLE_SWING: Flags = Flags::from_bits(1 << 26);
/// The normal force of the networks is outside the envelope of the analytic law at the same
/// contact.
pub const NETWORK_OUTSIDE_LAW: Flags = Flags::from_bits(1 << 27);
/// The estimate is replaced by the last trusted one.
pub const HELD: Flags = Flags::from_bits(1 << 28);
/// The estimate was finished later than its sample period allows.
pub const STALE: Flags = Flags::from_bits(1 << 29);
/// Too many late estimates in a row: the estimate is replaced by the last one in time until the
/// trip is cleared.
pub const TRIPPED: Flags = Flags::from_bits(1 << 30);
/// The normal force is above the configured limit.
pub const OVER_FORCE: Flags = Flags::from_bits(1 << 31);

/// All flags that mean "do not trust the sensors".
pub const SENSOR_FAULT: Flags = Flags::from_bits(
    IMPLAUSIBLE_POSITION.bits()
        | JUMP.bits()
        | STUCK.bits()
        | SEQUENCE_GAP.bits()
        | TIME_FAULT.bits()
        | SENSOR_MISSING.bits()
        | SENSOR_SATURATED.bits()
        | NOISY.bits()
        | IMPLAUSIBLE_SWING.bits(),
);

/// Flags about the networks alone: no reason to distrust an estimate with the law as its source.
pub(crate) const NETWORK_FAULT: Flags = Flags::from_bits(
    NETWORK_OUTSIDE_LAW.bits()
        | Flags::NON_FINITE.bits()
        | Flags::WARMING_UP.bits()
        | Flags::MISSING.bits()
        | Flags::IMPLAUSIBLE_FRICTION.bits(),
);

/// All flags that mean "do not trust the estimate": the monitor holds the last trusted one.
pub const DISTRUSTED: Flags = Flags::from_bits(
    SENSOR_FAULT.bits() | NETWORK_FAULT.bits() | NOT_STARTED.bits() | Flags::CORRUPTED.bits(),
);

/// Names of all flags for reports, including those of the networks.
pub const NAMES: [(Flags, &str); 27] = [
    (Flags::OUTSIDE_CLEARANCE, "outside-clearance"),
    (Flags::OUTSIDE_DEFORMATION, "outside-deformation"),
    (Flags::OUTSIDE_RATE_RATIO, "outside-rate-ratio"),
    (Flags::OUTSIDE_SLIDING_SPEED, "outside-sliding-speed"),
    (Flags::OUTSIDE_FORCE, "outside-force"),
    (Flags::SATURATED, "saturated"),
    (Flags::NON_FINITE, "non-finite"),
    (Flags::WARMING_UP, "warming-up"),
    (Flags::CORRUPTED, "altered"),
    (Flags::IMPLAUSIBLE_FRICTION, "implausible-friction"),
    (MODEL_MISFIT, "model-misfit"),
    (IMPLAUSIBLE_POSITION, "implausible-position"),
    (JUMP, "jump"),
    (STUCK, "stuck"),
    (SEQUENCE_GAP, "sequence-gap"),
    (TIME_FAULT, "time-fault"),
    (NOT_STARTED, "not-started"),
    (CONVERGING, "converging"),
    (SENSOR_MISSING, "sensor-missing"),
    (SENSOR_SATURATED, "sensor-saturated"),
    (NOISY, "noisy"),
    (IMPLAUSIBLE_SWING, "implausible-swing"),
    (NETWORK_OUTSIDE_LAW, "network-outside-law"),
    (HELD, "held"),
    (STALE, "stale"),
    (TRIPPED, "tripped"),
    (OVER_FORCE, "over-force"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_has_a_separate_bit() {
        let mut seen = 0_u32;
        for (flag, name) in NAMES {
            assert_eq!(flag.bits().count_ones(), 1, "{name}");
            assert_eq!(seen & flag.bits(), 0, "{name}");
            seen |= flag.bits();
        }
    }
}
