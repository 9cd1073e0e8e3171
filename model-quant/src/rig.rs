//! The friction network of the rig: trained on the friction set behind a collision network.
//!
//! A window has 8 columns, 20 ms apart, so that the lag of the rig (30 to 80 ms) lies inside it. The collision network of
//! the range `rig`, which holds 240 kN, sees the state in which the law carries the group's load at rest (clearance
//! .5 mm) and gives the normal force. A column is the root of that force over the root of the range's highest, the sliding
//! speed over 10 mm/s, and `v/(|v| + s)` for `s` of .3 and 3 mm/s.
//!
//! Friction is odd in the direction of sliding and does not ask for the direction of loading. Both are built in, because twelve
//! groups are too few to learn them from: a window that slides backward is turned round, speeds and torque, and the load
//! counts by its magnitude. The target is the cleaned torque over its standard deviation in the training groups (the paper's
//! eq. 9 without the mean, which would not be odd).
//!
//! The torque is judged on the test groups against what the rig's sensors would show without noise, resolution and
//! outliers; drift stays. Measured logs have no such truth: there it is the cleaned torque.

use crate::dataset::friction::{FrictionSet, Group, Sample};
use crate::dataset::friction_source::FrictionError;
use crate::dataset::split::Split;
use crate::draw::Draw;
use crate::errors::Errors;
use crate::features::FloatFeatures;
use crate::law::{depth_m, normal_law};
use crate::network::Network;
use crate::recipe::Recipe;
use crate::shapes::friction;
use crate::train::{Loss, Progress, Source, Training, Windows};
use bench::{Channel, MeasuredLog};
use inference::features::FRICTION_INPUTS;
use inference::{ContactState, WINDOW};
use rayon::prelude::*;

/// Time between two columns in s.
pub const SPACING_S: f64 = 0.020;
/// Clearance in m at which the law is inverted.
pub const CLEARANCE_M: f64 = 0.5e-3;
/// Radius in m that turns the spindle's speed into sliding.
const RADIUS_M: f64 = 0.07;
/// Full scale of the sliding speed in m/s.
const SPEED_M_S: f64 = 0.010;
/// Scales of the sliding speed in m/s.
const SCALES_M_S: [f64; 2] = [0.3e-3, 3e-3];
/// Values of a column.
const INPUTS: usize = FRICTION_INPUTS;
/// Standard deviation in s of the average's weights that the groups are cleaned with.
pub const SMOOTHING_S: f64 = 0.010;
/// Number of the training's streams.
const LANE: u64 = 2;

/// The deformation in m at rest under which the law carries a force in N; the deepest of the range where that is not enough.
pub fn deformation_m(features: &FloatFeatures, force_n: f64) -> f64 {
    let deepest_m = f64::from(features.deformation_m.high);
    depth_m(features.bearing, CLEARANCE_M, force_n, deepest_m).unwrap_or(deepest_m)
}

/// Refuses a set with loads beyond what the law carries in the range: the collision network would tell none of them from another.
///
/// # Errors
///
/// The first group with such a load.
pub fn check_loads(set: &FrictionSet, features: &FloatFeatures) -> Result<(), FrictionError> {
    let deepest_m = f64::from(features.deformation_m.high);
    for group in &set.groups {
        let [load, ..] = &group.clean;
        let largest_n = load.iter().fold(0.0_f64, |largest, load| largest.max(load.abs()));
        if depth_m(features.bearing, CLEARANCE_M, largest_n, deepest_m).is_none() {
            let most_n = normal_law(features.bearing, CLEARANCE_M, 1.0).force_n(deepest_m, 0.0, 0.0);
            return Err(FrictionError::Content {
                file: group.source.clone(),
                found: format!("a load of {largest_n:.0} N"),
                expected: format!("at most the {most_n:.0} N that the range of the rig's networks holds"),
            });
        }
    }
    Ok(())
}

/// The normal force in N that a collision network gives where the law carries a load.
pub fn collision_force_n(network: &Network, features: &FloatFeatures, load_n: f64) -> f64 {
    let state = ContactState {
        radial_clearance_m: CLEARANCE_M as f32,
        deformation_m: deformation_m(features, load_n.abs()) as f32,
        ..ContactState::default()
    };
    let column = features.collision(&state);
    let output = network.evaluate([column.inputs; WINDOW].as_flattened());
    let root = output.first().copied().unwrap_or_default().max(0.0) * column.root_force_factor;
    f64::from(root).powi(2)
}

/// The columns of a group, one a sample, in the order of time.
struct Series {
    columns: Vec<[f32; INPUTS]>,
    /// Samples between two columns of a window.
    spacing: usize,
}

impl Series {
    fn of(group: &Group, collision: &Network, features: &FloatFeatures) -> Self {
        let [load, speed, _] = &group.clean;
        let highest = f64::from(features.normal_force_n.high);
        let columns = load.par_iter().zip(speed).map(|(&load, &speed)| {
            let root = (collision_force_n(collision, features, load) / highest).sqrt();
            let sliding = speed * RADIUS_M;
            let [slow, fast] = SCALES_M_S.map(|scale| sliding / (sliding.abs() + scale));
            [root, sliding / SPEED_M_S, slow, fast].map(|value| value as f32)
        });
        let span = group.time_s.last().zip(group.time_s.first()).map_or(0.0, |(last, first)| last - first);
        let rate = (group.time_s.len() as f64 - 1.0) / span.max(f64::MIN_POSITIVE);
        Self { columns: columns.collect(), spacing: (SPACING_S * rate).round().max(1.0) as usize }
    }

    /// The window that ends at a sample, turned to slide forward, and the direction that it had; before the first sample stands
    /// the first one.
    fn window(&self, place: usize) -> ([[f32; INPUTS]; WINDOW], f32) {
        let mut window = core::array::from_fn(|column| {
            let age = (WINDOW - 1 - column) * self.spacing;
            self.columns.get(place.saturating_sub(age)).copied().unwrap_or_default()
        });
        let way: f32 = window.iter().map(|[_, speed, ..]: &[f32; INPUTS]| speed).sum();
        let direction = if way < 0.0 { -1.0 } else { 1.0 };
        for [_, speeds @ ..] in &mut window {
            for speed in speeds {
                *speed *= direction;
            }
        }
        (window, direction)
    }

    /// The network's output at a sample: the torque over its deviation.
    fn output(&self, network: &Network, place: usize) -> f64 {
        let (window, direction) = self.window(place);
        let output = network.evaluate(window.as_flattened()).first().copied().unwrap_or_default();
        f64::from(direction * output)
    }
}

/// A part of the set as windows.
struct Part<'a> {
    series: &'a [Series],
    /// Group, sample, target.
    rows: Vec<(usize, usize, f32)>,
}

impl Source for Part<'_> {
    fn count(&self) -> u64 {
        self.rows.len() as u64
    }

    fn add(&self, row: u64, _draw: &mut Draw, windows: &mut Windows) {
        let Some(&(group, place, target)) = self.rows.get(row as usize) else { return };
        let Some(series) = self.series.get(group) else { return };
        let (window, direction) = series.window(place);
        windows.columns.extend(window.as_flattened());
        windows.targets.push(direction * target);
    }
}

/// Group, sample and torque over its deviation.
fn rows(set: &FrictionSet, split: Split) -> Vec<(usize, usize, f32)> {
    let [.., scale] = set.scales;
    let row = |sample: Sample| {
        let [.., torque] = &set.groups.get(sample.group)?.clean;
        // As the set's files have it.
        let torque_nm = *torque.get(sample.place)? as f32;
        Some((sample.group, sample.place, (f64::from(torque_nm) / scale.deviation) as f32))
    };
    set.samples(split).filter_map(row).collect()
}

/// A test group over time: load in N, sliding speed in m/s, torques in N m.
#[derive(Clone, Debug)]
pub struct TestGroup {
    /// Where it comes from.
    pub source: String,
    /// Time in s.
    pub time_s: Vec<f64>,
    /// Load after cleaning.
    pub load_n: Vec<f64>,
    /// Sliding speed after cleaning.
    pub sliding_speed_m_s: Vec<f64>,
    /// As the sensor logs it.
    pub measured_nm: Vec<f64>,
    /// Without outliers and noise, as far as cleaning takes them out.
    pub cleaned_nm: Vec<f64>,
    /// What the sensor would show without them; none of a measured log.
    pub truth_nm: Option<Vec<f64>>,
    /// What the networks say.
    pub predicted_nm: Vec<f64>,
}

/// Every sample of the test groups as the collision and the friction network see it; `truth` as for [`train_on`].
pub fn test_groups(
    set: &FrictionSet,
    truth: &[MeasuredLog],
    [collision, friction]: [&Network; 2],
    features: &FloatFeatures,
) -> Vec<TestGroup> {
    let [.., scale] = set.scales;
    let one = |(number, group): (usize, &Group)| {
        let series = Series::of(group, collision, features);
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

/// What a training on the rig's groups gave.
#[derive(Clone, Debug)]
pub struct RigOutcome {
    /// The network; its output is the torque over its deviation.
    pub network: Network,
    /// Every epoch.
    pub history: Vec<Progress>,
    /// Torque in N m on the test groups against the noise-free truth, where there is one.
    pub truth: Option<Errors>,
    /// The same against the cleaned torque.
    pub cleaned: Errors,
}

/// Trains the friction network behind a collision network on a set; `truth` are the same groups without noise.
pub fn train_on(
    set: &FrictionSet,
    truth: &[MeasuredLog],
    collision: &Network,
    features: &FloatFeatures,
    recipe: &Recipe,
    report: &mut dyn FnMut(Progress),
) -> RigOutcome {
    let series: Vec<Series> = set.groups.iter().map(|group| Series::of(group, collision, features)).collect();
    let part = |split| Part { series: &series, rows: rows(set, split) };
    let (training, validation) = (part(Split::Training), part(Split::Validation));
    let mut fit = Training::new(recipe, friction(), (&training, &validation), Loss::Difference, LANE);
    while !fit.is_done() {
        report(fit.epoch());
    }
    let network = fit.finish().float;
    let [.., scale] = set.scales;
    let test = part(Split::Test);
    let found: Vec<(usize, usize, f64, f64)> = (test.rows.par_iter())
        .map(|&(group, place, target)| {
            let output = series.get(group).map_or(0.0, |series| series.output(&network, place));
            (group, place, output * scale.deviation, f64::from(target) * scale.deviation)
        })
        .collect();
    let exact = |group: usize, place: usize| {
        truth.get(group)?.channels.get(&Channel::FrictionTorque)?.get(place).copied()
    };
    let pairs: Option<Vec<(f64, f64)>> =
        found.iter().map(|&(group, place, torque, _)| Some((exact(group, place)?, torque))).collect();
    RigOutcome {
        network,
        history: fit.history().to_vec(),
        truth: pairs.filter(|pairs| !pairs.is_empty()).map(|pairs| Errors::of(pairs.into_iter())),
        cleaned: Errors::of(found.iter().map(|&(_, _, torque, cleaned)| (cleaned, torque))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::friction_source::from_rig;
    use crate::ranges::{RangeKind, header};
    use inference::Bearing;

    #[test]
    fn the_law_is_inverted_over_the_whole_range_of_loads() {
        for bearing in Bearing::ALL {
            let features = FloatFeatures::of(&header(bearing, RangeKind::Rig));
            let law = normal_law(bearing, CLEARANCE_M, f64::from(features.latch_floor_m_s));
            for load in [10.0, 1e3, 1e5, 2.4e5] {
                let deformation = deformation_m(&features, load);
                assert!(
                    deformation < 0.95 * f64::from(features.deformation_m.high),
                    "{load} N: {deformation} m"
                );
                assert!((law.force_n(deformation, 0.0, 0.0) / load - 1.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn loads_beyond_the_range_are_refused_and_those_of_the_published_test_are_not() {
        for bearing in Bearing::ALL {
            let name = format!("friction-rig-{}", bearing.name());
            let logs = from_rig(&name, bearing, 1).unwrap();
            let features = FloatFeatures::of(&header(bearing, RangeKind::Rig));
            let mut set = FrictionSet::new(logs, SMOOTHING_S, 1).unwrap();
            assert!(check_loads(&set, &features).is_ok());
            set.groups[4].clean[0][77] = -1e6;
            let refused = check_loads(&set, &features).unwrap_err().to_string();
            assert!(refused.contains(&set.groups[4].source) && refused.contains("1000000 N"), "{refused}");
        }
    }
}
