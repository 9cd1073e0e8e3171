//! Impacts of the journal, and the summary of the estimates that are not sent.
//!
//! SI units. Times are those of the samples, us modulo 2^32.

use serde::{Deserialize, Serialize};

/// Way in which the record of an impact ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ImpactEnd {
    /// The journal left the bearing.
    #[default]
    Separation,
    /// The contact lasted: the impact became sustained contact, and the record covers its start.
    Settled,
    /// An estimate could not be trusted, or the run ended. The record covers the time before.
    Interrupted,
}

/// One impact: a contact that began after a separation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ImpactRecord {
    /// Number of the impact in its run, from 0, modulo 2^32. A gap is a lost record.
    pub number: u32,
    /// Sequence number of the first sample in contact.
    pub onset_sequence: u32,
    /// Time of the onset, interpolated between two samples, us.
    pub onset_us: u32,
    /// Time of the peak, interpolated between samples, us.
    pub peak_us: u32,
    /// Time from onset to end, us.
    pub duration_us: u32,
    /// Largest normal force, interpolated between samples, N.
    pub peak_force_n: f32,
    /// Standard deviation of the normal force at the largest sample, N.
    pub peak_force_sd_n: f32,
    /// Approach speed before the onset, m/s.
    pub approach_speed_m_s: f32,
    /// Speed of separation, m/s; 0 unless the journal separated.
    pub separation_speed_m_s: f32,
    /// Work of the normal force on the bearing, J. After a separation it is the dissipated energy;
    /// else it includes the stored energy.
    pub energy_lost_j: f32,
    /// Flags of all estimates of the contact, combined by OR; with those of the estimate that
    /// interrupted it.
    pub flags: u32,
    /// End of the record.
    pub end: ImpactEnd,
}

impl ImpactRecord {
    /// Returns separation speed over approach speed; `None` without a separation. It is the
    /// restitution of free bodies. A driven body may separate faster than it approached.
    #[must_use]
    pub fn speed_ratio(&self) -> Option<f32> {
        let is_known = self.end == ImpactEnd::Separation && self.approach_speed_m_s > 0.0;
        is_known.then(|| self.separation_speed_m_s / self.approach_speed_m_s)
    }
}

/// Summary of all estimates of own samples after the last sent one, the sent one included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BlockSummary {
    /// Number of the sent estimate that ends the block.
    pub number: u32,
    /// Largest normal force, N.
    pub max_force_n: f32,
    /// Smallest normal force, N.
    pub min_force_n: f32,
    /// Flags of all estimates, combined by OR.
    pub flags: u32,
    /// Number of estimates.
    pub samples: u16,
    /// Number of samples from the largest force to the sent estimate.
    pub max_age: u16,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_separation_after_an_approach_has_a_speed_ratio() {
        let record =
            ImpactRecord { approach_speed_m_s: 0.2, separation_speed_m_s: 0.1, ..ImpactRecord::default() };
        assert_eq!(record.speed_ratio(), Some(0.5));
        for end in [ImpactEnd::Settled, ImpactEnd::Interrupted] {
            assert_eq!(ImpactRecord { end, ..record }.speed_ratio(), None);
        }
        assert_eq!(ImpactRecord { approach_speed_m_s: 0.0, ..record }.speed_ratio(), None);
    }
}
