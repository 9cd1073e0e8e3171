//! Results of an integration: impacts, final state, errors.

use super::{ContactAngles, Slip};
use serde::{Deserialize, Serialize};

/// Onsets of one contact within one largest step at which a run counts as chattering; and changes
/// of its slip.
pub const CHATTER_CONTACTS: usize = 500;

/// One period in contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Impact {
    /// Index of the contact; 0 if the plant has one.
    pub contact: usize,
    /// Time of onset in s.
    pub onset_s: f64,
    /// Angles at onset.
    pub angles: ContactAngles,
    /// Approach speed at onset in m/s, which the latch then holds; 0 for a run that starts in
    /// contact. A law with a floor divides by the larger of the two.
    pub approach_speed_m_s: f64,
    /// Largest normal force in N.
    pub peak_force_n: f64,
    /// Time of the largest force in s.
    pub peak_s: f64,
    /// Largest deformation in m.
    pub max_deformation_m: f64,
    /// Work of the normal force so far, J; the loss of a contact that has ended.
    pub energy_lost_j: f64,
    /// Work of the normal force while the deformation grew, J.
    pub compression_work_j: f64,
    /// Number of times the contact began to stick; 0 with a friction law that does not stick.
    pub sticks: usize,
    /// Time in s for which it stuck so far.
    pub stuck_s: f64,
    /// Time of separation in s; `None` while still in contact at the end.
    pub separation_s: Option<f64>,
    /// Speed of separation in m/s; 0 until then.
    pub separation_speed_m_s: f64,
}

impl Impact {
    /// Length of the contact in s, once it has ended.
    pub fn duration_s(&self) -> Option<f64> {
        self.separation_s.map(|end| end - self.onset_s)
    }

    /// Separation speed over approach speed, once the contact has ended. Forces other than that of
    /// the contact act on it, too: a driven body may separate faster than it approached.
    pub fn speed_ratio(&self) -> Option<f64> {
        (self.separation_s.is_some() && self.approach_speed_m_s > 0.0)
            .then(|| self.separation_speed_m_s / self.approach_speed_m_s)
    }

    /// Coefficient of restitution of the contact, once it has ended: the square root of the work
    /// that the normal force returned over the work that it took up (Stronge, "Impact mechanics",
    /// 2000). It equals the speed ratio of free bodies and does not exceed 1 for driven ones.
    pub fn restitution(&self) -> Option<f64> {
        let is_known = self.separation_s.is_some() && self.compression_work_j > 0.0;
        is_known.then(|| (1.0 - self.energy_lost_j / self.compression_work_j).clamp(0.0, 1.0).sqrt())
    }
}

/// Result of an integration.
#[derive(Clone, Debug)]
pub struct Integration<const N: usize> {
    /// State at the end.
    pub state: [f64; N],
    /// Every period in contact, in the order of the onsets.
    pub impacts: Vec<Impact>,
    /// Accepted and rejected steps.
    pub steps: usize,
    /// Contacts at the end, from which another integration continues.
    pub pause: Pause,
}

/// Memory of the integrator between two spans, besides the state of the plant.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pause {
    /// Contacts in the order of the plant.
    pub contacts: Vec<ContactPhase>,
    /// Step in s that the method would take next.
    pub step_s: f64,
}

/// A contact between two spans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactPhase {
    /// Latched approach speed in m/s; none in a gap.
    pub latched_m_s: Option<f64>,
    /// Motion along the surface.
    pub slip: Slip,
    /// Period in contact so far; none in a gap.
    pub impact: Option<Impact>,
}

/// Error that ended an integration early.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IntegrationError {
    /// The method failed.
    #[error("the integrator stopped at t = {time_s:e} s: {reason}")]
    Stopped {
        /// Time reached in s.
        time_s: f64,
        /// Message of the method.
        reason: String,
    },
    /// The run needed more steps than allowed.
    #[error(
        "the integrator used {steps} steps up to t = {time_s:e} s; expected fewer than {limit}: \
         the problem is too stiff for the method"
    )]
    TooManySteps {
        /// Steps used.
        steps: usize,
        /// The limit.
        limit: usize,
        /// Time reached in s.
        time_s: f64,
    },
    /// The plant has no log to simulate.
    #[error("found plant `{plant}`, which has no log; expected a transmission bench or a driven axis")]
    NoLog {
        /// Plant of the description.
        plant: &'static str,
    },
    /// A contact became deeper than the range of its law.
    #[error(
        "a contact deformed by {deformation_m:e} m; expected at most {largest_m:e} m, the limit of its law"
    )]
    OutsideLaw {
        /// Deepest deformation.
        deformation_m: f64,
        /// Maximum deformation of the law.
        largest_m: f64,
    },
    /// Onsets follow each other too fast for separate impacts.
    #[error(
        "contact {contact} chatters: {count} onsets within {window_s:e} s up to t = {time_s:e} s; \
         expected sustained contact or separate impacts"
    )]
    Chattering {
        /// Index of the contact.
        contact: usize,
        /// Onsets counted.
        count: usize,
        /// Duration of these onsets in s.
        window_s: f64,
        /// Time reached in s.
        time_s: f64,
    },
    /// A contact changes between sticking and sliding too fast.
    #[error(
        "contact {contact} changes between sticking and sliding {count} times within {window_s:e} s up to \
         t = {time_s:e} s; expected fewer: a friction law with a regularised sign can be integrated"
    )]
    SlipChattering {
        /// Index of the contact.
        contact: usize,
        /// Changes counted.
        count: usize,
        /// Duration of these changes in s.
        window_s: f64,
        /// Time reached in s.
        time_s: f64,
    },
}

impl IntegrationError {
    /// Error of a contact whose onsets, or changes of slip, follow each other too fast.
    pub(super) const fn chattering(contact: usize, is_onset: bool, window_s: f64, time_s: f64) -> Self {
        let count = CHATTER_CONTACTS;
        if is_onset {
            Self::Chattering { contact, count, window_s, time_s }
        } else {
            Self::SlipChattering { contact, count, window_s, time_s }
        }
    }
}
