//! The friction set: groups of a friction test, cleaned, brought to a common scale, sampled.
//!
//! The rig gives 20 groups a bearing (5 loads, both directions of loading and of turning); measured logs give one group a
//! file. Whole groups are dealt to training, validation and test, 12/4/4 of 20. The torque and the speed of every group
//! are cleaned ([`super::clean`]), the load as well. Mean and standard deviation for `z = (x - mean)/deviation` (the paper's eq.
//! 9) are those of all cleaned samples of the training groups, and the other parts are scaled by the same two numbers:
//! what is known of the test part must not enter the scale. Of each group 2048 samples are drawn without
//! repetition, 5 times, and kept in the order of time.

use super::clean::{smoothed, without_outliers};
use super::friction_source::FrictionError;
use super::split::{Split, deal};
use crate::draw::{Draw, Purpose};
use bench::{Channel, MeasuredLog};
use rayon::prelude::*;
use serde::Serialize;

/// Draws of every group.
pub const DRAWS: usize = 5;
/// Samples of a draw.
pub const SAMPLES: usize = 2048;
/// Fewest groups that can be split.
pub const LEAST_GROUPS: usize = 3;
/// Quantities of a sample, in the order of their columns.
pub const CHANNELS: [Channel; 3] = [Channel::LoadForce, Channel::SpindleSpeed, Channel::FrictionTorque];
/// Columns of the files: raw values are not kept; time counts from the group's first sample, because f32 cannot tell apart the samples
/// of a log whose clock began long ago; `_z` are the scaled values.
pub const COLUMNS: [&str; 9] = [
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
    /// Where it comes from.
    pub source: String,
    /// The part it was dealt to.
    pub split: Split,
    /// Time in s.
    pub time_s: Vec<f64>,
    /// As logged.
    pub raw: [Vec<f64>; 3],
    /// Without outliers and noise.
    pub clean: [Vec<f64>; 3],
    /// Outliers found in the torque.
    pub outliers: usize,
}

/// A sample that was drawn: its group, the draw and its place in the group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Number of the group.
    pub group: usize,
    /// Number of the draw.
    pub draw: usize,
    /// Place in the group.
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
    /// Groups in their order.
    pub groups: Vec<Group>,
    /// Scales by [`CHANNELS`].
    pub scales: [Scale; 3],
    seed: u64,
}

impl FrictionSet {
    /// Cleans, splits and scales groups; the weights of the average have a standard deviation of `smoothing_s`.
    pub fn new(logs: Vec<MeasuredLog>, smoothing_s: f64, seed: u64) -> Result<Self, FrictionError> {
        if logs.len() < LEAST_GROUPS {
            let file = logs.first().map_or_else(|| "groups".to_owned(), |log| log.source.clone());
            let found = format!("{} group(s)", logs.len());
            let expected = format!("at least {LEAST_GROUPS}, for training, validation and test");
            return Err(FrictionError::Content { file, found, expected });
        }
        let splits = deal(logs.len(), seed);
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

    /// The samples of a part, draw by draw of each of its groups.
    pub fn samples(&self, split: Split) -> impl Iterator<Item = Sample> + '_ {
        let groups = self.groups.iter().enumerate().filter(move |(_, group)| group.split == split);
        groups.flat_map(move |(number, group)| {
            (0..DRAWS).flat_map(move |draw| {
                let places = self.places(number, draw, group.time_s.len());
                places.into_iter().map(move |place| Sample { group: number, draw, place })
            })
        })
    }

    /// The samples of a part as columns, by [`COLUMNS`].
    pub fn columns(&self, split: Split) -> Vec<Vec<f32>> {
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

    /// The samples of a draw of a group: without repetition, ascending.
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
            let (values, found) = without_outliers(values);
            // The torque comes last and is the one that counts.
            outliers = found;
            smoothed(&values, deviation_samples)
        });
        Ok(Self { source: log.source, split, time_s: log.time_s, raw, clean, outliers })
    }
}

fn scale(values: impl Iterator<Item = f64> + Clone) -> Scale {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    let deviation = (values.map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
    // Rounding alone gives a constant a deviation.
    Scale { mean, deviation: if deviation > 1e-12 * mean.abs() { deviation } else { 1.0 } }
}

/// Root mean square of the torque's difference from the truth, before and after cleaning, in N m, over all groups.
pub fn torque_errors(groups: &[Group], truth: &[MeasuredLog]) -> [f64; 2] {
    let rms = |pick: fn(&Group) -> &[Vec<f64>; 3]| {
        let (mut squares, mut count) = (0.0, 0_u64);
        for (group, truth) in groups.iter().zip(truth) {
            let [.., torque] = pick(group);
            let truth = truth.channels.get(&Channel::FrictionTorque).map(Vec::as_slice).unwrap_or_default();
            for (found, truth) in torque.iter().zip(truth) {
                squares += (found - truth).powi(2);
                count += 1;
            }
        }
        (squares / count.max(1) as f64).sqrt()
    };
    [rms(|group| &group.raw), rms(|group| &group.clean)]
}

#[cfg(test)]
mod tests {
    use super::super::friction_source::{from_rig, truth_of_rig};
    use super::*;
    use inference::Bearing;

    fn set(seed: u64) -> FrictionSet {
        FrictionSet::new(from_rig("friction-rig-babbitt", Bearing::Babbitt, seed).unwrap(), 0.01, seed)
            .unwrap()
    }

    #[test]
    fn parts_have_the_papers_counts_and_training_has_mean_0_and_deviation_1() {
        let set = set(3);
        let counts = Split::ALL.map(|split| set.columns(split)[0].len() / SAMPLES);
        assert_eq!(counts, [60, 20, 20]);
        let training = set.columns(Split::Training);
        for z in &training[6..] {
            let mean = z.iter().map(|&v| f64::from(v)).sum::<f64>() / z.len() as f64;
            let square = z.iter().map(|&v| f64::from(v).powi(2)).sum::<f64>() / z.len() as f64;
            // Sampled, so near 0 and 1 only: 122880 samples, 12 groups of them.
            assert!(mean.abs() < 0.02 && (square - 1.0).abs() < 0.02, "{mean} {square}");
        }
        let place = set.places(4, 2, 5500);
        assert!(place.len() == SAMPLES && place.windows(2).all(|w| w[0] < w[1]) && place[SAMPLES - 1] < 5500);
        assert_ne!(place, set.places(4, 3, 5500));
        assert_eq!(training, super::tests::set(3).columns(Split::Training));
    }

    #[test]
    fn a_clock_that_began_long_ago_changes_nothing() {
        let logs = from_rig("friction-rig-babbitt", Bearing::Babbitt, 3).unwrap();
        let mut late = logs.clone();
        late.iter_mut().flat_map(|log| &mut log.time_s).for_each(|time_s| *time_s += f64::from(1 << 30));
        let [now, late] = [logs, late].map(|logs| FrictionSet::new(logs, 0.01, 3).unwrap());
        assert_eq!(now.samples(Split::Test).count(), 4 * DRAWS * SAMPLES);
        let [now, late] = [now, late].map(|set| set.columns(Split::Test));
        assert!(now[2].windows(2).filter(|pair| pair[0] == pair[1]).count() == 0 && now[2][0] < 0.1);
        // 2^-22 s is what f64 leaves of a time of 2^30 s.
        assert!(now[2].iter().zip(&late[2]).all(|(a, b)| (a - b).abs() < 1e-5));
    }

    #[test]
    fn cleaning_comes_nearer_to_the_truth() {
        for bearing in Bearing::ALL {
            let name = &format!("friction-rig-{}", bearing.name());
            let set = FrictionSet::new(from_rig(name, bearing, 5).unwrap(), 0.01, 5).unwrap();
            let [raw, clean] = torque_errors(&set.groups, &truth_of_rig(name, 5).unwrap());
            assert!(clean < 0.25 * raw && clean < 8.0, "{name}: {raw} {clean}");
            // A long average takes more off the break-away than it takes off the noise.
            let long = FrictionSet::new(from_rig(name, bearing, 5).unwrap(), 0.04, 5).unwrap();
            assert!(torque_errors(&long.groups, &truth_of_rig(name, 5).unwrap())[1] > 1.5 * clean);
            assert!(set.groups.iter().all(|group| (5..80).contains(&group.outliers)));
        }
    }

    #[test]
    fn what_cannot_be_a_set_is_refused() {
        let logs = from_rig("friction-rig-plastic", Bearing::Plastic, 1).unwrap();
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
        let refused = |name| from_rig(name, Bearing::Babbitt, 1).unwrap_err().to_string();
        assert!(refused("bench-b").contains("another plant"));
        assert!(refused("friction-rig-plastic").contains("found a plastic pair, expected babbitt"));
    }
}
