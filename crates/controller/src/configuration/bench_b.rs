//! Bench B with the Babbitt bearing, as `host-sim` configures it: an example, and the start of
//! tests.

use link::track::MonitorConfiguration;
use link::{BenchConfiguration, ContactSource, ControllerConfiguration};

/// Half a millimetre of clearance, 10 kHz.
pub const BENCH_B: ControllerConfiguration = ControllerConfiguration::new(
    BenchConfiguration {
        bearing: 0,
        radial_clearance_nm: 500_000,
        journal_radius_nm: 69_500_000,
        sample_period_us: 100,
        latch_floor_um_s: 1_000,
        contact: ContactSource::Network,
    },
    MonitorConfiguration {
        mass_g: 150_000,
        inertia_g_m2: 60_000,
        drive_lever_um: 300_000,
        load_lever_um: 360_000,
        crank_vertical_nrad: 0,
        effective_modulus_kpa: 44_213_599,
        damping_per_mille: 2_092,
        stiffness_deviation_per_mille: 50,
        mass_deviation_per_mille: 20,
        inertia_deviation_per_mille: 50,
        lever_deviation_ppht: 300,
        clearance_deviation_nm: 10_000,
        friction_deviation_per_mille: 30,
        friction_level_per_mille: 1_000,
        stroke_mm: 172,
        drive_period_ms: 1_000,
        journal_noise_nm: 200,
        angle_noise_nrad: 20_000,
        journal_noise_limit_nm: 2_000,
        angle_noise_limit_nrad: 200_000,
        load_noise_limit_mn: 200_000,
        load_stuck_samples: 0,
        journal_rail_nm: 2_000_000,
        load_rail_mn: 50_000_000,
        envelope_per_mille: 300,
        envelope_floor_n: 500,
        recovery_samples: 100,
        lost_samples: 10_000,
        wear_limit_nm: 700_000,
        wear_hysteresis_nm: 20_000,
    },
);
