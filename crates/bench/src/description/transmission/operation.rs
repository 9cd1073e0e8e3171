//! Described operation of the transmission bench: drive, load and start, length and sample times
//! of a run.

use super::{StartState, TransmissionBench, start};
use crate::signals::Profile;

impl TransmissionBench {
    /// Described motion of the drive; with a servo its order.
    pub fn drive_profile(&self) -> Profile {
        self.drive_course().unwrap_or_else(|| Profile::Cycles {
            stroke: self.drive.stroke_m,
            period_s: self.drive.period_s,
            cycles: f64::from(self.drive.cycles),
        })
    }

    /// Described load.
    pub fn load_profile(&self) -> Profile {
        let constant = || Profile::Ramp { level: self.load.force_n, ramp_s: self.load.ramp_s };
        self.load_course().unwrap_or_else(constant)
    }

    /// Journal at the start of a run.
    pub(crate) fn start_state(&self) -> StartState {
        start::state(self.start.as_ref(), self.bearing.radial_clearance_m)
    }

    /// Length of a run in s.
    pub fn duration_s(&self) -> f64 {
        self.drive.period_s * f64::from(self.drive.cycles)
    }

    /// Ascending sample times of a run at a rate, from 0 up to but without the end.
    pub fn sample_times_s(&self, rate_hz: f64) -> Vec<f64> {
        let count = (self.duration_s() * rate_hz).round() as usize;
        (0..count).map(|i| i as f64 / rate_hz).collect()
    }
}
