//! Motion and load of a driven axis from a log.

use super::respond::smooth_load;
use crate::description::FrictionRig;
use crate::log::MeasuredLog;
use crate::signals::{Channel, Motion, Profile, follow, smoothed};

/// Number of simulated intervals per sample.
pub(super) const FINENESS: usize = 4;

/// Smoothed motion of a log; none if it has neither position nor speed.
pub(super) fn measured_motion(rig: &FrictionRig, log: &MeasuredLog) -> Option<Profile> {
    let (position, speed, _) = rig.channels();
    match (log.channels.get(&position), log.channels.get(&speed)) {
        (Some(x), v) => Some(follow(&log.time_s, x, v.map(Vec::as_slice))),
        (None, Some(v)) => Some(integrated(&log.time_s, v)),
        (None, None) => None,
    }
}

/// Smoothed load of a log; the described one if none is logged.
pub(super) fn axis_load(rig: &FrictionRig, log: &MeasuredLog) -> Profile {
    match log.channels.get(&Channel::LoadForce) {
        Some(values) => smooth_load(&log.time_s, values),
        None => Profile::Ramp { level: rig.load.force_n, ramp_s: f64::MIN_POSITIVE },
    }
}

/// Motion whose rate is measured and whose value is not needed.
fn integrated(time_s: &[f64], rate: &[f64]) -> Profile {
    let smooth = smoothed(time_s, rate);
    let mut value = 0.0;
    let mut nodes: Vec<Motion> = Vec::with_capacity(time_s.len());
    let mut last: Option<(f64, f64)> = None;
    for &t in time_s {
        let here = smooth.at(t);
        if let Some((t0, v0)) = last {
            value += 0.5 * (v0 + here.value) * (t - t0);
        }
        last = Some((t, here.value));
        nodes.push(Motion { value, rate: here.value, acceleration: here.rate });
    }
    Profile::Curve { time_s: time_s.to_vec(), nodes }
}
