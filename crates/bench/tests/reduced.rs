//! A run without the energy balance equals a run with it, for every memory.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bench::Bench;
use bench::effects::Effect;
use bench::plants::transmission::Transmission;
use bench::simulate::{run_with_law, snapshots};

/// Relative tolerance of both runs.
const TOLERANCE: f64 = 1e-9;
const APART_M: f64 = 2e-9;
const APART_N: f64 = 0.5;

/// Effects with parameters at which they are visible.
const EFFECTS: &[(&str, &[(&str, f64)])] = &[
    ("clearance-wear", &[("clearance_increase_m", 5e-5)]),
    ("hydraulic-compliance", &[("compliance_m_n", 2e-8)]),
    ("shaft-flexibility", &[("compliance_rad_nm", 6e-7)]),
    ("presliding-hysteresis", &[("distance_m", 1e-4)]),
    ("breakaway", &[("excess", 0.8), ("rest_time_s", 0.1), ("distance_m", 5e-4)]),
    ("thermal-friction-drift", &[("level_per_k", -0.06), ("resistance_k_w", 0.1), ("time_constant_s", 1.0)]),
    ("squeeze-film", &[("viscosity_pa_s", 1e-3)]),
];

#[test]
fn a_run_without_energies_equals_the_run_with_them() {
    for (name, parameters) in EFFECTS {
        let mut bench = Bench::open("bench-b").unwrap();
        bench.effects_mut().push(Effect {
            name: (*name).into(),
            channel: None,
            of: None,
            parameters: parameters.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect(),
        });
        let Bench::Transmission(bench) = bench.resolved() else { unreachable!("bench B is a transmission") };
        let times: Vec<f64> = (0..300).map(|i| f64::from(i) * 1e-3).collect();
        let profiles = || (bench.drive_profile(), bench.load_profile());
        let (drive, load) = profiles();
        let full = run_with_law(&Transmission::new(&bench, drive, load), 0.3, &times, TOLERANCE).unwrap();
        let reduced = snapshots(&bench, profiles(), 0.3, &times, TOLERANCE).unwrap();
        assert_eq!(reduced.len(), full.samples.len(), "{name}");
        for (a, b) in reduced.iter().zip(&full.samples) {
            let journal = (a.y_m - b.y_m).abs().max((a.z_m - b.z_m).abs());
            let force = (a.drive_force_n - b.drive_force_n).abs().max((a.force_y_n - b.force_y_n).abs());
            assert!(journal < APART_M && force < APART_N, "{name} at {}: {journal} m, {force} N", b.time_s);
        }
    }
}
