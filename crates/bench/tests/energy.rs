//! The energy balance of runs closes, and a wrong sign leaves a residual.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]
use bench::BearingMaterial;
use bench::description::{Fork, LoadFriction, TransmissionBench};
use bench::plants::energy::EnergyAudit;
use bench::plants::transmission::Transmission;
use bench::simulate::{DEFAULT_TOLERANCE, Run, run_with_held_force, run_with_law};

/// Share of the drive's work that a run at the default tolerance of 1e-7 may leave unexplained.
const BOUND: f64 = 1e-8;

fn bench_b(material: BearingMaterial) -> TransmissionBench {
    let mut bench = TransmissionBench::open("bench-b").unwrap();
    bench.set_material(material);
    bench
}

fn run(bench: &TransmissionBench) -> Run {
    let plant = Transmission::new(bench, bench.drive_profile(), bench.load_profile());
    run_with_law(&plant, bench.duration_s(), &[], DEFAULT_TOLERANCE).unwrap()
}

fn variants() -> Vec<(&'static str, TransmissionBench)> {
    let nominal = bench_b(BearingMaterial::Babbitt);
    let mut column = nominal.clone();
    column.extension.hydraulic_compliance_m_n = 5e-8;
    let mut play = nominal.clone();
    play.fork = Some(Fork { backlash_m: 0.2e-3, stiffness_n_m: 1e8, damping_s_m: 1.0 });
    let mut cylinder = nominal.clone();
    cylinder.load_friction =
        Some(LoadFriction { coulomb_n: 400.0, viscous_n_s_m: 1000.0, regularisation_m_s: 1e-3 });
    vec![
        ("babbitt", nominal),
        ("plastic", bench_b(BearingMaterial::Plastic)),
        ("hydraulic column", column),
        ("play in the fork", play),
        ("friction of the load cylinder", cylinder),
    ]
}

#[test]
fn the_balance_of_every_variant_closes() {
    for (name, bench) in variants() {
        let run = run(&bench);
        eprintln!("{name}: steps {} {:?}", run.steps, run.energy);
        assert!(run.energy.residual_rel < BOUND, "{name}: {:?}", run.energy);
        assert_eq!(run.energy_residual_rel, run.energy.residual_rel);
        assert!(
            run.energy.friction_heat_j > 1.0 && run.energy.damping_loss_j > 0.0,
            "{name}: {:?}",
            run.energy
        );
    }
}

type Change = fn(EnergyAudit) -> EnergyAudit;

#[test]
fn a_wrong_sign_or_a_missing_term_leaves_a_residual() {
    for (name, bench) in variants() {
        let right = run(&bench).energy;
        let wrongs: [(&str, Change); 6] = [
            ("drive", |a| EnergyAudit { drive_work_j: -a.drive_work_j, ..a }),
            ("load", |a| EnergyAudit { load_work_j: -a.load_work_j, ..a }),
            ("friction", |a| EnergyAudit { friction_heat_j: -a.friction_heat_j, ..a }),
            ("damping", |a| EnergyAudit { damping_loss_j: 0.0, ..a }),
            ("stored", |a| EnergyAudit { stored_change_j: -a.stored_change_j, ..a }),
            ("gravity", |a| EnergyAudit { gravity_work_j: -a.gravity_work_j, ..a }),
        ];
        for (term, wrong) in wrongs {
            let found = wrong(right).with_residuals().residual_rel;
            assert!(found > 10.0 * BOUND, "{name}, {term}: {found}");
        }
    }
}

/// Shows that the balance does not close if equations and audit disagree about the direction of
/// friction.
#[test]
fn friction_of_the_wrong_sign_shows_as_negative_heat() {
    let bench = bench_b(BearingMaterial::Babbitt);
    let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let held = |sign: f64| {
        run_with_held_force(&plant, bench.duration_s(), &[], 1e-5, |view| {
            let mut forces = plant.law(view);
            forces.friction_n *= sign;
            forces
        })
        .unwrap()
        .energy
    };
    let (right, wrong) = (held(1.0), held(-1.0));
    assert!(right.friction_heat_j > 10.0 && wrong.friction_heat_j < -10.0, "{right:?} {wrong:?}");
    assert!(right.residual_rel < 1e-6 && wrong.residual_rel < 1e-6, "{right:?} {wrong:?}");
    // The run with held force has the same energy terms as the run with located events.
    let located = run(&bench).energy;
    assert!((right.friction_heat_j / located.friction_heat_j - 1.0).abs() < 1e-2, "{right:?} {located:?}");
    assert!((right.load_work_j / located.load_work_j - 1.0).abs() < 1e-3, "{right:?} {located:?}");
}

/// A stiff fork without play equals the rigid one. Play frees the shaft only where the fork changes
/// sides.
#[test]
fn play_is_visible_only_where_the_fork_changes_sides() {
    let times: Vec<f64> = (0..10_000).map(|i| 1e-4 * f64::from(i)).collect();
    let run = |fork: Option<Fork>| {
        // The inertia overcomes this load twice per cycle.
        let mut bench = TransmissionBench { fork, ..bench_b(BearingMaterial::Plastic) };
        bench.load.force_n = 1e3;
        let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
        run_with_law(&plant, 1.0, &times, DEFAULT_TOLERANCE).unwrap().samples
    };
    let fork = |backlash_m, stiffness_n_m| Some(Fork { backlash_m, stiffness_n_m, damping_s_m: 1.0 });
    let (rigid, tight, loose) = (run(None), run(fork(0.0, 1e9)), run(fork(0.5e-3, 1e9)));
    let angle = |a: &[bench::plants::transmission::Snapshot], b: &[bench::plants::transmission::Snapshot]| {
        a.iter().zip(b).map(|(a, b)| (a.angle_rad - b.angle_rad).abs()).fold(0.0, f64::max)
    };
    // 3 kN on 1e9 N/m at a lever of 0.3 m with its oscillation, against half a millimetre of play.
    assert!(angle(&rigid, &tight) < 2e-4, "{}", angle(&rigid, &tight));
    assert!((5e-4..3e-3).contains(&angle(&rigid, &loose)), "{}", angle(&rigid, &loose));
    let free = |samples: &[bench::plants::transmission::Snapshot]| {
        samples.iter().filter(|s| s.time_s > 0.05 && s.drive_force_n == 0.0).count()
    };
    assert_eq!(free(&rigid), 0);
    assert!(free(&loose) > 20 + free(&tight), "{} {}", free(&loose), free(&tight));
}

#[test]
fn the_residual_decreases_with_the_tolerance() {
    let bench = bench_b(BearingMaterial::Plastic);
    let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let at = |tolerance| run_with_law(&plant, 1.0, &[], tolerance).unwrap().energy.residual_rel;
    assert!(at(1e-4) > 10.0 * at(1e-7), "{} {}", at(1e-4), at(1e-7));
}
