//! Every effect of the catalogue, hidden at a clear size in a recorded log, is named, or is
//! ambiguous with effects that the catalogue declares as confounded with it.
//!
//! The logs come from the engine's own model with sensor noise. These tests show that every
//! candidate is connected, and not how good a diagnosis of a real bench is. The latter is tested in
//! `tests/` of the workspace with an independent generator.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

mod rig;

use bench::description::TwoPlaneSection;
use bench::effects::{Effect, kind};
use bench::simulate::record;
use bench::{Bench, Channel};
use diagnosis::{Diagnosis, Options, diagnose};
use rig::rig;
use std::time::Instant;

/// Parameters of an effect.
type Sizes<'a> = &'a [(&'a str, f64)];

fn hide(mut bench: Bench, name: &str, channel: Option<Channel>, sizes: Sizes<'_>, seed: u64) -> Diagnosis {
    let parameters = sizes.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let truth = Effect { name: name.into(), channel, of: None, parameters };
    truth.check(&bench).unwrap();
    let nominal = bench.clone();
    bench.effects_mut().push(truth);
    let log = record(&bench, seed).unwrap();
    let started = Instant::now();
    let d = diagnose(&nominal, &[log], &[], &Options::default()).unwrap();
    let causes = d.causes.iter().map(|c| (c.effect.as_str(), c.channel));
    let group: Vec<_> =
        causes.chain(d.ambiguous_with.iter().map(|a| (a.effect.as_str(), a.channel))).collect();
    let summary = format!(
        "{name} in {:.1} s: {:?} {group:?} {:?} left {:?} ranking {:?}",
        started.elapsed().as_secs_f64(),
        d.verdict,
        d.causes.iter().map(|c| &c.parameters).collect::<Vec<_>>(),
        d.signature,
        d.ranking.iter().take(4).map(|r| (&r.effect, r.channel, r.evidence as i64)).collect::<Vec<_>>()
    );
    eprintln!("{summary}");
    assert!(d.causes.len() == 1 && group.contains(&(name, channel)), "{summary}");
    let confounded = kind(name).unwrap().confounded();
    assert!(group.iter().all(|(other, _)| *other == name || confounded.contains(other)), "{summary}");
    d
}

/// Two cycles of bench B: one fitted, one held out.
fn bench_b() -> Bench {
    let mut bench = Bench::open("bench-b").unwrap();
    bench.set_cycles(2);
    bench
}

/// Bench B with a shaft that may tilt; its cranks are `aside_m` beside the middle of the bearing,
/// one on either side.
fn tilting(aside_m: f64) -> Bench {
    let mut bench = bench_b();
    if let Some(bench) = bench.transmission_mut() {
        bench.two_plane = Some(TwoPlaneSection {
            slices: 5,
            drive_offset_m: aside_m,
            load_offset_m: -aside_m,
            support_stiffness_nm_rad: 3e6,
            support_damping_nm_s_rad: 500.0,
            ..TwoPlaneSection::default()
        });
    }
    bench
}

/// The linear axis with dry friction that effects may change.
fn linear() -> Bench {
    let text = include_str!("../../../examples/seal-friction.toml");
    let mut bench = Bench::parse("linear", text).unwrap();
    if let Some(rig) = bench.axis_mut() {
        rig.axis.period_s = 2.0137;
        rig.axis.cycles = 6;
        rig.axis.coulomb_effort = 10.0;
        rig.load.ramp_s = 11.0;
    }
    bench
}

macro_rules! hidden {
    ($($(#[$meta:meta])* $test:ident: $bench:expr, $name:literal, $channel:expr, $sizes:expr;)*) => {
        $(#[test]
        $(#[$meta])*
        fn $test() {
            let _ = hide($bench, $name, $channel, &$sizes, 7);
        })*
    };
}

hidden! {
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    clearance_wear: bench_b(), "clearance-wear", None, [("clearance_increase_m", 1e-4)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    contact_stiffness: bench_b(), "contact-stiffness", None, [("relative_change", 0.4)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    restitution: bench_b(), "restitution", None, [("restitution_change", 0.2)];
    journal_out_of_round: bench_b(), "journal-out-of-round", None, [("cosine_m", 8e-6), ("sine_m", -6e-6)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    inertia_mismatch: bench_b(), "inertia-mismatch", None, [("relative_change", 0.4)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    shaft_flexibility: bench_b(), "shaft-flexibility", None, [("compliance_rad_nm", 6e-7)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    lever_ratio: bench_b(), "lever-ratio", None, [("relative_change", 0.03)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    stribeck_friction: bench_b(), "stribeck-friction", None,
        [("coefficient_rise", 0.08), ("speed_m_s", 0.008)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    coulomb_level: bench_b(), "coulomb-level", None, [("relative_change", 0.35)];
    viscous_friction: bench_b(), "viscous-friction", None, [("viscous_n_s_m", 400.0)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    viscous_asymmetry: bench_b(), "viscous-asymmetry", None, [("asymmetry_n_s_m", 400.0)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    coulomb_asymmetry: bench_b(), "coulomb-asymmetry", None, [("asymmetry", 0.1)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    load_dependent_friction: bench_b(), "load-dependent-friction", None, [("load_exponent", 0.2)];
    breakaway: bench_b(), "breakaway", None, [("excess", 0.8), ("rest_time_s", 0.1), ("distance_m", 5e-4)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    presliding_hysteresis: bench_b(), "presliding-hysteresis", None, [("distance_m", 1e-4)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    thermal_friction_drift: bench_b(), "thermal-friction-drift", None,
        [("level_per_k", -0.06), ("resistance_k_w", 0.1), ("time_constant_s", 1.0)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    friction_step: bench_b(), "friction-step", None, [("relative_change", 0.2), ("time_s", 0.67)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    seal_friction: bench_b(), "seal-friction", None, [("seal_force_n", 150.0)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    position_ripple: bench_b(), "position-ripple", None,
        [("cos_torque_nm", 30.0), ("sin_torque_nm", -20.0), ("period_rad", 0.07)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    hydraulic_compliance: bench_b(), "hydraulic-compliance", None, [("compliance_m_n", 2e-8)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    drive_lag: bench_b(), "drive-lag", None, [("lag_s", 1e-3)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    load_ripple: bench_b(), "load-ripple", None,
        [("cos_force_n", 60.0), ("sin_force_n", 80.0), ("frequency_hz", 23.4)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    fork_backlash: bench_b(), "fork-backlash", None, [("backlash_m", 1e-4)];
    squeeze_film: bench_b(), "squeeze-film", None, [("viscosity_pa_s", 1e-3)];
    sensor_offset: bench_b(), "sensor-offset", Some(Channel::BearingForceY), [("offset", 40.0)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    sensor_gain: bench_b(), "sensor-gain", Some(Channel::DriveForce), [("relative_change", 0.02)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    sensor_delay: bench_b(), "sensor-delay", Some(Channel::JournalY), [("delay_s", 4e-4)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    sensor_drift: bench_b(), "sensor-drift", Some(Channel::FrictionTorque), [("drift_per_s", 2.0)];
    #[ignore = "slow, some 15 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
    sensor_saturation: bench_b(), "sensor-saturation", Some(Channel::BearingForceY),
        [("inverse_limit", 1.25e-4)];
    rig_breakaway: rig(), "breakaway", None,
        [("excess_effort", 200.0), ("rest_time_s", 0.1), ("distance_m", 2e-3)];
    rig_presliding: rig(), "presliding-hysteresis", None, [("distance_m", 2e-3)];
    rig_stribeck: rig(), "stribeck-friction", None, [("effort_rise", 80.0), ("speed_m_s", 0.02)];
    rig_viscous_asymmetry: rig(), "viscous-asymmetry", None, [("asymmetry_effort", 30.0)];
    rig_thermal: rig(), "thermal-friction-drift", None, [("level_per_k", -0.005), ("time_constant_s", 8.0)];
    rig_step: rig(), "friction-step", None, [("coulomb_effort", 60.0), ("time_s", 4.3)];
    rig_ripple: rig(), "position-ripple", None,
        [("cos_effort", 15.0), ("sin_effort", 10.0), ("period", 0.11)];
    linear_saturation: linear(), "sensor-saturation", Some(Channel::DriveForce), [("inverse_limit", 1.67e-2)];
    linear_load_dependent_friction: linear(), "load-dependent-friction", None, [("load_coefficient", 0.04)];
    linear_load_ripple: linear(), "load-ripple", None,
        [("cos_force_n", 2.0), ("sin_force_n", 1.0), ("frequency_hz", 3.7)];
    linear_inertia: linear(), "inertia-mismatch", None, [("inertia_change", 20.0)];
    linear_lag: linear(), "drive-lag", None, [("lag_s", 0.02)];
}

/// Returns whether the sign of the cause is reported as undetermined.
fn has_either_sign(d: &Diagnosis) -> bool {
    d.identifiability.iter().any(|i| i.kind == "sign" && i.parameters == ["slope_y_rad", "slope_z_rad"])
}

#[test]
fn the_sign_of_a_misalignment_is_undetermined_if_drive_and_load_act_in_the_middle() {
    let d = hide(tilting(0.0), "misalignment", None, &[("slope_y_rad", 3e-5), ("slope_z_rad", -3e-5)], 7);
    assert!(has_either_sign(&d), "{:?}", d.identifiability);
}

#[test]
#[ignore = "slow, some 40 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
fn the_sign_of_a_misalignment_is_determined_if_the_loads_tilt_the_shaft() {
    let d = hide(tilting(0.02), "misalignment", None, &[("slope_y_rad", 3e-5), ("slope_z_rad", -3e-5)], 7);
    assert!(!has_either_sign(&d), "{:?}", d.identifiability);
}

#[test]
#[ignore = "slow, some 40 s of a core: cargo test -p diagnosis --test catalogue -- --ignored"]
fn a_misalignment_that_lifts_half_of_the_bearing_is_measured() {
    let d = hide(tilting(0.0), "misalignment", None, &[("slope_y_rad", 4e-4), ("slope_z_rad", -3e-4)], 7);
    let found: Vec<f64> = d.causes[0].parameters.iter().map(|p| p.value.abs()).collect();
    assert!((found[0] / 4e-4 - 1.0).abs() < 0.01 && (found[1] / 3e-4 - 1.0).abs() < 0.01, "{found:?}");
}

/// A cylinder seal adds two parts to the friction of an axis, which have separate names.
#[test]
fn seal_friction_on_an_axis_is_a_level_and_a_load_dependent_part() {
    let (mut bench, nominal) = (linear(), linear());
    for (name, parameter, value) in
        [("coulomb-level", "coulomb_effort", 8.0), ("load-dependent-friction", "load_coefficient", 0.04)]
    {
        let parameters = [(parameter.to_owned(), value)].into();
        bench.effects_mut().push(Effect { name: name.into(), channel: None, of: None, parameters });
    }
    let d = diagnose(&nominal, &[record(&bench, 7).unwrap()], &[], &Options::default()).unwrap();
    let mut causes: Vec<_> = d.causes.iter().map(|cause| cause.effect.as_str()).collect();
    causes.sort_unstable();
    assert_eq!(causes, ["coulomb-level", "load-dependent-friction"]);
}
