//! Integration of an axis' friction along its motion: memories, bristles and coupling.
//!
//! A step has at most 1 ms with a memory, and at most 0.25 ms with bristles or a coupling, whatever
//! the sampling of the log. While a coupling is loaded and slides along with the drive, 5 ms are
//! enough. Without any of them nothing is integrated.

use super::balance::{
    AxisMemory, Effort, Given, Moment, Sliding, effort_at, friction_at, memory_after, presliding_sign,
};
use super::coupling::{Coupling, DriveStep};
use super::rubbing_pair::coefficient;
use crate::description::{FrictionRig, Surface, ripples};
use crate::signals::Motion;

/// Maximum step of the standstill memory, s.
const MEMORY_STEP_S: f64 = 1e-3;
/// Maximum step while bristles bend or a coupling turns round over micrometres, near a reversal, s.
pub(in crate::plants) const BRISTLE_STEP_S: f64 = 2.5e-4;
/// Maximum step while a loaded coupling slides along, s.
const SLIDING_STEP_S: f64 = 5e-3;
/// Largest difference between the speeds of a part that slides along and of the drive, as a share.
const SLIDING_DIFFERENCE: f64 = 0.01;
/// Rounding error allowed in a count of steps.
pub(in crate::plants) const STEP_ROUNDING: f64 = 1e-6;
/// Difference of speeds for a slope of the friction, in widths of the regularised sign.
const PROBE_WIDTHS: f64 = 0.01;

/// Motion of the rubbing part relative to the drive within a step.
#[derive(Clone, Copy)]
struct Following {
    /// Speed of the rubbing part in the middle of the step.
    rate: f64,
    /// Speed of the drive there.
    drive_rate: f64,
    /// Deflection of the coupling.
    deflection: f64,
}

impl Following {
    /// Motion of the rubbing part under a motion of the drive at any time of the step.
    ///
    /// A part that follows the drive shares the change of its speed within the step; one at
    /// standstill does not.
    fn motion(&self, drive: &Motion) -> Motion {
        let share = if self.drive_rate == 0.0 { 0.0 } else { (self.rate / self.drive_rate).clamp(0.0, 1.0) };
        Motion {
            value: drive.value - self.deflection,
            rate: self.rate + share * (drive.rate - self.drive_rate),
            acceleration: drive.acceleration,
        }
    }
}

/// State of an axis that is integrated from one place of its course to the next.
pub(super) struct Stepping<'a, M> {
    rig: &'a FrictionRig,
    /// Motion that the axis makes, with its lag.
    motion: M,
    /// Time before which the motion is not known, s.
    start_s: f64,
    remembers: bool,
    bends: bool,
    coupling: Option<Coupling>,
    last: Given,
    /// Sliding at the end of the last step.
    slides: Sliding,
    memory: AxisMemory,
    following: Following,
}

impl<'a, M: Fn(f64) -> Motion> Stepping<'a, M> {
    /// State at the first place.
    ///
    /// An axis that moves at the start has its bristles and its coupling deflected that way, with
    /// the memory of this speed in steady sliding. An axis at standstill has been there for a long
    /// time, in the middle of its play.
    pub(super) fn new(rig: &'a FrictionRig, start_s: f64, first: Given, motion: M) -> Self {
        let extension = &rig.extension;
        let slides = Sliding::new(rig, &first.motion);
        let memory = AxisMemory::of_steady_sliding(rig, &slides);
        let rate = first.motion.rate;
        let mut start = Self {
            rig,
            motion,
            start_s,
            remembers: rig.surface.is_some() || extension.breakaway.is_some() || extension.thermal.is_some(),
            bends: extension.presliding_distance_m > 0.0,
            coupling: Coupling::new(&rig.axis),
            last: first,
            slides,
            memory,
            following: Following { rate, drive_rate: rate, deflection: 0.0 },
        };
        if let Some(coupling) = start.coupling {
            let friction = friction_at(rig, &start.moment(&first), &first.motion, &memory);
            start.following.deflection = coupling.deflection(slides.sign, friction);
        }
        start
    }

    /// Returns whether the effort depends on the course before.
    pub(super) fn has_state(&self) -> bool {
        self.remembers || self.bends || self.coupling.is_some()
    }

    /// Moment under given inputs, with the excess of static friction.
    fn moment(&self, given: &Given) -> Moment {
        let rig = self.rig;
        let load_n = given.load_n + ripples(&rig.extension.load_ripples, given.time_s);
        let slid = |s: &Surface| {
            let then = (self.motion)((given.time_s - s.lag_s).max(self.start_s));
            coefficient(s.material, (then.rate * rig.axis.friction_radius_m).abs(), load_n)
        };
        let coefficient = rig.surface.as_ref().map_or(0.0, slid) * (1.0 + self.memory.excess);
        Moment { time_s: given.time_s, motion: given.motion, load_n, coefficient }
    }

    /// Motion of the rubbing part under a motion of the drive in the last step.
    fn rubbing(&self, drive: &Motion) -> Motion {
        if self.coupling.is_some() { self.following.motion(drive) } else { *drive }
    }

    /// Integrates to later inputs.
    pub(super) fn advance(&mut self, given: &Given) {
        // The step depends on the speed.
        let last = self.last;
        let is_loose = self.coupling.is_some() && !self.slides_along([&last.motion, &given.motion]);
        let longest = match (self.bends || is_loose, self.remembers) {
            (true, _) => BRISTLE_STEP_S,
            (false, true) => MEMORY_STEP_S,
            (false, false) => SLIDING_STEP_S,
        };
        let steps = ((given.time_s - last.time_s) / longest - STEP_ROUNDING).ceil().max(1.0);
        let step_s = (given.time_s - last.time_s) / steps;
        for k in 0..steps as usize {
            let middle = last.towards(given, (k as f64 + 0.5) / steps);
            let end = || last.towards(given, (k as f64 + 1.0) / steps).motion;
            if let Some(coupling) = self.coupling {
                self.turn(coupling, &middle, &end(), step_s);
            }
            if self.remembers {
                let rubbing = self.rubbing(&middle.motion);
                self.memory = memory_after(self.rig, &self.moment(&middle), &rubbing, self.memory, step_s);
            }
            if self.bends {
                let there = Sliding::new(self.rig, &self.rubbing(&end()));
                self.memory.turned = self.turned([self.slides, there], step_s);
                self.slides = there;
            }
        }
        self.last = *given;
    }

    /// Returns whether the rubbing part slides along with the drive between two motions of it.
    fn slides_along(&self, drive: [&Motion; 2]) -> bool {
        let Following { rate, drive_rate, .. } = self.following;
        let slides = |motion: &Motion| motion.rate * rate > 0.0;
        drive.into_iter().all(slides) && (rate - drive_rate).abs() < SLIDING_DIFFERENCE * drive_rate.abs()
    }

    /// Pre-sliding sign after a step from one sliding state to another.
    fn turned(&self, ends: [Sliding; 2], step_s: f64) -> f64 {
        presliding_sign(self.rig.extension.presliding_distance_m, self.memory.turned, ends, step_s)
    }

    /// Moves the rubbing part by a step that the drive makes.
    fn turn(&mut self, coupling: Coupling, middle: &Given, end: &Motion, step_s: f64) {
        // The first place is no step.
        if step_s <= 0.0 {
            return;
        }
        let (drive_rate, before) = (middle.motion.rate, self.following);
        let now = self.moment(middle);
        let friction = |rate: f64| {
            let following = Following { rate, drive_rate, ..before };
            let mut memory = self.memory;
            if self.bends {
                let there = Sliding::new(self.rig, &following.motion(end));
                memory.turned = self.turned([self.slides, there], step_s);
            }
            let rubbing = Motion { rate, ..following.motion(&middle.motion) };
            friction_at(self.rig, &now, &rubbing, &memory)
        };
        let probe = PROBE_WIDTHS * self.rig.axis.regularisation_m_s / self.rig.axis.friction_radius_m;
        let bristles = self.rig.extension.presliding_distance_m / self.rig.axis.friction_radius_m;
        let step = DriveStep { deflection: before.deflection, rate: drive_rate, step_s, bristles };
        let guess = before.motion(&middle.motion).rate;
        let rate = coupling.speed(&step, [guess, probe], friction);
        let deflection = coupling.limited(before.deflection + step_s * (drive_rate - rate));
        self.following = Following { rate, drive_rate, deflection };
    }

    /// Effort at the inputs to which it was integrated.
    pub(super) fn effort(&self, given: &Given) -> Effort {
        effort_at(self.rig, &self.moment(given), &self.rubbing(&given.motion), &self.memory)
    }
}
