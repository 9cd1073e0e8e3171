//! Self-test of a package: known inputs and the outputs that the networks must give.
//!
//! A record is one sample and the networks' result for it, 32 bytes, little-endian: the five
//! numbers of [`Sample`] in their order, normal and friction force in mN, then flags and clipped
//! activations with 16 bits each. The records of a bearing are consecutive samples from an empty
//! history. All arithmetic is integer arithmetic, so every core must give the same bits.

use inference::{Flags, Model, Pair, Sample};

/// Bytes of a record.
pub(crate) const RECORD_LENGTH: usize = 32;

/// Returns a record's bytes.
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

/// Runs the networks over records.
///
/// # Errors
///
/// The position of the first record with another result.
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

/// Records hold the flags of the networks only; they fit into 16 bits.
const _: () = assert!(Flags::OUTSIDE_TRAINING.bits() < 1 << 16);

#[cfg(test)]
mod tests {
    use super::*;
    use inference::{BearingMaterial, shipped};

    #[test]
    fn other_networks_and_other_results_fail_at_their_sample() {
        let load = |bearing| -> Model<'static> { Model::load(shipped(bearing)).unwrap() };
        let mut pair = Pair::new(load(BearingMaterial::Babbitt));
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
        assert_eq!(run(load(BearingMaterial::Babbitt), &records), Ok(()));
        assert!(run(load(BearingMaterial::Plastic), &records).is_err());
        records[20 * RECORD_LENGTH + 20] ^= 1;
        assert_eq!(run(load(BearingMaterial::Babbitt), &records), Err(20));
    }
}
