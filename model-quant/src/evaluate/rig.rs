//! Accuracy of the rig's friction network on the test groups of a friction set.

use super::errors::Errors;
use crate::data::features::FloatFeatures;
use crate::data::friction::{FrictionSet, Group};
use crate::data::split::Split;
use crate::network::Network;
use crate::train::rig::{RADIUS_M, Series, targets};
use bench::{Channel, MeasuredLog};
use rayon::prelude::*;

/// Torque errors in N m over the samples that the set draws from its test groups.
#[derive(Clone, Copy, Debug)]
pub struct RigErrors {
    /// Errors against the torque without noise, if it is known.
    pub truth: Option<Errors>,
    /// Errors against the cleaned torque.
    pub cleaned: Errors,
}

/// Measures a collision and a friction network on the drawn test samples. `truth` has the same
/// groups without noise and is empty for measured logs.
pub fn errors(
    set: &FrictionSet,
    truth: &[MeasuredLog],
    [collision, friction]: [&Network; 2],
    features: &FloatFeatures,
) -> RigErrors {
    let series: Vec<Series> =
        set.groups.iter().map(|group| Series::from_group(group, collision, features)).collect();
    let [.., scale] = set.scales;
    let found: Vec<(usize, usize, f64, f64)> = (targets(set, Split::Test).par_iter())
        .map(|&(group, place, target)| {
            let output = series.get(group).map_or(0.0, |series| series.output(friction, place));
            (group, place, output * scale.deviation, f64::from(target) * scale.deviation)
        })
        .collect();
    let exact = |group: usize, place: usize| {
        truth.get(group)?.channels.get(&Channel::FrictionTorque)?.get(place).copied()
    };
    let pairs: Option<Vec<(f64, f64)>> =
        found.iter().map(|&(group, place, torque, _)| Some((exact(group, place)?, torque))).collect();
    RigErrors {
        truth: pairs.filter(|pairs| !pairs.is_empty()).map(|pairs| Errors::from_pairs(pairs.into_iter())),
        cleaned: Errors::from_pairs(found.iter().map(|&(_, _, torque, cleaned)| (cleaned, torque))),
    }
}

/// A test group over time.
#[derive(Clone, Debug)]
pub(crate) struct TestGroup {
    /// Name of the file or rig group.
    pub source: String,
    /// Time in s.
    pub time_s: Vec<f64>,
    /// Load in N after cleaning.
    pub load_n: Vec<f64>,
    /// Sliding speed in m/s after cleaning.
    pub sliding_speed_m_s: Vec<f64>,
    /// Torque in N m as logged.
    pub measured_nm: Vec<f64>,
    /// Torque in N m after cleaning.
    pub cleaned_nm: Vec<f64>,
    /// Torque in N m without noise, resolution and outliers; None for a measured log.
    pub truth_nm: Option<Vec<f64>>,
    /// Torque in N m predicted by the networks.
    pub predicted_nm: Vec<f64>,
}

/// Evaluates the networks on every sample of the test groups; `truth` as for [`errors`].
pub(crate) fn test_groups(
    set: &FrictionSet,
    truth: &[MeasuredLog],
    [collision, friction]: [&Network; 2],
    features: &FloatFeatures,
) -> Vec<TestGroup> {
    let [.., scale] = set.scales;
    let one = |(number, group): (usize, &Group)| {
        let series = Series::from_group(group, collision, features);
        let places = (0..group.time_s.len()).into_par_iter();
        let [load, speed, torque] = &group.clean;
        let [.., measured] = &group.raw;
        TestGroup {
            source: group.source.clone(),
            time_s: group.time_s.clone(),
            load_n: load.clone(),
            sliding_speed_m_s: speed.iter().map(|speed| speed * RADIUS_M).collect(),
            measured_nm: measured.clone(),
            cleaned_nm: torque.clone(),
            truth_nm: truth.get(number).and_then(|log| log.channels.get(&Channel::FrictionTorque).cloned()),
            predicted_nm: places.map(|place| scale.deviation * series.output(friction, place)).collect(),
        }
    };
    let groups = set.groups.iter().enumerate();
    groups.filter(|(_, group)| group.split == Split::Test).map(one).collect()
}
