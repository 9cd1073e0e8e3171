//! Where a run's bearing force comes from: the analytic law, as it is or held over a step, the float networks, or the
//! quantised ones.

use crate::error::CliError;
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use bench::peaks::{Peak, peaks_with_bars};
use bench::run::{DEFAULT_TOLERANCE, Run, run_with_held_force, run_with_law, snapshots};
use bench::transmission::{BearingForces, ContactView, Transmission};
use bench::two_plane::{TwoPlane, TwoPlaneSnapshot, run_two_plane};
use clap::ValueEnum;
use inference::{Bearing, ContactState, Flags, Model, Pair, shipped};
use model_quant::float_pair::{self, FloatPair};
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Source of the bearing force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ForceSource {
    /// The description's analytic laws, error-controlled.
    Law,
    /// The same laws held over the communication step: what the step alone does to a run with networks.
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

/// Rate of the controller and of a run's samples.
pub const SAMPLE_RATE_HZ: f64 = 10_000.0;
/// Communication step of the networks unless stated otherwise, s.
pub const DEFAULT_STEP_S: f64 = 1e-5;

/// Seconds that a run may last: more samples at the controller's rate would not fit into a memory.
const LONGEST_S: f64 = 2000.0;
/// The same for a bench in two planes, whose samples hold every slice.
const LONGEST_TILTING_S: f64 = 200.0;

/// A run with what its force source said about itself.
#[derive(Clone, Debug)]
pub struct ForcedRun {
    /// The run.
    pub run: Run,
    /// Wall time of the run alone, s.
    pub wall_s: f64,
    /// Peaks from the end of the load's ramp on. Of the law they are read at a tighter tolerance, and the bar is the
    /// distance from the run's own; of the networks it is the distance from a run at twice the communication step.
    pub peaks: Vec<Peak>,
    /// Share of the samples in contact on which the networks left their training range.
    pub outside_training_share: f64,
    /// Largest force that a held source gave without contact, N.
    pub without_contact_n: f64,
    /// The shaft's tilt, on a bench in two planes.
    pub tilt: Option<Tilt>,
    /// The slices at every sample, on a bench in two planes.
    pub tilting: Vec<TwoPlaneSnapshot>,
}

/// What the tilt came to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tilt {
    /// Largest angle between shaft and machine axis.
    pub largest_tilt_rad: f64,
    /// Largest line load at an end of the bearing over the mean.
    pub largest_edge_ratio: f64,
}

/// The trained bearing of a material.
pub const fn bearing_of(material: BearingMaterial) -> Bearing {
    match material {
        BearingMaterial::Babbitt => Bearing::Babbitt,
        BearingMaterial::Plastic => Bearing::Plastic,
    }
}

/// Check sum of the networks behind a source, in hexadecimal: what a recorded run depends on beside the description.
/// Empty for the laws.
pub fn identity(source: ForceSource, material: BearingMaterial) -> String {
    let bytes = match source {
        ForceSource::Law | ForceSource::HeldLaw => return String::new(),
        ForceSource::FloatNet => float_pair::shipped(bearing_of(material)),
        ForceSource::QuantisedNet => shipped(bearing_of(material)),
    };
    bytes.last_chunk::<4>().map_or_else(String::new, |sum| format!("{:08x}", u32::from_le_bytes(*sum)))
}

/// What the networks see of a contact.
pub fn contact_state(view: &ContactView) -> ContactState {
    ContactState {
        radial_clearance_m: view.radial_clearance_m as f32,
        deformation_m: view.deformation_m as f32,
        deformation_rate_m_s: view.rate_m_s as f32,
        approach_speed_m_s: view.latched_m_s as f32,
        sliding_speed_m_s: view.sliding_speed_m_s as f32,
    }
}

/// Runs a resolved bench over its drive's cycles, sampled at [`SAMPLE_RATE_HZ`]; `step_s` is the communication step of the
/// networks; `tick` is called a hundred times on the way.
pub fn run_bench(
    bench: &TransmissionBench,
    source: ForceSource,
    step_s: f64,
    tick: impl FnMut(),
) -> Result<ForcedRun, CliError> {
    let longest_s = if bench.two_plane.is_some() { LONGEST_TILTING_S } else { LONGEST_S };
    if bench.duration_s() > longest_s {
        return Err(CliError::Input(format!(
            "drive.cycles: found {} of drive.period_s {}; expected a run of at most {longest_s} s",
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
            // A step too coarse to hold the contact has no peaks, and the bar says so.
            let coarser = run_planar(bench, source, 2.0 * step_s, || {}).ok();
            extremes.against(coarser.and_then(|c| c.run.extremes).as_ref())
        }
        None => law_peaks(bench)?,
    };
    Ok(ForcedRun { wall_s, peaks, ..forced })
}

/// The analytic law's peaks: bars from the tolerance of every run, values from a tighter one.
pub fn law_peaks(bench: &TransmissionBench) -> Result<Vec<Peak>, CliError> {
    let profiles = || (bench.drive_profile(), bench.load_profile());
    let span = (bench.load.ramp_s, bench.duration_s());
    Ok(peaks_with_bars(span, DEFAULT_TOLERANCE, |tolerance, times| {
        snapshots(bench, profiles(), bench.duration_s(), times, tolerance)
    })?)
}

/// The bench in two planes; the networks know a bearing without tilt only.
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
        steps: run.steps,
        extremes: None,
    };
    Ok(ForcedRun { tilt: Some(tilt), tilting, ..ForcedRun::of(run) })
}

impl ForcedRun {
    fn of(run: Run) -> Self {
        Self {
            run,
            wall_s: 0.0,
            peaks: Vec::new(),
            outside_training_share: 0.0,
            without_contact_n: 0.0,
            tilt: None,
            tilting: Vec::new(),
        }
    }
}

/// The planar bench with a force source.
fn run_planar(
    bench: &TransmissionBench,
    source: ForceSource,
    step_s: f64,
    mut tick: impl FnMut(),
) -> Result<ForcedRun, CliError> {
    let plant = &Transmission::new(bench, bench.drive_profile(), bench.load_profile());
    let (samples_s, end_s) = (&bench.sample_times_s(SAMPLE_RATE_HZ), bench.duration_s());
    let bearing = bearing_of(bench.bearing.material);
    let every = ((end_s / step_s / 100.0) as usize).max(1);
    let (mut steps, mut contacts, mut outside) = (0_usize, 0_usize, 0_usize);
    let mut without_contact_n = 0.0_f64;
    let mut held = |view: &ContactView, [normal_n, friction_n]: [f64; 2], flags: Flags| {
        steps += 1;
        if steps.is_multiple_of(every) {
            tick();
        }
        if view.deformation_m > 0.0 {
            contacts += 1;
            outside += usize::from(flags.intersects(Flags::OUTSIDE_TRAINING));
        } else {
            without_contact_n = without_contact_n.max(normal_n.abs()).max(friction_n.abs());
        }
        BearingForces { normal_n, friction_n }
    };
    let run = match source {
        ForceSource::Law => run_with_law(plant, end_s, samples_s, DEFAULT_TOLERANCE)?,
        ForceSource::HeldLaw => run_with_held_force(plant, end_s, samples_s, step_s, |view| {
            let law = plant.law(view);
            held(view, [law.normal_n, law.friction_n], Flags::NONE)
        })?,
        ForceSource::FloatNet => {
            let mut pair =
                FloatPair::new(bearing).map_err(|e| CliError::Work(format!("shipped checkpoint: {e}")))?;
            run_with_held_force(plant, end_s, samples_s, step_s, |view| {
                let estimate = pair.push(&contact_state(view));
                let forces = [estimate.normal_force_n, estimate.friction_force_n].map(f64::from);
                held(view, forces, estimate.flags)
            })?
        }
        ForceSource::QuantisedNet => {
            let model =
                Model::load(shipped(bearing)).map_err(|e| CliError::Work(format!("shipped image: {e}")))?;
            let mut pair: Pair = Pair::new(model);
            run_with_held_force(plant, end_s, samples_s, step_s, |view| {
                let estimate = pair.push(&contact_state(view));
                let forces = [estimate.normal_force_n(), estimate.friction_force_n()].map(f64::from);
                held(view, forces, estimate.flags)
            })?
        }
    };
    let outside_training_share = if contacts > 0 { outside as f64 / contacts as f64 } else { 0.0 };
    Ok(ForcedRun { outside_training_share, without_contact_n, ..ForcedRun::of(run) })
}
