//! Complete cycles of bench B with noisy sensors: error of the force in % of the largest force of
//! the run.
//!
//! None of these benches was used to choose the conditioning: its parameters come from clearances
//! of .14, .35 and .7 mm.

use bench::Bench;
use bench::description::TransmissionBench;
use bench::plants::transmission::{Snapshot, Transmission};
use bench::simulate::{DEFAULT_TOLERANCE, snapshots};
use controller::Estimator;
use controller::estimator::{Conditioning, Masses};
use inference::{BearingMaterial, shipped};
use link::{BenchConfiguration, SensorFrame};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const RATE_HZ: f64 = 10_000.0;

/// True course of a cycle, and the configuration of the controller.
struct Cycle {
    bearing: BearingMaterial,
    truth: Vec<Snapshot>,
    configuration: BenchConfiguration,
}

fn cycle(bearing: BearingMaterial, clearance_m: f64, load_n: f64, period_s: f64) -> Cycle {
    let Ok(Bench::Transmission(preset)) = Bench::open("bench-b") else { unreachable!("a preset") };
    let mut bench: TransmissionBench = (*preset).clone();
    bench.set_material(bearing);
    bench.set_radial_clearance(clearance_m);
    bench.load.force_n = load_n;
    bench.drive.period_s = period_s;
    let times = bench.sample_times_s(RATE_HZ);
    let inputs = || (bench.drive_profile(), bench.load_profile());
    let truth = snapshots(&bench, inputs(), bench.duration_s(), &times, DEFAULT_TOLERANCE).unwrap();
    let plant = Transmission::new(&bench, inputs().0, inputs().1);
    let configuration = BenchConfiguration {
        bearing: bearing.code(),
        radial_clearance_nm: (clearance_m * 1e9).round() as u32,
        journal_radius_nm: (plant.journal_radius_m() * 1e9).round() as u32,
        sample_period_us: 100,
        latch_floor_um_s: 1_000,
        unseen_approach_um_s: (plant.landing_speed_m_s() * 1e6).round() as u32,
    };
    Cycle { bearing, truth, configuration }
}

impl Cycle {
    /// Error of the force after the load's ramp, root mean square in % of the largest force, with
    /// .2 um and .01 degrees of noise.
    fn error_percent(&self, seed: u64, conditioning: &Conditioning) -> f64 {
        let mut estimator =
            Estimator::conditioned(shipped(self.bearing), self.configuration, conditioning).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        // The sum of twelve uniform numbers has a variance of 1.
        let mut normal = || {
            let sum: f64 = (0..12).map(|_| f64::from(rng.next_u32()) / f64::from(u32::MAX)).sum();
            sum - 6.0
        };
        let (mut squares, mut count, mut peak) = (0.0, 0.0, 0.0_f64);
        for (index, truth) in (0_u32..).zip(&self.truth) {
            let estimate = estimator.step(&SensorFrame {
                sequence: index,
                time_us: index * 100,
                journal_y_nm: ((truth.y_m + 0.2e-6 * normal()) * 1e9).round() as i32,
                journal_z_nm: ((truth.z_m + 0.2e-6 * normal()) * 1e9).round() as i32,
                shaft_angle_nrad: ((truth.angle_rad + 0.01_f64.to_radians() * normal()) * 1e9).round() as i32,
                load_force_mn: 0,
            });
            if truth.time_s >= 0.05 {
                squares += (f64::from(estimate.normal_force_n) - truth.forces.normal_n).powi(2);
                count += 1.0;
                peak = peak.max(truth.forces.normal_n);
            }
        }
        100.0 * f64::sqrt(squares / count) / peak
    }
}

/// Benches that were not used to choose the conditioning.
fn held_out() -> impl Iterator<Item = Cycle> {
    BearingMaterial::ALL.into_iter().flat_map(|bearing| {
        [
            (0.1e-3, -10e3, 1.0),
            (0.12e-3, 6e3, 1.6),
            (0.18e-3, -6e3, 0.9),
            (0.4e-3, 9e3, 0.9),
            (1e-3, 10e3, 1.0),
        ]
        .into_iter()
        .map(move |(clearance, load, period)| cycle(bearing, clearance, load, period))
    })
}

#[test]
fn with_the_sensors_noise_the_force_is_right_to_three_percent() {
    for (seed, cycle) in (1..).zip(held_out()) {
        let error = cycle.error_percent(seed, &Conditioning::for_bearing(cycle.bearing));
        let is_metal = cycle.bearing.elastic().youngs_modulus_pa > 1e10;
        let limit = if is_metal { 2.4 } else { 1.2 };
        assert!(error < limit, "{:?}: {error:.2} %", cycle.configuration);
    }
}

/// A mass that is 10 % too small along one axis and too large along the other, or a damping that is
/// off by a fifth, increases the error only slightly.
#[test]
fn masses_and_damping_need_not_be_exact() {
    for (seed, cycle) in (11..).zip(held_out()) {
        let right = Conditioning::for_bearing(cycle.bearing);
        for (y, z, damping) in [(0.9, 1.1, 1.0), (1.1, 0.9, 1.0), (1.0, 1.0, 0.8), (1.0, 1.0, 1.2)] {
            let masses = right.masses.map(|masses| Masses {
                along_y_g: (f64::from(masses.along_y_g) * y) as u32,
                along_z_g: (f64::from(masses.along_z_g) * z) as u32,
            });
            let damping_per_mille = (f64::from(right.damping_per_mille) * damping) as u32;
            let error = cycle.error_percent(seed, &Conditioning { masses, damping_per_mille, ..right });
            assert!(error < 3.0, "{:?}, {y} {z} {damping}: {error:.2} %", cycle.configuration);
        }
    }
}

/// Effect of the prediction: without masses the rate is derived from the position alone.
#[test]
fn without_masses_the_force_is_as_noisy_as_the_window() {
    for (seed, cycle) in (21..).zip(held_out().filter(|cycle| cycle.bearing == BearingMaterial::Babbitt)) {
        let known = Conditioning::for_bearing(cycle.bearing);
        let error = |conditioning: &Conditioning| cycle.error_percent(seed, conditioning);
        let (with, without) = (error(&known), error(&Conditioning { masses: None, ..known }));
        assert!(
            without > 1.3 * with && without < 12.0,
            "{:?}: {with:.2} % {without:.2} %",
            cycle.configuration
        );
    }
}
