//! A controller that goes in the middle of a run: the run ends in time with the right error, or goes on behind a restart.

use crate::twin::{CONFIGURATION, Plan, frames};
use host_sim::controller::{Controller, ControllerError, NativeController, RemoteController};
use host_sim::estimator::{OnRestart, bit_differences, track_restarting, track_through};
use std::time::{Duration, Instant};

/// A sample's wait, the question after it, and room for a busy machine.
pub(crate) const MOST: Duration = Duration::from_secs(6);
/// Samples of a run; its trouble comes before the last.
pub(crate) const SAMPLES: u32 = 120;

/// The controller's trouble ends the run with the right error, which tells the last sample that was answered and the likely cause.
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
    assert!(took < MOST, "seed {seed}, {plan:?}: {took:?}");
    assert!(is_expected(&error), "seed {seed}, {plan:?}: {error:?}");
    let text = error.to_string();
    let told = last.map_or_else(|| "none".into(), |last| last.to_string());
    assert!(text.contains(&format!("last sequence number answered: {told}")), "seed {seed}: {text}");
    assert!(text.contains(cause), "seed {seed}: {text}");
}

/// Asked to, the run goes on behind a restart, with the estimates of a controller configured anew there.
pub(crate) fn gone_on(controller: RemoteController, seed: u64, plan: Plan) {
    let frames = frames(SAMPLES + 1, seed);
    let there = track_through(Box::new(controller), CONFIGURATION, &frames, OnRestart::Continue).unwrap();
    assert_eq!(there.restarts.len(), 1, "seed {seed}, {plan:?}");
    let here = Box::new(NativeController::start(CONFIGURATION).unwrap());
    let here = track_restarting(here, CONFIGURATION, &frames, &there.restarts).unwrap();
    assert_eq!(bit_differences(&there, &here), 0, "seed {seed}, {plan:?}");
}
