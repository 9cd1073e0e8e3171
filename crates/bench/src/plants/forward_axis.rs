//! A driven axis whose motion is simulated: under a measured effort, under a voltage, or in closed
//! loop.
//!
//! The equation is that of [`super::friction_rig`], solved for the acceleration: `effort_at` with
//! the motion that the drive's effort gives. Friction, effects and memories are the same code.
//!
//! The regularised sign is stiff, down to widths of 1e-12 m/s. So position, speed, effort and
//! integrals are advanced by the L-stable SDIRK method of order 2 (`g = 1 - 1/sqrt(2)`; Alexander
//! 1977, SIAM J. Numer. Anal. 14) with fixed steps: at least four per sample of the log, of at most
//! 0.5 ms (0.25 ms with pre-sliding), and at most 200 between two simulated times. In a stage all
//! states follow from the speed. One equation remains for it, and a bracketing root search solves
//! it. At standstill the friction balances the effort: the axis creeps with the speed at which the
//! regularised sign gives this friction.
//!
//! Memories of friction are advanced after a step with the motion in its middle, as for a given
//! motion. Only the pre-sliding sign is part of a stage, because it is stiff too.
//!
//! Limits: play and coupling of the axis have no part. A position beyond 1e12 and a speed beyond
//! 1e9 stay there, so that a runaway remains finite. An inertia below 1e-12, which a fit may try,
//! counts as 1e-12. Where friction falls with speed so steeply that a step has several solutions,
//! the one found first counts.

mod controller;
mod root;

use self::controller::{State, controller};
use self::root::root;
use super::friction_rig::{
    AxisMemory, BRISTLE_STEP_S, Given, Moment, STEP_ROUNDING, Sliding, coefficient, effort_at, memory_after,
    presliding_sign, sign,
};
use crate::description::{Drive, DriveInput, FrictionRig, ripples};
use crate::signals::Motion;
use core::f64::consts::FRAC_1_SQRT_2;

/// Diagonal coefficient of the method.
const DIAGONAL: f64 = 1.0 - FRAC_1_SQRT_2;
/// Maximum step, s.
const MAX_STEP_S: f64 = 5e-4;
/// Maximum number of steps between two places of a course.
const MAX_STEPS: f64 = 200.0;
/// Tolerance of a speed, in widths of the regularised sign.
const SPEED_TOLERANCE: f64 = 1e-9;
/// Minimum inertia, kg or kg m2.
const MIN_INERTIA: f64 = 1e-12;

/// Motion at the start.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Start {
    pub(crate) position: f64,
    pub(crate) speed: f64,
    /// Effort of the drive; none if it is not measured. The integrals of the controller then begin
    /// with the effort that holds the axis without friction.
    pub(crate) effort: Option<f64>,
}

/// State of the axis at one time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moved {
    pub(crate) motion: Motion,
    /// Effort of the drive.
    pub(crate) effort: f64,
    /// Friction share.
    pub(crate) friction: f64,
    /// Voltage, or output of the controller, V or in its own unit.
    pub(crate) output: f64,
}

/// Input of a stage's effort.
#[derive(Clone, Copy)]
enum Source {
    /// Effort as given.
    Effort(f64),
    /// Voltage, or the held output of a controller with a sample period.
    Output(f64),
    /// Continuous controller, with the direction in which its integrals are held.
    Controller(f64),
}

/// One stage of a step.
struct Stage<'a> {
    rig: &'a FrictionRig,
    drive: &'a Drive,
    /// State before the stage, with the share of earlier stages.
    base: State,
    /// Weight of the stage's own rate, s.
    weight_s: f64,
    /// Time since the start of the step, s.
    elapsed_s: f64,
    /// Input and load at the time of the stage.
    given: Given,
    load_n: f64,
    source: Source,
    memory: &'a AxisMemory,
    /// Sliding at the start of the step.
    slides: Sliding,
    /// Sliding speed of the rubbing pair a lag earlier; none if the lag is shorter than a step.
    earlier_m_s: Option<f64>,
}

impl Stage<'_> {
    /// State at the end of the stage for a speed there.
    fn state(&self, speed: f64) -> State {
        let (base, weight_s, drive) = (&self.base, self.weight_s, self.drive);
        let mut state = State { position: base.position + weight_s * speed, speed, ..*base };
        let output = match self.source {
            Source::Effort(effort) => return State { effort, ..state },
            Source::Output(output) => output,
            Source::Controller(saturation) => {
                let error = self.given.motion.value - state.position;
                if saturation * error <= 0.0 {
                    state.integral += weight_s * error;
                }
                let speed_error = controller(drive, &self.given.motion, &state).speed_error;
                if drive.speed_gain > 0.0 && saturation * speed_error <= 0.0 {
                    state.speed_integral += weight_s * speed_error;
                }
                controller(drive, &self.given.motion, &state).limited
            }
        };
        let effort = drive.gain * output;
        state.effort = if drive.time_constant_s > 0.0 {
            let share = weight_s / drive.time_constant_s;
            (base.effort + share * effort) / (1.0 + share)
        } else {
            effort
        };
        state
    }

    /// Effort that the motion needs less that of the drive, and the friction, for a speed.
    fn balance(&self, speed: f64) -> (f64, f64) {
        let state = self.state(speed);
        let sliding = sliding(self.rig, speed);
        let acceleration = (speed - self.base.speed) / self.weight_s;
        let mut memory = *self.memory;
        let distance_m = self.rig.extension.presliding_distance_m;
        if distance_m > 0.0 {
            memory.turned =
                presliding_sign(distance_m, memory.turned, [self.slides, sliding], self.elapsed_s);
        }
        let then_m_s = self.earlier_m_s.unwrap_or(sliding.speed_m_s).abs();
        let now = Moment {
            time_s: self.given.time_s,
            motion: Motion { value: state.position, rate: speed, acceleration },
            load_n: self.load_n,
            coefficient: rubbing(self.rig, then_m_s, self.load_n) * (1.0 + memory.excess),
        };
        let needed = effort_at(self.rig, &now, &now.motion, &memory);
        (needed.effort - state.effort, needed.friction)
    }

    /// Speed at the end of the stage.
    fn solve(&self, guess: f64) -> f64 {
        let tolerance = SPEED_TOLERANCE * self.rig.axis.regularisation_m_s / self.rig.axis.friction_radius_m;
        let slope = self.rig.axis.inertia / self.weight_s;
        root(|speed| self.balance(speed).0, guess, slope, tolerance)
    }
}

/// Sliding of the axis at a speed.
fn sliding(rig: &FrictionRig, speed: f64) -> Sliding {
    let speed_m_s = speed * rig.axis.friction_radius_m;
    Sliding { speed_m_s, sign: sign(rig, speed_m_s) }
}

/// Coefficient of the rubbing pair; 0 without one.
fn rubbing(rig: &FrictionRig, sliding_m_s: f64, load_n: f64) -> f64 {
    rig.surface.as_ref().map_or(0.0, |surface| coefficient(surface.material, sliding_m_s, load_n))
}

/// Sliding speeds of the past, for a rubbing pair whose coefficient lags.
#[derive(Default)]
struct Past {
    time_s: Vec<f64>,
    speed_m_s: Vec<f64>,
}

impl Past {
    fn push(&mut self, time_s: f64, speed_m_s: f64) {
        self.time_s.push(time_s);
        self.speed_m_s.push(speed_m_s);
    }

    /// Speed at a time; none after the last one.
    fn at(&self, time_s: f64) -> Option<f64> {
        let after = self.time_s.partition_point(|&t| t <= time_s);
        let (&t1, &v1) = self.time_s.get(after).zip(self.speed_m_s.get(after))?;
        let Some(before) = after.checked_sub(1) else { return Some(v1) };
        let (&t0, &v0) = self.time_s.get(before).zip(self.speed_m_s.get(before))?;
        Some(v0 + (v1 - v0) * (time_s - t0) / (t1 - t0))
    }
}

/// The simulated axis.
struct Axis<'a> {
    rig: &'a FrictionRig,
    drive: &'a Drive,
    state: State,
    memory: AxisMemory,
    slides: Sliding,
    past: Past,
    /// Held output of a controller with a sample period, and the time of the next one.
    held: f64,
    /// True if the last step had the held output.
    is_held: bool,
    next_output_s: f64,
    saturation: f64,
}

impl<'a> Axis<'a> {
    fn new(rig: &'a FrictionRig, drive: &'a Drive, given: &Given, start: Start) -> Self {
        let slides = sliding(rig, start.speed);
        let memory = AxisMemory::of_steady_sliding(rig, &slides);
        let mut state = State { position: start.position, speed: start.speed, ..State::default() };
        let balance = Moment {
            time_s: given.time_s,
            motion: Motion { value: start.position, ..Motion::default() },
            load_n: given.load_n + ripples(&rig.extension.load_ripples, given.time_s),
            coefficient: 0.0,
        };
        let holding = || {
            let still = effort_at(rig, &balance, &balance.motion, &memory);
            still.effort - still.friction
        };
        state.effort = match drive.input {
            DriveInput::Effort => given.motion.value,
            DriveInput::Voltage => drive.gain * given.motion.value,
            DriveInput::Order => start.effort.unwrap_or_else(holding),
        };
        if drive.input == DriveInput::Order {
            let missing = state.effort / drive.gain - controller(drive, &given.motion, &state).unlimited;
            if drive.speed_ki > 0.0 {
                state.speed_integral = missing / drive.speed_ki;
            } else if drive.ki > 0.0 {
                let per_integral = if drive.speed_gain > 0.0 { drive.speed_gain } else { 1.0 };
                state.integral = missing / (per_integral * drive.ki);
            }
            if drive.time_constant_s == 0.0 {
                state.effort = drive.gain * controller(drive, &given.motion, &state).limited;
            }
        }
        let state = state.limited();
        let next_output_s = given.time_s;
        let mut axis = Self {
            rig,
            drive,
            state,
            memory,
            slides,
            past: Past::default(),
            held: 0.0,
            is_held: false,
            next_output_s,
            saturation: 0.0,
        };
        axis.remember(given.time_s);
        axis
    }

    /// Keeps the sliding speed for a rubbing pair whose coefficient lags.
    fn remember(&mut self, time_s: f64) {
        if self.rig.surface.as_ref().is_some_and(|surface| surface.lag_s > 0.0) {
            self.past.push(time_s, self.slides.speed_m_s);
        }
    }

    /// Sliding speed of the rubbing pair a lag before a time; none if that is not yet known.
    fn earlier_m_s(&self, time_s: f64) -> Option<f64> {
        let surface = self.rig.surface.as_ref().filter(|surface| surface.lag_s > 0.0)?;
        self.past.at(time_s - surface.lag_s)
    }

    fn load_n(&self, given: &Given) -> f64 {
        given.load_n + ripples(&self.rig.extension.load_ripples, given.time_s)
    }

    /// Input of the effort during a step from some inputs; a controller with a sample period gives
    /// its next output if it is due.
    fn source(&mut self, given: &Given, step_s: f64) -> Option<f64> {
        let period_s = self.drive.sample_period_s;
        let output = controller(self.drive, &given.motion, &self.state);
        self.saturation = output.saturation;
        self.is_held = period_s > step_s * (1.0 + STEP_ROUNDING);
        if !self.is_held {
            // After a gap of a log the next output is due at once, and no earlier one.
            self.next_output_s = given.time_s + step_s;
            return None;
        }
        if given.time_s >= self.next_output_s - STEP_ROUNDING * period_s {
            if output.saturation * output.position_error <= 0.0 {
                self.state.integral += period_s * output.position_error;
            }
            if output.saturation * output.speed_error <= 0.0 && self.drive.speed_gain > 0.0 {
                self.state.speed_integral += period_s * output.speed_error;
            }
            self.state = self.state.limited();
            self.held = controller(self.drive, &given.motion, &self.state).limited;
            self.next_output_s += period_s;
        }
        Some(self.held)
    }

    /// Advances the axis by one step between two inputs.
    fn step(&mut self, from: &Given, to: &Given) {
        let step_s = to.time_s - from.time_s;
        let held = match self.drive.input {
            DriveInput::Order => self.source(from, step_s),
            _ => None,
        };
        let weight_s = DIAGONAL * step_s;
        let begin = self.state;
        let stage = |base: State, given: Given, elapsed_s: f64| Stage {
            rig: self.rig,
            drive: self.drive,
            base,
            weight_s,
            elapsed_s,
            given,
            load_n: self.load_n(&given),
            source: match (self.drive.input, held) {
                (DriveInput::Effort, _) => Source::Effort(given.motion.value),
                (DriveInput::Voltage, _) => Source::Output(given.motion.value),
                (DriveInput::Order, Some(output)) => Source::Output(output),
                (DriveInput::Order, None) => Source::Controller(self.saturation),
            },
            memory: &self.memory,
            slides: self.slides,
            earlier_m_s: self.earlier_m_s(given.time_s),
        };
        let first = stage(begin, from.towards(to, DIAGONAL), weight_s);
        let first = first.state(first.solve(begin.speed));
        // The rate of the first stage is its change over its weight.
        let base = first.beyond(&begin, (1.0 - DIAGONAL) / DIAGONAL);
        let second = stage(base, *to, step_s);
        self.state = second.state(second.solve(first.speed)).limited();
        let end = sliding(self.rig, self.state.speed);
        let mut memory = self.memory_after(from, to, &begin);
        let distance_m = self.rig.extension.presliding_distance_m;
        if distance_m > 0.0 {
            memory.turned = presliding_sign(distance_m, self.memory.turned, [self.slides, end], step_s);
        }
        (self.memory, self.slides) = (memory, end);
        self.remember(to.time_s);
    }

    /// Memory after a step with the motion in its middle.
    fn memory_after(&self, from: &Given, to: &Given, begin: &State) -> AxisMemory {
        let middle = from.towards(to, 0.5);
        let motion = Motion {
            value: 0.5 * (begin.position + self.state.position),
            rate: 0.5 * (begin.speed + self.state.speed),
            acceleration: 0.0,
        };
        let load_n = self.load_n(&middle);
        let then_m_s =
            self.earlier_m_s(middle.time_s).unwrap_or(motion.rate * self.rig.axis.friction_radius_m).abs();
        let coefficient = rubbing(self.rig, then_m_s, load_n) * (1.0 + self.memory.excess);
        let now = Moment { time_s: middle.time_s, motion, load_n, coefficient };
        memory_after(self.rig, &now, &now.motion, self.memory, to.time_s - from.time_s)
    }

    /// The axis under its inputs now.
    fn moved(&self, given: &Given) -> Moved {
        let state = &self.state;
        let load_n = self.load_n(given);
        let then_m_s = self.earlier_m_s(given.time_s).unwrap_or(self.slides.speed_m_s).abs();
        let now = Moment {
            time_s: given.time_s,
            motion: Motion { value: state.position, rate: state.speed, acceleration: 0.0 },
            load_n,
            coefficient: rubbing(self.rig, then_m_s, load_n) * (1.0 + self.memory.excess),
        };
        let needed = effort_at(self.rig, &now, &now.motion, &self.memory);
        let acceleration = (state.effort - needed.effort) / self.rig.axis.inertia;
        let output = match self.drive.input {
            DriveInput::Effort => 0.0,
            DriveInput::Voltage => given.motion.value,
            DriveInput::Order if self.is_held => self.held,
            DriveInput::Order => controller(self.drive, &given.motion, state).limited,
        };
        Moved {
            motion: Motion { acceleration, ..now.motion },
            effort: state.effort,
            friction: needed.friction,
            output,
        }
    }
}

/// Motion at every `every`-th place of a course of inputs and loads with ascending times. `input`
/// gives the input also between them. All places are simulated, so that a motion does not depend on
/// `every`.
pub(crate) fn motions_along(
    rig: &FrictionRig,
    drive: &Drive,
    (course, every): (&[Given], usize),
    start: Start,
    input: impl Fn(f64) -> Motion,
) -> Vec<Moved> {
    let Some(first) = course.first() else { return Vec::new() };
    let mut rig = rig.clone();
    rig.axis.inertia = rig.axis.inertia.max(MIN_INERTIA);
    // Motion that lags an order, or that an effort follows with a lag.
    let lag_s = rig.extension.drive_lag_s * if drive.input == DriveInput::Order { 1.0 } else { -1.0 };
    let lagged = |given: &Given| match lag_s {
        0.0 => *given,
        _ => Given { motion: input(given.time_s - lag_s), ..*given },
    };
    let max_step_s = if rig.extension.presliding_distance_m > 0.0 { BRISTLE_STEP_S } else { MAX_STEP_S };
    let mut last = lagged(first);
    let mut axis = Axis::new(&rig, drive, &last, start);
    let mut moved = Vec::with_capacity(course.len().div_ceil(every));
    for (place, given) in course.iter().enumerate() {
        let given = lagged(given);
        if place > 0 {
            let length_s = given.time_s - last.time_s;
            let steps = (length_s / max_step_s - STEP_ROUNDING).ceil().clamp(1.0, MAX_STEPS);
            let mut from = last;
            for k in 1..=steps as usize {
                let to = if k == steps as usize { given } else { last.towards(&given, k as f64 / steps) };
                axis.step(&from, &to);
                from = to;
            }
            last = given;
        }
        if place % every == 0 {
            moved.push(axis.moved(&given));
        }
    }
    moved
}
