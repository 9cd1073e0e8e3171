//! Virtual sensors of clearance, friction and stiffness: the filter's factors with their
//! deviations, compared with the limits of wear and friction.
//!
//! The alarms compare one sample in [`INTERVAL`], and only while the estimate has converged, its
//! model fits, no sensor is faulty, and the stiffness is within [`PLAUSIBLE`] declared deviations:
//! after an unlucky start a wrong stiffness hides a wrong clearance.

use super::alarm::{Alarm, AlarmState, ENOUGH};
use crate::integrity::words;
use link::EstimateFrame;
use link::track::{MonitorConfiguration, SafeState, TrackReport};

/// Samples from one comparison to the next: 26 ms at 10 kHz.
const INTERVAL: u32 = 256;

/// Comparisons without one that counts after which an alarm's state is unknown: 6.5 s at 10 kHz.
const MAX_IDLE: u32 = 256;
/// Declared deviations of the stiffness within which the factors are compared.
const PLAUSIBLE: f32 = 3.0;

/// Limits of the alarms.
#[derive(Clone, Debug)]
pub(super) struct Tracked {
    wear: Alarm,
    friction: Alarm,
    /// Largest difference of the stiffness factor from 1.
    stiffness_limit: f32,
}
words!(Tracked { wear, friction, stiffness_limit });

/// State of the alarms, and the factors that were compared last.
#[derive(Clone, Debug, Default)]
pub(super) struct TrackedState {
    wear: AlarmState,
    friction: AlarmState,
    /// Comparisons that counted, saturating; 0 again when none has counted for long.
    comparisons: u32,
    /// Comparisons since the last one that counted.
    idle: u32,
    place: u32,
    last: Factors,
}

/// Factors with their deviations.
#[derive(Clone, Copy, Debug)]
struct Factors {
    clearance_m: [f32; 2],
    friction: [f32; 2],
    stiffness: [f32; 2],
}

impl Default for Factors {
    fn default() -> Self {
        let unknown = [1.0, f32::INFINITY];
        Self { clearance_m: [0.0, f32::INFINITY], friction: unknown, stiffness: unknown }
    }
}

impl Tracked {
    /// Prepares the alarms of a configuration; a friction limit of 0 is none.
    pub(super) fn new(monitor: &MonitorConfiguration) -> Self {
        Self {
            wear: Alarm::for_wear(monitor.wear_limit_nm, monitor.wear_hysteresis_nm),
            friction: Alarm::for_friction(0),
            stiffness_limit: PLAUSIBLE * f32::from(monitor.stiffness_deviation_per_mille.max(1)) * 1e-3,
        }
    }

    /// Sets the limit of the friction level, thousandths; 0 for none.
    pub(super) fn limit_friction(&mut self, per_mille: u16) {
        self.friction = Alarm::for_friction(per_mille);
    }

    /// Takes an estimate; `counts` is false if the estimate cannot be trusted or has not converged.
    pub(super) fn step(&self, state: &mut TrackedState, estimate: &EstimateFrame, counts: bool) {
        state.last = Factors {
            clearance_m: [estimate.clearance_m, estimate.clearance_sd_m],
            friction: [estimate.friction_factor, estimate.friction_sd],
            stiffness: [estimate.stiffness_factor, estimate.stiffness_sd],
        };
        state.place = state.place.wrapping_add(1) % INTERVAL;
        if state.place != 0 {
            return;
        }
        let Factors { clearance_m: [clearance, clearance_sd], friction: [friction, friction_sd], .. } =
            state.last;
        state.idle = state.idle.saturating_add(1);
        let counts = counts & ((state.last.stiffness[0] - 1.0).abs() <= self.stiffness_limit);
        if counts {
            (state.comparisons, state.idle) = (state.comparisons.saturating_add(1), 0);
        } else if state.idle > MAX_IDLE {
            state.comparisons = 0;
        }
        let counts = counts & (state.comparisons >= ENOUGH);
        self.wear.update(&mut state.wear, clearance, clearance_sd * clearance_sd, counts);
        self.friction.update(&mut state.friction, friction, friction_sd * friction_sd, counts);
    }

    /// The tracked quantities; the monitor fills in time and safe state.
    pub(super) fn report(&self, state: &TrackedState) -> TrackReport {
        let Factors { clearance_m, friction, stiffness } = state.last;
        // Infinity saturates.
        let scaled = |value: f32, unit: f32| (value * unit) as u32;
        TrackReport {
            time_us: 0,
            radial_clearance_nm: scaled(clearance_m[0], 1e9),
            radial_clearance_deviation_nm: scaled(clearance_m[1], 1e9),
            friction_level_per_mille: scaled(friction[0], 1e3),
            friction_level_deviation_per_mille: scaled(friction[1], 1e3),
            stiffness_per_mille: scaled(stiffness[0], 1e3),
            stiffness_deviation_per_mille: scaled(stiffness[1], 1e3),
            wear: state.wear.wear(state.comparisons),
            wear_alarms: state.wear.count(),
            friction: self.friction.friction(&state.friction, state.comparisons),
            friction_alarms: state.friction.count(),
            safe_state: SafeState::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::configuration::BENCH_B;
    use link::track::Wear;

    #[test]
    fn an_alarm_s_state_is_unknown_again_when_nothing_has_counted_for_long() {
        let tracked = Tracked::new(&BENCH_B.monitor);
        let mut state = TrackedState::default();
        let estimate = EstimateFrame { clearance_m: 5e-4, clearance_sd_m: 1e-6, ..EstimateFrame::UNKNOWN };
        let mut follow = |comparisons: u32, counts: bool| {
            for _ in 0..comparisons * INTERVAL {
                tracked.step(&mut state, &estimate, counts);
            }
            tracked.report(&state).wear
        };
        assert_eq!(follow(40, true), Wear::Below);
        assert_eq!(follow(MAX_IDLE, false), Wear::Below);
        assert_eq!(follow(1, false), Wear::Unknown);
    }
}
