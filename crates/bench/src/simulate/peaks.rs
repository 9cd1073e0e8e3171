//! Peaks with their numerical error bars: the same run three times, at three accuracies.
//!
//! The value is that of the finest run. The bar follows from the differences between the runs
//! ([`super::error_bars`]). The runs differ in tolerance or, with a held force, in the
//! communication step. A bar says nothing about the model. In a run whose trajectories decorrelate
//! (a slider-crank beyond two revolutions) bars become as large as the peaks; then only statistics
//! can be compared.

use crate::integrate::{ContactPlant, Impact, IntegrationError, Tolerances, integrate};
use crate::plants::transmission::Snapshot;
use crate::simulate::error_bars::error_bars;

/// Tolerance of a run relative to that of the next coarser one.
pub const TIGHTER: f64 = 0.03;
/// Interval of the search for peaks, s.
const COARSE_S: f64 = 1e-4;
/// Interval at which peaks are read, s: a torque that reverses falls from its peak within 50 us.
const FINE_S: f64 = 2e-6;
/// Number of peaks per quantity that are read finely: the highest ones at the coarse interval.
const PLACES: usize = 6;

/// A peak with its error bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Quantity, unit included.
    pub name: &'static str,
    /// Largest magnitude.
    pub value: f64,
    /// Error bar from the coarser runs; infinite if they gave no result.
    pub error_bar: f64,
    /// Time of the peak in s.
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

/// Largest magnitude of every quantity, each with its time in s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extremes([(f64, f64); QUANTITIES.len()]);

impl Extremes {
    /// Adds the state of the bench at one time.
    pub fn update(&mut self, snapshot: &Snapshot) {
        for ((largest, time_s), (_, read)) in self.0.iter_mut().zip(QUANTITIES) {
            let size = read(snapshot).abs();
            if size > *largest {
                (*largest, *time_s) = (size, snapshot.time_s);
            }
        }
    }

    /// Returns the extremes as peaks, with their error bars from a coarser run and one that is
    /// coarser still.
    pub fn to_peaks(&self, [middle, coarse]: [Option<&Self>; 2]) -> Vec<Peak> {
        let of = |run: Option<&Self>, i: usize| run.and_then(|run| run.0.get(i)).map(|(value, _)| *value);
        let values = self.0.iter().enumerate().map(|(i, (value, _))| (*value, of(middle, i), of(coarse, i)));
        let bars = error_bars(&values.collect::<Vec<_>>());
        let rows = QUANTITIES.iter().zip(&self.0).zip(bars);
        rows.map(|(((name, _), &(value, time_s)), error_bar)| Peak { name, value, error_bar, time_s })
            .collect()
    }
}

/// Returns the peaks from `from_s` to `end_s` with their bars. `run` simulates the bench at
/// ascending times, the first of them 0, at a relative tolerance; it is called with `tolerance`,
/// with a tighter one and with a wider one, which may fail.
pub fn peaks_with_bars<E>(
    (from_s, end_s): (f64, f64),
    tolerance: f64,
    run: impl Fn(f64, &[f64]) -> Result<Vec<Snapshot>, E>,
) -> Result<Vec<Peak>, E> {
    let at = |tolerance| located((from_s, end_s), |times: &[f64]| run(tolerance, times));
    let (fine, middle, coarse) = (at(tolerance * TIGHTER)?, at(tolerance)?, at(tolerance / TIGHTER).ok());
    Ok(fine.to_peaks([Some(&middle), coarse.as_ref()]))
}

/// Extremes of a repeatable run: searched at the coarse interval, then read finely near the highest
/// values.
fn located<E>(
    (from_s, end_s): (f64, f64),
    run: impl Fn(&[f64]) -> Result<Vec<Snapshot>, E>,
) -> Result<Extremes, E> {
    let times: Vec<f64> = (0..(end_s / COARSE_S).ceil() as usize).map(|i| i as f64 * COARSE_S).collect();
    let samples = run(&times)?;
    let counted = samples.get(samples.partition_point(|s| s.time_s < from_s)..).unwrap_or_default();
    let places = QUANTITIES.map(|(_, read)| highest(counted, read));
    let around = |t: &f64| {
        let (first, last) = ((t - COARSE_S).max(from_s), (t + COARSE_S).min(end_s));
        let count = ((last - first) / FINE_S) as usize;
        (0..=count).map(move |i| first + i as f64 * FINE_S)
    };
    let mut fine: Vec<f64> = places.iter().flatten().flat_map(around).chain([0.0]).collect();
    fine.sort_by(f64::total_cmp);
    fine.dedup();
    let mut extremes = Extremes::default();
    counted.iter().for_each(|s| extremes.update(s));
    run(&fine)?.iter().filter(|s| s.time_s >= from_s).for_each(|s| extremes.update(s));
    Ok(extremes)
}

/// Times of the highest local maxima of a magnitude, the ends included.
fn highest(samples: &[Snapshot], read: fn(&Snapshot) -> f64) -> Vec<f64> {
    let size = |i: usize| samples.get(i).map_or(f64::NEG_INFINITY, |s| read(s).abs());
    let mut tops: Vec<usize> = (0..samples.len())
        .filter(|&i| size(i) >= size(i + 1) && i.checked_sub(1).is_none_or(|before| size(i) >= size(before)))
        .collect();
    tops.sort_by(|&a, &b| size(b).total_cmp(&size(a)));
    tops.iter().take(PLACES).filter_map(|&i| samples.get(i)).map(|s| s.time_s).collect()
}

/// Returns every impact of a plant with the error bar of its peak force. The runs have the given
/// tolerances, tighter ones and wider ones, and the tighter ones give the impacts. A contact that
/// the middle run does not have gets an infinite bar.
pub fn impacts_with_bars<P: ContactPlant<N>, const N: usize>(
    plant: &P,
    span_s: (f64, f64),
    initial: [f64; N],
    tolerances: &Tolerances<N>,
) -> Result<Vec<(Impact, f64)>, IntegrationError> {
    let run = |factor: f64| {
        let tolerances = Tolerances {
            relative: tolerances.relative * factor,
            absolute: tolerances.absolute.map(|a| a * factor),
            largest_step_s: tolerances.largest_step_s,
        };
        let run = integrate(plant, span_s, initial, false, &[], &tolerances, |_, _, _| {});
        run.map(|run| run.impacts)
    };
    let (fine, middle, coarse) = (run(TIGHTER)?, run(1.0)?, run(1.0 / TIGHTER).unwrap_or_default());
    let peak = |impacts: &[Impact], i: usize| impacts.get(i).map(|impact| impact.peak_force_n);
    let peaks =
        fine.iter().enumerate().map(|(i, impact)| (impact.peak_force_n, peak(&middle, i), peak(&coarse, i)));
    let bars = error_bars(&peaks.collect::<Vec<_>>());
    Ok(fine.into_iter().zip(bars).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::{SliderCrankBench, TransmissionBench};
    use crate::simulate::snapshots;

    #[test]
    fn bars_cover_the_known_peaks_and_grow_along_a_chaotic_run() {
        let bench = SliderCrankBench::open("slider-crank").unwrap();
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
        let bench = TransmissionBench::open("bench-b").unwrap();
        let run = |tolerance, times: &[f64]| {
            snapshots(&bench, (bench.drive_profile(), bench.load_profile()), 1.0, times, tolerance)
        };
        let peaks = peaks_with_bars((0.05, 1.0), 1e-6, run).unwrap();
        // Values of another run, read at every microsecond.
        for (peak, known) in
            peaks.iter().zip([11755.003656, 11855.979192, 2403.820530, 137.098368, 45.7933e-6])
        {
            assert!((peak.value / known - 1.0).abs() < 1e-4, "{peak:?} for {known}");
            assert!(peak.error_bar > 0.0 && peak.error_bar < 1e-4 * peak.value, "{peak:?}");
        }
    }
}
