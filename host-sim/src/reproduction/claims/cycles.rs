//! Facts of single cycles of a run: the first one, which starts from rest, and settled ones.
//!
//! The paper ran one cycle from rest. The bench forgets its start after about one cycle. A run of
//! [`CYCLES`] cycles therefore gives both: the first cycle from the end of the load's ramp on, and
//! the last two together. Two, because some benches settle to a motion that repeats only every
//! second cycle. Over both, peaks are the larger one and oscillations the root of the mean square.
//!
//! Runs use the analytic laws. Peaks are read at [`SAMPLE_RATE_HZ`], without a finer search.

use super::facts::{BearingFacts, JointFacts, MotionFacts, RunFacts};
use crate::cli::error::CliError;
use crate::cli::parallel;
use crate::reproduction::claims::gather::{settled_slider_crank_ratio, slider_crank_ratio};
use crate::reproduction::runs::{cases, coefficients, joint_acceleration_ratio};
use crate::reproduction::swing::{self, Swing};
use crate::run::conditions::{CLEARANCE_LOAD_KN, LOAD_CLEARANCE_MM, variant};
use crate::run::force::SAMPLE_RATE_HZ;
use crate::run::magnitude::peak;
use crate::run::summary::{acceleration_reversals_s, fluctuation_rms_n, oscillation_window_s};
use bench::BearingMaterial::{self, Babbitt, Plastic};
use bench::description::TransmissionBench;
use bench::integrate::IntegrationError;
use bench::plants::transmission::Snapshot;
use bench::simulate::{DEFAULT_TOLERANCE, snapshots};
use std::ops::Range;

/// Cycles of a run.
pub const CYCLES: u32 = 5;
/// Number of cycles at the end of a run that count as settled.
const SETTLED: u32 = 2;
/// Revolutions of the slider-crank that do not count as settled.
const SLIDER_CRANK_REVOLUTIONS: u32 = 2;

/// Operation of the bench in which a claim is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// One cycle from rest, as the paper ran it.
    FromRest,
    /// Cycles that no longer depend on the start.
    Settled,
}

impl Operation {
    /// Both, in the order of results.
    pub const ALL: [Self; 2] = [Self::FromRest, Self::Settled];

    const fn cycles(self) -> Range<u32> {
        match self {
            Self::FromRest => 0..1,
            Self::Settled => CYCLES - SETTLED..CYCLES,
        }
    }
}

/// Extent of the facts of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// Numbers on which verdicts depend.
    Verdicts,
    /// Also the swing of the journal, which explains claim 6.
    Causes,
}

/// Facts of one run in both operations.
#[derive(Clone, Debug)]
pub struct CycleFacts {
    bearing: BearingMaterial,
    facts: [RunFacts; 2],
    joint_acceleration_ratio: [f64; 2],
}

/// A run of the paper's series over [`CYCLES`] cycles.
#[derive(Clone, Debug)]
pub struct SettledRun {
    /// The bench as run.
    pub bench: TransmissionBench,
    /// The counted cycles.
    pub samples: Vec<Snapshot>,
}

impl SettledRun {
    /// Returns whether another bench has the same bearing, clearance and load.
    pub(crate) fn has_conditions_of(&self, other: &TransmissionBench) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
        self.bench.bearing.material == other.bearing.material
            && near(self.bench.bearing.radial_clearance_m, other.bearing.radial_clearance_m)
            && near(self.bench.load.force_n, other.load.force_n)
    }
}

/// Returns the bench with the number of cycles of a settled run.
pub(crate) fn with_cycles(mut bench: TransmissionBench) -> TransmissionBench {
    bench.drive.cycles = CYCLES;
    bench
}

/// Simulates the counted cycles of a resolved bench with [`CYCLES`] cycles.
pub fn simulate(bench: &TransmissionBench) -> Result<Vec<Snapshot>, IntegrationError> {
    let period_s = bench.drive.period_s;
    let is_counted = |time_s: &f64| {
        Operation::ALL.iter().any(|operation| {
            let Range { start, end } = operation.cycles();
            (f64::from(start) * period_s..f64::from(end) * period_s).contains(time_s)
        })
    };
    let times: Vec<f64> = bench.sample_times_s(SAMPLE_RATE_HZ).into_iter().filter(is_counted).collect();
    let inputs = (bench.drive_profile(), bench.load_profile());
    snapshots(bench, inputs, bench.duration_s(), &times, DEFAULT_TOLERANCE)
}

/// Returns the samples of an operation, from the end of the load's ramp on.
pub(crate) fn of_operation<'a>(
    bench: &TransmissionBench,
    samples: &'a [Snapshot],
    operation: Operation,
) -> &'a [Snapshot] {
    let Range { start, end } = operation.cycles();
    let from_s = (f64::from(start) * bench.drive.period_s).max(bench.load.ramp_s);
    let low = samples.partition_point(|s| s.time_s < from_s);
    let high = samples.partition_point(|s| s.time_s < f64::from(end) * bench.drive.period_s);
    samples.get(low..high).unwrap_or_default()
}

/// Runs a resolved bench with [`CYCLES`] cycles and measures both operations.
pub fn measure(bench: &TransmissionBench, detail: Detail) -> Result<CycleFacts, IntegrationError> {
    Ok(measure_samples(bench, &simulate(bench)?, detail))
}

fn measure_samples(bench: &TransmissionBench, samples: &[Snapshot], detail: Detail) -> CycleFacts {
    let reversals_s = acceleration_reversals_s(bench);
    CycleFacts {
        bearing: bench.bearing.material,
        facts: Operation::ALL.map(|o| facts(bench, &reversals_s, samples, o, detail)),
        joint_acceleration_ratio: Operation::ALL
            .map(|o| joint_acceleration_ratio(bench, of_operation(bench, samples, o))),
    }
}

fn facts(
    bench: &TransmissionBench,
    reversals_s: &[f64],
    samples: &[Snapshot],
    operation: Operation,
    detail: Detail,
) -> RunFacts {
    let counted = of_operation(bench, samples, operation);
    let cycles = operation.cycles();
    let shifted = |(from, to): (f64, f64), cycle: u32| {
        let start_s = f64::from(cycle) * bench.drive.period_s;
        (start_s + from, start_s + to)
    };
    let rms = |window: (f64, f64)| {
        let squares = cycles
            .clone()
            .map(|cycle| fluctuation_rms_n(samples, SAMPLE_RATE_HZ, shifted(window, cycle)).powi(2));
        (squares.sum::<f64>() / f64::from(cycles.end - cycles.start)).sqrt()
    };
    let after: Vec<(f64, f64)> = reversals_s.iter().map(|at| oscillation_window_s(bench, *at)).collect();
    let oscillation: Vec<f64> = after.iter().map(|window| rms(*window)).collect();
    let before = after.iter().map(|(from, to)| rms((from - (to - from), *from)));
    let growth = oscillation.iter().zip(before).map(|(rms, before)| rms / before.max(f64::MIN_POSITIVE));
    // The frequency is that of the last cycle: two cycles side by side have a step between them.
    let last = after.first().map(|window| shifted(*window, cycles.end - 1));
    let swing = match detail {
        Detail::Causes => last.map(|window| swing::within_window(samples, SAMPLE_RATE_HZ, window)),
        Detail::Verdicts => last.map(|window| Swing {
            fluctuation_hz: swing::fluctuation_hz(samples, SAMPLE_RATE_HZ, window),
            ..Swing::default()
        }),
    };
    let swing = swing.unwrap_or_default();
    let coefficients = coefficients(bench, counted);
    RunFacts {
        clearance_mm: bench.bearing.radial_clearance_m * 1e3,
        load_kn: bench.load.force_n * 1e-3,
        peak_n: peak(counted, |s| s.forces.normal_n),
        peak_y_n: peak(counted, |s| s.force_y_n),
        peak_z_n: peak(counted, |s| s.force_z_n),
        peak_torque_nm: peak(counted, |s| s.friction_torque_nm),
        oscillation_n: oscillation.first().copied().unwrap_or_default(),
        growth: growth.collect(),
        fluctuation_hz: swing.fluctuation_hz,
        swing_hz: swing.swing_hz,
        swing_radius_mm: swing.swing_radius_mm,
        coefficient_error: RunFacts::coefficient_error(bench, &coefficients),
        coefficients,
    }
}

/// Sorts the facts of the paper's runs into both series, for each operation.
/// `slider_crank_ratios` are the joint accelerations of [`slider_crank_ratios`].
pub fn assemble(runs: &[CycleFacts], slider_crank_ratios: [f64; 2]) -> [MotionFacts; 2] {
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
    [0, 1].map(|operation| {
        let facts = |run: &CycleFacts| run.facts.get(operation).cloned();
        let of_bearing = |bearing: BearingMaterial| {
            let of = || runs.iter().filter(|run| run.bearing == bearing).filter_map(facts);
            BearingFacts {
                bearing,
                clearance: of().filter(|f| near(f.load_kn, CLEARANCE_LOAD_KN)).collect(),
                load: of().filter(|f| near(f.clearance_mm, LOAD_CLEARANCE_MM)).collect(),
                load_curve: Vec::new(),
            }
        };
        let joint = |run: &CycleFacts| {
            let facts = facts(run).filter(|f| near(f.load_kn, CLEARANCE_LOAD_KN))?;
            Some((facts.clearance_mm, *run.joint_acceleration_ratio.get(operation)?))
        };
        MotionFacts {
            babbitt: of_bearing(Babbitt),
            plastic: of_bearing(Plastic),
            modulus: Vec::new(),
            joint: JointFacts {
                slider_crank: slider_crank_ratios.get(operation).copied().unwrap_or_default(),
                bench: runs.iter().filter_map(joint).collect(),
            },
        }
    })
}

/// Joint acceleration of the published slider-crank: from its start, and settled.
pub fn slider_crank_ratios() -> Result<[f64; 2], CliError> {
    Ok([slider_crank_ratio()?, settled_slider_crank_ratio(SLIDER_CRANK_REVOLUTIONS)?])
}

/// Runs the paper's series with the analytic laws and returns the runs and the facts of both
/// operations.
pub fn gather(
    base: &TransmissionBench,
    threads: usize,
    finished: impl Fn() + Sync,
) -> Result<(Vec<SettledRun>, [MotionFacts; 2]), CliError> {
    let runs = parallel::map(threads, &cases(), |_, &(bearing, clearance_mm, load_kn)| {
        let bench = with_cycles(variant(base, bearing, clearance_mm, load_kn)).resolved();
        let samples = simulate(&bench)?;
        let facts = measure_samples(&bench, &samples, Detail::Causes);
        finished();
        Ok((SettledRun { bench, samples }, facts))
    })?;
    let (runs, facts): (Vec<SettledRun>, Vec<CycleFacts>) = runs.into_iter().unzip();
    Ok((runs, assemble(&facts, slider_crank_ratios()?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of two independent codes for +10 kN: clearance in mm, peak in N and oscillation in N
    /// rms, from rest and settled, each from its lowest to its highest value.
    type Known = (BearingMaterial, f64, (f64, f64), [(f64, f64); 2]);
    const KNOWN: [Known; 8] = [
        (Babbitt, 0.1, (8067.0, 94.0), [(7976.0, 7976.0), (860.0, 860.0)]),
        (Babbitt, 0.25, (10137.0, 743.0), [(8241.0, 9589.0), (511.0, 621.0)]),
        (Babbitt, 0.5, (11755.0, 1034.0), [(9671.0, 9671.0), (387.0, 387.0)]),
        (Babbitt, 1.0, (13924.0, 1152.0), [(8038.0, 8038.0), (180.0, 180.0)]),
        (Plastic, 0.1, (6004.0, 189.0), [(5993.0, 5993.0), (88.0, 88.0)]),
        (Plastic, 0.25, (5952.0, 378.0), [(6019.0, 6019.0), (78.0, 78.0)]),
        (Plastic, 0.5, (6245.0, 523.0), [(5988.0, 5988.0), (66.0, 66.0)]),
        (Plastic, 1.0, (7173.0, 526.0), [(5960.0, 5960.0), (46.0, 46.0)]),
    ];

    #[test]
    fn peaks_and_oscillations_from_rest_and_settled_match_independent_codes() {
        let base = TransmissionBench::open("bench-b").unwrap();
        let within = |found: f64, (low, high): (f64, f64), share: f64| {
            found >= low * (1.0 - share) && found <= high * (1.0 + share)
        };
        for (bearing, clearance_mm, (peak_n, rms_n), [settled_peak_n, settled_rms_n]) in KNOWN {
            let bench = with_cycles(variant(&base, bearing, clearance_mm, 10.0)).resolved();
            let [rest, settled] = measure(&bench, Detail::Verdicts).unwrap().facts;
            let place = format!("{bearing:?}, {clearance_mm} mm");
            assert!(within(rest.peak_n, (peak_n, peak_n), 2e-3), "{place}: {}", rest.peak_n);
            assert!(within(rest.oscillation_n, (rms_n, rms_n), 0.02), "{place}: {}", rest.oscillation_n);
            assert!(within(settled.peak_n, settled_peak_n, 0.01), "{place}: {}", settled.peak_n);
            assert!(within(settled.oscillation_n, settled_rms_n, 0.03), "{place}: {}", settled.oscillation_n);
        }
    }
}
