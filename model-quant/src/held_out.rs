//! Runs of bench B that nothing is chosen on: clearances, loads and drive periods between and beyond the paper's.
//!
//! Whoever chooses a training recipe, a window or an observer looks at the paper's clearances and loads, never at these; once they have been
//! looked at for a choice, others take their place. `verify` runs the networks over their contacts, `host-sim accuracy` puts them into the loop and behind the sensors.

use crate::checkpoint::Checkpoint;
use crate::dataset::bench_runs::{RATE_HZ, RunError};
use crate::errors::Errors;
use crate::float_pair::FloatPair;
use crate::image::{AnyModel, AnyPair};
use crate::verify::Verdict;
use bench::run::{DEFAULT_TOLERANCE, snapshots};
use bench::transmission::Snapshot;
use bench::{BearingMaterial, Bench};
use inference::{Bearing, ContactState, WINDOW};
use rayon::prelude::*;
use serde::Serialize;

/// Clearance in mm, load in kN and drive period in s.
pub const CONDITIONS: [(f64, f64, f64); 10] = [
    (0.14, 6.0, 1.0),
    (0.14, -4.0, 1.2),
    (0.22, 9.0, 0.9),
    (0.3, -6.5, 1.0),
    (0.3, 2.5, 1.4),
    (0.6, 6.0, 1.1),
    (0.6, -8.0, 0.85),
    (0.9, -4.0, 1.0),
    (0.9, 8.5, 1.3),
    (1.2, 3.0, 1.0),
];

/// Errors of the networks over the contacts of the held-out runs, at 10 kHz and without noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeldOut {
    /// Runs.
    pub runs: usize,
    /// The image against the law.
    pub image: Errors,
    /// The float networks against the law.
    pub float: Errors,
}

/// The bench through all conditions with its own law, each from the end of the load's ramp on.
pub fn runs(bearing: Bearing) -> Result<Vec<Vec<Snapshot>>, RunError> {
    let Bench::Transmission(base) = Bench::open("bench-b")? else { return Ok(Vec::new()) };
    let run = |(clearance_mm, load_kn, period_s): (f64, f64, f64)| {
        let mut bench = base.clone();
        bench.set_material(match bearing {
            Bearing::Babbitt => BearingMaterial::Babbitt,
            Bearing::Plastic => BearingMaterial::Plastic,
        });
        bench.set_radial_clearance(clearance_mm * 1e-3);
        bench.load.force_n = load_kn * 1e3;
        bench.drive.period_s = period_s;
        let inputs = (bench.drive_profile(), bench.load_profile());
        let times_s = bench.sample_times_s(RATE_HZ);
        let mut samples = snapshots(&bench, inputs, bench.duration_s(), &times_s, DEFAULT_TOLERANCE)?;
        samples.retain(|s| s.time_s >= bench.load.ramp_s);
        Ok(samples)
    };
    CONDITIONS.into_par_iter().map(run).collect()
}

/// Runs image and float networks over the contacts; collision first, friction second. The first samples of a run, for which
/// the networks' history is not full, are flagged so and do not count.
pub fn errors(checkpoint: &Checkpoint, model: AnyModel<'_>, runs: &[Vec<Snapshot>]) -> [HeldOut; 2] {
    let float = FloatPair::of(checkpoint, 0);
    // Truth, image, float; each normal and friction.
    let rows: Vec<[[f64; 2]; 3]> = (runs.par_iter())
        .flat_map_iter(|samples| {
            let (mut float, mut image) = (float.clone(), AnyPair::new(model));
            let estimates = samples.iter().map(move |sample| {
                let state = contact(sample);
                let (floats, estimate) = (float.push(&state), image.push(&state));
                [
                    [sample.forces.normal_n, sample.forces.friction_n],
                    [estimate.normal_force_mn, estimate.friction_force_mn].map(|mn| f64::from(mn) / 1000.0),
                    [floats.normal_force_n, floats.friction_force_n].map(f64::from),
                ]
            });
            estimates.skip(WINDOW - 1)
        })
        .collect();
    [0, 1].map(|which| {
        let of = |source: usize| Errors::of(rows.iter().map(move |row| (row[0][which], row[source][which])));
        HeldOut { runs: runs.len(), image: of(1), float: of(2) }
    })
}

/// The verdicts on an image with its errors over the held-out runs of its bearing.
///
/// # Errors
///
/// The bench cannot be run.
pub fn judged(
    verdicts: [Verdict; 2],
    checkpoint: &Checkpoint,
    model: AnyModel<'_>,
) -> Result<[Verdict; 2], RunError> {
    let [collision, friction] = verdicts;
    let [normal, tangential] = errors(checkpoint, model, &runs(checkpoint.bearing)?);
    Ok([collision.with_held_out(normal), friction.with_held_out(tangential)])
}

fn contact(sample: &Snapshot) -> ContactState {
    let contact = &sample.contact;
    ContactState {
        radial_clearance_m: contact.radial_clearance_m as f32,
        deformation_m: contact.deformation_m as f32,
        deformation_rate_m_s: contact.rate_m_s as f32,
        approach_speed_m_s: contact.latched_m_s as f32,
        sliding_speed_m_s: contact.sliding_speed_m_s as f32,
    }
}
