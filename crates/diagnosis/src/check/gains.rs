//! Outputs whose gain is wrong by a factor of the bench's geometry. Related channels show that the
//! bench itself has not changed.

use super::factors;
use super::finding::Finding;
use super::rows::multiply;
use super::simulated::Simulated;
use super::tuning;
use super::units::correction;
use crate::statistics::robust_slope;
use bench::{Bench, Channel, MeasuredLog};

/// Finds and corrects outputs whose gain is wrong by a factor of the geometry while related
/// channels are right.
pub(super) fn check(
    bench: &Bench,
    log: &mut MeasuredLog,
    simulated: &Simulated,
    findings: &mut Vec<Finding>,
) {
    let gains: Vec<(Channel, f64)> =
        bench.outputs(log).into_iter().filter_map(|c| Some((c, simulated.gain(log, c)?))).collect();
    for &(channel, gain) in &gains {
        // The gain relative to related channels does not depend on friction, inertia or clearance;
        // the gain relative to the simulation does.
        let Some(exact) = exact_gain(bench, log, simulated, &gains, channel) else { continue };
        let named = factors::geometry(bench)
            .into_iter()
            .find(|(f, _)| (exact / f - 1.0).abs() < tuning::NAMED_TOLERANCE);
        let Some((factor, cause)) = named.filter(|(f, _)| (gain / f - 1.0).abs() < tuning::GAIN_TOLERANCE)
        else {
            continue;
        };
        let own = simulated.mismatch(log, channel, channel, 1.0);
        let left = simulated.mismatch(log, channel, channel, factor);
        if !own.zip(left).is_some_and(|(own, left)| left < tuning::MAX_LEFT_SHARE_GAIN * own) {
            continue;
        }
        findings.push(
            correction(bench, log, channel, "gain", factor, cause)
                .evidence("gain", gain)
                .evidence("gain_against_other_channels", exact)
                .evidence("mismatch", own.unwrap_or(f64::NAN))
                .evidence("mismatch_corrected", left.unwrap_or(f64::NAN)),
        );
        multiply(log, channel, 1.0 / factor);
    }
}

/// The gain of a channel relative to related channels; `None` if none of them is right.
fn exact_gain(
    bench: &Bench,
    log: &MeasuredLog,
    simulated: &Simulated,
    gains: &[(Channel, f64)],
    channel: Channel,
) -> Option<f64> {
    let b = bench.transmission()?;
    let gain_of = |c: Channel| gains.iter().find(|(k, _)| *k == c).map(|(_, g)| *g);
    let gain_if_right = |c: Channel| gain_of(c).filter(|g| (g - 1.0).abs() < tuning::GAIN_TOLERANCE);
    let steady = |values: &'_ [f64]| values.get(simulated.steady()).map(<[f64]>::to_vec);
    let measured = |c: Channel| steady(log.channels.get(&c)?);
    match channel {
        // The motion of the shaft depends on the levers alone.
        Channel::ShaftAngle | Channel::ShaftSpeed => gain_of(channel),
        // Wear scales both axes.
        Channel::JournalY => Some(gain_of(channel)? / gain_if_right(Channel::JournalZ)?),
        Channel::JournalZ => Some(gain_of(channel)? / gain_if_right(Channel::JournalY)?),
        // This force is mostly the weight.
        Channel::BearingForceZ => {
            gain_of(channel).filter(|_| gain_if_right(Channel::BearingForceY).is_some())
        }
        // Balance of forces along Y: fork force = m y'' - load - bearing force.
        Channel::BearingForceY | Channel::DriveForce => {
            let other =
                if channel == Channel::DriveForce { Channel::BearingForceY } else { Channel::DriveForce };
            gain_if_right(other)?;
            let (other, load) = (measured(other)?, measured(Channel::LoadForce)?);
            let inertia = steady(&accelerations(&log.time_s, simulated.channel(Channel::JournalY)?))?;
            let balance: Vec<f64> = inertia
                .iter()
                .zip(load.iter().zip(&other))
                .map(|(a, (load, other))| b.shaft.mass_kg * a - load - other)
                .collect();
            robust_slope(&balance, &measured(channel)?)
        }
        Channel::FrictionTorque => {
            gain_if_right(Channel::BearingForceY).or(gain_if_right(Channel::BearingForceZ))?;
            let radius_m = b.bearing.bearing_radius_m - b.bearing.radial_clearance_m;
            let journal = measured(Channel::JournalY)?.into_iter().zip(measured(Channel::JournalZ)?);
            let force = measured(Channel::BearingForceY)?.into_iter().zip(measured(Channel::BearingForceZ)?);
            // Whatever the friction law, the torque is the force across the line of centres times
            // the journal's radius.
            let friction: Vec<f64> = journal
                .zip(force)
                .map(|((y, z), (fy, fz))| radius_m * (fy * z - fz * y) / y.hypot(z).max(f64::MIN_POSITIVE))
                .collect();
            robust_slope(&friction, &measured(channel)?).map(f64::abs)
        }
        _ => None,
    }
}

/// Second derivatives from differences; 0 at both ends.
fn accelerations(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let inner = time_s.windows(3).zip(values.windows(3)).map(|(t, v)| match (t, v) {
        (&[t0, t1, t2], &[v0, v1, v2]) => 2.0 * ((v2 - v1) / (t2 - t1) - (v1 - v0) / (t1 - t0)) / (t2 - t0),
        _ => 0.0,
    });
    std::iter::once(0.0).chain(inner).chain(std::iter::once(0.0)).collect()
}
