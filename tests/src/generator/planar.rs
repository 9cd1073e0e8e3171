//! Transmission bench, independent of the engine: the source of "measured" logs for the tests of
//! the diagnosis.
//!
//! It is written from the equations of the planar bench and differs from the engine wherever a
//! choice is free. It has fixed-step fourth-order Runge-Kutta instead of an adaptive pair, a
//! contact onset interpolated between two steps instead of a located one, and a separate noise
//! generator. Readings are rounded, and samples get lost. The smoothed sign of friction is the
//! described curve in another form. A different curve of the same width would move the journal by a
//! micrometre, which is five times its sensor's noise and a true finding. A hidden effect is a
//! field of [`Hidden`] or of the vocabulary.

use super::hidden::HiddenEffect;
use super::noise::Noise;
use super::planar_data::{Hidden, RealBench, Row, State};
use super::planar_plant::Plant;
use super::plant::{BENCH_OUTPUTS, BENCH_SENSORS};
use super::sensing::Signals;
use super::tilt::NODES;
use std::fmt::Write as _;

/// Integrator steps per step of the signals.
const WRITTEN_EVERY: usize = 20;

/// Described parameters of bench B: cranks in m, mass in kg, moment of inertia in kg m2, clearance
/// in m, Young's modulus in Pa, level of friction.
const DESCRIBED: [f64; 7] = [0.30, 0.36, 150.0, 60.0, 0.5e-3, 50e9, 1.0];

/// Returns the index of the described parameter that an effect moves, and the change.
pub(super) fn moved_number(off: &[f64], hidden: &HiddenEffect) -> Option<(usize, f64)> {
    let (place, share) = match hidden.effect.as_str() {
        "lever-ratio" => (1, hidden.get("relative_change")),
        "inertia-mismatch" => (3, hidden.get("relative_change")),
        "clearance-wear" => return Some((4, hidden.get("clearance_increase_m"))),
        "contact-stiffness" => (5, hidden.get("relative_change")),
        "coulomb-level" => (6, hidden.get("relative_change")),
        _ => return None,
    };
    Some((place, share * (DESCRIBED.get(place)? + off.get(place)?)))
}

/// Operation of bench B in a record.
#[derive(Clone, Copy, Debug)]
pub struct Operation {
    /// Load, relative to the described one.
    pub load: f64,
    /// Number of cycles.
    pub cycles: usize,
    /// True if the shaft may tilt in its bearing.
    pub tilts: bool,
}

/// Returns the true signals of bench B. `off` is in SI: drive crank, load crank, mass, inertia,
/// clearance, modulus, friction.
pub fn signals(operation: Operation, off: &[f64], hidden: &[HiddenEffect]) -> Signals {
    let number = |i: usize| DESCRIBED[i] + off.get(i).copied().unwrap_or_default();
    let real = RealBench {
        levers_m: (number(0), number(1)),
        inertia: (number(2), number(3)),
        clearance_m: number(4),
        modulus_pa: number(5),
        friction: number(6),
        load_n: 10e3 * operation.load,
        cycles: operation.cycles,
        noise_colour: 0.0,
        tilts: operation.tilts,
    };
    let rows = real.run(&Hidden::default(), hidden);
    let written = || rows.iter().step_by(WRITTEN_EVERY);
    let inputs: [fn(&Row) -> f64; 3] = [|r| r.drive.0, |r| r.drive.1, |r| r.load];
    let names = BENCH_SENSORS.iter().map(|s| s.0);
    Signals {
        step_s: WRITTEN_EVERY as f64 * STEP_S,
        inputs: names.zip(inputs).map(|(n, read)| (n, written().map(read).collect())).collect(),
        outputs: BENCH_OUTPUTS
            .iter()
            .enumerate()
            .map(|(i, n)| (*n, written().map(|r| r.outputs[i]).collect()))
            .collect(),
    }
}

/// Step, s. The contact's damping limits it to some 20 us.
const STEP_S: f64 = 5e-6;
const RATE_HZ: f64 = 1000.0;
/// Share of lost samples.
const LOST: f64 = 0.004;

impl RealBench {
    /// Returns bench B with every uncertain parameter off by up to `deviations` of its declared
    /// standard deviation.
    pub fn near_description(noise: &mut Noise, deviations: f64) -> Self {
        let mut off = |share: f64| 1.0 + share * deviations * (2.0 * noise.uniform() - 1.0);
        Self {
            levers_m: (0.30 * off(0.003), 0.36 * off(0.003)),
            inertia: (150.0 * off(0.02), 60.0 * off(0.05)),
            clearance_m: 0.5e-3 * off(0.02),
            modulus_pa: 50e9 * off(0.05),
            friction: off(0.03),
            load_n: 10e3,
            cycles: 2,
            noise_colour: 0.0,
            tilts: false,
        }
    }

    /// Runs the bench and returns the log as CSV text.
    pub fn log(&self, hidden: &Hidden, noise: &mut Noise) -> String {
        let rows = self.run(hidden, &[]);
        let (angle, speed) = (Sensor::new(20e-6, 5e-6), Sensor::new(2e-3, 5e-4));
        let (journal, force) = (Sensor::new(0.2e-6, 0.05e-6), Sensor::new(15.0, 4.0));
        let (torque, drive) = (Sensor::new(0.4, 0.1), Sensor::new(20.0, 5.0));
        let sensors = [angle, speed, journal, journal, force, force, torque, drive];
        let mut coloured = [0.0; 8];
        let mut text = String::from(
            "t_s,drive_displacement_m,drive_velocity_m_s,load_force_n,shaft_angle_rad,shaft_speed_rad_s,\
             journal_y_m,journal_z_m,bearing_force_y_n,bearing_force_z_n,friction_torque_nm,drive_force_n\n",
        );
        let per_sample = (1.0 / RATE_HZ / STEP_S).round() as usize;
        let late = (hidden.journal_y_delay_s / STEP_S).round() as usize;
        for sample in 0..rows.len() / per_sample {
            let at = sample * per_sample;
            let row = &rows[at];
            let mut outputs = row.outputs;
            outputs[2] = rows[at.saturating_sub(late)].outputs[2];
            outputs[4] += hidden.force_y_offset_n;
            let colour = self.noise_colour;
            for ((value, sensor), state) in outputs.iter_mut().zip(&sensors).zip(&mut coloured) {
                *state = colour * *state + (1.0 - colour * colour).sqrt() * noise.normal();
                *value = round(*value + sensor.noise * *state, sensor.resolution);
            }
            let inputs = [
                round(row.drive.0, 1e-8),
                round(row.drive.1, 1e-6),
                round(row.load + 0.5 * noise.normal(), 0.1),
            ];
            if sample > 0 && noise.uniform() < LOST {
                continue;
            }
            let _ = write!(text, "{:.3}", sample as f64 / RATE_HZ);
            for value in inputs.iter().chain(&outputs) {
                let _ = write!(text, ",{value:.9e}");
            }
            text.push('\n');
        }
        text
    }

    fn run(&self, hidden: &Hidden, effects: &[HiddenEffect]) -> Vec<Row> {
        let plant = Plant::new(self, hidden, effects);
        let (x, v, _) = plant.drive(0.0);
        let angle = (x / plant.drive_lever_m).asin();
        let (slope_y, slope_z) = plant.tilt.bearing;
        let start = -0.999 * plant.clearance_m;
        let mut state = [0.0, start, 0.0, 0.0, angle, v, angle, v, slope_y, slope_z, 0.0, 0.0];
        let steps = (self.cycles as f64 / STEP_S).round() as usize;
        let mut rows = Vec::with_capacity(steps);
        let (mut touching, mut latched, mut last) = ([false; NODES], [0.0; NODES], [(0.0, 0.0); NODES]);
        for step in 0..steps {
            let t = step as f64 * STEP_S;
            for (i, place) in plant.places(t, &state).enumerate() {
                let (depth, rate) = (place.depth, place.rate);
                if depth > 0.0 && !touching[i] {
                    let (before, rate_before): (f64, f64) = last[i];
                    latched[i] = (rate_before + (rate - rate_before) * before / (before - depth)).max(0.0);
                }
                touching[i] = depth > 0.0;
                last[i] = (depth, rate);
            }
            rows.push(plant.row(t, &state, &latched));
            let k1 = plant.derivative(t, &state, &latched).0;
            let k2 = plant.derivative(t + 0.5 * STEP_S, &add(&state, &k1, 0.5 * STEP_S), &latched).0;
            let k3 = plant.derivative(t + 0.5 * STEP_S, &add(&state, &k2, 0.5 * STEP_S), &latched).0;
            let k4 = plant.derivative(t + STEP_S, &add(&state, &k3, STEP_S), &latched).0;
            let slope = |i: usize| k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i];
            state = std::array::from_fn(|i| state[i] + STEP_S / 6.0 * slope(i));
        }
        rows
    }
}

/// Noise and resolution of a sensor.
#[derive(Clone, Copy)]
struct Sensor {
    noise: f64,
    resolution: f64,
}

impl Sensor {
    fn new(noise: f64, resolution: f64) -> Self {
        Self { noise, resolution }
    }
}

fn round(value: f64, resolution: f64) -> f64 {
    (value / resolution).round() * resolution
}

fn add(a: &State, b: &State, h: f64) -> State {
    std::array::from_fn(|i| a[i] + h * b[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use bench::Bench;

    #[test]
    fn the_description_is_the_preset_with_resolutions_and_has_the_parameters_of_the_generator() {
        let preset = include_str!("../../../crates/bench/presets/bench-b.toml");
        let own = super::super::plant::Plant::Bench.description();
        let data = |line: &str| line.split('#').next().unwrap_or_default().trim_end().to_owned();
        let lines = |text: &str| text.lines().map(data).filter(|line| !line.is_empty()).collect::<Vec<_>>();
        let without_resolution = |line: String| match line.split_once(", resolution = ") {
            Some((before, _)) => format!("{before} }}"),
            None => line,
        };
        let plain: Vec<_> = lines(own).into_iter().map(without_resolution).collect();
        assert_eq!(plain, lines(preset), "all but the comments");
        let mut bench = Bench::parse("bench", own).unwrap();
        let names = [
            "geometry.drive_lever_radius_m",
            "geometry.load_lever_radius_m",
            "shaft.mass_kg",
            "shaft.inertia_kg_m2",
            "bearing.radial_clearance_m",
            "bearing.youngs_modulus_pa",
            "friction.level",
        ];
        assert_eq!(names.map(|name| *bench.parameter_mut(name).unwrap()), DESCRIBED);
        let declared = names.map(|name| bench.uncertain()[name]);
        assert_eq!(declared.as_slice(), super::super::plant::Plant::Bench.deviations());
    }
}
