//! Where a run's bearing force comes from: the analytic law, the float networks, or the quantised ones.

use crate::error::CliError;
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use bench::run::{DEFAULT_TOLERANCE, Run, run_with_held_force, run_with_law};
use bench::transmission::{BearingForces, ContactView, Transmission};
use bench::two_plane::{TwoPlane, TwoPlaneSnapshot, run_two_plane};
use clap::ValueEnum;
use inference::{Bearing, ContactState, Flags, Model, Pair, shipped};
use model_quant::float_pair::{self, FloatPair};
use serde::{Deserialize, Serialize};

/// Source of the bearing force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ForceSource {
    /// The description's analytic laws, error-controlled.
    Law,
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
            Self::FloatNet => "float-net",
            Self::QuantisedNet => "quantised-net",
        }
    }
}

/// Rate of the controller and of a run's samples.
pub const SAMPLE_RATE_HZ: f64 = 10_000.0;
/// Communication step of the networks unless stated otherwise, s.
pub const DEFAULT_STEP_S: f64 = 1e-5;

/// A run with what its force source said about itself.
#[derive(Clone, Debug)]
pub struct ForcedRun {
    /// The run.
    pub run: Run,
    /// Share of the samples in contact on which the networks left their training range.
    pub outside_training_share: f64,
    /// The shaft's tilt, on a bench in two planes.
    pub tilt: Option<Tilt>,
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
/// Empty for the law.
pub fn identity(source: ForceSource, material: BearingMaterial) -> String {
    let bytes = match source {
        ForceSource::Law => return String::new(),
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

/// Runs a resolved bench over its drive's cycles, sampled at [`SAMPLE_RATE_HZ`]; `step_s` and `tick` as in [`run`].
pub fn run_bench(
    bench: &TransmissionBench,
    source: ForceSource,
    step_s: f64,
    tick: impl FnMut(),
) -> Result<ForcedRun, CliError> {
    if bench.two_plane.is_some() {
        return run_tilting(bench, source);
    }
    let plant = Transmission::new(bench, bench.drive_profile(), bench.load_profile());
    let times = bench.sample_times_s(SAMPLE_RATE_HZ);
    run(&plant, bench.bearing.material, source, (bench.duration_s(), step_s), &times, tick)
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
    let run = Run {
        samples: run.samples.into_iter().map(|s| s.planar).collect(),
        impacts: run.impacts,
        energy_residual_rel: run.energy.residual_rel,
        energy: run.energy,
        steps: run.steps,
    };
    Ok(ForcedRun { run, outside_training_share: 0.0, tilt: Some(tilt) })
}

/// Runs the plant with a force source. `end_s` and `samples_s` as in `bench::run`; `step_s` is the communication step
/// of the networks; `tick` is called a hundred times on the way.
pub fn run(
    plant: &Transmission,
    material: BearingMaterial,
    source: ForceSource,
    (end_s, step_s): (f64, f64),
    samples_s: &[f64],
    mut tick: impl FnMut(),
) -> Result<ForcedRun, CliError> {
    let bearing = bearing_of(material);
    let every = ((end_s / step_s / 100.0) as usize).max(1);
    let (mut steps, mut contacts, mut outside) = (0_usize, 0_usize, 0_usize);
    let mut held = |view: &ContactView, [normal_n, friction_n]: [f32; 2], flags: Flags| {
        steps += 1;
        if steps.is_multiple_of(every) {
            tick();
        }
        if view.deformation_m > 0.0 {
            contacts += 1;
            outside += usize::from(flags.intersects(Flags::OUTSIDE_TRAINING));
        }
        BearingForces { normal_n: f64::from(normal_n), friction_n: f64::from(friction_n) }
    };
    let run = match source {
        ForceSource::Law => run_with_law(plant, end_s, samples_s, DEFAULT_TOLERANCE)?,
        ForceSource::FloatNet => {
            let mut pair =
                FloatPair::new(bearing).map_err(|e| CliError::Work(format!("shipped checkpoint: {e}")))?;
            run_with_held_force(plant, end_s, samples_s, step_s, |view| {
                let estimate = pair.push(&contact_state(view));
                held(view, [estimate.normal_force_n, estimate.friction_force_n], estimate.flags)
            })?
        }
        ForceSource::QuantisedNet => {
            let model =
                Model::load(shipped(bearing)).map_err(|e| CliError::Work(format!("shipped image: {e}")))?;
            let mut pair: Pair = Pair::new(model);
            run_with_held_force(plant, end_s, samples_s, step_s, |view| {
                let estimate = pair.push(&contact_state(view));
                held(view, [estimate.normal_force_n(), estimate.friction_force_n()], estimate.flags)
            })?
        }
    };
    Ok(ForcedRun {
        run,
        outside_training_share: if contacts > 0 { outside as f64 / contacts as f64 } else { 0.0 },
        tilt: None,
    })
}
