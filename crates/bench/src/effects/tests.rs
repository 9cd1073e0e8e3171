//! Tests of every effect on every plant: no change at size 0, visible growth with its size, closed
//! energy balance.

use super::*;
use crate::description::TwoPlaneSection;
use crate::plants::transmission::Transmission;
use crate::signals::Channel;
use crate::simulate::record;
use crate::simulate::{DEFAULT_TOLERANCE, run_with_law};
use proptest::prelude::*;
use std::collections::BTreeMap;

/// Largest readings of the effort, in the order of [`Plant::ALL`].
const LARGEST: [f64; 5] = [11.6e3, 11.6e3, 990.0, 150.0, 30.0];

/// A driven arm with play, and a driven crank on which a link hangs in a bearing with clearance.
const MECHANISM: &str = r#"
plant = "mechanism"
run = { duration_s = 0.5, gravity_m_s2 = [0, -9.81], samples = 500 }
body = [
    { name = "arm", mass_kg = 1, from_m = [1, 0], to_m = [1, -0.2] },
    { name = "crank", mass_kg = 1, from_m = [0, 0], to_m = [0.1, 0] },
    { name = "link", mass_kg = 2, from_m = [0.1, -0.25e-3], to_m = [0.1, -0.2] },
]
joint = [
    { kind = "revolute", first = "ground", second = "arm", at_m = [1, 0], drive_amplitude = 0.3,
        drive_period_s = 0.25, backlash_m = 1e-3, flank_radius_m = 0.05, contact = "flank" },
    { kind = "revolute", first = "ground", second = "crank", at_m = [0, 0], drive_stroke = 0.5,
        drive_period_s = 0.25 },
    { kind = "clearance", first = "crank", second = "link", at_m = [0.1, 0], offset_m = [0, -0.25e-3],
        contact = "dry", bearing_radius_m = 0.01, clearance_m = 0.25e-3 },
]
contact = [
    { name = "flank", dissipation = "flores", restitution = 0.5, coefficient = 1e9 },
    { name = "dry", dissipation = "flores", restitution = 0.5, coulomb_coefficient = 0.1 },
]
measured = [
    { channel = "shaft_angle_rad", of = "arm" },
    { channel = "drive_torque_nm", of = "ground_crank" },
    { channel = "journal_y_m", of = "crank_link" },
    { channel = "journal_z_m", of = "crank_link" },
    { channel = "bearing_force_y_n", of = "crank_link" },
    { channel = "friction_torque_nm", of = "crank_link" },
]
"#;

/// Returns a short bench of every plant, without noise.
fn plant(plant: Plant) -> Bench {
    let linear = include_str!("../../../../examples/seal-friction.toml");
    let mut bench = match plant {
        Plant::Planar | Plant::TwoPlane => Bench::open("bench-b").unwrap(),
        Plant::Rotary => Bench::open("friction-rig").unwrap(),
        Plant::Linear => Bench::parse("linear", linear).unwrap(),
        Plant::Mechanism => Bench::parse("mechanism", MECHANISM).unwrap(),
    };
    bench.sensors_mut().clear();
    match &mut bench {
        Bench::Transmission(b) => {
            b.drive.cycles = 1;
            if plant == Plant::TwoPlane {
                b.two_plane =
                    Some(TwoPlaneSection { slices: 5, support_stiffness_nm_rad: 1e6, ..Default::default() });
            }
        }
        Bench::FrictionRig(r) => {
            // Some friction, which some effects change.
            r.axis.coulomb_effort += 10.0;
            // No sample falls on a reversal.
            r.axis.period_s = 2.0137;
            r.axis.dwell_s = 0.5;
        }
        _ => {}
    }
    bench
}

/// Effect with shapes that suit a short record, and with sizes where the prior is unsuitable.
/// Priors in quantities of a log count in SI units here.
fn effect(kind: &EffectKind, bench: &Bench, share: f64) -> Effect {
    let mut parameters = BTreeMap::new();
    for p in kind.parameters(bench) {
        let value = match (kind.name, p.name) {
            (_, "time_s") => 0.45,
            (_, "time_constant_s") => 0.5,
            (_, "period") => 0.01,
            ("viscous-friction", "viscous_n_s_m") => 1e3 * share,
            ("sensor-saturation", _) => {
                1.0 / (LARGEST[bench.effect_plant().unwrap() as usize] * (1.01 - 0.5 * share))
            }
            ("inertia-mismatch", "inertia_change") => 10.0 * share,
            // The link rings in its bearing.
            (_, "delay_s") if matches!(bench, Bench::Mechanism(_)) => 5e-4 * share,
            (_, "viscous_torque") => 1e-3 * share,
            (_, "torsion_nm_rad") => 0.1 * share,
            ("presliding-hysteresis", _) => 1e-4 * share,
            _ if p.is_size => p.prior * share,
            _ => p.default,
        };
        parameters.insert(p.name.to_owned(), value);
    }
    let channel =
        kind.is_per_channel().then_some(bench.axis().map_or(Channel::BearingForceY, |rig| rig.channels().2));
    let of = kind.parts(bench).and_then(|parts| parts.last().cloned());
    Effect { name: kind.name.into(), channel, of, parameters }
}

fn effort_or(bench: &Bench, kind: &EffectKind) -> Channel {
    if let (Bench::Mechanism(_), "inertia-mismatch" | "viscous-friction" | "spring-effort") =
        (bench, kind.name)
    {
        return Channel::DriveTorque;
    }
    let on_bench = kind.shows_in.unwrap_or(Channel::BearingForceY);
    bench.axis().map_or(on_bench, |rig| rig.channels().2)
}

/// Removes the standstills for pre-sliding: there it keeps its force while the nominal sign goes to
/// 0.
fn suited(kind: &EffectKind, mut bench: Bench) -> Bench {
    if let (Bench::FrictionRig(rig), "presliding-hysteresis") = (&mut bench, kind.name) {
        rig.axis.dwell_s = 0.0;
    }
    bench
}

/// Channel that shows an effect, with the effect at a share of its clear size (0: without the
/// effect).
fn shown(kind: &EffectKind, nominal: &Bench, share: f64) -> Vec<f64> {
    let mut bench = nominal.clone();
    if share != 0.0 {
        bench.effects_mut().push(effect(kind, nominal, share));
    }
    assert_eq!(bench.refusals(), []);
    let mut log = record(&bench, 0).unwrap();
    log.channels.remove(&effort_or(nominal, kind)).unwrap()
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn the_catalogue_is_the_vocabulary() {
    for kind in CATALOGUE {
        assert!(kind.plants().next().is_some() && ![kind.name, kind.summary].contains(&""), "{}", kind.name);
        let simpler = kind.refines.iter().chain(&kind.generalises);
        for other in kind.confounded_with.iter().chain(simpler) {
            assert!(super::kind(other).is_some() && *other != kind.name, "{}: {other}", kind.name);
        }
        for plant in Plant::ALL {
            let actions = kind.actions.iter().filter(|action| action.plants.contains(plant));
            assert!(actions.count() <= 1, "{} has two actions on a {plant:?}", kind.name);
        }
        for p in kind.actions.iter().flat_map(|action| action.parameters) {
            assert!(p.min <= p.default && p.default <= p.max, "{}.{}", kind.name, p.name);
            assert!(p.scale > 0.0 && p.prior > 0.0, "{}.{}", kind.name, p.name);
        }
    }
}

#[test]
fn an_effect_that_is_named_by_another_is_confounded_with_it() {
    for kind in CATALOGUE {
        let names = kind.confounded();
        assert!(names.is_sorted_by(|a, b| a < b), "{}: {names:?}", kind.name);
        for other in CATALOGUE.iter().filter(|other| other.confounded_with.contains(&kind.name)) {
            assert!(names.contains(&other.name), "{}: {names:?}", kind.name);
        }
    }
}

#[test]
fn an_effect_is_refused_on_a_plant_where_it_does_not_act() {
    for &plant_of in Plant::ALL {
        let bench = plant(plant_of);
        for kind in CATALOGUE {
            let found = effect(kind, &bench, 0.5).check(&bench).map(|_| ());
            if kind.action(plant_of).is_some() {
                found.unwrap();
            } else {
                let message = found.unwrap_err().to_string();
                assert!(message.contains("does not act on a") && message.contains("; expected"), "{message}");
                assert!(message.contains(kind.plants().next().unwrap().description()), "{message}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    /// Checks that at size 0 the resolved description is the nominal one to the bit, for all
    /// shapes.
    #[test]
    fn an_effect_of_size_0_is_the_nominal_bench(share in 0.0..1.0_f64) {
        for &plant_of in Plant::ALL {
            let bench = plant(plant_of);
            for kind in CATALOGUE.iter().filter(|k| k.action(plant_of).is_some()) {
                let mut with = bench.clone();
                let mut none = effect(kind, &bench, 0.0);
                for p in kind.parameters(&bench) {
                    let range = p.max.min(100.0) - p.default;
                    let value = if p.is_size { 0.0 } else { p.default + share * range };
                    none.parameters.insert(p.name.into(), value);
                }
                with.effects_mut().push(none);
                assert_eq!(with.refusals(), []);
                prop_assert_eq!(with.resolved(), bench.clone(), "{}", kind.name);
            }
        }
    }
}

/// An effect is visible at a clear size, grows with its size, and vanishes with it.
#[test]
fn every_effect_grows_with_its_size_in_the_channel_that_shows_it() {
    for &plant_of in Plant::ALL {
        let bench = plant(plant_of);
        for kind in CATALOGUE.iter().filter(|k| k.action(plant_of).is_some()) {
            let bench = suited(kind, bench.clone());
            let none = shown(kind, &bench, 0.0);
            let size = none.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let [tiny, small, large] = [1e-3, 0.3, 1.0].map(|share| rms(&shown(kind, &bench, share), &none));
            eprintln!("{plant_of:?}, {}: {tiny:.3e} {small:.3e} {large:.3e} of {size:.3e}", kind.name);
            assert!(large > small && small > tiny, "{plant_of:?}, {}: {tiny} {small} {large}", kind.name);
            assert!(large > 1e-5 * size, "{plant_of:?}, {}: {large} of {size}", kind.name);
            assert!(tiny < 0.1 * large, "{plant_of:?}, {}: {tiny} of {large}", kind.name);
        }
    }
}

#[test]
fn the_energy_balance_of_a_mechanism_closes_with_every_effect() {
    let nominal = plant(Plant::Mechanism);
    for kind in CATALOGUE.iter().filter(|k| k.parts(&nominal).is_some()) {
        let mut bench = nominal.clone();
        bench.effects_mut().push(effect(kind, &nominal, 1.0));
        let Bench::Mechanism(bench) = bench.resolved() else { panic!() };
        let run = bench.simulate(&[], 1e-9).unwrap();
        assert!(run.energy.residual_rel() < 1e-6, "{}: {:?}", kind.name, run.energy.terms());
    }
}

#[test]
fn the_energy_balance_closes_with_every_effect() {
    let nominal = plant(Plant::Planar);
    for kind in CATALOGUE.iter().filter(|k| k.action(Plant::Planar).is_some() && !k.is_per_channel()) {
        let mut bench = nominal.clone();
        bench.effects_mut().push(effect(kind, &nominal, 1.0));
        let Bench::Transmission(bench) = bench.resolved() else { panic!() };
        let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
        let run = run_with_law(&plant, 1.0, &[], DEFAULT_TOLERANCE).unwrap();
        eprintln!("{}: {} steps, {:.1e}", kind.name, run.steps, run.energy_residual_rel);
        assert!(run.energy_residual_rel < 1e-7, "{}: {:?}", kind.name, run.energy);
    }
}

fn refused(text: &str) -> String {
    Bench::parse("x.toml", &format!("{MECHANISM}{text}")).unwrap_err().to_string()
}

#[test]
fn an_effect_on_a_mechanism_acts_on_a_named_part() {
    let wear = "[[effects]]\nname = \"clearance-wear\"\nclearance_increase_m = 1e-4\n";
    let message = refused(wear);
    assert!(message.contains("names no part; expected `of`, one of crank_link"), "{message}");
    let message = refused(&format!("{wear}of = \"ground_crank\"\n"));
    assert!(message.contains("acts on no `ground_crank`; expected `of`, one of crank_link"), "{message}");
    let sensor = "[[effects]]\nname = \"sensor-gain\"\nchannel = \"journal_y_m\"\nof = \"arm\"\n";
    let message = refused(sensor);
    assert!(message.contains("names a part; expected no `of`"), "{message}");
    let message = refused(&sensor.replace("of = \"arm\"\n", "").replace("journal_y_m", "drive_force_n"));
    assert!(message.contains("not measured; expected a channel of `[[measured]]`"), "{message}");
    let by = |size: &str| wear.replace("1e-4", size) + "of = \"crank_link\"\n";
    let two = by("-1.5e-4").repeat(2);
    for impossible in [&by("-3e-4"), &two] {
        let message = refused(impossible);
        assert!(message.contains("leaves a joint no clearance"), "{message}");
    }
}

#[test]
fn an_effect_on_one_joint_leaves_the_laws_of_others() {
    let text = MECHANISM.replace("contact = \"dry\"", "contact = \"flank\"");
    let mut bench = Bench::parse("x.toml", &text).unwrap();
    let entries = |bench: &Bench| match bench {
        Bench::Mechanism(mechanism) => mechanism.contact.clone(),
        _ => panic!("a mechanism"),
    };
    let before = entries(&bench);
    let restitution = effect(kind("restitution").unwrap(), &bench, 1.0);
    bench.effects_mut().push(restitution);
    let after = entries(&bench.resolved());
    assert_eq!(after[..before.len()], before);
    assert!((after[before.len()].restitution - before[0].restitution - 0.1).abs() < 1e-12);
    assert_eq!(after.len(), before.len() + 1);
}
