//! Simulated runs of bench B: a source of rows, and a measure of how well a training range covers
//! the bench.
//!
//! Each bearing has 24 runs: radial clearances .1, .25, .5 and 1 mm by loads of 1, 5 and 10 kN in
//! both directions. A run is one cycle with the bench's own law, logged at 10 kHz through the
//! bench's sensors (.2 um of noise on the journal position along Y and Z).
//!
//! The rows contain what an estimator would know. The deformation `d = a - D` follows from the
//! noisy position. The rate `d'` is the slope of a least-squares line through the latest 32 values
//! of `d` (standard deviation .038 mm/s, delay 1.6 ms). The approach speed is latched when `d`
//! rises above 0: it is that slope, at least 0. It is 0 in a gap. A run touches within its first
//! millisecond, before the first full slope. Its first latched value is therefore the first slope
//! and not the landing speed. The controller's estimator takes the configured speed instead. The
//! force is that of the law without noise at the same time. The rows of a run follow each other at
//! 100 us, so a window is a number of consecutive rows of one run.

use super::collision::{push, window_values};
use super::split::{Split, split_groups};
use crate::data::features::FloatFeatures;
use crate::data::window::Window;
use bench::description::TransmissionBench;
use bench::integrate::IntegrationError;
use bench::plants::transmission::Snapshot;
use bench::simulate::log_from_samples;
use bench::simulate::{DEFAULT_TOLERANCE, snapshots};
use bench::{Bench, Channel, DescriptionError, MeasuredLog};
use inference::features::COLLISION_INPUTS;
use inference::{BearingMaterial, ContactState, Flags, WINDOW};
use rayon::prelude::*;
use serde::Serialize;

/// Radial clearances of the runs in m.
const CLEARANCES_M: [f64; 4] = [0.1e-3, 0.25e-3, 0.5e-3, 1.0e-3];
/// Loads of the runs in N.
const LOADS_N: [f64; 6] = [10e3, 5e3, 1e3, -1e3, -5e3, -10e3];
/// Sample rate of the log in Hz.
pub(crate) const RATE_HZ: f64 = 10_000.0;
/// Number of values in the slope fit.
pub(crate) const SLOPE_VALUES: usize = 32;
/// Columns of the rows: run and time, then those of a collision set.
pub(crate) const COLUMNS: [&str; 7] = [
    "run",
    "time_s",
    "radial_clearance_m",
    "deformation_m",
    "deformation_rate_m_s",
    "approach_speed_m_s",
    "normal_force_n",
];

/// Error of the simulation of the runs.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The preset was refused.
    #[error("bench-b: {0}")]
    Description(#[from] DescriptionError),
    /// A run failed.
    #[error("bench-b: {0}")]
    Integration(#[from] IntegrationError),
}

/// One run: the true states and the log of the sensors.
#[derive(Clone, Debug)]
pub(crate) struct BenchRun {
    /// Radial clearance in m.
    pub radial_clearance_m: f64,
    truth: Vec<Snapshot>,
    log: MeasuredLog,
}

/// State that an estimator knows at one time, and the true force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Estimate {
    /// Time in s.
    pub time_s: f64,
    /// Estimated state; the sliding speed is always 0.
    pub state: ContactState,
    /// Normal force in N without noise.
    pub normal_force_n: f64,
}

/// Simulates the runs of a bearing; `seed` sets the sensor noise, which differs from run to run.
pub(crate) fn bench_runs(bearing: BearingMaterial, seed: u64) -> Result<Vec<BenchRun>, RunError> {
    let bench = TransmissionBench::open("bench-b")?;
    let pairs = CLEARANCES_M.iter().flat_map(|&clearance| LOADS_N.map(|load| (clearance, load)));
    let pairs: Vec<_> = pairs.zip(seed.wrapping_mul(64)..).collect();
    (pairs.into_par_iter())
        .map(|((radial_clearance_m, load_n), seed)| {
            let mut bench: TransmissionBench = bench.clone();
            bench.set_material(bearing);
            bench.set_radial_clearance(radial_clearance_m);
            bench.load.force_n = load_n;
            bench.logging.sample_rate_hz = RATE_HZ;
            let inputs = (bench.drive_profile(), bench.load_profile());
            let times_s = bench.sample_times_s(RATE_HZ);
            let truth = snapshots(&bench, inputs, bench.duration_s(), &times_s, DEFAULT_TOLERANCE)?;
            let log = log_from_samples(&Bench::from(bench), (&truth, 1), seed);
            Ok(BenchRun { radial_clearance_m, truth, log })
        })
        .collect()
}

impl BenchRun {
    /// Returns the estimator's states from the first full slope on.
    pub(crate) fn estimates(&self) -> Vec<Estimate> {
        let channel = |channel| self.log.channels.get(&channel).map(Vec::as_slice).unwrap_or_default();
        let places = channel(Channel::JournalY).iter().zip(channel(Channel::JournalZ));
        let deformations: Vec<f64> = places.map(|(y, z)| y.hypot(*z) - self.radial_clearance_m).collect();
        let mut latched = 0.0;
        let mut touching = false;
        let rows = deformations.windows(SLOPE_VALUES).zip(self.truth.iter().skip(SLOPE_VALUES - 1));
        rows.map(|(values, truth)| {
            let deformation = values.last().copied().unwrap_or_default();
            let rate = slope(values) * RATE_HZ;
            if deformation > 0.0 && !touching {
                latched = rate.max(0.0);
            } else if deformation <= 0.0 {
                latched = 0.0;
            }
            touching = deformation > 0.0;
            let state = ContactState {
                radial_clearance_m: self.radial_clearance_m as f32,
                deformation_m: deformation as f32,
                deformation_rate_m_s: rate as f32,
                approach_speed_m_s: latched as f32,
                sliding_speed_m_s: 0.0,
            };
            Estimate { time_s: truth.time_s, state, normal_force_n: truth.forces.normal_n }
        })
        .collect()
    }
}

/// Least-squares slope through equally spaced values, per step.
fn slope(values: &[f64]) -> f64 {
    let middle = 0.5 * (values.len() as f64 - 1.0);
    let (mut above, mut below) = (0.0, 0.0);
    for (index, value) in values.iter().enumerate() {
        let from_middle = index as f64 - middle;
        above += from_middle * value;
        below += from_middle * from_middle;
    }
    above / below
}

/// Returns the rows of one part of the runs as columns: either [`COLUMNS`], or run and time
/// followed by a window.
pub(crate) fn columns(
    features: &FloatFeatures,
    runs: &[BenchRun],
    seed: u64,
    split: Split,
    windows: bool,
) -> Vec<Vec<f32>> {
    let count = if windows { WINDOW * COLLISION_INPUTS + 4 } else { COLUMNS.len() };
    let mut columns = vec![Vec::new(); count];
    let splits = split_groups(runs.len(), seed);
    for (number, (run, _)) in runs.iter().zip(splits).enumerate().filter(|(_, (_, part))| *part == split) {
        let estimates = run.estimates();
        if windows {
            for rows in estimates.windows(WINDOW) {
                let mut inputs = [[0.0; COLLISION_INPUTS]; WINDOW];
                for (column, row) in inputs.iter_mut().zip(rows) {
                    *column = features.collision(&row.state).inputs;
                }
                let Some(newest) = rows.last() else { continue };
                let factor = features.collision(&newest.state).root_force_factor;
                let root = newest.normal_force_n.sqrt() as f32;
                let window =
                    Window { columns: inputs, target: if factor > 0.0 { root / factor } else { 0.0 } };
                let start = [number as f32, newest.time_s as f32];
                push(&mut columns, start.into_iter().chain(window_values(&window, newest.normal_force_n)));
            }
            continue;
        }
        for row in &estimates {
            let state = &row.state;
            let values = [
                number as f32,
                row.time_s as f32,
                state.radial_clearance_m,
                state.deformation_m,
                state.deformation_rate_m_s,
                state.approach_speed_m_s,
                row.normal_force_n as f32,
            ];
            push(&mut columns, values);
        }
    }
    columns
}

/// Share of the contact samples of the runs, without noise, that lie outside a training range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct OutsideShare {
    /// Outside in at least one of the three inputs of the law.
    pub any: f64,
    /// Deformation above the range.
    pub deformation: f64,
    /// Radial clearance outside the range.
    pub radial_clearance: f64,
    /// Ratio of rate to approach speed beyond the limit.
    pub rate_ratio: f64,
    /// Rate below 0, which Table 2 does not contain. Not counted in `any`, because the input range
    /// has both signs.
    pub rate_below_zero: f64,
    /// Largest deformation of all runs in m.
    pub deepest_m: f64,
}

/// Measures how much of the runs lies outside a training range.
pub(crate) fn measure_outside_share(features: &FloatFeatures, runs: &[BenchRun]) -> OutsideShare {
    let mut counts = [0_u64; 5];
    let mut contacts = 0_u64;
    let mut deepest_m = 0.0_f64;
    let inputs = [Flags::OUTSIDE_DEFORMATION, Flags::OUTSIDE_CLEARANCE, Flags::OUTSIDE_RATE_RATIO];
    for contact in runs.iter().flat_map(|run| &run.truth).map(|s| s.contact).filter(|c| c.deformation_m > 0.0)
    {
        let flags = features
            .collision(&ContactState {
                radial_clearance_m: contact.radial_clearance_m as f32,
                deformation_m: contact.deformation_m as f32,
                deformation_rate_m_s: contact.rate_m_s as f32,
                approach_speed_m_s: contact.latched_m_s as f32,
                sliding_speed_m_s: 0.0,
            })
            .flags;
        let [a, b, c] = inputs.map(|input| flags.intersects(input));
        for (count, outside) in counts.iter_mut().zip([a || b || c, a, b, c, contact.rate_m_s < 0.0]) {
            *count += u64::from(outside);
        }
        contacts += 1;
        deepest_m = deepest_m.max(contact.deformation_m);
    }
    let [any, deformation, radial_clearance, rate_ratio, rate_below_zero] =
        counts.map(|count| count as f64 / contacts.max(1) as f64);
    OutsideShare { any, deformation, radial_clearance, rate_ratio, rate_below_zero, deepest_m }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::ranges::{RangeKind, header};

    #[test]
    fn run_estimates_reach_their_noise_limit_and_runs_are_not_divided_between_parts() {
        let runs = bench_runs(BearingMaterial::Plastic, 4).unwrap();
        assert_eq!(runs.len(), 24);
        // 0.5 mm and +10 kN.
        let run = &runs[2 * LOADS_N.len()];
        assert_eq!(run.radial_clearance_m, 0.5e-3);
        let estimates = run.estimates();
        assert_eq!(estimates.len(), 10_000 - SLOPE_VALUES + 1);
        // The position noise, .2 um, appears unchanged in the deformation.
        let errors = estimates.iter().zip(&run.truth[SLOPE_VALUES - 1..]);
        let squares =
            errors.map(|(e, t)| (f64::from(e.state.deformation_m) - t.contact.deformation_m).powi(2));
        let rms = (squares.sum::<f64>() / estimates.len() as f64).sqrt();
        assert!((rms / 0.2e-6 - 1.0).abs() < 0.05, "{rms}");
        // The slope is delayed by half its values. Compared with that time only noise and curvature
        // remain.
        let late = estimates.iter().skip(2000).zip(&run.truth[2000 + SLOPE_VALUES / 2..]);
        let squares =
            late.map(|(e, t)| (f64::from(e.state.deformation_rate_m_s) - t.contact.rate_m_s).powi(2));
        let rms = (squares.sum::<f64>() / 7900.0).sqrt();
        assert!((2e-5..2e-4).contains(&rms), "{rms}");

        let features = FloatFeatures::from_header(&header(BearingMaterial::Plastic, RangeKind::Bench));
        let rows = Split::ALL.map(|split| columns(&features, &runs, 4, split, false)[0].len());
        assert_eq!(rows, [14, 5, 5].map(|runs| runs * estimates.len()));
        let windows = columns(&features, &runs, 4, Split::Test, true);
        assert_eq!(windows[0].len(), 5 * (estimates.len() - WINDOW + 1));
        let paper = measure_outside_share(
            &FloatFeatures::from_header(&header(BearingMaterial::Plastic, RangeKind::Paper)),
            &runs,
        );
        let bench = measure_outside_share(&features, &runs);
        assert!(
            paper.deformation > 0.2 && bench.deformation == 0.0 && bench.any < 0.05,
            "{paper:?} {bench:?}"
        );
        assert!(paper.deepest_m > 1.5e-4 && paper.rate_below_zero > 0.2);
    }

    #[test]
    fn a_slope_is_exact_on_a_line() {
        let line: Vec<f64> = (0..SLOPE_VALUES).map(|i| 3.0 - 0.25 * i as f64).collect();
        assert!((slope(&line) + 0.25).abs() < 1e-12);
    }
}
