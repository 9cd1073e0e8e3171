//! Lines for the controller's log: changes of the session's state, and what was lost since the last
//! line.

use link::State;
use rtic_core::Mutex;

use super::{Platform, SampleSource, SharedSession};

/// Time between two looks, us. A state that lasts for less has no line.
const INTERVAL_US: u32 = 100_000;

/// A line of the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogEvent {
    /// State of the session, after it has changed.
    State(LoggedState),
    /// Counts that have grown.
    Losses(Losses),
    /// A request about models was refused; number of packages that were refused so far.
    RefusedUpdate(u16),
}

/// State of the session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoggedState {
    /// State.
    pub state: State,
    /// True if the board's sensors are sampled.
    pub is_sampling: bool,
    /// Sample period, us.
    pub period_us: u32,
}

/// Counts of what was late, lost or refused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    /// Estimates later than their period.
    pub late: u32,
    /// Own samples that no tick took, and samples of the link without room.
    pub samples: u32,
    /// Estimates without room.
    pub estimates: u32,
    /// Bytes without room, and frames that were refused.
    pub received: u32,
    /// Commands that were refused.
    pub commands: u32,
}

/// Contents of the last lines.
#[derive(Debug, Default)]
pub(super) struct Journal {
    looked_us: u32,
    state: Option<LoggedState>,
    losses: Losses,
}

impl Journal {
    /// Logs what has changed, if it is time for a look.
    pub(super) fn look<S: SampleSource>(
        &mut self,
        shared: &mut impl Mutex<T = SharedSession<S>>,
        platform: &impl Platform,
    ) {
        let now_us = platform.uptime_us();
        if now_us.wrapping_sub(self.looked_us) < INTERVAL_US {
            return;
        }
        self.looked_us = now_us;
        let (state, losses) = shared.lock(|shared| (shared.logged_state(), shared.losses()));
        if self.state.replace(state) != Some(state) {
            platform.log(&LogEvent::State(state));
        }
        if self.losses != losses {
            platform.log(&LogEvent::Losses(losses));
        }
        self.losses = losses;
    }
}
