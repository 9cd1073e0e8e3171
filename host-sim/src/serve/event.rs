//! Events that a page receives, as JSON. `docs/serve.md` describes the stream.
//!
//! Times are in us and positions in nm, as the controller's frames have them; the rest is in SI
//! units. A number that is infinite is written as null.

use crate::impact_text;
use controller::flags::NAMES;
use link::ImpactRecord;
use schemars::JsonSchema;
use serde::Serialize;

/// Event of a live run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub(crate) enum Event {
    /// First event: the run. A page that has shown another run before begins anew.
    Start(Start),
    /// Consecutive blocks of samples.
    Blocks(Blocks),
    /// Impact that has ended.
    Impact(Impact),
    /// Events are missing that the history no longer contains.
    Gap(Gap),
    /// Last event.
    End(End),
}

/// Description of a run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub(crate) struct Start {
    /// Title: bearing, clearance, load, controller.
    pub(crate) title: String,
    /// Transport: `native`, `emulated` or `attached`.
    pub(crate) controller: String,
    /// Duration of the run, s.
    pub(crate) duration_s: f64,
    /// Radial clearance as described, nm.
    pub(crate) clearance_nm: f64,
    /// Samples per second.
    pub(crate) sample_rate_hz: f64,
    /// Samples of a complete block.
    pub(crate) block_samples: u32,
    /// Flags with their bits.
    pub(crate) flags: Vec<FlagName>,
}

/// Name of a flag.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub(crate) struct FlagName {
    /// Value of the bit.
    pub(crate) bit: u32,
    /// Name, as in reports.
    pub(crate) name: &'static str,
}

impl FlagName {
    /// Returns the names of all flags.
    pub(crate) fn all() -> Vec<Self> {
        NAMES.iter().map(|(flag, name)| Self { bit: flag.bits(), name }).collect()
    }
}

/// Blocks of samples as columns: element `i` of every column belongs to block `i`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub(crate) struct Blocks {
    /// Sequence number of the first sample.
    pub(crate) first_sequence: Vec<u32>,
    /// Number of samples.
    pub(crate) samples: Vec<u32>,
    /// Time of the first sample, us.
    pub(crate) first_us: Vec<u32>,
    /// Time of the last sample, us.
    pub(crate) last_us: Vec<u32>,
    /// Smallest normal force, N.
    pub(crate) min_force_n: Vec<f32>,
    /// Largest normal force, N.
    pub(crate) max_force_n: Vec<f32>,
    /// Smallest normal force less two standard deviations, N; null if a deviation is unknown.
    pub(crate) lower_n: Vec<f32>,
    /// Largest normal force plus two standard deviations, N; null if a deviation is unknown.
    pub(crate) upper_n: Vec<f32>,
    /// Normal force of the last sample, N.
    pub(crate) force_n: Vec<f32>,
    /// Friction torque of the last sample, N m.
    pub(crate) friction_torque_nm: Vec<f32>,
    /// Journal along y at the last sample, nm.
    pub(crate) journal_y_nm: Vec<i32>,
    /// Journal along z (up) at the last sample, nm.
    pub(crate) journal_z_nm: Vec<i32>,
    /// Journal along y at the sample farthest from the bearing's centre, nm.
    pub(crate) outermost_y_nm: Vec<i32>,
    /// Journal along z (up) at the sample farthest from the bearing's centre, nm.
    pub(crate) outermost_z_nm: Vec<i32>,
    /// Flags of all samples, combined by OR.
    pub(crate) flags: Vec<u32>,
}

/// Impact, with the columns of `estimated_impacts.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub(crate) struct Impact {
    /// Number of the impact in its run, from 0.
    pub(crate) number: u32,
    /// Sequence number of the first sample in contact.
    pub(crate) onset_sequence: u32,
    /// Time of the onset, us.
    pub(crate) onset_us: u32,
    /// Time of the peak, us.
    pub(crate) peak_us: u32,
    /// Time from onset to end, us.
    pub(crate) duration_us: u32,
    /// Largest normal force, N.
    pub(crate) peak_force_n: f32,
    /// Standard deviation of the normal force at the largest sample, N.
    pub(crate) peak_force_sd_n: f32,
    /// Approach speed, m/s.
    pub(crate) approach_speed_m_s: f32,
    /// Speed of separation, m/s; 0 without a separation.
    pub(crate) separation_speed_m_s: f32,
    /// Lost energy, J.
    pub(crate) energy_lost_j: f32,
    /// Separation speed over approach speed; null without a separation.
    pub(crate) speed_ratio: Option<f32>,
    /// Flags of all estimates of the contact, combined by OR.
    pub(crate) flags: u32,
    /// End of the record: `separation`, `settled` or `interrupted`.
    pub(crate) end: &'static str,
}

impl From<&ImpactRecord> for Impact {
    fn from(r: &ImpactRecord) -> Self {
        Self {
            number: r.number,
            onset_sequence: r.onset_sequence,
            onset_us: r.onset_us,
            peak_us: r.peak_us,
            duration_us: r.duration_us,
            peak_force_n: r.peak_force_n,
            peak_force_sd_n: r.peak_force_sd_n,
            approach_speed_m_s: r.approach_speed_m_s,
            separation_speed_m_s: r.separation_speed_m_s,
            energy_lost_j: r.energy_lost_j,
            speed_ratio: r.speed_ratio(),
            flags: r.flags,
            end: impact_text::end(r.end),
        }
    }
}

/// Events that the history no longer contained when a page asked for them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub(crate) struct Gap {
    /// Number of missing events.
    pub(crate) missing_events: u64,
}

/// End of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub(crate) struct End {
    /// Error of a run that failed; null if it is complete.
    pub(crate) error: Option<String>,
}
