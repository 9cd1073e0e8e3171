//! Clearance that the controller tracks at a few points of a life.
//!
//! At each point the bench runs with the effect `clearance-wear` of the predicted size. The
//! controller of this process gets the noisy sensors. It is configured as it was for the new
//! bearing, and starts from the clearance that it tracked at the point before, as a controller does
//! that works through the life. Where it cannot track, it keeps the clearance it knows.

use crate::cli::error::CliError;
use crate::cli::{parallel, progress};
use crate::controller::NativeController;
use crate::run::configuration::lockstep_configuration;
use crate::run::exchange::exchange;
use crate::run::force::SAMPLE_RATE_HZ;
use crate::run::sensing;
use bench::Bench;
use bench::description::{Effect, TransmissionBench};
use bench::plants::transmission::Transmission;
use bench::simulate::life::Life;
use bench::simulate::{DEFAULT_TOLERANCE, run_bench_with_law};
use link::{ContactSource, SensorFrame};
use schemars::JsonSchema;
use serde::Serialize;

/// Points of a life that are followed.
const POINTS: u32 = 6;

/// Effect that a life ends in.
const EFFECT: &str = "clearance-wear";
/// Its parameter.
const PARAMETER: &str = "clearance_increase_m";

/// Settings that do not belong to the bench.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings {
    /// Source of the contact in the estimate.
    pub(crate) contact: ContactSource,
    /// Seed of the sensors' noise.
    pub(crate) seed: u64,
    /// Threads; 0: one per core.
    pub(crate) threads: usize,
}

/// Clearance at one point of a life.
#[derive(Clone, Copy, Debug, JsonSchema, Serialize)]
pub(crate) struct Tracked {
    /// Cycle.
    pub(crate) cycle: f64,
    /// Predicted clearance, with which the bench ran.
    pub(crate) predicted_m: f64,
    /// Tracked clearance at the end of the run; none if the estimator could not track it.
    pub(crate) clearance_m: Option<f64>,
    /// Its deviation.
    pub(crate) clearance_sd_m: Option<f64>,
}

/// Follows a life up to a cycle.
pub(super) fn follow(
    bench: &TransmissionBench,
    life: &Life,
    cycles: f64,
    settings: Settings,
) -> Result<Vec<Tracked>, CliError> {
    let last = f64::from(POINTS - 1);
    let points: Vec<f64> = (0..POINTS).map(|i| cycles * f64::from(i) / last).collect();
    let bar = progress::bar(u64::from(POINTS));
    bar.set_message("controller");
    let frames = parallel::map(settings.threads, &points, |index, cycle| {
        let frames = sensed(bench, life.clearance_m(*cycle), settings.seed.wrapping_add(index as u64))?;
        bar.inc(1);
        Ok(frames)
    })?;
    bar.finish_and_clear();
    let mut known_m = bench.bearing.radial_clearance_m;
    let mut tracked = Vec::with_capacity(points.len());
    for (cycle, frames) in points.into_iter().zip(&frames) {
        let mut configured = bench.clone();
        configured.bearing.radial_clearance_m = known_m;
        let plant = Transmission::new(&configured, configured.drive_profile(), configured.load_profile());
        let configuration = lockstep_configuration(&plant, &configured, SAMPLE_RATE_HZ, settings.contact)?;
        let controller = NativeController::start(configuration).map_err(|e| CliError::Work(e.to_string()))?;
        let found = exchange(Box::new(controller), frames).map_err(|e| CliError::Work(e.to_string()))?;
        let estimate = found.estimates.last().map(|e| [e.clearance_m, e.clearance_sd_m].map(f64::from));
        let valid = estimate.filter(|[clearance_m, sd_m]| *clearance_m > 0.0 && sd_m.is_finite());
        known_m = valid.map_or(known_m, |[clearance_m, _]| clearance_m);
        tracked.push(Tracked {
            cycle,
            predicted_m: life.clearance_m(cycle),
            clearance_m: valid.map(|[clearance_m, _]| clearance_m),
            clearance_sd_m: valid.map(|[_, sd_m]| sd_m),
        });
    }
    Ok(tracked)
}

/// Sensor frames of the bench with a larger clearance.
fn sensed(bench: &TransmissionBench, clearance_m: f64, seed: u64) -> Result<Vec<SensorFrame>, CliError> {
    let mut worn = bench.clone();
    worn.common.effects.push(wear_effect(clearance_m - bench.bearing.radial_clearance_m));
    let worn = worn.resolved();
    let run = run_bench_with_law(&worn, &worn.sample_times_s(SAMPLE_RATE_HZ), DEFAULT_TOLERANCE)?;
    Ok(sensing::frames(&Bench::from(worn), &run.samples, seed))
}

/// Effect of a larger clearance.
pub(super) fn wear_effect(increase_m: f64) -> Effect {
    let parameters = [(PARAMETER.to_owned(), increase_m)].into();
    Effect { name: EFFECT.into(), channel: None, of: None, parameters }
}
