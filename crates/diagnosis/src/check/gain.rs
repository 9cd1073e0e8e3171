//! Outputs whose gain is off by a factor of the bench's geometry, told from a change of the bench by the other channels.

use super::factors;
use super::finding::Finding;
use super::multiply;
use super::simulated::{Simulated, corrected};
use super::statistics::slope;
use bench::{Bench, Channel, MeasuredLog};

/// Share of the mismatch that the correction may leave: the rest is what the description may be off.
const LEFT: f64 = 0.5;
/// Tolerance on a factor where other channels tell it, and on a gain against the described bench.
const NAMED: f64 = 0.03;
const COARSE: f64 = 0.1;

/// Outputs whose gain is off by a factor of the bench's geometry, while their fellows are right.
pub(super) fn check(
    bench: &Bench,
    log: &mut MeasuredLog,
    simulated: &Simulated,
    findings: &mut Vec<Finding>,
) {
    let gains: Vec<(Channel, f64)> =
        log.outputs().filter_map(|(c, _)| Some((c, simulated.gain(log, c)?))).collect();
    for &(channel, gain) in &gains {
        // What neither friction nor inertia nor clearance changes; the gain alone is coarse.
        let Some(exact) = exact_gain(bench, log, simulated, &gains, channel) else { continue };
        let named = factors::geometry(bench).into_iter().find(|(f, _)| (exact / f - 1.0).abs() < NAMED);
        let Some((factor, cause)) = named.filter(|(f, _)| (gain / f - 1.0).abs() < COARSE) else { continue };
        let own = simulated.mismatch(log, channel, channel, 1.0);
        let left = simulated.mismatch(log, channel, channel, factor);
        if !own.zip(left).is_some_and(|(own, left)| left < LEFT * own) {
            continue;
        }
        findings.push(
            corrected(bench, log, channel, "gain", factor, cause)
                .evidence("gain", gain)
                .evidence("gain_against_other_channels", exact)
                .evidence("mismatch", own.unwrap_or(f64::NAN))
                .evidence("mismatch_corrected", left.unwrap_or(f64::NAN)),
        );
        multiply(log, channel, 1.0 / factor);
    }
}

/// The gain of a channel as its fellows tell it; `None` where none of them is right.
fn exact_gain(
    bench: &Bench,
    log: &MeasuredLog,
    simulated: &Simulated,
    gains: &[(Channel, f64)],
    channel: Channel,
) -> Option<f64> {
    let Bench::Transmission(b) = bench else { return None };
    let gain_of = |c: Channel| gains.iter().find(|(k, _)| *k == c).map(|(_, g)| *g);
    let normal = |c: Channel| gain_of(c).filter(|g| (g - 1.0).abs() < COARSE);
    let steady = |values: &'_ [f64]| values.get(simulated.steady()).map(<[f64]>::to_vec);
    let measured = |c: Channel| steady(log.channels.get(&c)?);
    match channel {
        // The levers alone make the motion of the shaft.
        Channel::ShaftAngle | Channel::ShaftSpeed => gain_of(channel),
        // Wear scales both axes.
        Channel::JournalY => Some(gain_of(channel)? / normal(Channel::JournalZ)?),
        Channel::JournalZ => Some(gain_of(channel)? / normal(Channel::JournalY)?),
        // Weight and little else.
        Channel::BearingForceZ => gain_of(channel).filter(|_| normal(Channel::BearingForceY).is_some()),
        // Forces along Y balance: fork force = m y'' - load - bearing force.
        Channel::BearingForceY | Channel::DriveForce => {
            let other =
                if channel == Channel::DriveForce { Channel::BearingForceY } else { Channel::DriveForce };
            normal(other)?;
            let (other, load) = (measured(other)?, measured(Channel::LoadForce)?);
            let inertia = steady(&accelerations(&log.time_s, simulated.of(Channel::JournalY)?))?;
            let balance: Vec<f64> = inertia
                .iter()
                .zip(load.iter().zip(&other))
                .map(|(a, (load, other))| b.shaft.mass_kg * a - load - other)
                .collect();
            slope(&balance, &measured(channel)?)
        }
        Channel::FrictionTorque => {
            normal(Channel::BearingForceY).or(normal(Channel::BearingForceZ))?;
            let radius_m = b.bearing.bearing_radius_m - b.bearing.radial_clearance_m;
            let journal = measured(Channel::JournalY)?.into_iter().zip(measured(Channel::JournalZ)?);
            let force = measured(Channel::BearingForceY)?.into_iter().zip(measured(Channel::BearingForceZ)?);
            // The force across the line of centres, at the journal's radius: friction whatever its law.
            let made: Vec<f64> = journal
                .zip(force)
                .map(|((y, z), (fy, fz))| radius_m * (fy * z - fz * y) / y.hypot(z).max(f64::MIN_POSITIVE))
                .collect();
            slope(&made, &measured(channel)?).map(f64::abs)
        }
        _ => None,
    }
}

/// Second derivatives by differences; 0 at the ends.
fn accelerations(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let inner = time_s.windows(3).zip(values.windows(3)).map(|(t, v)| match (t, v) {
        (&[t0, t1, t2], &[v0, v1, v2]) => 2.0 * ((v2 - v1) / (t2 - t1) - (v1 - v0) / (t1 - t0)) / (t2 - t0),
        _ => 0.0,
    });
    std::iter::once(0.0).chain(inner).chain(std::iter::once(0.0)).collect()
}
