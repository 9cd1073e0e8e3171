//! Logs of a driven axis whose motion is simulated: inputs of a log, outputs, and the described
//! run.
//!
//! The input is interpolated between its samples by cubics with the slopes of central differences,
//! and is not smoothed: the axis does that. The simulation begins with the smoothed position and
//! speed of the log's first sample (the order and its speed if neither is logged), and a controller
//! with the effort of the first sample (without one, with the effort that holds the axis).

use super::axis_inputs::{FINENESS, axis_load, measured_motion};
use super::respond::{Command, Inputs, Response, Truth, refined};
use crate::description::{Drive, DriveInput, FrictionRig};
use crate::log::{LogError, MeasuredLog};
use crate::plants::forward_axis::{Moved, Start, motions_along};
use crate::plants::friction_rig::{Given, efforts_along};
use crate::signals::{Channel, Motion, Profile, Sensor, white_noise};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Number of disturbed starts from which the error of the start is estimated.
const DISTURBED_STARTS: u64 = 16;
/// Samples of a log from which its start is smoothed, at most.
const START_SAMPLES: usize = 64;

/// Takes the inputs of a simulated motion from a log. Its measured motion serves the comparison
/// alone, but for the start.
pub(super) fn inputs(rig: &FrictionRig, drive: &Drive, log: &MeasuredLog) -> Result<Inputs, LogError> {
    let time_s = &log.time_s;
    let (position, speed, effort) = rig.channels();
    let channel = rig.input_channel().unwrap_or(effort);
    let values = log.need(channel)?;
    let profile = interpolated(time_s, values);
    let first_s = time_s.first().copied().unwrap_or_default();
    let motion = match measured_motion(rig, log) {
        Some(motion) => motion,
        None if drive.input == DriveInput::Order => profile.clone(),
        None => return Err(log.missing(position)),
    };
    let at_start = motion.at(first_s);
    // A position that is integrated from a speed begins at the order.
    let is_placed = log.channels.contains_key(&position) || !log.channels.contains_key(&speed);
    let place = if is_placed || drive.input != DriveInput::Order { at_start } else { profile.at(first_s) };
    let first = |channel| log.channels.get(&channel).and_then(|values| values.first()).copied();
    let of_voltage = first(Channel::DriveVoltage).map(|volts| drive.gain * volts);
    let start = Start { position: place.value, speed: at_start.rate, effort: first(effort).or(of_voltage) };
    let mut inputs = Inputs::from_profiles(log, outputs(rig, log), (motion, axis_load(rig, log)), FINENESS);
    let given = |&t: &f64| Given { time_s: t, motion: profile.at(t), load_n: inputs.load_n(t) };
    inputs.course = inputs.fine_s.iter().map(given).collect();
    inputs.command = Some(Command {
        profile,
        noise: noise_of(rig, channel, (time_s, values)),
        start,
        start_noise: start_noise(rig, log),
    });
    Ok(inputs)
}

/// Noise of a channel: as declared, else that between neighbouring samples.
fn noise_of(rig: &FrictionRig, channel: Channel, (time_s, values): (&[f64], &[f64])) -> f64 {
    let declared = rig.common.sensors.get(&channel).map_or(0.0, Sensor::floor);
    if declared > 0.0 { declared } else { white_noise::deviation(&mut white_noise::squares(time_s, values)) }
}

/// Standard deviations of the smoothed position and speed at the first sample of a log.
fn start_noise(rig: &FrictionRig, log: &MeasuredLog) -> [f64; 2] {
    let mut short = log.clone();
    let count = log.time_s.len().min(START_SAMPLES);
    short.time_s.truncate(count);
    short.channels.values_mut().for_each(|values| values.truncate(count));
    let Some(first_s) = short.time_s.first().copied() else { return [0.0; 2] };
    let start = |log: &MeasuredLog| {
        measured_motion(rig, log).map_or([0.0; 2], |m| [m.at(first_s).value, m.at(first_s).rate])
    };
    let here = start(&short);
    let mut squares = [0.0; 2];
    for seed in 0..DISTURBED_STARTS {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut disturbed = short.clone();
        for channel in [rig.channels().0, rig.channels().1] {
            let Some(values) = log.channels.get(&channel) else { continue };
            let noise = noise_of(rig, channel, (&log.time_s, values));
            disturbed
                .channels
                .entry(channel)
                .or_default()
                .iter_mut()
                .for_each(|v| *v += noise * draw(&mut rng));
        }
        let there = start(&disturbed);
        squares = std::array::from_fn(|i| squares[i] + (there[i] - here[i]).powi(2));
    }
    squares.map(|sum: f64| (sum / DISTURBED_STARTS as f64).sqrt())
}

fn draw(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

impl Inputs {
    /// The same inputs of a simulated motion with another realisation of their noise and of that
    /// of the start; none if a motion is the input.
    pub fn disturbed(&self, seed: u64) -> Option<Self> {
        let command = self.command.as_ref()?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let values =
            self.time_s.iter().map(|&t| command.profile.at(t).value + command.noise * draw(&mut rng));
        let profile = interpolated(&self.time_s, &values.collect::<Vec<f64>>());
        let [position, speed] = command.start_noise;
        let start = Start {
            position: command.start.position + position * draw(&mut rng),
            speed: command.start.speed + speed * draw(&mut rng),
            effort: command.start.effort,
        };
        let mut inputs = self.clone();
        for given in &mut inputs.course {
            given.motion = profile.at(given.time_s);
        }
        inputs.command = Some(Command { profile, start, ..command.clone() });
        Some(inputs)
    }

    /// Efforts at the simulated times: those of the input, or in closed loop those that the
    /// measured motion needs.
    pub fn driving_efforts(&self, rig: &FrictionRig, drive: &Drive) -> Vec<f64> {
        match drive.input {
            DriveInput::Order => {
                let efforts = efforts_along(rig, &self.measured_course(), 1, |t| self.drive(t));
                efforts.into_iter().map(|e| e.effort).collect()
            }
            _ => self.course.iter().map(|given| drive.gain * given.motion.value).collect(),
        }
    }

    /// Measured motion and load at the samples.
    fn measured_course(&self) -> Vec<Given> {
        let given = |&t: &f64| Given { time_s: t, motion: self.drive(t), load_n: self.load_n(t) };
        self.time_s.iter().map(given).collect()
    }
}

fn outputs(rig: &FrictionRig, log: &MeasuredLog) -> Vec<Channel> {
    crate::description::PlantDescription::outputs(rig, log)
}

/// Simulates the outputs of a log at every `every`-th place of its course.
pub(super) fn respond(rig: &FrictionRig, drive: &Drive, inputs: &Inputs, every: usize) -> Response {
    let Some(command) = &inputs.command else { return Response::new() };
    let course = (inputs.course.as_slice(), every);
    let moved = motions_along(rig, drive, course, command.start, |t| command.profile.at(t));
    let mut response = read(rig, &moved);
    response.retain(|channel, _| inputs.outputs.contains(channel));
    response
}

/// Simulates the described run: its refined times, and its inputs and outputs at them.
pub(super) fn run(rig: &FrictionRig, drive: &Drive) -> (Vec<f64>, Truth) {
    let load = Profile::Ramp { level: rig.load.force_n, ramp_s: rig.load.ramp_s };
    let count = (rig.axis.duration_s() * rig.logging.sample_rate_hz).round() as usize;
    let samples_s: Vec<f64> = (0..count).map(|i| i as f64 / rig.logging.sample_rate_hz).collect();
    let fine_s = refined(&samples_s, FINENESS);
    let described = rig.axis.motion();
    let load_n = |t: f64| load.at(t).value;
    let input = |t: f64| described_input(rig, drive, &described, (t, load_n(t)));
    let given = |&t: &f64| Given { time_s: t, motion: input(t), load_n: load_n(t) };
    let course: Vec<Given> = fine_s.iter().map(given).collect();
    let moved = motions_along(rig, drive, (&course, 1), Start::default(), input);
    let mut outputs = read(rig, &moved);
    outputs.retain(|channel, _| match *channel {
        // A measured effort beside an open loop's voltage is not recorded.
        c if c == rig.channels().2 => drive.input != DriveInput::Voltage,
        Channel::DriveVoltage => drive.input == DriveInput::Voltage,
        Channel::FrictionTorque => rig.surface.is_some(),
        _ => true,
    });
    outputs.insert(Channel::LoadForce, course.iter().map(|given| given.load_n).collect());
    if let Some(channel) = rig.input_channel() {
        outputs.insert(channel, course.iter().map(|given| given.motion.value).collect());
    }
    (fine_s, Truth { outputs, fineness: FINENESS })
}

/// Input of the described run at a time under a load there: the described motion as the order, or
/// an effort in the shape of its speed beside what load and constant effort need.
fn described_input(
    rig: &FrictionRig,
    drive: &Drive,
    described: &Profile,
    (time_s, load_n): (f64, f64),
) -> Motion {
    let motion = described.at(time_s);
    if drive.input == DriveInput::Order {
        return motion;
    }
    let axis = &rig.axis;
    let top_speed = core::f64::consts::TAU / axis.period_s * axis.amplitude;
    let effort =
        drive.effort_amplitude * motion.rate / top_speed + axis.load_gain * load_n + axis.constant_effort;
    let value = if drive.input == DriveInput::Voltage { effort / drive.gain } else { effort };
    Motion { value, ..Motion::default() }
}

/// Channels of simulated motions.
fn read(rig: &FrictionRig, moved: &[Moved]) -> Response {
    let (position, speed, effort) = rig.channels();
    let of = |value: fn(&Moved) -> f64| moved.iter().map(value).collect();
    Response::from([
        (position, of(|m| m.motion.value)),
        (speed, of(|m| m.motion.rate)),
        (effort, of(|m| m.effort)),
        (Channel::DriveVoltage, of(|m| m.output)),
        (Channel::FrictionTorque, of(|m| -m.friction)),
    ])
}

/// Curve through samples as they are, with the slopes of central differences.
fn interpolated(time_s: &[f64], values: &[f64]) -> Profile {
    let rates = slopes(time_s, values);
    let accelerations = slopes(time_s, &rates);
    let nodes = values.iter().zip(rates).zip(accelerations);
    let nodes = nodes.map(|((&value, rate), acceleration)| Motion { value, rate, acceleration }).collect();
    Profile::Curve { time_s: time_s.to_vec(), nodes }
}

/// Slopes at samples by the parabola through each and its neighbours; one-sided at the ends.
fn slopes(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let slope = |i: usize, k: usize| match (time_s.get(i), time_s.get(k), values.get(i), values.get(k)) {
        (Some(t0), Some(t1), Some(v0), Some(v1)) => Some(((v1 - v0) / (t1 - t0), t1 - t0)),
        _ => None,
    };
    let at = |i: usize| {
        let before = i.checked_sub(1).and_then(|before| slope(before, i));
        match (before, slope(i, i + 1)) {
            (Some((s0, h0)), Some((s1, h1))) => (s0 * h1 + s1 * h0) / (h0 + h1),
            (Some((one, _)), None) | (None, Some((one, _))) => one,
            (None, None) => 0.0,
        }
    };
    (0..values.len()).map(at).collect()
}
