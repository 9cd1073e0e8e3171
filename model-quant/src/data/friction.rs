//! The friction set: groups of a friction test, cleaned, scaled and sampled.
//!
//! The rig gives 20 groups a bearing (5 loads, both directions of loading and of rotation);
//! measured logs give one group a file. Complete groups are assigned to training, validation and
//! test: 12, 4 and 4 of 20. Torque, speed and load of every group are cleaned ([`super::clean`]).
//! The scale is `z = (x - mean)/deviation` (the paper's eq. 9). Mean and deviation are those of all
//! cleaned samples of the training groups, and the other parts use the same two numbers, so that no
//! information about the test part enters the scale. From each group 2048 samples are drawn without
//! repetition, 5 times, and sorted by time.

use super::clean::{remove_outliers, smooth};
use super::friction_source::FrictionError;
use super::split::{Split, split_groups};
use super::statistics::{mean_and_deviation, root_mean_square};
use crate::data::draw::{Draw, Purpose};
use bench::{Channel, MeasuredLog};
use rayon::prelude::*;
use serde::Serialize;

/// Draws from every group.
pub(crate) const DRAWS: usize = 5;
/// Samples of a draw.
pub(crate) const SAMPLES: usize = 2048;
/// Minimum number of groups, one for each part.
pub(crate) const MIN_GROUPS: usize = 3;
/// Quantities of a sample, in the order of their columns.
pub(crate) const CHANNELS: [Channel; 3] =
    [Channel::LoadForce, Channel::SpindleSpeed, Channel::FrictionTorque];
/// Columns of the files. Raw values are not written. Time counts from the group's first sample,
/// because f32 cannot resolve the samples of a log with a large clock value. `_z` are the scaled
/// values.
pub(crate) const COLUMNS: [&str; 9] = [
    "group",
    "draw",
    "time_s",
    "load_force_n",
    "spindle_speed_rad_s",
    "friction_torque_nm",
    "load_force_z",
    "spindle_speed_z",
    "friction_torque_z",
];

/// One group before and after cleaning, quantities by [`CHANNELS`].
#[derive(Clone, Debug)]
pub struct Group {
    /// Name of the file or rig group.
    pub source: String,
    /// Part that the group belongs to.
    pub split: Split,
    /// Time in s.
    pub time_s: Vec<f64>,
    /// Columns as logged.
    pub raw: [Vec<f64>; 3],
    /// Columns without outliers and noise.
    pub clean: [Vec<f64>; 3],
    /// Outliers found in the torque.
    pub outliers: usize,
}

/// A drawn sample: its group, draw and index in the group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sample {
    /// Number of the group.
    pub group: usize,
    /// Number of the draw.
    pub draw: usize,
    /// Index in the group.
    pub place: usize,
}

/// Mean and standard deviation of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scale {
    /// Mean in the quantity's unit.
    pub mean: f64,
    /// Standard deviation in the quantity's unit; 1 for a quantity that never changes.
    pub deviation: f64,
}

/// A cleaned set.
#[derive(Clone, Debug)]
pub struct FrictionSet {
    /// All groups.
    pub groups: Vec<Group>,
    /// Scales by [`CHANNELS`].
    pub scales: [Scale; 3],
    seed: u64,
}

impl FrictionSet {
    /// Cleans, splits and scales groups; `smoothing_s` is the standard deviation of the averaging
    /// weights in s.
    pub fn new(logs: Vec<MeasuredLog>, smoothing_s: f64, seed: u64) -> Result<Self, FrictionError> {
        if logs.len() < MIN_GROUPS {
            let file = logs.first().map_or_else(|| "groups".to_owned(), |log| log.source.clone());
            let found = format!("{} group(s)", logs.len());
            let expected = format!("at least {MIN_GROUPS}, for training, validation and test");
            return Err(FrictionError::Content { file, found, expected });
        }
        let splits = split_groups(logs.len(), seed);
        let groups: Result<Vec<Group>, FrictionError> = (logs.into_par_iter().zip(splits))
            .map(|(log, split)| Group::new(log, split, smoothing_s))
            .collect();
        let groups = groups?;
        let scales = core::array::from_fn(|index| {
            let training = || groups.iter().filter(|group| group.split == Split::Training);
            scale(training().flat_map(|group| group.clean.get(index).into_iter().flatten().copied()))
        });
        Ok(Self { groups, scales, seed })
    }

    /// Samples of a part: for each group, draw by draw.
    pub(crate) fn samples(&self, split: Split) -> impl Iterator<Item = Sample> + '_ {
        let groups = self.groups.iter().enumerate().filter(move |(_, group)| group.split == split);
        groups.flat_map(move |(number, group)| {
            (0..DRAWS).flat_map(move |draw| {
                let places = self.places(number, draw, group.time_s.len());
                places.into_iter().map(move |place| Sample { group: number, draw, place })
            })
        })
    }

    /// Samples of a part as columns, by [`COLUMNS`].
    pub(crate) fn columns(&self, split: Split) -> Vec<Vec<f32>> {
        let mut columns = vec![Vec::new(); COLUMNS.len()];
        for Sample { group: number, draw, place } in self.samples(split) {
            let Some(group) = self.groups.get(number) else { continue };
            let at = |values: &Vec<f64>| values.get(place).copied().unwrap_or_default();
            let time_s = at(&group.time_s) - group.time_s.first().copied().unwrap_or_default();
            let values = group.clean.each_ref().map(at);
            let scaled = values.into_iter().zip(&self.scales);
            let scaled = scaled.map(|(value, scale)| ((value - scale.mean) / scale.deviation) as f32);
            let start = [number as f32, draw as f32, time_s as f32];
            let all = start.into_iter().chain(values.map(|value| value as f32)).chain(scaled);
            super::collision::push(&mut columns, all);
        }
        columns
    }

    /// Sample indices of one draw from a group: without repetition, ascending.
    fn places(&self, group: usize, draw: usize, count: usize) -> Vec<usize> {
        let mut rng = Draw::new(self.seed, Purpose::DatasetSamples, (group * DRAWS + draw) as u64);
        let mut all: Vec<usize> = (0..count).collect();
        for place in 0..SAMPLES.min(count) {
            all.swap(place, place + rng.below(count - place));
        }
        all.truncate(SAMPLES);
        all.sort_unstable();
        all
    }
}

impl Group {
    fn new(log: MeasuredLog, split: Split, smoothing_s: f64) -> Result<Self, FrictionError> {
        let refused = |found: String, expected: String| FrictionError::Content {
            file: log.source.clone(),
            found,
            expected,
        };
        let count = log.time_s.len();
        if count < SAMPLES {
            return Err(refused(format!("{count} samples"), format!("at least {SAMPLES}")));
        }
        let span_s =
            log.time_s.last().copied().unwrap_or_default() - log.time_s.first().copied().unwrap_or_default();
        let deviation_samples = smoothing_s * (count as f64 - 1.0) / span_s;
        let mut raw = [const { Vec::new() }; 3];
        for (slot, channel) in raw.iter_mut().zip(CHANNELS) {
            let values = log.channels.get(&channel);
            let missing =
                || refused(format!("no column {channel}"), "load, spindle speed and friction torque".into());
            *slot = values.ok_or_else(missing)?.clone();
            if let Some(place) = slot.iter().position(|value| !value.is_finite()) {
                return Err(refused(
                    format!("{channel} without a value in sample {}", place + 1),
                    "numbers".into(),
                ));
            }
        }
        let mut outliers = 0;
        let clean = raw.each_ref().map(|values| {
            let (values, found) = remove_outliers(values);
            // The torque is the last channel; only its outliers are reported.
            outliers = found;
            smooth(&values, deviation_samples)
        });
        Ok(Self { source: log.source, split, time_s: log.time_s, raw, clean, outliers })
    }
}

fn scale(values: impl Iterator<Item = f64>) -> Scale {
    let [mean, deviation] = mean_and_deviation(values);
    // A constant has a small deviation because of rounding.
    Scale { mean, deviation: if deviation > 1e-12 * mean.abs() { deviation } else { 1.0 } }
}

/// Root mean square error of the torque in N m over all groups, before and after cleaning.
pub(crate) fn torque_errors(groups: &[Group], truth: &[MeasuredLog]) -> [f64; 2] {
    let rms = |pick: fn(&Group) -> &[Vec<f64>; 3]| {
        root_mean_square(groups.iter().zip(truth).flat_map(|(group, truth)| {
            let [.., torque] = pick(group);
            let truth = truth.channels.get(&Channel::FrictionTorque).map(Vec::as_slice).unwrap_or_default();
            torque.iter().zip(truth).map(|(found, truth)| found - truth)
        }))
    };
    [rms(|group| &group.raw), rms(|group| &group.clean)]
}

#[cfg(test)]
mod tests {
    use super::super::friction_source::{from_rig, truth_of_rig};
    use super::*;
    use inference::BearingMaterial;

    fn set(seed: u64) -> FrictionSet {
        FrictionSet::new(
            from_rig("friction-rig-babbitt", BearingMaterial::Babbitt, seed).unwrap(),
            0.01,
            seed,
        )
        .unwrap()
    }

    #[test]
    fn parts_have_the_counts_of_the_paper_and_training_has_mean_0_and_deviation_1() {
        let set = set(3);
        let counts = Split::ALL.map(|split| set.columns(split)[0].len() / SAMPLES);
        assert_eq!(counts, [60, 20, 20]);
        let training = set.columns(Split::Training);
        for z in &training[6..] {
            let mean = z.iter().map(|&v| f64::from(v)).sum::<f64>() / z.len() as f64;
            let square = z.iter().map(|&v| f64::from(v).powi(2)).sum::<f64>() / z.len() as f64;
            // The samples are a random subset, so mean and deviation are only near 0 and 1: 122880
            // samples of 12 groups.
            assert!(mean.abs() < 0.02 && (square - 1.0).abs() < 0.02, "{mean} {square}");
        }
        let place = set.places(4, 2, 5500);
        assert!(place.len() == SAMPLES && place.windows(2).all(|w| w[0] < w[1]) && place[SAMPLES - 1] < 5500);
        assert_ne!(place, set.places(4, 3, 5500));
        assert_eq!(training, super::tests::set(3).columns(Split::Training));
    }

    #[test]
    fn a_large_clock_offset_does_not_change_the_set() {
        let logs = from_rig("friction-rig-babbitt", BearingMaterial::Babbitt, 3).unwrap();
        let mut late = logs.clone();
        late.iter_mut().flat_map(|log| &mut log.time_s).for_each(|time_s| *time_s += f64::from(1 << 30));
        let [now, late] = [logs, late].map(|logs| FrictionSet::new(logs, 0.01, 3).unwrap());
        assert_eq!(now.samples(Split::Test).count(), 4 * DRAWS * SAMPLES);
        let [now, late] = [now, late].map(|set| set.columns(Split::Test));
        assert!(now[2].windows(2).filter(|pair| pair[0] == pair[1]).count() == 0 && now[2][0] < 0.1);
        // At 2^30 s an f64 resolves 2^-22 s.
        assert!(now[2].iter().zip(&late[2]).all(|(a, b)| (a - b).abs() < 1e-5));
    }

    #[test]
    fn cleaning_reduces_the_error_against_the_noise_free_torque() {
        for bearing in BearingMaterial::ALL {
            let name = &format!("friction-rig-{}", bearing.name());
            let set = FrictionSet::new(from_rig(name, bearing, 5).unwrap(), 0.01, 5).unwrap();
            let [raw, clean] = torque_errors(&set.groups, &truth_of_rig(name, 5).unwrap());
            assert!(clean < 0.25 * raw && clean < 8.0, "{name}: {raw} {clean}");
            // A longer average removes more of the break-away peak than of the noise.
            let long = FrictionSet::new(from_rig(name, bearing, 5).unwrap(), 0.04, 5).unwrap();
            assert!(torque_errors(&long.groups, &truth_of_rig(name, 5).unwrap())[1] > 1.5 * clean);
            assert!(set.groups.iter().all(|group| (5..80).contains(&group.outliers)));
        }
    }

    #[test]
    fn unusable_logs_are_refused_with_a_reason() {
        let logs = from_rig("friction-rig-plastic", BearingMaterial::Plastic, 1).unwrap();
        let refused = |logs: Vec<MeasuredLog>| FrictionSet::new(logs, 0.01, 1).unwrap_err().to_string();
        assert!(refused(logs[..2].to_vec()).contains("2 group(s), expected at least 3"));
        let mut short = logs[..3].to_vec();
        short[1].time_s.truncate(2047);
        assert!(refused(short).contains("2047 samples, expected at least 2048"));
        let mut bare = logs[..3].to_vec();
        bare[2].channels.remove(&Channel::FrictionTorque);
        assert!(refused(bare).contains("no column friction_torque_nm"));
        let mut hole = logs[..3].to_vec();
        hole[0].channels.get_mut(&Channel::LoadForce).unwrap()[6] = f64::NAN;
        assert!(refused(hole).contains("load_force_n without a value in sample 7"));
        let refused = |name| from_rig(name, BearingMaterial::Babbitt, 1).unwrap_err().to_string();
        assert!(refused("bench-b").contains("found plant `transmission-bench`; expected `friction-rig`"));
        assert!(refused("friction-rig-plastic").contains("found a plastic pair, expected babbitt"));
    }
}
