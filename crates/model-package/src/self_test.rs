//! Known inputs, known outputs: what a package's networks must give before they are let run.
//!
//! A record is one sample and what the two networks give for it, 32 bytes, little-endian: the five numbers of [`Sample`] in their order,
//! normal and friction force in mN, then flags and clipped activations with 16 bits each. The records of a bearing follow one another
//! as samples do, from an empty history. Everything is whole numbers, so that every core must give the same bits.

use inference::{Flags, Model, Pair, Sample};

/// Bytes of a record.
pub const RECORD_LENGTH: usize = 32;

/// A record's bytes.
#[must_use]
pub fn record(pair: &mut Pair<'_>, sample: &Sample) -> [u8; RECORD_LENGTH] {
    let estimate = pair.step(sample);
    let remarks = estimate.flags.bits() & 0xFFFF | u32::from(estimate.saturated) << 16;
    let words = [
        sample.radial_clearance_nm,
        sample.deformation_pm.cast_unsigned(),
        sample.deformation_rate_nm_s.cast_unsigned(),
        sample.approach_speed_nm_s,
        sample.sliding_speed_nm_s.cast_unsigned(),
        estimate.normal_force_mn.cast_unsigned(),
        estimate.friction_force_mn.cast_unsigned(),
        remarks,
    ];
    let mut bytes = [0; RECORD_LENGTH];
    for (to, from) in bytes.iter_mut().zip(words.into_iter().flat_map(u32::to_le_bytes)) {
        *to = from;
    }
    bytes
}

/// Runs the networks over records; the position of the first with another result.
///
/// # Errors
///
/// That position.
pub fn run(model: Model<'_>, records: &[u8]) -> Result<(), u16> {
    let mut pair: Pair<'_> = Pair::new(model);
    for (position, expected) in (0..=u16::MAX).zip(records.as_chunks::<RECORD_LENGTH>().0) {
        if record(&mut pair, &sample(expected)) != *expected {
            return Err(position);
        }
    }
    Ok(())
}

fn sample(record: &[u8; RECORD_LENGTH]) -> Sample {
    let word = |index: usize| {
        let bytes = record.as_chunks::<4>().0.get(index);
        bytes.map_or(0, |bytes| u32::from_le_bytes(*bytes))
    };
    Sample {
        radial_clearance_nm: word(0),
        deformation_pm: word(1).cast_signed(),
        deformation_rate_nm_s: word(2).cast_signed(),
        approach_speed_nm_s: word(3),
        sliding_speed_nm_s: word(4).cast_signed(),
    }
}

/// Remarks that an estimate carries: those of the networks alone.
const _: () = assert!(Flags::OUTSIDE_TRAINING.bits() < 1 << 16);

#[cfg(test)]
mod tests {
    use super::*;
    use inference::{Bearing, shipped};

    #[test]
    fn other_networks_and_other_results_fail_at_their_sample() {
        let load = |bearing| -> Model<'static> { Model::load(shipped(bearing)).unwrap() };
        let mut pair = Pair::new(load(Bearing::Babbitt));
        let mut records: Vec<u8> = Vec::new();
        for step in 0..24_i32 {
            let sample = Sample {
                radial_clearance_nm: 500_000,
                deformation_pm: step * 1_000_000,
                deformation_rate_nm_s: 10_000_000,
                approach_speed_nm_s: 10_000_000,
                sliding_speed_nm_s: 50_000_000,
            };
            records.extend(record(&mut pair, &sample));
        }
        assert_eq!(run(load(Bearing::Babbitt), &records), Ok(()));
        assert!(run(load(Bearing::Plastic), &records).is_err());
        records[20 * RECORD_LENGTH + 20] ^= 1;
        assert_eq!(run(load(Bearing::Babbitt), &records), Err(20));
    }
}
