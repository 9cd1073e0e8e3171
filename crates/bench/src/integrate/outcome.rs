//! What an integration reports: impacts, the end, or why it ended early.

use super::ContactAngles;

/// One period in contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Impact {
    /// Which contact of the plant; 0 where there is one.
    pub contact: usize,
    /// Time of onset in s.
    pub onset_s: f64,
    /// Angles at onset.
    pub angles: ContactAngles,
    /// Approach speed at onset in m/s (0 for a run that starts in contact): what the latch then holds. A law with a
    /// floor divides by the larger of the two.
    pub approach_speed_m_s: f64,
    /// Largest normal force in N.
    pub peak_force_n: f64,
    /// Time of the largest force in s.
    pub peak_s: f64,
    /// Largest deformation in m.
    pub max_deformation_m: f64,
    /// Work that the normal force took so far, J; over a closed contact its loss.
    pub energy_lost_j: f64,
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

    /// Separation speed over approach speed, once the contact has ended.
    pub fn restitution(&self) -> Option<f64> {
        (self.separation_s.is_some() && self.approach_speed_m_s > 0.0)
            .then(|| self.separation_speed_m_s / self.approach_speed_m_s)
    }
}

/// What an integration leaves behind.
#[derive(Clone, Debug)]
pub struct Integration<const N: usize> {
    /// State at the end.
    pub state: [f64; N],
    /// Every period in contact, in the order of the onsets.
    pub impacts: Vec<Impact>,
    /// Accepted and rejected steps.
    pub steps: usize,
}

/// Why an integration ended early.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IntegrationError {
    /// The method gave up.
    #[error("the integrator stopped at t = {time_s:e} s: {reason}")]
    Stopped {
        /// Time reached in s.
        time_s: f64,
        /// The method's own words.
        reason: String,
    },
    /// The number of steps is bounded, so that no parameter set can hang a run.
    #[error(
        "the integrator used {steps} steps up to t = {time_s:e} s; expected fewer than {limit}: stiffer than the method can take"
    )]
    TooManySteps {
        /// Steps used.
        steps: usize,
        /// The limit.
        limit: usize,
        /// Time reached in s.
        time_s: f64,
    },
    /// A contact went deeper than its law holds.
    #[error(
        "a contact went {deformation_m:e} m deep; expected at most the {largest_m:e} m up to which its law holds"
    )]
    OutsideLaw {
        /// Deepest deformation.
        deformation_m: f64,
        /// The law's largest.
        largest_m: f64,
    },
    /// Onsets follow each other faster than the run can mean.
    #[error(
        "contact {contact} chatters: {count} onsets within {window_s:e} s up to t = {time_s:e} s; expected sustained contact or separate impacts"
    )]
    Chattering {
        /// Which contact.
        contact: usize,
        /// Onsets counted.
        count: usize,
        /// Within this time, s.
        window_s: f64,
        /// Time reached in s.
        time_s: f64,
    },
}
