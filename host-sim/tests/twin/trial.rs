//! Faults of a controller in the middle of a run: the run ends in time with the right error, or
//! continues after a restart.

use crate::twin::{CONFIGURATION, Plan, frames};
use host_sim::controller::{Controller, ControllerError, NativeController, RemoteController};
use host_sim::run::exchange::{OnRestart, bit_differences, exchange_observed, exchange_with_restarts};
use std::time::{Duration, Instant};

/// Timeout of a sample and of the request after it, with room for a busy machine.
pub(crate) const MAX_DURATION: Duration = Duration::from_secs(15);
/// Samples of a run; the trouble occurs before the last one.
pub(crate) const SAMPLES: u32 = 120;

/// The controller's trouble ends the run with the right error, which names the last answered sample
/// and the likely cause.
pub(crate) fn stopped(
    mut controller: RemoteController,
    seed: u64,
    plan: Plan,
    is_expected: fn(&ControllerError) -> bool,
    cause: &str,
) {
    let (mut last, mut failure) = (None, None);
    for frame in frames(SAMPLES + 1, seed) {
        let started = Instant::now();
        match controller.exchange(&frame) {
            Ok(estimate) => last = Some(estimate.sequence),
            Err(error) => {
                failure = Some((error, started.elapsed()));
                break;
            }
        }
    }
    let Some((error, took)) = failure else { panic!("seed {seed}, {plan:?}: no error") };
    assert!(took < MAX_DURATION, "seed {seed}, {plan:?}: {took:?}");
    assert!(is_expected(&error), "seed {seed}, {plan:?}: {error:?}");
    let text = error.to_string();
    let named = last.map_or_else(|| "none".into(), |last| last.to_string());
    assert!(text.contains(&format!("last sequence number answered: {named}")), "seed {seed}: {text}");
    assert!(text.contains(cause), "seed {seed}: {text}");
}

/// The run continues after a restart, with the estimates of a controller that is reconfigured at
/// that sample.
pub(crate) fn continued(controller: RemoteController, seed: u64, plan: Plan) {
    let frames = frames(SAMPLES + 1, seed);
    let there =
        exchange_observed(Box::new(controller), CONFIGURATION, &frames, OnRestart::Continue, None).unwrap();
    assert_eq!(there.restarts.len(), 1, "seed {seed}, {plan:?}");
    let here = Box::new(NativeController::start(CONFIGURATION).unwrap());
    let here = exchange_with_restarts(here, CONFIGURATION, &frames, &there.restarts).unwrap();
    assert_eq!(bit_differences(&there, &here), 0, "seed {seed}, {plan:?}");
}
