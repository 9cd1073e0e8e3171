//! Training of the rig's friction network on the friction set, with the force of a collision
//! network as input.
//!
//! A window has 8 columns, 20 ms apart, so that it covers the lag of the rig (30 to 80 ms). The
//! collision network of range `rig` (up to 240 kN) gets the static state that carries the group's
//! load (clearance .5 mm) and gives the normal force. A column has the root of that force relative
//! to the root of the range's highest force, the sliding speed relative to 10 mm/s, and `v/(|v| +
//! s)` for `s` of .3 and 3 mm/s.
//!
//! Friction is odd in the sliding direction and does not depend on the loading direction. Twelve
//! groups are too few to learn this, so both are built in: a window that slides backward is
//! inverted, speeds and torque, and the load enters by its magnitude. The target is the cleaned
//! torque divided by its standard deviation in the training groups (the paper's eq. 9 without the
//! mean, which would not be odd).

use crate::data::draw::Draw;
use crate::data::features::FloatFeatures;
use crate::data::friction::{FrictionSet, Group, Sample};
use crate::data::friction_source::FrictionError;
use crate::data::split::Split;
use crate::data::static_deformation::{CLEARANCE_M, static_deformation_m};
use crate::network::recipe::Recipe;
use crate::network::{Network, NetworkKind};
use crate::train::{Loss, Progress, Source, Training, Windows};
use inference::features::FRICTION_INPUTS;
use inference::{ContactState, WINDOW};
use rayon::prelude::*;

/// Time between two columns in s.
pub(crate) const SPACING_S: f64 = 0.020;
/// Radius in m of the sliding surface.
pub(crate) const RADIUS_M: f64 = 0.07;
/// Full scale of the sliding speed in m/s.
const SPEED_M_S: f64 = 0.010;
/// Scales of the sliding speed in m/s.
const SCALES_M_S: [f64; 2] = [0.3e-3, 3e-3];
/// Values of a column.
const INPUTS: usize = FRICTION_INPUTS;
/// Standard deviation in s of the average's weights that the groups are cleaned with.
pub(crate) const SMOOTHING_S: f64 = 0.010;
/// Number of this training's random streams, apart from those of the collision network.
const STREAM: u64 = 2;

/// Static deformation in m under a force in N; the largest of the range if the force exceeds it.
pub(crate) fn deformation_m(features: &FloatFeatures, force_n: f64) -> f64 {
    let deepest_m = f64::from(features.deformation_m.high);
    static_deformation_m(features.bearing, CLEARANCE_M, force_n, deepest_m).unwrap_or(deepest_m)
}

/// Refuses a set with loads above the force range, because the collision network cannot distinguish
/// them.
///
/// # Errors
///
/// The first group with such a load.
pub(crate) fn check_loads(set: &FrictionSet, features: &FloatFeatures) -> Result<(), FrictionError> {
    let deepest_m = f64::from(features.deformation_m.high);
    for group in &set.groups {
        let [load, ..] = &group.clean;
        let largest_n = load.iter().fold(0.0_f64, |largest, load| largest.max(load.abs()));
        if static_deformation_m(features.bearing, CLEARANCE_M, largest_n, deepest_m).is_none() {
            let max_n = features.bearing.normal_law(CLEARANCE_M, 1.0).force_n(deepest_m, 0.0, 0.0);
            return Err(FrictionError::Content {
                file: group.source.clone(),
                found: format!("a load of {largest_n:.0} N"),
                expected: format!("at most the {max_n:.0} N of the range of the rig's networks"),
            });
        }
    }
    Ok(())
}

/// Normal force in N that a collision network gives in the static state under a load.
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

/// Columns of a group, one for each sample, in order of time.
pub(crate) struct Series {
    columns: Vec<[f32; INPUTS]>,
    /// Samples between two columns of a window.
    spacing: usize,
}

impl Series {
    pub(crate) fn from_group(group: &Group, collision: &Network, features: &FloatFeatures) -> Self {
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

    /// Window that ends at a sample, inverted to slide forward, and its original direction. The
    /// first sample is repeated before the start.
    fn window(&self, place: usize) -> ([[f32; INPUTS]; WINDOW], f32) {
        let mut window = core::array::from_fn(|column| {
            let age = (WINDOW - 1 - column) * self.spacing;
            self.columns.get(place.saturating_sub(age)).copied().unwrap_or_default()
        });
        let displacement: f32 = window.iter().map(|[_, speed, ..]: &[f32; INPUTS]| speed).sum();
        let direction = if displacement < 0.0 { -1.0 } else { 1.0 };
        for [_, speeds @ ..] in &mut window {
            for speed in speeds {
                *speed *= direction;
            }
        }
        (window, direction)
    }

    /// Output of the network at a sample: torque divided by its standard deviation.
    pub(crate) fn output(&self, network: &Network, place: usize) -> f64 {
        let (window, direction) = self.window(place);
        let output = network.evaluate(window.as_flattened()).first().copied().unwrap_or_default();
        f64::from(direction * output)
    }
}

/// Windows of one part of the set.
struct RigWindows<'a> {
    series: &'a [Series],
    /// Group, sample, target.
    rows: Vec<(usize, usize, f32)>,
}

impl Source for RigWindows<'_> {
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

/// Group, sample and normalised torque of every drawn sample of a part.
pub(crate) fn targets(set: &FrictionSet, split: Split) -> Vec<(usize, usize, f32)> {
    let [.., scale] = set.scales;
    let row = |sample: Sample| {
        let [.., torque] = &set.groups.get(sample.group)?.clean;
        // Rounded to f32 as in the files of the set.
        let torque_nm = *torque.get(sample.place)? as f32;
        Some((sample.group, sample.place, (f64::from(torque_nm) / scale.deviation) as f32))
    };
    set.samples(split).filter_map(row).collect()
}

/// Result of a training on the rig's groups.
#[derive(Clone, Debug)]
pub struct RigOutcome {
    /// Friction network; its output is the torque divided by its standard deviation.
    pub network: Network,
    /// Every epoch.
    pub history: Vec<Progress>,
}

/// Trains the friction network of the rig on a set, with the forces of `collision`.
pub fn train_on(
    set: &FrictionSet,
    collision: &Network,
    features: &FloatFeatures,
    recipe: &Recipe,
    report: &mut dyn FnMut(Progress),
) -> RigOutcome {
    let series: Vec<Series> =
        set.groups.iter().map(|group| Series::from_group(group, collision, features)).collect();
    let part = |split| RigWindows { series: &series, rows: targets(set, split) };
    let (training, validation) = (part(Split::Training), part(Split::Validation));
    let mut fit = Training::new(
        recipe,
        NetworkKind::Friction.shape(),
        (&training, &validation),
        Loss::Difference,
        STREAM,
    );
    while !fit.is_done() {
        report(fit.epoch());
    }
    RigOutcome { network: fit.finish().float, history: fit.history().to_vec() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::friction_source::from_rig;
    use crate::data::ranges::{RangeKind, header};
    use inference::BearingMaterial;

    #[test]
    fn the_law_is_inverted_over_the_whole_range_of_loads() {
        for bearing in BearingMaterial::ALL {
            let features = FloatFeatures::from_header(&header(bearing, RangeKind::Rig));
            let law = bearing.normal_law(CLEARANCE_M, f64::from(features.latch_floor_m_s));
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
        for bearing in BearingMaterial::ALL {
            let name = format!("friction-rig-{}", bearing.name());
            let logs = from_rig(&name, bearing, 1).unwrap();
            let features = FloatFeatures::from_header(&header(bearing, RangeKind::Rig));
            let mut set = FrictionSet::new(logs, SMOOTHING_S, 1).unwrap();
            assert!(check_loads(&set, &features).is_ok());
            set.groups[4].clean[0][77] = -1e6;
            let refused = check_loads(&set, &features).unwrap_err().to_string();
            assert!(refused.contains(&set.groups[4].source) && refused.contains("1000000 N"), "{refused}");
        }
    }
}
