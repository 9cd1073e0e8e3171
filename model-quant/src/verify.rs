//! Image against float networks against laws, on rows that no training saw.
//!
//! Every row is preceded by its history, and the networks run as streams, as they do on the controller; only the
//! estimate after the newest column counts. The friction figures are those of the whole chain: the friction network
//! behind the collision network.

use crate::checkpoint::Checkpoint;
use crate::draw::{Draw, Purpose};
use crate::errors::Errors;
use crate::features::FloatFeatures;
use crate::float_pair::{FloatEstimate, FloatPair};
use crate::goals::{Goal, goals};
use crate::held_out::HeldOut;
use crate::image::{AnyModel, AnyPair};
use crate::peers::PeerVerdict;
use crate::rows::{Row, rows};
use crate::window::history;
use inference::image::{CRC_LENGTH, check_sum};
use inference::{ContactState, Estimate, ImageError, WINDOW};
use rayon::prelude::*;
use serde::Serialize;

/// Rows of the test set.
pub const TEST_ROWS: usize = 20_000;
/// Upper ends in N of the bands of the normal force that errors are given for; the lower end of the first is 0, and a
/// last band goes up to the end of the model's range.
pub const BANDS_N: [f64; 5] = [100.0, 1000.0, 3000.0, 7000.0, 14_000.0];
/// The working points of the bench: normal force in N and largest magnitude of the rate ratio.
pub const WORKING_FORCE_N: [f64; 2] = [1000.0, 14_000.0];
/// See [`WORKING_FORCE_N`].
pub const WORKING_RATIO: f64 = 2.0;

/// Errors of one network in one band of the law's normal force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Band {
    /// Upper end of the band in N.
    pub up_to_n: f64,
    /// Rows in the band.
    pub rows: usize,
    /// Mean magnitude of the law's force in N.
    pub mean_force_n: f64,
    /// Mean absolute error of the float networks in N.
    pub mae_float_n: f64,
    /// Mean absolute error of the image in N.
    pub mae_n: f64,
    /// Largest absolute error of the image in N.
    pub largest_n: f64,
    /// Mean absolute difference between image and float networks in N.
    pub mae_quantisation_n: f64,
    /// Largest absolute difference between image and float networks in N.
    pub largest_quantisation_n: f64,
}

/// What verification found for one network of one bearing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// Name of the bearing.
    pub bearing: &'static str,
    /// `collision` or `friction`.
    pub network: &'static str,
    /// Share of the variance of the law's force that the float networks explain.
    pub r2_float: f64,
    /// The same for the image.
    pub r2_quantised: f64,
    /// Mean absolute error of the image against the law in N.
    pub mae_n: f64,
    /// The same as a torque on the bench's bearing radius in N m; of the friction network alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mae_nm: Option<f64>,
    /// 99th percentile of the law's force in N.
    pub p99_force_n: f64,
    /// Mean absolute error of the image over that percentile.
    pub mae_share_of_p99: f64,
    /// Largest absolute error of the image against the law in N.
    pub largest_n: f64,
    /// Mean absolute difference between image and float networks in N.
    pub mae_quantisation_n: f64,
    /// Largest absolute difference between image and float networks in N.
    pub largest_quantisation_n: f64,
    /// Median relative error of the image at the bench's working points.
    pub working_error_median: f64,
    /// 95th percentile of the same.
    pub working_error_p95: f64,
    /// Largest force that the image gives without contact, in N.
    pub zero_contact_output: f64,
    /// Whether the check sum at the end of the image is that of its bytes.
    pub image_crc_ok: bool,
    /// Whether the image was made from this checkpoint.
    pub image_matches_checkpoint: bool,
    /// Share of the rows in which an activation was clipped.
    pub saturated_share: f64,
    /// Rows tested.
    pub rows: usize,
    /// Errors by band.
    pub bands: Vec<Band>,
    /// Errors over the contacts of held-out bench runs, where they were measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub held_out: Option<HeldOut>,
    /// The figures held against their goals.
    pub goals: Vec<Goal>,
    /// Other runtimes on the same parameters.
    pub peers: Vec<PeerVerdict>,
}

impl Verdict {
    fn judged(mut self) -> Self {
        self.goals = goals(&self);
        self
    }

    /// The verdict with the errors over held-out bench runs, which have goals of their own.
    #[must_use]
    pub fn with_held_out(self, held_out: HeldOut) -> Self {
        Self { held_out: Some(held_out), ..self }.judged()
    }
}

struct Sample {
    law: [f64; 2],
    float: [f64; 2],
    image: [f64; 2],
    gap: f64,
    saturated: bool,
    working: bool,
}

fn forces(estimate: &Estimate) -> [f64; 2] {
    [estimate.normal_force_mn, estimate.friction_force_mn].map(|force_mn| f64::from(force_mn) / 1000.0)
}

fn float_forces(estimate: &FloatEstimate) -> [f64; 2] {
    [f64::from(estimate.normal_force_n), f64::from(estimate.friction_force_n)]
}

/// The first rows of a checkpoint's test set with their histories.
pub fn test_set(checkpoint: &Checkpoint, count: usize) -> Vec<(Row, [ContactState; WINDOW])> {
    let recipe = &checkpoint.recipe;
    let features = FloatFeatures::of(&checkpoint.header());
    (rows(checkpoint.bearing, recipe.range, recipe.seed, Purpose::TestRows, count)
        .into_par_iter()
        .enumerate())
    .map(|(index, row)| {
        let mut draw = Draw::new(recipe.seed, Purpose::FixedHistories, 2 << 32 | index as u64);
        (row, history(&features, &row, &mut draw))
    })
    .collect()
}

/// Normal and friction force in N that float networks give after each history.
pub(crate) fn float_forces_after(set: &[(Row, [ContactState; WINDOW])], pair: &FloatPair) -> Vec<[f64; 2]> {
    set.par_iter()
        .map_init(
            || pair.clone(),
            |pair, (_, states)| {
                pair.reset();
                float_forces(&states.map(|state| pair.push(&state))[WINDOW - 1])
            },
        )
        .collect()
}

/// The same that an image gives.
pub(crate) fn image_forces_after(
    set: &[(Row, [ContactState; WINDOW])],
    model: AnyModel<'_>,
) -> Vec<[f64; 2]> {
    set.par_iter()
        .map_init(
            || AnyPair::new(model),
            |pair, (_, states)| {
                pair.reset();
                forces(&states.map(|state| pair.push(&state))[WINDOW - 1])
            },
        )
        .collect()
}

/// Runs image and float networks over the test rows; collision first, friction second. Peers and held-out runs are left to
/// the caller.
pub fn verify(checkpoint: &Checkpoint, training_id: u64, image: &[u8]) -> Result<[Verdict; 2], ImageError> {
    let model = AnyModel::load(image)?;
    let image_crc_ok = (image.split_last_chunk::<CRC_LENGTH>())
        .is_some_and(|(body, sum)| check_sum(body).to_le_bytes() == *sum);
    let header = model.header();
    let features = FloatFeatures::of(&header);
    let float = FloatPair::of(checkpoint, training_id);
    let set = test_set(checkpoint, TEST_ROWS);
    let samples: Vec<Sample> = (set.par_iter())
        .map_init(
            || (float.clone(), AnyPair::new(model)),
            |(float, image), (row, states)| {
                float.reset();
                image.reset();
                let float = float_forces(&states.map(|state| float.push(&state))[WINDOW - 1]);
                let last = states.map(|state| image.push(&state))[WINDOW - 1];
                let gap = ContactState { deformation_m: -row.state.deformation_m, ..row.state };
                let [without_contact, sliding] = forces(&image.push(&gap));
                Sample {
                    law: [row.normal_force_n, row.friction_force_n],
                    float,
                    image: forces(&last),
                    gap: without_contact.abs().max(sliding.abs()),
                    saturated: last.saturated > 0,
                    working: is_working_point(&features, row),
                }
            },
        )
        .collect();
    let verdict = |which: usize, network: &'static str| {
        let errors = |pick: fn(&Sample) -> [f64; 2]| {
            Errors::of(samples.iter().map(move |s| (s.law[which], pick(s)[which])))
        };
        let (image, float) = (errors(|s| s.image), errors(|s| s.float));
        Verdict {
            bearing: checkpoint.bearing.name(),
            network,
            r2_float: float.r2,
            r2_quantised: image.r2,
            mae_n: image.mae_n,
            mae_nm: (network == "friction").then(|| image.mae_nm()),
            p99_force_n: image.p99_force_n,
            mae_share_of_p99: image.mae_share_of_p99,
            largest_n: image.largest_n,
            mae_quantisation_n: mean(samples.iter().map(|s| (s.float[which] - s.image[which]).abs())),
            largest_quantisation_n: (samples.iter())
                .fold(0.0, |largest, s| (s.float[which] - s.image[which]).abs().max(largest)),
            working_error_median: relative_error(&samples, which, 0.5),
            working_error_p95: relative_error(&samples, which, 0.95),
            zero_contact_output: samples.iter().fold(0.0, |largest, s| s.gap.max(largest)),
            image_crc_ok,
            image_matches_checkpoint: header.training_id == training_id,
            saturated_share: mean(samples.iter().map(|s| f64::from(u8::from(s.saturated)))),
            rows: samples.len(),
            bands: bands(&samples, which, f64::from(features.normal_force_n.high)),
            held_out: None,
            goals: Vec::new(),
            peers: Vec::new(),
        }
    };
    Ok([verdict(0, "collision"), verdict(1, "friction")].map(Verdict::judged))
}

fn is_working_point(features: &FloatFeatures, row: &Row) -> bool {
    let [low, high] = WORKING_FORCE_N;
    let ratio = f64::from(features.rate_ratio_of(&row.state));
    (low..=high).contains(&row.normal_force_n) && ratio.abs() <= WORKING_RATIO
}

pub(crate) fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0usize), |(sum, count), value| (sum + value, count + 1));
    if count == 0 { 0.0 } else { sum / count as f64 }
}

fn relative_error(samples: &[Sample], which: usize, quantile: f64) -> f64 {
    let mut errors: Vec<f64> = (samples.iter())
        .filter(|s| s.working && s.law[which] != 0.0)
        .map(|s| ((s.image[which] - s.law[which]) / s.law[which]).abs())
        .collect();
    errors.sort_by(f64::total_cmp);
    let position = (quantile * errors.len().saturating_sub(1) as f64) as usize;
    errors.get(position).copied().unwrap_or(0.0)
}

fn bands(samples: &[Sample], which: usize, highest_n: f64) -> Vec<Band> {
    let mut low = -1.0;
    (BANDS_N.into_iter().chain([highest_n]))
        .map(|up_to_n| {
            let inside = || samples.iter().filter(|s| s.law[0] > low && s.law[0] <= up_to_n);
            let error = |s: &Sample| (s.law[which] - s.image[which]).abs();
            let quantisation = |s: &Sample| (s.float[which] - s.image[which]).abs();
            let band = Band {
                up_to_n,
                rows: inside().count(),
                mean_force_n: mean(inside().map(|s| s.law[which].abs())),
                mae_float_n: mean(inside().map(|s| (s.law[which] - s.float[which]).abs())),
                mae_n: mean(inside().map(error)),
                largest_n: inside().map(error).fold(0.0, f64::max),
                mae_quantisation_n: mean(inside().map(quantisation)),
                largest_quantisation_n: inside().map(quantisation).fold(0.0, f64::max),
            };
            low = up_to_n;
            band
        })
        .collect()
}
