//! Held-out runs of bench B: clearances, loads and drive periods between and beyond those of the
//! paper.
//!
//! No choice of a training recipe, a window or an estimator may depend on these runs. If one ever
//! does, the runs must be replaced by others. `verify` evaluates the networks on their contacts;
//! `host-sim accuracy` uses the same conditions in the closed loop and with sensors.

use crate::data::bench_runs::{RATE_HZ, RunError};
use crate::evaluate::errors::Errors;
use crate::network::checkpoint::Checkpoint;
use crate::network::float_pair::FloatPair;
use crate::quantise::image::{AnyModel, AnyPair};
use bench::description::TransmissionBench;
use bench::plants::transmission::Snapshot;
use bench::simulate::{DEFAULT_TOLERANCE, snapshots};
use inference::{BearingMaterial, ContactState, WINDOW};
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

/// Errors of the networks over the contacts of the held-out runs, sampled at 10 kHz without noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeldOut {
    /// Number of runs.
    pub runs: usize,
    /// Errors of the image against the law.
    pub image: Errors,
    /// Errors of the float networks against the law.
    pub float: Errors,
}

/// Simulates the bench with its own law under all conditions; samples begin after the ramp of the
/// load.
pub(crate) fn simulate_runs(bearing: BearingMaterial) -> Result<Vec<Vec<Snapshot>>, RunError> {
    let base = TransmissionBench::open("bench-b")?;
    let run = |(clearance_mm, load_kn, period_s): (f64, f64, f64)| {
        let mut bench = base.clone();
        bench.set_material(bearing);
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

/// Evaluates image and float networks on the contacts; collision first, friction second. The first
/// samples of a run are skipped, because the networks' history is incomplete.
pub(crate) fn errors(checkpoint: &Checkpoint, model: AnyModel<'_>, runs: &[Vec<Snapshot>]) -> [HeldOut; 2] {
    let float = FloatPair::from_checkpoint(checkpoint);
    // Truth, image, float; each with normal and friction force.
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
        let errors_of = |source: usize| {
            Errors::from_pairs(rows.iter().map(move |row| (row[0][which], row[source][which])))
        };
        HeldOut { runs: runs.len(), image: errors_of(1), float: errors_of(2) }
    })
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
