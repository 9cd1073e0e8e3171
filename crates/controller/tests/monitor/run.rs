//! Runs of bench B for the monitor. The true bench may differ from the configuration in clearance
//! and in the parameters that calibration leaves uncertain.

use bench::Bench;
use bench::description::TransmissionBench;
use bench::plants::transmission::{Snapshot, Transmission};
use bench::signals::Sensor;
use bench::simulate::run_with_law;
use contact::Dissipation;
use controller::Monitor;
use controller::configuration::BENCH_B;
use inference::{BearingMaterial, shipped};
use link::track::{MonitorConfiguration, SensorStatus};
use link::{BenchConfiguration, EstimateFrame, SensorFrame};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Sample rate of every run.
pub(crate) const RATE_HZ: f64 = 10_000.0;

/// True parameters of a bench that differ from its description.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    pub bearing: BearingMaterial,
    pub clearance_m: f64,
    pub friction_level: f64,
    pub load_n: f64,
    pub inertia: f64,
    pub mass: f64,
    pub modulus: f64,
    pub drive_lever: f64,
    pub load_lever: f64,
    pub offset_y_m: f64,
    pub offset_z_m: f64,
}

impl Truth {
    /// All parameters as described.
    pub(crate) fn nominal(bearing: BearingMaterial) -> Self {
        Self {
            bearing,
            clearance_m: 0.5e-3,
            friction_level: 1.0,
            load_n: 10e3,
            inertia: 1.0,
            mass: 1.0,
            modulus: 1.0,
            drive_lever: 1.0,
            load_lever: 1.0,
            offset_y_m: 0.0,
            offset_z_m: 0.0,
        }
    }

    /// Random parameters with the uncertainties of a calibration: J 5 %, m 2 %, E 5 %, levers 0.3
    /// %, offsets 0.2 um.
    pub(crate) fn drawn(bearing: BearingMaterial, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || {
            let sum: f64 = (0..12).map(|_| f64::from(rng.next_u32()) / f64::from(u32::MAX)).sum();
            sum - 6.0
        };
        Self {
            inertia: 1.0 + 0.05 * normal(),
            mass: 1.0 + 0.02 * normal(),
            modulus: 1.0 + 0.05 * normal(),
            drive_lever: 1.0 + 0.003 * normal(),
            load_lever: 1.0 + 0.003 * normal(),
            offset_y_m: 0.2e-6 * normal(),
            offset_z_m: 0.2e-6 * normal(),
            ..Self::nominal(bearing)
        }
    }

    fn bench(&self) -> TransmissionBench {
        let Ok(Bench::Transmission(mut bench)) = Bench::open("bench-b") else { unreachable!("a preset") };
        bench.set_material(self.bearing);
        bench.set_radial_clearance(self.clearance_m);
        bench.load.force_n = self.load_n;
        bench.friction.level *= self.friction_level;
        bench.shaft.inertia_kg_m2 *= self.inertia;
        bench.shaft.mass_kg *= self.mass;
        bench.bearing.youngs_modulus_pa *= self.modulus;
        bench.geometry.drive_lever_radius_m *= self.drive_lever;
        bench.geometry.load_lever_radius_m *= self.load_lever;
        *bench
    }

    /// The frames of one cycle, numbered from `first`.
    pub(crate) fn frames(&self, seed: u64, first: u32) -> (Vec<SensorFrame>, Vec<Snapshot>) {
        let bench = self.bench();
        let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
        let times = bench.sample_times_s(RATE_HZ);
        let run = run_with_law(&plant, bench.duration_s(), &times, 1e-7).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut read = |truth: fn(&Snapshot) -> f64, noise: f64, offset: f64| {
            let mut signal: Vec<f64> = run.samples.iter().map(|s| truth(s) + offset).collect();
            Sensor { noise, ..Sensor::default() }.read(&mut signal, &mut rng);
            signal
        };
        let y = read(|s| s.y_m, 0.2e-6, self.offset_y_m);
        let z = read(|s| s.z_m, 0.2e-6, self.offset_z_m);
        let angle = read(|s| s.angle_rad, 20e-6, 0.0);
        let load = read(|s| s.load_force_n, 10.0, 0.0);
        let counts = |value: f64, unit: f64| (value / unit).round() as i32;
        let frames = (0..times.len())
            .map(|i| SensorFrame {
                sequence: first + i as u32,
                time_us: (first + i as u32) * 100,
                journal_y_nm: counts(y[i], 1e-9),
                journal_z_nm: counts(z[i], 1e-9),
                shaft_angle_nrad: counts(angle[i], 1e-9),
                load_force_mn: counts(load[i], 1e-3),
            })
            .collect();
        (frames, run.samples)
    }
}

/// Configuration of the controller for bench B with a bearing.
pub(crate) fn configuration(bearing: BearingMaterial) -> (BenchConfiguration, MonitorConfiguration) {
    let modulus = bearing.effective_modulus_pa();
    let damping: f64 = Dissipation::ZhiyingQishao.factor(bearing.restitution());
    let configuration = BenchConfiguration { bearing: bearing.code(), ..BENCH_B.bench };
    let monitor = MonitorConfiguration {
        effective_modulus_kpa: (modulus * 1e-3) as u32,
        damping_per_mille: (damping * 1e3).round() as u16,
        ..BENCH_B.monitor
    };
    (configuration, monitor)
}

/// A monitor of bench B.
pub(crate) fn monitor(bearing: BearingMaterial, change: impl FnOnce(&mut MonitorConfiguration)) -> Monitor {
    let (configuration, mut monitor) = configuration(bearing);
    change(&mut monitor);
    Monitor::new(shipped(bearing), &configuration, &monitor, 100).unwrap()
}

/// Sends frames with good status.
pub(crate) fn follow(monitor: &mut Monitor, frames: &[SensorFrame]) -> Vec<EstimateFrame> {
    frames.iter().map(|frame| monitor.step(frame, SensorStatus::GOOD)).collect()
}
