//! Quantities of the logs of an axis in which steps and priors of effects are given.

use super::logs::{Block, Data};
use crate::statistics::limits;
use bench::description::FrictionRig;
use bench::effects::Measure;
use bench::{Bench, Channel};

/// Effort and motion of the logs of a driven axis, or of the drive of a mechanism whose torque is
/// measured; 1 on other benches, whose effects have steps and priors in their own units.
#[derive(Clone, Copy)]
pub(crate) struct Measures {
    /// Largest rms of a measured effort, N or N m.
    effort: f64,
    /// Lowest and highest position, m or rad.
    travel: [f64; 2],
    /// Half the range of the motion, m or rad.
    half_range: f64,
    /// Rms speed, m/s or rad/s.
    speed: f64,
    /// Rms speed of the fastest log, m/s or rad/s.
    largest_speed: f64,
    /// Largest load, N.
    largest_load: f64,
    /// Effort for each newton of the load, by gain and friction.
    effort_per_load: f64,
    /// Rms effort over rms load, N/N or N m/N.
    load_gain: f64,
    /// Distance at the friction radius for each unit of the motion, m per m or rad.
    friction_radius: f64,
}

impl Measures {
    /// The quantities over all samples of the logs. A quantity without a positive value is 1.
    pub(crate) fn new(bench: &Bench, data: &Data) -> Self {
        let Some(rig) = bench.axis() else { return Self::without_axis(bench, data) };
        let is_effort = |channel: Channel| {
            rig.forward().is_none() || channel == rig.channels().2 || channel == Channel::FrictionTorque
        };
        let efforts = data.channels.iter().filter(|c| is_effort(**c)).map(|&channel| {
            let blocks = data.blocks.iter().filter(|b| b.channel == channel);
            finite_rms(blocks.flat_map(|b| b.measured.iter().copied()))
        });
        let given = rig
            .forward()
            .map(|drive| finite_rms(data.logs.iter().flat_map(|log| log.inputs.driving_efforts(rig, drive))));
        let positions = || data.logs.iter().flat_map(|log| log.position.iter().copied());
        let highest = positions().fold(f64::NEG_INFINITY, f64::max);
        let lowest = positions().fold(f64::INFINITY, f64::min);
        let measured = efforts.fold(0.0, f64::max);
        let effort = positive(if measured > 0.0 { measured } else { given.unwrap_or_default() });
        let load = finite_rms(data.logs.iter().flat_map(|log| log.load.iter().copied()));
        Self {
            effort,
            travel: [lowest, highest],
            half_range: positive(0.5 * (highest - lowest)),
            speed: positive(finite_rms(data.logs.iter().flat_map(|log| log.speed.iter().copied()))),
            largest_speed: positive(
                data.logs.iter().map(|log| finite_rms(log.speed.iter().copied())).fold(0.0, f64::max),
            ),
            effort_per_load: positive(
                rig.axis.load_gain.abs() + rig.axis.load_coefficient.abs() * rig.axis.friction_radius_m,
            ),
            largest_load: data.logs.iter().flat_map(|log| &log.load).fold(0.0, |max, f| max.max(f.abs())),
            load_gain: positive(effort / load),
            friction_radius: positive(rig.axis.friction_radius_m),
        }
    }

    /// The quantities of a bench that is no axis.
    fn without_axis(bench: &Bench, data: &Data) -> Self {
        let ones = Self {
            effort: 1.0,
            travel: [0.0; 2],
            half_range: 1.0,
            speed: 1.0,
            largest_speed: 1.0,
            largest_load: 0.0,
            effort_per_load: 1.0,
            load_gain: 1.0,
            friction_radius: 1.0,
        };
        // The effects act on pins, so a force has no use.
        let is_driven = |block: &&Block| block.channel == Channel::DriveTorque;
        let measured =
            || data.blocks.iter().filter(is_driven).flat_map(|block| block.measured.iter().copied());
        if !matches!(bench, Bench::Mechanism(_)) || measured().next().is_none() {
            return ones;
        }
        let (lowest, highest) = limits(data.logs.iter().flat_map(|log| log.position.iter().copied()));
        Self {
            effort: positive(finite_rms(measured())),
            half_range: positive(0.5 * (highest - lowest)),
            speed: positive(finite_rms(data.logs.iter().flat_map(|log| log.speed.iter().copied()))),
            ..ones
        }
    }

    /// The value of one unit of a measure.
    pub(crate) fn value(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Unit => 1.0,
            Measure::Effort => self.effort,
            Measure::Distance => self.half_range * self.friction_radius,
            Measure::Speed => self.speed * self.friction_radius,
            Measure::Drag => self.effort / self.speed,
            Measure::Stiffness => self.effort / self.half_range,
            Measure::LoadGain => self.load_gain,
            Measure::Inertia => self.effort * self.half_range / self.speed.powi(2),
            Measure::Load => self.effort / self.effort_per_load,
        }
    }

    /// Dry friction of an axis where friction that changes along the stroke is lowest, under the
    /// largest load, N or N m.
    pub(crate) fn lowest_friction(&self, rig: &FrictionRig) -> f64 {
        let (axis, slope) = (&rig.axis, rig.extension.friction_slope);
        let [change, other] = self.travel.map(|position| slope * (position - axis.neutral_position));
        let of_load = axis.load_coefficient * self.largest_load * axis.friction_radius_m;
        axis.coulomb_effort + of_load + change.min(other)
    }

    /// The largest value of a measure in any log; no limit for parameters in their own unit.
    pub(crate) fn largest(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Unit => f64::INFINITY,
            Measure::Speed => self.largest_speed * self.friction_radius,
            _ => self.value(measure),
        }
    }
}

/// Rms of finite values; 0 without values.
fn finite_rms(values: impl Iterator<Item = f64>) -> f64 {
    bench::statistics::rms(values.filter(|v| v.is_finite()))
}

/// A finite positive value, or 1.
fn positive(value: f64) -> f64 {
    if value.is_finite() && value > 0.0 { value } else { 1.0 }
}
