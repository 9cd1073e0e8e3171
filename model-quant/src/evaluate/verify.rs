//! Verification: image against float networks and laws, on rows that no training used.
//!
//! Every row has a history, and the networks run as streams, as on the controller; only the
//! estimate after the newest column counts. The friction figures are those of the complete chain,
//! in which the collision network supplies the normal force.

use super::errors::Errors;
use super::held_out;
use super::test_set::{TEST_ROWS, draw_test_set, float_forces_n, forces_n};
use super::verdict::{BANDS_N, Band, Verdict};
use crate::data::bench_runs::RunError;
use crate::data::features::FloatFeatures;
use crate::data::rows::Row;
use crate::data::statistics::{mean, quantile};
use crate::network::checkpoint::Checkpoint;
use crate::network::float_pair::FloatPair;
use crate::quantise::image::{AnyModel, AnyPair};
use inference::image::{CRC_LENGTH, checksum};
use inference::{ContactState, ImageError, WINDOW};
use rayon::prelude::*;

/// Normal force in N at the bench's working points.
pub(crate) const WORKING_FORCE_N: [f64; 2] = [1000.0, 14_000.0];
/// Largest magnitude of the rate ratio at the working points.
pub(crate) const WORKING_RATIO: f64 = 2.0;

struct Sample {
    law: [f64; 2],
    float: [f64; 2],
    image: [f64; 2],
    /// Largest magnitude of a force in N at the same state without contact.
    without_contact_n: f64,
    saturated: bool,
    working: bool,
}

/// Evaluates image and float networks on the test rows; collision first, friction second. Other
/// runtimes and held-out runs are not included.
pub fn verify(checkpoint: &Checkpoint, training_id: u64, image: &[u8]) -> Result<[Verdict; 2], ImageError> {
    let model = AnyModel::load(image)?;
    let image_crc_ok = (image.split_last_chunk::<CRC_LENGTH>())
        .is_some_and(|(body, sum)| checksum(body).to_le_bytes() == *sum);
    let header = model.header();
    let features = FloatFeatures::from_header(&header);
    let float = FloatPair::from_checkpoint(checkpoint);
    let set = draw_test_set(checkpoint, TEST_ROWS);
    let samples: Vec<Sample> = (set.par_iter())
        .map_init(
            || (float.clone(), AnyPair::new(model)),
            |(float, image), (row, states)| {
                float.reset();
                image.reset();
                let float = float_forces_n(&states.map(|state| float.push(&state))[WINDOW - 1]);
                let last = states.map(|state| image.push(&state))[WINDOW - 1];
                let gap = ContactState { deformation_m: -row.state.deformation_m, ..row.state };
                let [normal, friction] = forces_n(&image.push(&gap));
                Sample {
                    law: [row.normal_force_n, row.friction_force_n],
                    float,
                    image: forces_n(&last),
                    without_contact_n: normal.abs().max(friction.abs()),
                    saturated: last.saturated > 0,
                    working: is_working_point(&features, row),
                }
            },
        )
        .collect();
    let verdict = |which: usize, network: &'static str| {
        let errors = |pick: fn(&Sample) -> [f64; 2]| {
            Errors::from_pairs(samples.iter().map(move |s| (s.law[which], pick(s)[which])))
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
            zero_contact_output: samples.iter().fold(0.0, |largest, s| s.without_contact_n.max(largest)),
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
    Ok([verdict(0, "collision"), verdict(1, "friction")].map(Verdict::with_goals))
}

/// Adds the errors over the held-out runs of the bearing.
///
/// # Errors
///
/// The bench cannot be simulated.
pub fn add_held_out_errors(
    verdicts: [Verdict; 2],
    checkpoint: &Checkpoint,
    model: AnyModel<'_>,
) -> Result<[Verdict; 2], RunError> {
    let [collision, friction] = verdicts;
    let [normal, tangential] =
        held_out::errors(checkpoint, model, &held_out::simulate_runs(checkpoint.bearing)?);
    Ok([collision.with_held_out(normal), friction.with_held_out(tangential)])
}

fn is_working_point(features: &FloatFeatures, row: &Row) -> bool {
    let [low, high] = WORKING_FORCE_N;
    let ratio = f64::from(features.unclamped_rate_ratio(&row.state));
    (low..=high).contains(&row.normal_force_n) && ratio.abs() <= WORKING_RATIO
}

fn relative_error(samples: &[Sample], which: usize, share: f64) -> f64 {
    let mut errors: Vec<f64> = (samples.iter())
        .filter(|s| s.working && s.law[which] != 0.0)
        .map(|s| ((s.image[which] - s.law[which]) / s.law[which]).abs())
        .collect();
    quantile(&mut errors, share)
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
