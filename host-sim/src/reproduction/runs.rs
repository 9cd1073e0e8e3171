//! Runs of the paper's Figs. 16-20: four clearances at +10 kN and six loads at 1 mm, for both
//! bearings.
//!
//! The paper's list of loads leaves out -1 kN. It is run as well, because fall and rise under
//! negative load are not visible without it.

use crate::cli::error::CliError;
use crate::cli::parallel;
use crate::reproduction::swing::{self, Swing};
use crate::run::conditions::{
    BEARINGS, CLEARANCE_LOAD_KN, CLEARANCES_MM, LOAD_CLEARANCE_MM, LOADS_KN, variant,
};
use crate::run::force::{self, ForceSource, SAMPLE_RATE_HZ};
use crate::run::magnitude::after_start;
use crate::run::summary::{self, AgainstLaw, Figures};
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use bench::plants::transmission::Snapshot;
use schemars::JsonSchema;
use serde::Serialize;

/// Number of sliding speed bands over which the coefficient of friction is averaged.
const SPEED_BANDS: usize = 12;
/// Multiple of the regularisation speed below which friction is dominated by the regularised sign,
/// not by the law.
const SIGN_WIDTHS: f64 = 5.0;

/// One of the two series of runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Series {
    /// Four clearances.
    Clearance,
    /// Six loads.
    Load,
}

/// One run with additional measurements.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct PaperRun {
    /// The usual figures.
    #[serde(flatten)]
    pub figures: Figures,
    /// Frequencies after the first sign change of the angular acceleration.
    #[serde(flatten)]
    pub swing: Swing,
    /// Oscillation around each sign change relative to that in an equally long window before it.
    pub oscillation_growth: Vec<f64>,
    /// Largest angular acceleration of the shaft relative to that of the drive with the journal
    /// centred.
    pub joint_acceleration_ratio: f64,
    /// Comparison with the analytic law, if the run used networks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against_law: Option<AgainstLaw>,
    /// Mean coefficient of friction by sliding speed in m/s.
    #[serde(skip)]
    pub coefficients: Vec<(f64, f64)>,
    /// The bench as run.
    #[serde(skip)]
    pub bench: TransmissionBench,
    /// The run.
    #[serde(skip)]
    pub samples: Vec<Snapshot>,
}

/// All runs of both series.
#[derive(Clone, Debug)]
pub struct PaperRuns(Vec<PaperRun>);

/// Bearings, clearances in mm and loads in kN of all runs.
pub(super) fn cases() -> Vec<(BearingMaterial, f64, f64)> {
    let one = |bearing| {
        let clearances = CLEARANCES_MM.map(|c| (bearing, c, CLEARANCE_LOAD_KN));
        let loads = LOADS_KN.map(|l| (bearing, LOAD_CLEARANCE_MM, l));
        // 1 mm at +10 kN belongs to both series and is run once.
        clearances.into_iter().chain(loads.into_iter().skip(1))
    };
    BEARINGS.into_iter().flat_map(one).collect()
}

impl PaperRuns {
    /// Number of runs.
    pub const COUNT: u64 = 2 * (CLEARANCES_MM.len() + LOADS_KN.len() - 1) as u64;

    /// Runs everything; `finished` is called after every run.
    pub fn execute(
        base: &TransmissionBench,
        source: ForceSource,
        step_s: f64,
        threads: usize,
        finished: impl Fn() + Sync,
    ) -> Result<Self, CliError> {
        let runs = parallel::map(threads, &cases(), |_, &(bearing, clearance_mm, load_kn)| {
            let bench = variant(base, bearing, clearance_mm, load_kn).resolved();
            let run = PaperRun::execute(bench, source, step_s);
            finished();
            run
        })?;
        Ok(Self(runs))
    }

    /// Returns the runs of a series with a bearing, in the paper's order.
    pub(crate) fn of_bearing(&self, series: Series, bearing: BearingMaterial) -> Vec<&PaperRun> {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let find = |clearance: f64, load: f64| {
            self.0.iter().find(|r| {
                r.figures.bearing == bearing
                    && near(r.figures.clearance_mm, clearance)
                    && near(r.figures.load_kn, load)
            })
        };
        match series {
            Series::Clearance => CLEARANCES_MM.iter().filter_map(|&c| find(c, CLEARANCE_LOAD_KN)).collect(),
            Series::Load => LOADS_KN.iter().filter_map(|&l| find(LOAD_CLEARANCE_MM, l)).collect(),
        }
    }

    /// Returns the runs of a series with both bearings.
    pub fn series(&self, series: Series) -> Vec<&PaperRun> {
        BEARINGS.into_iter().flat_map(|bearing| self.of_bearing(series, bearing)).collect()
    }
}

impl PaperRun {
    /// Runs a resolved bench and measures.
    pub fn execute(bench: TransmissionBench, source: ForceSource, step_s: f64) -> Result<Self, CliError> {
        let forced = force::run_bench(&bench, source, step_s, || {})?;
        let against_law = if source == ForceSource::Law {
            None
        } else {
            let law = force::run_bench(&bench, ForceSource::Law, step_s, || {})?;
            Some(AgainstLaw::compare(&bench, &forced.run.samples, &law.run.samples))
        };
        let figures = Figures::from_run(&bench, source, &forced, SAMPLE_RATE_HZ);
        let samples = forced.run.samples;
        Ok(Self {
            figures,
            swing: swing::measure(&bench, &samples, SAMPLE_RATE_HZ),
            oscillation_growth: growth(&bench, &samples),
            joint_acceleration_ratio: joint_acceleration_ratio(&bench, after_start(&bench, &samples)),
            against_law,
            coefficients: coefficients(&bench, after_start(&bench, &samples)),
            bench,
            samples,
        })
    }
}

/// Angular acceleration of the shaft over time, from the speed at neighbouring samples.
pub(super) fn joint_acceleration(samples: &[Snapshot]) -> Vec<(f64, f64)> {
    let slope = |(a, b): (&Snapshot, &Snapshot)| {
        let (from, to) = (a.time_s, b.time_s);
        (0.5 * (from + to), (b.speed_rad_s - a.speed_rad_s) / (to - from))
    };
    samples.iter().zip(samples.iter().skip(1)).map(slope).collect()
}

/// Largest angular acceleration of the shaft in some samples relative to that of the drive.
pub(super) fn joint_acceleration_ratio(bench: &TransmissionBench, counted: &[Snapshot]) -> f64 {
    let ideal = counted
        .iter()
        .map(|s| summary::ideal_angular_acceleration(bench, s.time_s).abs())
        .fold(0.0, f64::max);
    joint_acceleration(counted).iter().map(|p| p.1.abs()).fold(0.0, f64::max) / ideal.max(f64::MIN_POSITIVE)
}

fn growth(bench: &TransmissionBench, samples: &[Snapshot]) -> Vec<f64> {
    let one = |reversal: f64| {
        let (from, to) = summary::oscillation_window_s(bench, reversal);
        let rms = |window| summary::fluctuation_rms_n(samples, SAMPLE_RATE_HZ, window);
        rms((from, to)) / rms((from - (to - from), from)).max(f64::MIN_POSITIVE)
    };
    summary::acceleration_reversals_s(bench).into_iter().map(one).collect()
}

/// Mean coefficient of friction in bands of the sliding speed in m/s.
pub(super) fn coefficients(bench: &TransmissionBench, samples: &[Snapshot]) -> Vec<(f64, f64)> {
    let min_speed = SIGN_WIDTHS * bench.friction.regularisation_m_s;
    let speed = |s: &Snapshot| s.contact.sliding_speed_m_s.abs();
    let max_speed = samples.iter().map(speed).fold(0.0, f64::max);
    let mut bands = [(0.0, 0.0, 0_u32); SPEED_BANDS];
    for s in samples.iter().filter(|s| s.forces.normal_n > 0.0 && speed(s) > min_speed) {
        let place = (speed(s) - min_speed) / (max_speed - min_speed).max(f64::MIN_POSITIVE);
        if let Some(band) = bands.get_mut(((place * SPEED_BANDS as f64) as usize).min(SPEED_BANDS - 1)) {
            band.0 += speed(s);
            band.1 += s.forces.friction_n.abs() / s.forces.normal_n;
            band.2 += 1;
        }
    }
    let mean = |(v, c, n): (f64, f64, u32)| (n > 0).then(|| (v / f64::from(n), c / f64::from(n)));
    bands.into_iter().filter_map(mean).collect()
}
