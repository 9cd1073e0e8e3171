//! Predictions of the rig's friction networks compared with the rig's records, in place of the
//! paper's Fig. 11.
//!
//! `model-quant train --friction rig` writes both networks to `BEARING.rig.json`. The groups are
//! simulated again from the bearing's preset and the recipe's seed; a file whose networks were
//! trained on other groups is refused. Errors are in N m over every sample of the test groups.

use super::ReportError;
use crate::data::features::FloatFeatures;
use crate::data::file_io::FileError;
use crate::data::friction::FrictionSet;
use crate::data::friction_source::{from_rig, truth_of_rig};
use crate::data::ranges::header;
use crate::evaluate::errors::Errors;
use crate::evaluate::goals::FRICTION_R2;
use crate::evaluate::rig::{TestGroup, test_groups};
use crate::network::recipe::Recipe;
use crate::network::shipped::bearing_names;
use crate::network::{Network, NetworkKind, Shape};
use crate::train::rig::SMOOTHING_S;
use inference::BearingMaterial;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Largest relative difference of the torque's scale; the file has decimal numbers.
const SCALE_TOLERANCE: f64 = 1e-9;

#[derive(Deserialize)]
struct File {
    bearing: String,
    groups: Vec<GroupSplit>,
    scales: [Deviation; 3],
    recipe: Recipe,
    shape: Shape,
    parameters: Vec<f32>,
    collision_parameters: Vec<f32>,
}

#[derive(PartialEq, Deserialize)]
struct GroupSplit {
    source: String,
    part: String,
}

#[derive(Deserialize)]
struct Deviation {
    deviation: f64,
}

/// Torque errors in N m.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct TorqueErrors {
    /// Number of samples.
    pub samples: usize,
    /// Share of the variance that is explained (R^2).
    pub r2: f64,
    /// Mean absolute error.
    pub mae_nm: f64,
    /// Largest absolute error.
    pub largest_nm: f64,
}

impl TorqueErrors {
    fn from_groups(groups: &[TestGroup], truth: fn(&TestGroup) -> &[f64]) -> Self {
        let pairs = groups.iter().flat_map(|group| truth(group).iter().zip(&group.predicted_nm));
        let errors = Errors::from_pairs(pairs.map(|(truth, found)| (*truth, *found)));
        let Errors { rows, r2, mae_n, largest_n, .. } = errors;
        Self { samples: rows, r2, mae_nm: mae_n, largest_nm: largest_n }
    }
}

/// Errors over one test group, or over all.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct GroupFacts {
    /// The group, or `all`.
    pub group: String,
    /// Errors against the sensor value without noise, resolution and outliers.
    pub truth: TorqueErrors,
    /// Errors against the cleaned torque.
    pub cleaned: TorqueErrors,
}

/// Name of a group with its direction first.
pub(super) fn label(group: &TestGroup) -> String {
    let source = group.source.as_str();
    let (load, direction) = source.split_once(", ").unwrap_or((source, "group"));
    format!("{direction}, {}", if load == "-0 N" { "0 N" } else { load })
}

/// Figures of a rig's networks on its test groups.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct RigFacts {
    /// Bearing.
    pub bearing: &'static str,
    /// Recipe of both networks.
    pub recipe: Recipe,
    /// Errors over all test groups, then over each.
    pub errors: Vec<GroupFacts>,
    /// True if R^2 against the torque without noise over all groups reaches [`FRICTION_R2`].
    pub met: bool,
    /// The test groups.
    #[serde(skip)]
    pub groups: Vec<TestGroup>,
}

impl RigFacts {
    /// Reads the networks of a rig and evaluates them on its test groups.
    ///
    /// # Errors
    ///
    /// The file cannot be read, has other content or belongs to other groups, or the rig cannot be
    /// simulated.
    pub(crate) fn read(path: &Path) -> Result<Self, ReportError> {
        let expected = "networks of the rig, as `model-quant train --friction rig` writes them";
        let file: File = FileError::json(path, &FileError::text(path)?, expected)?;
        let refused = |found: String, expected: &str| FileError::content(path, found, expected);
        let bearing = BearingMaterial::from_name(&file.bearing)
            .ok_or_else(|| refused(format!("bearing `{}`", file.bearing), &bearing_names()))?;
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
        if file.shape != NetworkKind::Friction.shape() {
            return Err(refused("another shape".into(), "the shape of the friction network").into());
        }
        let friction = network(file.shape, &file.parameters)?;
        let collision = network(NetworkKind::Collision.shape(), &file.collision_parameters)?;
        let (preset, seed) = (format!("friction-rig-{}", bearing.name()), file.recipe.seed);
        let set = FrictionSet::new(from_rig(&preset, bearing, seed)?, SMOOTHING_S, seed)?;
        let groups = (set.groups.iter())
            .map(|group| GroupSplit { source: group.source.clone(), part: group.split.name().to_owned() });
        let mut scales = set.scales.iter().zip(&file.scales);
        let has_same_scales =
            scales.all(|(here, there)| (here.deviation / there.deviation - 1.0).abs() <= SCALE_TOLERANCE);
        if !has_same_scales || !groups.eq(file.groups) {
            return Err(refused("other groups".into(), &format!("those of {preset} with seed {seed}")).into());
        }
        let features = FloatFeatures::from_header(&header(bearing, file.recipe.range));
        let truth = truth_of_rig(&preset, seed)?;
        let groups = test_groups(&set, &truth, [&collision, &friction], &features);
        let facts = |name: &str, groups: &[TestGroup]| GroupFacts {
            group: name.to_owned(),
            truth: TorqueErrors::from_groups(groups, |g| g.truth_nm.as_deref().unwrap_or_default()),
            cleaned: TorqueErrors::from_groups(groups, |g| &g.cleaned_nm),
        };
        let all = facts("all", &groups);
        let met = all.truth.r2 >= FRICTION_R2;
        let each = groups.iter().map(|group| facts(&label(group), core::slice::from_ref(group)));
        let errors = core::iter::once(all).chain(each).collect();
        Ok(Self { bearing: bearing.name(), recipe: file.recipe, errors, met, groups })
    }
}
