//! A record: a plant close to its description at some operating point, with a logger and nuisance
//! parameters.
//!
//! The seed of a record draws the deviations of the uncertain parameters, the first time stamp,
//! the start phase in the motion, offsets within the resolution of the readings, and the initial
//! temperature.

use super::axis::Run;
use super::axis_data::RealAxis;
use super::conditions::Conditions;
use super::hidden::HiddenEffect;
use super::motion::{Course, Load, Motion};
use super::noise::Noise;
use super::planar;
use super::plant::Plant;
use super::sensing::{Logger, Reading, Signals, log, readings};

/// Length of a cycle of an axis, s.
const CYCLE_S: f64 = 4.0;

/// Operating point, relative to the described one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Factor on the speed.
    pub speed: f64,
    /// Factor on the load; negative: reversed.
    pub load: f64,
    /// Factor on the stroke.
    pub stroke: f64,
    /// Course of an axis' motion. With a plain or described course, the load does not swing.
    pub course: Course,
    /// Length of the load's ramp at the start of an axis' log, s; 0: no ramp.
    pub ramp_s: f64,
}

impl Default for Point {
    fn default() -> Self {
        Self { speed: 1.0, load: 1.0, stroke: 1.0, course: Course::Swing, ramp_s: 0.0 }
    }
}

/// A measured record of a plant, without its hidden effects.
#[derive(Clone, Debug)]
pub struct Record {
    /// Plant.
    pub plant: Plant,
    /// Deviation of each uncertain parameter, in declared standard deviations.
    pub off: Vec<f64>,
    /// Conditions.
    pub conditions: Conditions,
    /// Operating point.
    pub point: Point,
    /// Number of cycles of the log.
    pub cycles: f64,
    /// Logger.
    pub logger: Logger,
    /// Start of the log in the motion, in cycles.
    pub phase: f64,
    load_phase_rad: f64,
    warm: f64,
    /// Offsets of the readings, in resolutions.
    offsets: Vec<f64>,
}

impl Record {
    /// Draws a record with uncertain parameters off by up to `spread` deviations, uniformly.
    pub fn draw(plant: Plant, spread: f64, point: Point, noise: &mut Noise) -> Self {
        let off = plant.deviations().iter().map(|_| spread * (2.0 * noise.uniform() - 1.0)).collect();
        let bench = plant.is_transmission();
        let conditions = Conditions::default();
        let rate_hz = if bench { 1000.0 } else { conditions.axis_rate_hz() };
        let start_s = if bench { 0.0 } else { (noise.uniform() * 1e4).round() / 10.0 };
        Self {
            plant,
            off,
            conditions,
            point,
            cycles: if bench { 2.0 } else { 4.0 },
            logger: Logger { rate_hz, colour: 0.0, lost: 0.004, start_s },
            phase: noise.uniform(),
            load_phase_rad: std::f64::consts::TAU * noise.uniform(),
            warm: noise.uniform(),
            offsets: plant.outputs().iter().map(|_| noise.uniform() - 0.5).collect(),
        }
    }

    /// Draws another record of the same plant: deviations stay, all else is drawn again.
    pub fn repeat(&self, point: Point, noise: &mut Noise) -> Self {
        let logger = Logger { colour: self.logger.colour, lost: self.logger.lost, ..self.logger };
        let fresh = Self::draw(self.plant, 0.0, point, noise);
        Self { off: self.off.clone(), logger, conditions: self.conditions, ..fresh }
    }

    /// Returns the record under hard conditions.
    pub fn hard(mut self) -> Self {
        if !self.plant.is_transmission() {
            self.conditions = Conditions::Hard;
            self.point.course = self.conditions.course();
            self.logger.rate_hz = self.conditions.axis_rate_hz();
        }
        self
    }

    /// Returns the sensors of inputs and outputs.
    pub fn sensors(&self) -> Vec<Reading> {
        self.conditions.sensors(self.plant)
    }

    /// Returns the length of the log, s.
    pub fn length_s(&self) -> f64 {
        let cycle_s = if self.plant.is_transmission() { 1.0 } else { CYCLE_S };
        let cycles = match self.point.course {
            Course::Described { standstill, .. } if standstill > 0.0 => {
                self.cycles * (1.0 + 2.0 * standstill)
            }
            // Turns at a rising frequency.
            Course::Described { rise, .. } if rise != 0.0 => {
                ((1.0 + 2.0 * rise * self.cycles).sqrt() - 1.0) / rise
            }
            _ => self.cycles,
        };
        cycles * cycle_s / self.point.speed
    }

    /// Returns the true signals with uncertain parameters off by `off` deviations.
    pub fn signals(&self, off: &[f64], hidden: &[HiddenEffect]) -> Signals {
        let by = |i: usize| {
            off.get(i).copied().unwrap_or_default()
                * self.plant.deviations().get(i).copied().unwrap_or_default()
        };
        let point = self.point;
        let sign_width_m_s = self.conditions.sign_width_m_s(self.plant);
        let (axis, amplitude, load_n) = match self.plant {
            Plant::Bench | Plant::TwoPlane => {
                let operation = planar::Operation {
                    load: self.point.load,
                    cycles: self.cycles as usize,
                    tilts: self.plant == Plant::TwoPlane,
                };
                return planar::signals(operation, &(0..7).map(by).collect::<Vec<_>>(), hidden);
            }
            Plant::Rotary => {
                let axis = RealAxis {
                    rotary: true,
                    inertia: 10.0 + by(0),
                    coulomb: 30.0 + by(1),
                    viscous: 20.0 + by(2),
                    load_coefficient: 0.08 + by(3),
                    load_gain: 0.0,
                    radius_m: 0.07,
                    sign_width_m_s,
                    warm: self.warm,
                };
                (axis, 0.4, 20e3)
            }
            Plant::Linear => {
                let axis = RealAxis {
                    rotary: false,
                    inertia: 80.0 + by(0),
                    coulomb: 120.0 + by(1),
                    viscous: 300.0 + by(2),
                    load_coefficient: 0.05 + by(3),
                    load_gain: 1.0 + by(4),
                    radius_m: 1.0,
                    sign_width_m_s,
                    warm: self.warm,
                };
                (axis, 0.15, 1000.0)
            }
        };
        let cycle_s = CYCLE_S / point.speed;
        let motion = Motion { amplitude: amplitude * point.stroke, cycle_s, course: point.course };
        let described = matches!(point.course, Course::Described { .. });
        let load = Load {
            mean_n: load_n * point.load,
            swing: if described || point.course == Course::Plain { 0.0 } else { 0.35 },
            period_s: 7.3,
            phase_rad: self.load_phase_rad,
            ramp_s: point.ramp_s,
        };
        let run = Run {
            motion,
            load,
            // A described course starts at its beginning.
            phase_s: if described { 0.0 } else { 2.0 * self.phase * cycle_s },
            length_s: self.length_s(),
            start_s: self.logger.start_s,
        };
        axis.run(&run, hidden)
    }

    /// Returns the readings without noise, by output.
    pub fn readings(&self, off: &[f64], hidden: &[HiddenEffect]) -> Vec<Vec<f64>> {
        readings(&self.signals(off, hidden), self.logger.rate_hz, hidden)
    }

    /// Returns the log as CSV text.
    pub fn log(&self, hidden: &[HiddenEffect], noise: &mut Noise) -> String {
        let sensors = self.sensors();
        let resolution = |c: &str| sensors.iter().find(|s| s.channel == c).map_or(0.0, |s| s.resolution);
        let nuisance = self.plant.outputs().iter().zip(&self.offsets).map(|(channel, share)| {
            HiddenEffect::for_sensor("sensor-offset", channel, "offset", share * resolution(channel))
        });
        let all: Vec<HiddenEffect> = hidden.iter().cloned().chain(nuisance).collect();
        log(&self.signals(&self.off, &all), &sensors, &self.logger, &all, noise)
    }
}
