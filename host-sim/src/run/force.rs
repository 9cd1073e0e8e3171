//! Sources of the bearing force: the analytic law, the law held over a step, the float networks,
//! the quantised networks.

use crate::cli::error::CliError;
use crate::fmu::plant_unit::PlantFigures;
use crate::run::networks::{Networks, Readings};
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use bench::plants::transmission::{ContactView, Transmission};
use bench::plants::two_plane::{TwoPlane, TwoPlaneSnapshot, run_two_plane};
use bench::simulate::peaks::{Peak, peaks_with_bars};
use bench::simulate::{DEFAULT_TOLERANCE, Run, run_bench_with_law, run_with_held_force, snapshots};
use bench::sticking_plants;
use clap::ValueEnum;
use inference::{Flags, shipped};
use model_quant::network::shipped::shipped_checkpoint;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Source of the bearing force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, JsonSchema, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ForceSource {
    /// The description's analytic laws, error-controlled.
    Law,
    /// The same laws held over the communication step: shows the effect of the step alone.
    HeldLaw,
    /// The trained networks in floating point, held over the communication step.
    FloatNet,
    /// The quantised networks, the controller's own code, held over the communication step.
    QuantisedNet,
}

impl ForceSource {
    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Law => "law",
            Self::HeldLaw => "held-law",
            Self::FloatNet => "float-net",
            Self::QuantisedNet => "quantised-net",
        }
    }
}

/// Sample rate of the controller and of a run, Hz.
pub const SAMPLE_RATE_HZ: f64 = 10_000.0;
/// Default communication step of the networks, s.
pub const DEFAULT_STEP_S: f64 = 1e-5;

/// Maximum duration of a run, s. The samples of a longer one would not fit into memory.
const MAX_S: f64 = 2000.0;
/// Maximum duration on a bench in two planes, whose samples contain every slice, s.
const MAX_TILTING_S: f64 = 200.0;

/// A run with data about its force source.
#[derive(Clone, Debug)]
pub struct ForcedRun {
    /// The run.
    pub run: Run,
    /// Wall time of the run alone, s.
    pub wall_s: f64,
    /// Peaks from the end of the load's ramp on. With the law they are read at a tighter tolerance
    /// than the run's, and the error bars come from that run and one at a wider tolerance. With
    /// networks they come from runs at twice and four times the communication step.
    pub peaks: Vec<Peak>,
    /// Share of the contact samples outside the networks' training range.
    pub outside_training_share: f64,
    /// Largest force of a held source without contact, N.
    pub without_contact_n: f64,
    /// The shaft's tilt, on a bench in two planes.
    pub tilt: Option<Tilt>,
    /// The slices at every sample, on a bench in two planes.
    pub tilting: Vec<TwoPlaneSnapshot>,
    /// Unit of another program that was the plant.
    pub plant: Option<PlantFigures>,
}

/// Largest tilt of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Tilt {
    /// Largest angle between shaft and machine axis.
    pub largest_tilt_rad: f64,
    /// Largest line load at an end of the bearing relative to the mean.
    pub largest_edge_ratio: f64,
}

/// Checksum of a source's networks, in hexadecimal. A recorded run depends on it as well as on the
/// description. Empty for the laws.
pub fn identity(source: ForceSource, material: BearingMaterial) -> String {
    let bytes = match source {
        ForceSource::Law | ForceSource::HeldLaw => return String::new(),
        ForceSource::FloatNet => shipped_checkpoint(material),
        ForceSource::QuantisedNet => shipped(material),
    };
    bytes.last_chunk::<4>().map_or_else(String::new, |sum| format!("{:08x}", u32::from_le_bytes(*sum)))
}

/// Runs a resolved bench over its drive's cycles, sampled at [`SAMPLE_RATE_HZ`]. `step_s` is the
/// communication step of the networks. `tick` is called about a hundred times during the run.
pub fn run_bench(
    bench: &TransmissionBench,
    source: ForceSource,
    step_s: f64,
    tick: impl FnMut(),
) -> Result<ForcedRun, CliError> {
    let max_s = if bench.two_plane.is_some() { MAX_TILTING_S } else { MAX_S };
    if bench.duration_s() > max_s {
        return Err(CliError::Input(format!(
            "drive.cycles: found {} of drive.period_s {}; expected a run of at most {max_s} s",
            bench.drive.cycles, bench.drive.period_s
        )));
    }
    let started = Instant::now();
    let forced = if bench.two_plane.is_some() {
        run_tilting(bench, source)?
    } else {
        run_planar(bench, source, step_s, tick)?
    };
    let wall_s = started.elapsed().as_secs_f64();
    let peaks = match &forced.run.extremes {
        Some(extremes) => {
            // A step too coarse for the contact gives no peaks: the error bar is wide or unknown.
            let coarser = [2.0, 4.0].map(|factor| {
                let forced = run_planar(bench, source, factor * step_s, || {}).ok();
                forced.and_then(|forced| forced.run.extremes)
            });
            extremes.to_peaks(coarser.each_ref().map(Option::as_ref))
        }
        None => law_peaks(bench)?,
    };
    Ok(ForcedRun { wall_s, peaks, ..forced })
}

/// Peaks of the analytic law, read at a tighter tolerance than the run's, with their error bars.
pub fn law_peaks(bench: &TransmissionBench) -> Result<Vec<Peak>, CliError> {
    let profiles = || (bench.drive_profile(), bench.load_profile());
    let span = (bench.load.ramp_s, bench.duration_s());
    Ok(peaks_with_bars(span, DEFAULT_TOLERANCE, |tolerance, times| {
        snapshots(bench, profiles(), bench.duration_s(), times, tolerance)
    })?)
}

/// Runs the bench in two planes. The networks are trained without tilt, so only the law is allowed.
fn run_tilting(bench: &TransmissionBench, source: ForceSource) -> Result<ForcedRun, CliError> {
    if source != ForceSource::Law {
        return Err(CliError::Input(format!(
            "force: found {} on a bench with [two_plane]; expected law: the networks know no tilt",
            source.name()
        )));
    }
    let plant = TwoPlane::new(bench, bench.drive_profile(), bench.load_profile());
    let times = bench.sample_times_s(SAMPLE_RATE_HZ);
    let run = run_two_plane(&plant, bench.duration_s(), &times, DEFAULT_TOLERANCE)?;
    let largest = |read: fn(&TwoPlaneSnapshot) -> f64| run.samples.iter().map(read).fold(0.0, f64::max);
    let tilt = Tilt {
        largest_tilt_rad: largest(|s| s.tilt_about_y_rad.hypot(s.tilt_about_z_rad)),
        largest_edge_ratio: largest(TwoPlaneSnapshot::edge_ratio),
    };
    let tilting = run.samples;
    let run = Run {
        samples: tilting.iter().map(|s| s.planar).collect(),
        impacts: run.impacts,
        energy_residual_rel: run.energy.residual_rel,
        energy: run.energy,
        losses_j: run.losses_j,
        steps: run.steps,
        extremes: None,
    };
    Ok(ForcedRun { tilt: Some(tilt), tilting, ..ForcedRun::from_run(run) })
}

impl ForcedRun {
    pub(crate) fn from_run(run: Run) -> Self {
        Self {
            run,
            wall_s: 0.0,
            peaks: Vec::new(),
            outside_training_share: 0.0,
            without_contact_n: 0.0,
            tilt: None,
            tilting: Vec::new(),
            plant: None,
        }
    }
}

/// Runs the planar bench.
fn run_planar(
    bench: &TransmissionBench,
    source: ForceSource,
    step_s: f64,
    mut tick: impl FnMut(),
) -> Result<ForcedRun, CliError> {
    if bench.servo.is_some() && source != ForceSource::Law {
        return Err(CliError::Input(format!(
            "force: found {} on a bench with [servo]; expected law: a held force is no part of its loop",
            source.name()
        )));
    }
    let sticks = bench.friction.law.is_some_and(|law| sticking_plants(law.0.entry().name).is_some());
    if sticks && source == ForceSource::HeldLaw {
        return Err(CliError::Input(
            "force: found held-law on a bench whose friction sticks; expected law: held forces do not stick"
                .into(),
        ));
    }
    let plant = &Transmission::new(bench, bench.drive_profile(), bench.load_profile());
    let (samples_s, end_s) = (&bench.sample_times_s(SAMPLE_RATE_HZ), bench.duration_s());
    let every = ((end_s / step_s / 100.0) as usize).max(1);
    let (mut steps, mut readings) = (0_usize, Readings::default());
    let mut held = |view: &ContactView, reading: ([f64; 2], Flags)| {
        steps += 1;
        if steps.is_multiple_of(every) {
            tick();
        }
        readings.count(view, reading)
    };
    let run = match source {
        ForceSource::Law => run_bench_with_law(bench, samples_s, DEFAULT_TOLERANCE)?,
        ForceSource::HeldLaw => run_with_held_force(plant, end_s, samples_s, step_s, |view| {
            let law = plant.law(view);
            held(view, ([law.normal_n, law.friction_n], Flags::NONE))
        })?,
        ForceSource::FloatNet | ForceSource::QuantisedNet => {
            let mut networks = Networks::new(source, bench.bearing.material)?;
            run_with_held_force(plant, end_s, samples_s, step_s, |view| held(view, networks.push(view)))?
        }
    };
    Ok(ForcedRun {
        outside_training_share: readings.outside_share(),
        without_contact_n: readings.without_contact_n,
        ..ForcedRun::from_run(run)
    })
}
