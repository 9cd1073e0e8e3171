//! Groups of a friction test: every load, both directions of loading, both directions of turning.
//!
//! The published test has 20 groups for each bearing: loads of 0, 100, 150, 200 and 240 kN,
//! downwards and upwards, with the spindle turning in either direction. Each record here is one
//! cycle of the described rig at one load. Its two halves are the two directions of turning.

use crate::description::FrictionRig;
use crate::integrate::IntegrationError;
use crate::log::MeasuredLog;
use crate::signals::Channel;
use crate::simulate::record;

/// Loads of the published test in N.
pub const LOADS_N: [f64; 5] = [0.0, 100e3, 150e3, 200e3, 240e3];

/// One group: a direction of turning at one load.
#[derive(Clone, Debug, PartialEq)]
pub struct RigGroup {
    /// Load in N; its sign is the direction of loading.
    pub load_n: f64,
    /// True if the spindle turns forward.
    pub forward: bool,
    /// Log of the group.
    pub log: MeasuredLog,
}

/// Records all 20 groups. Every record has its own seed, derived from `seed`.
pub fn rig_groups(rig: &FrictionRig, seed: u64) -> Result<Vec<RigGroup>, IntegrationError> {
    let mut groups = Vec::with_capacity(4 * LOADS_N.len());
    let loads = LOADS_N.into_iter().flat_map(|load| [load, -load]);
    for (index, load_n) in loads.enumerate() {
        let mut rig = rig.clone();
        rig.load.force_n = load_n;
        rig.axis.cycles = 1;
        (rig.axis.last_period_s, rig.axis.backwards) = (0.0, false);
        let half_s = 0.5 * rig.axis.period_s + rig.axis.dwell_s;
        let log = record(&rig.into(), seed.wrapping_mul(64).wrapping_add(index as u64))?;
        let middle = log.time_s.partition_point(|&t| t < half_s);
        for forward in [true, false] {
            let part = |values: &Vec<f64>| {
                let range = if forward { 0..middle } else { middle..values.len() };
                values.get(range).unwrap_or_default().to_vec()
            };
            let log = MeasuredLog {
                source: format!("{} N, {}", load_n, if forward { "forward" } else { "backward" }),
                time_s: part(&log.time_s),
                channels: log.channels.iter().map(|(channel, values)| (*channel, part(values))).collect(),
            };
            groups.push(RigGroup { load_n, forward, log });
        }
    }
    Ok(groups)
}

impl RigGroup {
    /// Logged torque of the bearing on the spindle, N m.
    pub fn friction_torque_nm(&self) -> &[f64] {
        self.log.channels.get(&Channel::FrictionTorque).map(Vec::as_slice).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::median;

    #[test]
    fn twenty_groups_have_noise_outliers_and_a_torque_against_the_motion() {
        for (name, least) in [("friction-rig-babbitt", 0.13), ("friction-rig-plastic", 0.05)] {
            let rig = FrictionRig::open(name).unwrap();
            let groups = rig_groups(&rig, 3).unwrap();
            assert_eq!(groups.len(), 20);
            for group in &groups {
                let torque = group.friction_torque_nm();
                assert!(torque.len() > 2048 && torque.len() == group.log.time_s.len());
                let median = median(torque.iter().copied()).unwrap();
                assert_eq!(median < 0.0, group.forward, "{} {median}", group.log.source);
                let coefficient = (median.abs() - 15.0) / (group.load_n.abs().max(1.0) * 0.07);
                assert!(group.load_n == 0.0 || (least..0.25).contains(&coefficient), "{coefficient}");
                let outliers = torque.windows(2).filter(|w| (w[1] - w[0]).abs() > 150.0).count();
                assert!((3..120).contains(&outliers), "{outliers}");
            }
            assert_eq!(groups, rig_groups(&rig, 3).unwrap());
            assert_ne!(groups, rig_groups(&rig, 4).unwrap());
        }
    }
}
