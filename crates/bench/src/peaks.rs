//! Peaks with their numerical error bars: the same run at two tolerances.
//!
//! The value is the tighter run's; the bar is the distance between the two runs, which to first order is the error of
//! the coarser one and so an upper estimate for the value's own. A bar says nothing about the model. In a run whose
//! trajectories decorrelate (a slider-crank beyond two revolutions) bars become as large as the peaks: then only
//! statistics can be compared, and the bar is how one sees it.

use crate::integrate::{Impact, IntegrationError, SlicedPlant, Tolerances, integrate_slices};
use crate::run::{Run, run_with_law};
use crate::transmission::{Snapshot, Transmission};

/// How much tighter the second run is.
const TIGHTER: f64 = 0.03;
/// Samples a second from which peaks other than the contact force are read.
const SAMPLE_RATE_HZ: f64 = 20_000.0;

/// A peak with its error bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// What it is the peak of, unit included.
    pub name: &'static str,
    /// Largest magnitude.
    pub value: f64,
    /// Distance between the runs at the two tolerances.
    pub error_bar: f64,
    /// When, s.
    pub time_s: f64,
}

/// Quantities of the transmission bench whose peaks are reported.
type Quantity = (&'static str, fn(&Snapshot) -> f64);
const QUANTITIES: [Quantity; 5] = [
    ("peak_contact_force_n", |s| s.forces.normal_n),
    ("peak_force_y_n", |s| s.force_y_n),
    ("peak_force_z_n", |s| s.force_z_n),
    ("peak_friction_torque_nm", |s| s.friction_torque_nm),
    ("max_deformation_m", |s| s.contact.deformation_m.max(0.0)),
];

/// Runs the bench twice, at `tolerance` and tighter, and gives its peaks from `from_s` to `end_s` with their bars.
pub fn peaks_with_bars(
    plant: &Transmission,
    (from_s, end_s): (f64, f64),
    tolerance: f64,
) -> Result<Vec<Peak>, IntegrationError> {
    let count = (end_s * SAMPLE_RATE_HZ).ceil() as usize;
    let times: Vec<f64> = (0..count).map(|i| i as f64 / SAMPLE_RATE_HZ).collect();
    let coarse = run_with_law(plant, end_s, &times, tolerance)?;
    let fine = run_with_law(plant, end_s, &times, tolerance * TIGHTER)?;
    Ok(QUANTITIES
        .iter()
        .map(|&(name, read)| {
            let (value, time_s) = largest(&fine, from_s, read);
            let (other, _) = largest(&coarse, from_s, read);
            Peak { name, value, error_bar: (value - other).abs(), time_s }
        })
        .collect())
}

/// Largest magnitude of a sampled quantity and its time, by the parabola through the three samples around it.
fn largest(run: &Run, from_s: f64, read: fn(&Snapshot) -> f64) -> (f64, f64) {
    let first = run.samples.partition_point(|s| s.time_s < from_s);
    let samples = run.samples.get(first..).unwrap_or_default();
    let size = |s: &Snapshot| read(s).abs();
    let top = samples.iter().enumerate().max_by(|(_, a), (_, b)| size(a).total_cmp(&size(b)));
    let Some((top, highest)) = top else { return (0.0, from_s) };
    if let Some([a, b, c]) = top.checked_sub(1).and_then(|i| samples.get(i..i + 3)) {
        let (a, b, c) = (size(a), size(b), size(c));
        if a + c < 2.0 * b {
            let shift = 0.5 * (a - c) / (a - 2.0 * b + c);
            return (b - 0.25 * (a - c) * shift, highest.time_s + shift / SAMPLE_RATE_HZ);
        }
    }
    (size(highest), highest.time_s)
}

/// Every impact of a plant with the error bar of its peak force. A contact that only one of the runs has carries an
/// infinite bar.
pub fn impacts_with_bars<P: SlicedPlant<N>, const N: usize>(
    plant: &P,
    span_s: (f64, f64),
    initial: [f64; N],
    tolerances: &Tolerances<N>,
) -> Result<Vec<(Impact, f64)>, IntegrationError> {
    let tighter = Tolerances {
        relative: tolerances.relative * TIGHTER,
        absolute: tolerances.absolute.map(|a| a * TIGHTER),
        largest_step_s: tolerances.largest_step_s,
    };
    let run = |tolerances| integrate_slices(plant, span_s, initial, &[], &[], tolerances, |_, _, _| {});
    let (coarse, fine) = (run(tolerances)?, run(&tighter)?);
    let bar = |i: usize, impact: &Impact| {
        coarse.impacts.get(i).map_or(f64::INFINITY, |c| (c.peak_force_n - impact.peak_force_n).abs())
    };
    Ok(fine.impacts.iter().enumerate().map(|(i, impact)| (*impact, bar(i, impact))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bench;
    use crate::slider_crank_description::reference_problem;

    #[test]
    fn bars_cover_the_known_peaks_and_grow_along_a_chaotic_run() {
        let bench = reference_problem().unwrap();
        let plant = bench.plant();
        let span = (0.0, bench.duration_s());
        let peaks = impacts_with_bars(&plant, span, plant.initial_state(), &plant.tolerances(1e-8)).unwrap();
        for ((impact, bar), known) in peaks.iter().zip([45777.458, 20971.99, 25593.21, 6770.89, 13012.17]) {
            assert!((impact.peak_force_n - known).abs() < bar + 0.01, "{impact:?} +- {bar} for {known}");
            assert!(*bar < 2e-4 * known, "{bar} of {known}");
        }
        assert!(peaks[15].1 > 10.0 * peaks[0].1);
    }

    #[test]
    fn bench_b_has_peaks_with_small_bars() {
        let Bench::Transmission(bench) = Bench::open("bench-b").unwrap() else { panic!("bench-b") };
        let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
        let peaks = peaks_with_bars(&plant, (0.05, 1.0), 1e-6).unwrap();
        for (peak, known) in peaks.iter().zip([11755.0, 11855.0, 2404.0, 137.0, 45.8e-6]) {
            assert!((peak.value / known - 1.0).abs() < 4e-3, "{peak:?} for {known}");
            assert!(peak.error_bar > 0.0 && peak.error_bar < 1e-4 * peak.value, "{peak:?}");
        }
    }
}
