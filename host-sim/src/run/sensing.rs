//! The controller's sensors: converts a run into one sensor frame per sample period.

use bench::plants::transmission::Snapshot;
use bench::signals::Sensor;
use bench::{Bench, Channel};
use link::SensorFrame;
use link::track::{SensorChannel, SensorStatus};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A frame with the drivers' status of its channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampled {
    /// The frame.
    pub frame: SensorFrame,
    /// Channels that are missing or at their rail.
    pub status: SensorStatus,
}

impl From<SensorFrame> for Sampled {
    fn from(frame: SensorFrame) -> Self {
        Self { frame, status: SensorStatus::GOOD }
    }
}

/// Drop-outs of each channel, as from a loose plug or a restarting transmitter. The last good value
/// replaces a lost reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DropOut {
    /// Share of lost readings, 0 to below 1.
    pub share: f64,
    /// Number of readings lost in a row, 1 or more.
    pub samples: f64,
}

impl DropOut {
    /// No drop-outs.
    pub const NONE: Self = Self { share: 0.0, samples: 1.0 };

    /// Draws the lost readings among `count`. Between two losses lie `samples (1/share - 1)` good
    /// readings on average.
    fn lost(self, count: usize, rng: &mut ChaCha8Rng) -> Vec<bool> {
        let begins = self.share / (self.share + self.samples * (1.0 - self.share));
        let mut left = 0.0;
        let mut next = |first: bool| {
            if left >= 1.0 {
                left -= 1.0;
                return true;
            }
            // The first reading is never lost: there is none before it to replace it.
            let lost = !first && unit(rng) < begins;
            left = if lost { self.samples.round() - 1.0 } else { 0.0 };
            lost
        };
        (0..count).map(|index| next(index == 0)).collect()
    }
}

/// Draws a number from 0 to below 1.
fn unit(rng: &mut ChaCha8Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Converts a run, sampled at the controller's rate, into sensor frames without drop-outs; see
/// [`samples`].
pub fn frames(bench: &Bench, samples: &[Snapshot], seed: u64) -> Vec<SensorFrame> {
    self::samples(bench, samples, seed, DropOut::NONE).iter().map(|sampled| sampled.frame).collect()
}

/// Converts a run, sampled at the controller's rate, into what the controller receives. Noise,
/// delay and the other properties come from the sensors of the bench's description. A load
/// transmitter without a description is perfect. Drop-outs are applied last. A reading at the end
/// of its sensor's range gets the status "at rail".
pub fn samples(bench: &Bench, samples: &[Snapshot], seed: u64, drop_out: DropOut) -> Vec<Sampled> {
    let time_s: Vec<f64> = samples.iter().map(|s| s.time_s).collect();
    let perfect = Sensor::default();
    let read = |channel: Channel, stream: u64, truth: fn(&Snapshot) -> f64| {
        let sensor = bench.sensors().get(&channel).unwrap_or(&perfect);
        let truth: Vec<f64> = samples.iter().map(truth).collect();
        let mut signal = sensor.respond(&time_s, &truth);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        sensor.read(&mut signal, &mut rng);
        // A separate stream: the noise of a seed does not depend on drop-outs.
        rng.set_stream(stream + 16);
        let lost = if drop_out.share > 0.0 {
            drop_out.lost(signal.len(), &mut rng)
        } else {
            vec![false; signal.len()]
        };
        let mut last = 0.0;
        for (value, lost) in signal.iter_mut().zip(&lost) {
            last = if *lost { last } else { *value };
            *value = last;
        }
        let at_limit: Vec<bool> = signal.iter().map(|value| sensor.is_at_limit(*value)).collect();
        Readings { signal, lost, at_limit }
    };
    let y = read(Channel::JournalY, 1, |s| s.y_m);
    let z = read(Channel::JournalZ, 2, |s| s.z_m);
    let angle = read(Channel::ShaftAngle, 3, |s| s.angle_rad);
    let load = read(Channel::LoadForce, 4, |s| s.load_force_n);
    let channels = [y, z, angle, load];
    let sampled = |(index, time_s): (usize, &f64)| {
        let status = SensorChannel::ALL.into_iter().zip(&channels).fold(
            SensorStatus::GOOD,
            |status, (channel, readings)| match (readings.lost[index], readings.at_limit[index]) {
                (true, _) => status.missing(channel),
                (false, true) => status.at_rail(channel),
                (false, false) => status,
            },
        );
        Sampled { frame: frame(index as u32, *time_s, channels.each_ref().map(|c| c.signal[index])), status }
    };
    time_s.iter().enumerate().map(sampled).collect()
}

/// Readings of one channel.
struct Readings {
    signal: Vec<f64>,
    /// Lost readings.
    lost: Vec<bool>,
    /// Readings at the end of the sensor's range.
    at_limit: Vec<bool>,
}

/// Encodes a sample: journal along y and z in m, shaft angle in rad, load force in N.
///
/// A reading beyond the range is limited to its end. Time and angle wrap around, as the controller
/// uses only their differences.
pub fn frame(sequence: u32, time_s: f64, [y_m, z_m, angle_rad, load_n]: [f64; 4]) -> SensorFrame {
    // `as` saturates.
    let counts = |value: f64, unit: f64| (value / unit).round() as i32;
    SensorFrame {
        sequence,
        time_us: (time_s * 1e6).round() as i64 as u32,
        journal_y_nm: counts(y_m, 1e-9),
        journal_z_nm: counts(z_m, 1e-9),
        shaft_angle_nrad: (angle_rad / 1e-9).round() as i64 as i32,
        load_force_mn: counts(load_n, 1e-3),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_and_angle_wrap_and_the_other_channels_saturate() {
        let before = frame(0, 4294.0, [1.0, -1.0, 2.1, 3e6]);
        let after = frame(1, 4296.0, [3.0, -3.0, 2.2, -3e6]);
        assert_eq!(after.time_us.wrapping_sub(before.time_us), 2_000_000);
        assert_eq!(after.shaft_angle_nrad.wrapping_sub(before.shaft_angle_nrad), 100_000_000);
        assert_eq!((after.journal_y_nm, after.journal_z_nm), (i32::MAX, i32::MIN));
        assert_eq!((before.load_force_mn, after.load_force_mn), (i32::MAX, i32::MIN));
    }

    fn lost(share: f64, samples: f64, seed: u64) -> Vec<bool> {
        DropOut { share, samples }.lost(200_000, &mut ChaCha8Rng::seed_from_u64(seed))
    }

    #[test]
    fn drop_outs_have_their_share_and_their_length_and_repeat_by_seed() {
        for (share, samples) in [(0.01, 1.0), (0.05, 20.0), (0.5, 3.0)] {
            let lost = lost(share, samples, 1);
            let found = lost.iter().filter(|lost| **lost).count() as f64 / lost.len() as f64;
            assert!((found / share - 1.0).abs() < 0.1, "{share}, {samples}: {found}");
            let ends = lost.windows(2).filter(|pair| pair[0] && !pair[1]).count() as f64;
            let length = found * lost.len() as f64 / ends;
            assert!(length >= samples * 0.99, "{share}, {samples}: {length} in a row");
            assert!(length < samples / (1.0 - share) * 1.1, "{share}, {samples}: {length} in a row");
        }
        assert_eq!(lost(0.1, 2.0, 7), lost(0.1, 2.0, 7));
        assert_ne!(lost(0.1, 2.0, 7), lost(0.1, 2.0, 8));
        assert!(!lost(0.9, 5.0, 1)[0]);
    }

    #[test]
    fn a_lost_reading_is_marked_missing_and_replaced_by_the_last_good_one() {
        let bench = Bench::open("bench-b").unwrap();
        let snapshot = |index: u32| Snapshot {
            time_s: f64::from(index) * 1e-4,
            y_m: f64::from(index) * 1e-6,
            ..Snapshot::default()
        };
        let truth: Vec<Snapshot> = (0..2_000).map(snapshot).collect();
        let good = samples(&bench, &truth, 3, DropOut::NONE);
        let some = samples(&bench, &truth, 3, DropOut { share: 0.05, samples: 4.0 });
        assert!(good.iter().all(|sampled| sampled.status == SensorStatus::GOOD));
        let (mut last, mut missing) = (good[0].frame.journal_y_nm, 0);
        for (good, some) in good.iter().zip(&some) {
            if some.status.missing_bits() & 1 == 0 {
                assert_eq!(some.frame.journal_y_nm, good.frame.journal_y_nm);
                last = good.frame.journal_y_nm;
            } else {
                missing += 1;
                assert_eq!(some.frame.journal_y_nm, last);
            }
        }
        assert!((50..200).contains(&missing), "{missing}");
        let of =
            |channel: u8| some.iter().map(|s| s.status.missing_bits() >> channel & 1).collect::<Vec<_>>();
        assert!((1..4).all(|channel| of(channel) != of(0) && of(channel).contains(&1)), "each for itself");
    }

    #[test]
    fn a_reading_at_the_end_of_its_range_is_marked_at_rail() {
        let mut bench = Bench::open("bench-b").unwrap();
        let sensor = Sensor { inverse_limit: 1.0 / 1.003e-4, resolution: 5e-7, ..Sensor::default() };
        bench.sensors_mut().insert(Channel::JournalZ, sensor);
        let z_m = |index: u32| (f64::from(index) - 200.0) * 1e-6;
        let snapshot =
            |index: u32| Snapshot { time_s: f64::from(index) * 1e-4, z_m: z_m(index), ..Snapshot::default() };
        let truth: Vec<Snapshot> = (0..400).map(snapshot).collect();
        let found = samples(&bench, &truth, 3, DropOut::NONE);
        for (sampled, truth) in found.iter().zip(&truth) {
            let rail = SensorStatus::GOOD.at_rail(SensorChannel::JournalZ);
            match truth.z_m.abs() {
                beyond if beyond > 1.01e-4 => assert_eq!(sampled.status, rail, "{beyond}"),
                within if within < 0.99e-4 => assert_eq!(sampled.status, SensorStatus::GOOD, "{within}"),
                _ => {}
            }
        }
    }
}
