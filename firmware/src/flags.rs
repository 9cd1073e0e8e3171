//! What an estimate says about its sensors: bits 16 to 31 of [`Flags`]. Bits 0 to 15 are the networks'.

use inference::Flags;

/// The journal is further outside the clearance than any bearing deforms ([`crate::estimator::MAX_DEFORMATION_NM`]).
pub const IMPLAUSIBLE_POSITION: Flags = Flags::from_bits(1 << 16);
/// A sensor moved further since the last sample than the machine can; the window starts anew.
pub const JUMP: Flags = Flags::from_bits(1 << 17);
/// A sensor has shown the same code for [`crate::estimator::STUCK_SAMPLES`] samples.
pub const STUCK: Flags = Flags::from_bits(1 << 18);
/// The sequence number did not follow: samples were lost or repeated; the window starts anew.
pub const SEQUENCE_GAP: Flags = Flags::from_bits(1 << 19);
/// The time did not advance by the sample period (half of it either way); the window starts anew.
pub const TIME_FAULT: Flags = Flags::from_bits(1 << 20);
/// The window is not full: the rates are taken as 0.
pub const WINDOW_FILLING: Flags = Flags::from_bits(1 << 21);
/// In contact, but its onset was not seen (start, or a gap in the samples): the approach speed is the one configured
/// for that case.
pub const ONSET_NOT_SEEN: Flags = Flags::from_bits(1 << 22);

/// Every remark that means "do not trust the sensors".
pub const SENSOR_FAULT: Flags = Flags::from_bits(
    IMPLAUSIBLE_POSITION.bits() | JUMP.bits() | STUCK.bits() | SEQUENCE_GAP.bits() | TIME_FAULT.bits(),
);

/// Names of all remarks, those of the networks included, for reports.
pub const NAMES: [(Flags, &str); 15] = [
    (Flags::OUTSIDE_CLEARANCE, "outside-clearance"),
    (Flags::OUTSIDE_DEFORMATION, "outside-deformation"),
    (Flags::OUTSIDE_RATE_RATIO, "outside-rate-ratio"),
    (Flags::OUTSIDE_SLIDING_SPEED, "outside-sliding-speed"),
    (Flags::OUTSIDE_FORCE, "outside-force"),
    (Flags::SATURATED, "saturated"),
    (Flags::NON_FINITE, "non-finite"),
    (Flags::WARMING_UP, "warming-up"),
    (IMPLAUSIBLE_POSITION, "implausible-position"),
    (JUMP, "jump"),
    (STUCK, "stuck"),
    (SEQUENCE_GAP, "sequence-gap"),
    (TIME_FAULT, "time-fault"),
    (WINDOW_FILLING, "window-filling"),
    (ONSET_NOT_SEEN, "onset-not-seen"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_stands_for_one_bit_of_its_own() {
        let mut seen = 0_u32;
        for (flag, name) in NAMES {
            assert_eq!(flag.bits().count_ones(), 1, "{name}");
            assert_eq!(seen & flag.bits(), 0, "{name}");
            seen |= flag.bits();
        }
    }
}
