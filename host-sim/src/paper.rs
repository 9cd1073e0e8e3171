//! The runs behind the paper's Figs. 16-20: four clearances at +10 kN and six loads at 1 mm, for both bearings.
//!
//! The paper's own load list leaves out -1 kN; it is run as well, because the fall and rise under negative load cannot
//! be seen without it.

use crate::error::CliError;
use crate::force::{self, ForceSource, SAMPLE_RATE_HZ};
use crate::parallel;
use crate::summary::{self, AgainstLaw, Figures, after_start};
use crate::swing::{self, Swing};
use bench::description::TransmissionBench;
use bench::transmission::Snapshot;
use bench::{BearingMaterial, Bench};
use serde::Serialize;

/// Clearances of Figs. 17 and 18, mm.
pub const CLEARANCES_MM: [f64; 4] = [0.1, 0.25, 0.5, 1.0];
/// Load of Figs. 17 and 18, kN.
pub const CLEARANCE_LOAD_KN: f64 = 10.0;
/// Loads of Figs. 19 and 20, kN, and -1.
pub const LOADS_KN: [f64; 6] = [10.0, 5.0, 1.0, -1.0, -5.0, -10.0];
/// Clearance of Figs. 19 and 20, mm.
pub const LOAD_CLEARANCE_MM: f64 = 1.0;
/// Both bearings, in the order of the paper.
pub const BEARINGS: [BearingMaterial; 2] = [BearingMaterial::Babbitt, BearingMaterial::Plastic];
/// Bands of the sliding speed that the coefficient of friction is averaged in.
const SPEED_BANDS: usize = 12;
/// Sliding speeds below this multiple of the regularisation belong to the sign, not to the law.
const SIGN_WIDTHS: f64 = 5.0;

/// One of the two series of runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Series {
    /// Four clearances.
    Clearance,
    /// Six loads.
    Load,
}

/// One run with what is measured on it beside the usual figures.
#[derive(Clone, Debug, Serialize)]
pub struct PaperRun {
    /// The usual figures.
    #[serde(flatten)]
    pub figures: Figures,
    /// Frequencies after the first sign change of the angular acceleration.
    #[serde(flatten)]
    pub swing: Swing,
    /// Oscillation around each sign change over that of as long a stretch before it.
    pub oscillation_growth: Vec<f64>,
    /// Largest angular acceleration of the shaft over that of the drive with the journal centred.
    pub joint_acceleration_ratio: f64,
    /// The same run with the analytic law, where the force came from networks.
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

/// The base bench with another bearing, clearance and load.
pub fn variant(
    base: &TransmissionBench,
    bearing: BearingMaterial,
    clearance_mm: f64,
    load_kn: f64,
) -> TransmissionBench {
    let mut bench = base.clone();
    bench.set_material(bearing);
    bench.set_radial_clearance(clearance_mm * 1e-3);
    bench.load.force_n = load_kn * 1e3;
    bench
}

/// The bench with its effects applied.
pub fn resolved(bench: TransmissionBench) -> Result<TransmissionBench, CliError> {
    match Bench::Transmission(Box::new(bench)).resolved() {
        Bench::Transmission(resolved) => Ok(*resolved),
        Bench::FrictionRig(_) => Err(CliError::Work("a transmission bench turned into a rig".into())),
    }
}

fn cases() -> Vec<(BearingMaterial, f64, f64)> {
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
            let bench = resolved(variant(base, bearing, clearance_mm, load_kn))?;
            let run = PaperRun::execute(bench, source, step_s);
            finished();
            run
        })?;
        Ok(Self(runs))
    }

    /// The runs of a series with a bearing, in the paper's order.
    pub fn of(&self, series: Series, bearing: BearingMaterial) -> Vec<&PaperRun> {
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

    /// The runs of a series, both bearings.
    pub fn series(&self, series: Series) -> Vec<&PaperRun> {
        BEARINGS.into_iter().flat_map(|bearing| self.of(series, bearing)).collect()
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
            Some(AgainstLaw::of(&bench, &forced.run.samples, &law.run.samples))
        };
        let figures = Figures::of(&bench, source, &forced, SAMPLE_RATE_HZ);
        let samples = forced.run.samples;
        Ok(Self {
            figures,
            swing: swing::measure(&bench, &samples, SAMPLE_RATE_HZ),
            oscillation_growth: growth(&bench, &samples),
            joint_acceleration_ratio: joint_acceleration_ratio(&bench, &samples),
            against_law,
            coefficients: coefficients(&bench, after_start(&bench, &samples)),
            bench,
            samples,
        })
    }

    /// Angular acceleration of the shaft over time, from the speed at neighbouring samples.
    pub fn joint_acceleration(&self) -> Vec<(f64, f64)> {
        joint_acceleration(after_start(&self.bench, &self.samples))
    }
}

fn joint_acceleration(samples: &[Snapshot]) -> Vec<(f64, f64)> {
    let slope = |(a, b): (&Snapshot, &Snapshot)| {
        let (from, to) = (a.time_s, b.time_s);
        (0.5 * (from + to), (b.speed_rad_s - a.speed_rad_s) / (to - from))
    };
    samples.iter().zip(samples.iter().skip(1)).map(slope).collect()
}

fn joint_acceleration_ratio(bench: &TransmissionBench, samples: &[Snapshot]) -> f64 {
    let counted = after_start(bench, samples);
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

fn coefficients(bench: &TransmissionBench, samples: &[Snapshot]) -> Vec<(f64, f64)> {
    let least = SIGN_WIDTHS * bench.friction.regularisation_m_s;
    let speed = |s: &Snapshot| s.contact.sliding_speed_m_s.abs();
    let most = samples.iter().map(speed).fold(0.0, f64::max);
    let mut bands = [(0.0, 0.0, 0_u32); SPEED_BANDS];
    for s in samples.iter().filter(|s| s.forces.normal_n > 0.0 && speed(s) > least) {
        let place = (speed(s) - least) / (most - least).max(f64::MIN_POSITIVE);
        if let Some(band) = bands.get_mut(((place * SPEED_BANDS as f64) as usize).min(SPEED_BANDS - 1)) {
            band.0 += speed(s);
            band.1 += s.forces.friction_n.abs() / s.forces.normal_n;
            band.2 += 1;
        }
    }
    let mean = |(v, c, n): (f64, f64, u32)| (n > 0).then(|| (v / f64::from(n), c / f64::from(n)));
    bands.into_iter().filter_map(mean).collect()
}
