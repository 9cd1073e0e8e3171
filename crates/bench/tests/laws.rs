//! Every law of the catalogue that a description may name runs on bench B and keeps the energy
//! balance.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

mod normal_law;

use bench::integrate::IntegrationError;
use bench::plants::transmission::Transmission;
use bench::simulate::{DEFAULT_TOLERANCE, Run, run_with_law};
use bench::{Bench, DescriptionError};
use contact::{CompleteLawKind, Dissipation, FrictionKind, StiffnessKind};
use normal_law::parameters;

const PRESET: &str = include_str!("../presets/bench-b.toml");
const STIFFNESS: &str = "stiffness = \"hybrid-as-printed\"";
const DISSIPATION: &str = "dissipation = \"zhiying-qishao\"";

fn parse(changes: &[(&str, &str)]) -> Result<Bench, DescriptionError> {
    let text = changes.iter().fold(PRESET.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    let bench = Bench::parse("x.toml", &text)?;
    // A parsed description survives a round trip.
    assert_eq!(Bench::parse("again", &bench.to_toml().unwrap()).unwrap(), bench);
    Ok(bench)
}

fn run(changes: &[(&str, &str)]) -> Result<Run, IntegrationError> {
    let Bench::Transmission(bench) = parse(changes).unwrap() else { panic!("bench-b") };
    let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let times: Vec<f64> = (0..300).map(|i| 1e-3 * f64::from(i)).collect();
    run_with_law(&plant, 0.3, &times, DEFAULT_TOLERANCE)
}

fn peak(run: &Run) -> f64 {
    run.impacts.iter().map(|i| i.peak_force_n).fold(0.0, f64::max)
}

#[test]
fn every_stiffness_carries_the_bench_or_reports_its_limit() {
    let mut deep = Vec::new();
    for kind in StiffnessKind::ALL {
        let name = kind.entry().name;
        let more = parameters(kind.parameters(), "5e8");
        let law = format!("stiffness = \"{name}\"\n{more}");
        match run(&[(STIFFNESS, &law)]) {
            Ok(run) => {
                eprintln!(
                    "{name}: {} steps, peak {:.0} N, {:.1e}",
                    run.steps,
                    peak(&run),
                    run.energy.residual_rel
                );
                assert!(run.energy.residual_rel < 1e-6, "{name}: {:?}", run.energy);
                assert!((3e3..1e5).contains(&peak(&run)), "{name}: {}", peak(&run));
            }
            Err(IntegrationError::OutsideLaw { .. }) => deep.push(name),
            Err(e) => panic!("{name}: {e}"),
        }
    }
    assert!(deep.len() < 4, "{deep:?}");
}

#[test]
fn every_dissipation_and_damping_keeps_the_balance() {
    for kind in Dissipation::ALL {
        let name = kind.entry().name;
        let run = run(&[(DISSIPATION, &format!("dissipation = \"{name}\""))]).unwrap();
        assert!(run.energy.residual_rel < 1e-6, "{name}: {:?}", run.energy);
        let lossless = kind.factor(0.4) == 0.0;
        assert_eq!(run.energy.damping_loss_j.abs() < 1e-6, lossless, "{name}: {:?}", run.energy);
    }
    let with =
        |damping: &str| run(&[("[friction]", &format!("damping = \"{damping}\"\n[friction]"))]).unwrap();
    let (latched, bounded, reference) = (with("latched"), with("bounded"), with("reference"));
    assert_eq!(latched.energy, run(&[]).unwrap().energy);
    for run in [&bounded, &reference] {
        assert!(run.energy.residual_rel < 1e-6 && run.energy.damping_loss_j > 0.0, "{:?}", run.energy);
        assert!(peak(run) != peak(&latched));
    }
}

#[test]
fn laws_with_their_own_damping_keep_the_balance() {
    for kind in CompleteLawKind::ALL {
        let (name, more) = (kind.entry().name, parameters(kind.parameters(), "3e8"));
        let run = run(&[("[friction]", &format!("law = \"{name}\"\n{more}\n[friction]"))]).unwrap();
        assert!(run.energy.residual_rel < 1e-6, "{name}: {:?}", run.energy);
        assert!(run.energy.damping_loss_j > 0.0, "{name}: {:?}", run.energy);
    }
    let error = parse(&[("[friction]", "law = \"kelvin-voigt\"\n[friction]")]).unwrap_err().to_string();
    for field in ["contact.coefficient", "contact.damping_n_s_m"] {
        let missing = format!("line 21: {field} is missing; expected a number, which `kelvin-voigt` needs");
        assert!(error.contains(&missing), "{error}");
    }
}

/// The friction of every sample is the dry curve plus `c v`, whatever the normal force is.
#[test]
fn the_viscous_part_of_brown_and_mcphee_is_in_newtons_per_speed() {
    const SLOPE: &str = "viscous_slope_s_m = 0.0";
    let law = "law = \"brown-mcphee\"\ntransition_force_n = 100.0\nviscous_damping_n_s_m = 2500.0";
    let run = run(&[(SLOPE, &format!("{SLOPE}\n{law}"))]).unwrap();
    assert!(run.energy.residual_rel < 1e-6, "{:?}", run.energy);
    let loaded = run.samples.iter().filter(|s| s.forces.normal_n > 1e3);
    assert!(loaded.clone().count() > 200);
    for s in loaded {
        let (v, normal_n) = (s.contact.sliding_speed_m_s, s.forces.normal_n);
        let r = v / 1e-3;
        let dry = 0.14 * (4.0 * r).tanh() + 0.08 * r / (0.25 * r * r + 0.75).powi(2);
        let viscous_n = -s.forces.friction_n - normal_n * dry;
        assert!((viscous_n - 2500.0 * v).abs() < 1e-9 * normal_n, "{viscous_n} N at {v} m/s");
    }
    let refused = |text: &str, expected: &str| {
        let error = parse(&[(SLOPE, text)]).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    };
    refused(
        "viscous_slope_s_m = 0.25\nlaw = \"brown-mcphee\"",
        "friction.viscous_slope_s_m is 0.25; expected 0: `brown-mcphee` uses viscous_damping_n_s_m",
    );
    refused(
        "viscous_slope_s_m = 0.0\nviscous_damping_n_s_m = 2500.0",
        "friction.viscous_damping_n_s_m is 2500; expected 0: only `brown-mcphee` uses it",
    );
    let Bench::Transmission(mut bench) =
        parse(&[(SLOPE, "viscous_slope_s_m = 0.0\nlaw = \"brown-mcphee\"")]).unwrap()
    else {
        panic!("bench-b")
    };
    bench.set_material(contact::BearingMaterial::Plastic);
    assert_eq!(bench.friction.viscous_slope_s_m, 0.0, "the description can still be read");
}

#[test]
fn every_friction_law_keeps_the_balance() {
    let nominal = run(&[]).unwrap().energy.friction_heat_j;
    for kind in FrictionKind::ALL {
        let name = kind.entry().name;
        let law = format!(
            "shape = \"tustin\"\nlaw = \"{name}\"\nbristle_stiffness_per_m = 1e4\n\
             bristle_damping_s_m = 1.0\ntransition_force_n = 100.0"
        );
        let memory = match kind {
            FrictionKind::SevenParameter => "[friction_memory]\nlag_s = 0.01\nrise_s = 0.5\n[logging]",
            _ => "[logging]",
        };
        let changes = [("shape = \"tustin\"", law.as_str()), ("[logging]", memory)];
        let run = run(&changes).unwrap();
        eprintln!(
            "{name}: {} steps, heat {}, {:.1e}, {:?}",
            run.steps,
            run.energy.friction_heat_j,
            run.energy.residual_rel,
            run.impacts.iter().map(|i| (i.sticks, i.stuck_s)).collect::<Vec<_>>()
        );
        assert!(run.energy.residual_rel < 1e-6, "{name}: {:?}", run.energy);
        let ratio = run.energy.friction_heat_j / nominal;
        assert!((0.7..1.5).contains(&ratio), "{name}: {ratio}");
    }
}
