//! Runs of bench B in the independent simulator, as the controller's samples.

use controller::Estimator;
use controller::configuration::BENCH_B;
use inference::{BearingMaterial, shipped};
use link::track::MonitorConfiguration;
use link::{BenchConfiguration, ContactSource, EstimateFrame, SensorFrame};
use worlds::{Bearing, Reading, Row, Sensors, World};

/// Samples of the start that do not count: 50 ms.
pub(crate) const START: usize = 500;

/// An operating point of bench B as it is described to the controller.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub bearing: Bearing,
    pub clearance_m: f64,
    pub load_n: f64,
    pub source: ContactSource,
    pub period_us: u32,
}

impl Point {
    /// Babbitt, half a millimetre, +10 kN, 10 kHz, networks.
    pub(crate) const DEFAULT: Self = Self {
        bearing: Bearing::Babbitt,
        clearance_m: 5e-4,
        load_n: 10e3,
        source: ContactSource::Network,
        period_us: 100,
    };

    /// Both bearings, two clearances, two loads.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        [Bearing::Babbitt, Bearing::Plastic].into_iter().flat_map(|bearing| {
            [(1e-4, 10e3), (1e-4, -5e3), (5e-4, 10e3), (5e-4, -5e3)].map(|(clearance_m, load_n)| Self {
                bearing,
                clearance_m,
                load_n,
                ..Self::DEFAULT
            })
        })
    }

    fn material(&self) -> BearingMaterial {
        match self.bearing {
            Bearing::Babbitt => BearingMaterial::Babbitt,
            Bearing::Plastic => BearingMaterial::Plastic,
        }
    }

    /// Returns the described bench as a world.
    pub(crate) fn world(&self) -> World {
        World::bench_b(self.bearing, self.clearance_m, self.load_n)
    }

    /// Returns a light bench on a short, fast stroke, whose journal bounces: it leaves the bearing
    /// several times in every cycle.
    pub(crate) fn bouncing_world(&self) -> World {
        World { inertia_kg_m2: 3.0, stroke_m: 0.01, period_s: 0.07, ..self.world() }
    }

    /// Returns an estimator for the bouncing bench.
    pub(crate) fn bouncing_estimator(&self) -> Estimator {
        let (bench, mut monitor) = self.configuration();
        (monitor.inertia_g_m2, monitor.stroke_mm, monitor.drive_period_ms) = (3_000, 10, 70);
        self.estimator_for(&bench, &monitor)
    }

    /// Returns the configuration of the controller.
    pub(crate) fn configuration(&self) -> (BenchConfiguration, MonitorConfiguration) {
        let bench = BenchConfiguration {
            bearing: self.material().code(),
            radial_clearance_nm: (self.clearance_m * 1e9).round() as u32,
            journal_radius_nm: ((0.07 - self.clearance_m) * 1e9).round() as u32,
            sample_period_us: self.period_us,
            contact: self.source,
            ..BENCH_B.bench
        };
        let effective_modulus_kpa = (self.material().effective_modulus_pa() * 1e-3) as u32;
        let monitor = MonitorConfiguration { effective_modulus_kpa, damping_per_mille: 0, ..BENCH_B.monitor };
        (bench, monitor)
    }

    /// Returns a fresh estimator.
    pub(crate) fn estimator(&self) -> Estimator {
        let (bench, monitor) = self.configuration();
        self.estimator_for(&bench, &monitor)
    }

    /// Returns a fresh estimator for a configuration.
    pub(crate) fn estimator_for(
        &self,
        bench: &BenchConfiguration,
        monitor: &MonitorConfiguration,
    ) -> Estimator {
        Estimator::new(shipped(self.material()), bench, monitor)
            .unwrap_or_else(|refusal| unreachable!("a bench within the limits: {refusal:?}"))
    }

    /// Runs a world for a time and returns the truth and the frames of bench B's sensors.
    pub(crate) fn read(&self, world: &World, seed: u64, time_s: f64) -> (Vec<Row>, Vec<SensorFrame>) {
        let rows = world.run(time_s, 1e6 / f64::from(self.period_us));
        let frames = self.frames(&Sensors::BENCH_B.read(&rows, seed));
        (rows, frames)
    }

    /// Returns the frames of some readings.
    pub(crate) fn frames(&self, readings: &[Reading]) -> Vec<SensorFrame> {
        let counts = |value: f64, unit: f64| (value / unit).round() as i32;
        let frames = readings.iter().zip(0_u32..).map(|(r, sequence)| SensorFrame {
            sequence,
            time_us: sequence * self.period_us,
            journal_y_nm: counts(r.journal_y_m, 1e-9),
            journal_z_nm: counts(r.journal_z_m, 1e-9),
            shaft_angle_nrad: counts(r.shaft_angle_rad, 1e-9),
            load_force_mn: counts(r.load_force_n, 1e-3),
        });
        frames.collect()
    }
}

/// Length of the force vector's error, N.
pub(crate) fn error_n(row: &Row, estimate: &EstimateFrame) -> f64 {
    let y = f64::from(estimate.force_y_n) - row.force_y_n;
    y.hypot(f64::from(estimate.force_z_n) - row.force_z_n)
}

/// Errors after the start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Errors {
    /// Rms of the force vector's error over the largest force.
    pub force_share: f64,
    /// Largest error over the largest force.
    pub max_share: f64,
    /// Rms error of the torque over the largest torque.
    pub torque_share: f64,
    /// Share of the samples within two deviations.
    pub inside: f64,
}

impl Errors {
    /// Compares estimates with the truth.
    pub(crate) fn new(rows: &[Row], estimates: &[EstimateFrame]) -> Self {
        let pairs: Vec<_> = rows.iter().zip(estimates).filter(|(row, _)| row.time_s >= 0.05).collect();
        let count = pairs.len() as f64;
        let rms = |value: &dyn Fn(&(&Row, &EstimateFrame)) -> f64| {
            (pairs.iter().map(|pair| value(pair).powi(2)).sum::<f64>() / count).sqrt()
        };
        let most = |value: &dyn Fn(&(&Row, &EstimateFrame)) -> f64| {
            pairs.iter().map(|pair| value(pair).abs()).fold(0.0, f64::max)
        };
        let force = most(&|(row, _)| row.force_y_n.hypot(row.force_z_n));
        let torque = |(row, estimate): &(&Row, &EstimateFrame)| {
            f64::from(estimate.friction_torque_nm) - row.friction_torque_nm
        };
        let is_inside = |(row, estimate): &&(&Row, &EstimateFrame)| {
            let deviation_n = f64::from(estimate.force_sd_n);
            deviation_n.is_finite() && error_n(row, estimate) <= 2.0 * deviation_n
        };
        Self {
            force_share: rms(&|(row, estimate)| error_n(row, estimate)) / force,
            max_share: most(&|(row, estimate)| error_n(row, estimate)) / force,
            torque_share: rms(&torque) / most(&|(row, _)| row.friction_torque_nm),
            inside: pairs.iter().filter(is_inside).count() as f64 / count,
        }
    }
}

/// Runs the described world of a point for a cycle and compares.
pub(crate) fn errors(point: &Point, world: &World, seed: u64) -> Errors {
    let (rows, frames) = point.read(world, seed, 1.0);
    let mut estimator = point.estimator();
    let estimates: Vec<_> = frames.iter().map(|frame| estimator.step(frame)).collect();
    Errors::new(&rows, &estimates)
}
