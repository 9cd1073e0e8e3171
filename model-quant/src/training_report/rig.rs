//! The rig's friction networks against the rig's records: what stands for the paper's Fig. 11.
//!
//! `model-quant train --friction rig` leaves both networks in `BEARING.rig.json`. The groups are recorded again from the
//! preset of the bearing and the recipe's seed; a file whose networks were trained on other groups is refused. Every sample of
//! the test groups counts, in N m.

use super::{FileError, ReportError};
use crate::checkpoint::bearing_named;
use crate::dataset::friction::FrictionSet;
use crate::dataset::friction_source::{from_rig, truth_of_rig};
use crate::errors::Errors;
use crate::features::FloatFeatures;
use crate::network::{Network, Shape};
use crate::ranges::header;
use crate::recipe::Recipe;
use crate::rig::{SMOOTHING_S, TestGroup, test_groups};
use crate::shapes::collision;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Least R^2 against the truth without noise.
pub const GOAL_R2: f64 = 0.999;
/// Largest share that the scale of the torque may differ by: the file's decimals.
const SAME: f64 = 1e-9;

#[derive(Deserialize)]
struct File {
    bearing: String,
    groups: Vec<Dealt>,
    scales: [Deviation; 3],
    recipe: Recipe,
    shape: Shape,
    parameters: Vec<f32>,
    collision_parameters: Vec<f32>,
}

#[derive(PartialEq, Deserialize)]
struct Dealt {
    source: String,
    part: String,
}

#[derive(Deserialize)]
struct Deviation {
    deviation: f64,
}

/// Errors of a torque in N m.
#[derive(Clone, Debug, Serialize)]
pub struct TorqueErrors {
    /// Samples.
    pub samples: usize,
    /// Share of the variance explained.
    pub r2: f64,
    /// Mean absolute error.
    pub mae_nm: f64,
    /// Largest absolute error.
    pub largest_nm: f64,
}

impl TorqueErrors {
    fn of(groups: &[TestGroup], truth: fn(&TestGroup) -> &[f64]) -> Self {
        let pairs = groups.iter().flat_map(|group| truth(group).iter().zip(&group.predicted_nm));
        let errors = Errors::of(pairs.map(|(truth, found)| (*truth, *found)));
        let Errors { rows, r2, mae_n, largest_n, .. } = errors;
        Self { samples: rows, r2, mae_nm: mae_n, largest_nm: largest_n }
    }
}

/// Errors over a test group, or over all.
#[derive(Clone, Debug, Serialize)]
pub struct GroupFacts {
    /// The group, or `all`.
    pub group: String,
    /// Against what the sensor would show without noise, resolution and outliers.
    pub truth: TorqueErrors,
    /// Against the cleaned torque.
    pub cleaned: TorqueErrors,
}

/// A group's name with its direction first.
pub(super) fn label(group: &TestGroup) -> String {
    let source = group.source.as_str();
    let (load, direction) = source.split_once(", ").unwrap_or((source, "group"));
    format!("{direction}, {}", if load == "-0 N" { "0 N" } else { load })
}

/// A rig's networks on its test groups.
#[derive(Clone, Debug, Serialize)]
pub struct RigFacts {
    /// Bearing.
    pub bearing: &'static str,
    /// Recipe of both networks.
    pub recipe: Recipe,
    /// Over all test groups, then each.
    pub errors: Vec<GroupFacts>,
    /// Whether R^2 against the truth over all groups reaches [`GOAL_R2`].
    pub met: bool,
    /// The test groups.
    #[serde(skip)]
    pub groups: Vec<TestGroup>,
}

impl RigFacts {
    /// Reads the networks of a rig and asks them for the torque of its test groups.
    ///
    /// # Errors
    ///
    /// The file cannot be read, is none or is of other groups; the rig cannot be recorded.
    pub fn read(path: &Path) -> Result<Self, ReportError> {
        let expected = "networks of the rig, as `model-quant train --friction rig` writes them";
        let file: File = FileError::json(path, &FileError::text(path)?, expected)?;
        let refused = |found: String, expected: &str| FileError::content(path, found, expected);
        let bearing = bearing_named(&file.bearing)
            .ok_or_else(|| refused(format!("bearing `{}`", file.bearing), "`babbitt` or `plastic`"))?;
        let network = |shape: Shape, parameters: &[f32]| {
            let found = shape.check().map_err(|error| error.to_string());
            let (count, given) = (found.map(|()| shape.parameters()), parameters.len());
            match count {
                Ok(count) if count == given => {
                    let mut network = Network::zero(shape);
                    let slots = network.slices_mut().flatten();
                    slots.zip(parameters).for_each(|(slot, value)| *slot = *value);
                    Ok(network)
                }
                Ok(count) => Err(refused(format!("{given} parameters"), &format!("{count}"))),
                Err(found) => Err(refused(found, expected)),
            }
        };
        if file.shape != crate::shapes::friction() {
            return Err(refused("another shape".into(), "the shape of the friction network").into());
        }
        let friction = network(file.shape, &file.parameters)?;
        let collision = network(collision(), &file.collision_parameters)?;
        let (preset, seed) = (format!("friction-rig-{}", bearing.name()), file.recipe.seed);
        let set = FrictionSet::new(from_rig(&preset, bearing, seed)?, SMOOTHING_S, seed)?;
        let dealt = set.groups.iter();
        let dealt = dealt.map(|g| Dealt { source: g.source.clone(), part: g.split.name().to_owned() });
        let alike = set.scales.iter().zip(&file.scales);
        let alike = alike
            .fold(true, |all, (here, there)| all && (here.deviation / there.deviation - 1.0).abs() <= SAME);
        if !alike || !dealt.eq(file.groups) {
            return Err(refused("other groups".into(), &format!("those of {preset} with seed {seed}")).into());
        }
        let features = FloatFeatures::of(&header(bearing, file.recipe.range));
        let truth = truth_of_rig(&preset, seed)?;
        let groups = test_groups(&set, &truth, [&collision, &friction], &features);
        let facts = |name: &str, groups: &[TestGroup]| GroupFacts {
            group: name.to_owned(),
            truth: TorqueErrors::of(groups, |g| g.truth_nm.as_deref().unwrap_or_default()),
            cleaned: TorqueErrors::of(groups, |g| &g.cleaned_nm),
        };
        let all = facts("all", &groups);
        let met = all.truth.r2 >= GOAL_R2;
        let each = groups.iter().map(|group| facts(&label(group), core::slice::from_ref(group)));
        let errors = core::iter::once(all).chain(each).collect();
        Ok(Self { bearing: bearing.name(), recipe: file.recipe, errors, met, groups })
    }
}
