//! Contacts whose forces are held over a communication step, as networks give them.

use super::{assert_balanced, assert_near, example, parsed, text};
use bench::Bench;
use bench::description::TransmissionBench;
use bench::plants::mechanism::HeldForces;
use bench::plants::transmission::{ContactView, Transmission};
use bench::simulate::run_with_held_force;

/// The law of bench B in place of networks: the dedicated plant holds the same forces with a fixed
/// step, and latches the approach speed at the end of the step in which the journal lands, 0.1 mm/s
/// of 4.4 mm/s later.
#[test]
fn held_forces_move_bench_b_as_they_move_the_dedicated_plant() {
    let dedicated = TransmissionBench::open("bench-b").unwrap();
    let plant = Transmission::new(&dedicated, dedicated.drive_profile(), dedicated.load_profile());
    let times: Vec<f64> = (0..300).map(|i| 1e-3 * f64::from(i)).collect();
    let known = run_with_held_force(&plant, 0.3, &times, 1e-5, |view| plant.law(view)).unwrap();
    let mut bench = example("bench-b-mechanism");
    bench.run.duration_s = 0.3;
    let mut calls = 0;
    let mut force = |contact: usize, view: &ContactView| {
        assert_eq!((contact, view.radial_clearance_m), (0, 0.07 - 0.0695));
        calls += 1;
        plant.law(view)
    };
    let held = HeldForces { step_s: 1e-5, contacts: vec![true], force: &mut force };
    let run = bench.simulate_held(&times, 1e-8, held).unwrap();
    assert_eq!(calls, 30_000);
    assert_eq!(run.samples.len(), known.samples.len());
    for (found, known) in run.samples.iter().zip(&known.samples) {
        let shaft = found.bodies[1].position;
        assert_near("journal Y, m", shaft[0], known.y_m, 1e-6);
        assert_near("journal Z, m", shaft[1], known.z_m, 1e-6);
        assert_near("normal force, N", found.contacts[0].normal_n, known.forces.normal_n, 100.0);
        assert_near("friction, N", found.contacts[0].friction_n.abs(), known.forces.friction_n.abs(), 50.0);
    }
    let peak_n = run.samples.iter().map(|sample| sample.contacts[0].normal_n).fold(0.0, f64::max);
    assert!(peak_n > 4000.0, "{peak_n}");
    assert_near("heat, J", run.energy.friction_heat_j, known.energy.friction_heat_j, 0.02);
    assert_balanced(&run, 1e-6);
}

/// The works of the impacts are read from forces that jump at every step. Their sum is the damping
/// of the balance and the elastic energy at the end, which gravity leaves of the potential change.
#[test]
fn the_losses_of_impacts_with_held_forces_are_those_of_the_balance() {
    let dedicated = TransmissionBench::open("bench-b").unwrap();
    let plant = Transmission::new(&dedicated, dedicated.drive_profile(), dedicated.load_profile());
    let mut bench = example("bench-b-mechanism");
    bench.run.duration_s = 0.1;
    let mut force = |_: usize, view: &ContactView| plant.law(view);
    let held = HeldForces { step_s: 2e-4, contacts: vec![true], force: &mut force };
    let run = bench.simulate_held(&[0.0], 1e-8, held).unwrap();
    let fall_m = run.samples[0].bodies[1].position[1] - run.end.bodies[1].position[1];
    let elastic_j = run.energy.potential_change_j + 150.0 * 9.81 * fall_m;
    let lost_j: f64 = run.impacts.iter().map(|impact| impact.energy_lost_j).sum();
    let work_j: f64 = run.impacts.iter().map(|impact| impact.compression_work_j).sum();
    assert_near("loss, J", lost_j, run.energy.contact_damping_j + elastic_j, 1e-3 * work_j);
}

#[test]
fn networks_are_those_of_clearance_joints_alone() {
    let text = text("../../examples/bench-b-mechanism.toml");
    let with = |text: &str| text.replace("name = \"babbitt\"", "name = \"babbitt\"\nnetwork = \"plastic\"");
    assert_eq!(parsed(&with(&text)).networks(), [Some(contact::BearingMaterial::Plastic)]);
    let unknown = with(&text).replace("\"plastic\"", "\"wood\"");
    let error = Bench::parse("x.toml", &unknown).unwrap_err().to_string();
    assert!(error.contains("contact.0.network is `wood`; expected one of babbitt, plastic"), "{error}");
    let guide = with(&text)
        .replace("kind = \"clearance\"", "kind = \"guide\", height_m = 0.1")
        .replace("bearing_radius_m = 0.07, ", "");
    let error = Bench::parse("x.toml", &guide).unwrap_err().to_string();
    assert!(error.contains("joint.2.contact is `babbitt`; expected a contact without `network`"), "{error}");
}

/// A shaft that falls into its bearing and rebounds, with the law of bench B held over steps.
#[test]
fn the_balance_of_impacts_with_held_forces_closes_to_half_a_millionth_up_to_steps_of_50_us() {
    let mut bench = example("bench-b-mechanism");
    bench.run.duration_s = 1.0;
    bench.run.gravity_m_s2 = [0.0, -9.81];
    bench.load.clear();
    bench.joint.retain(|joint| joint.contact.is_some());
    bench.body.retain(|body| body.name == "shaft");
    bench.body[0].at_m = Some([0.0; 2]);
    bench.joint[0].offset_m = [0.0; 2];
    let dedicated = TransmissionBench::open("bench-b").unwrap();
    let plant = Transmission::new(&dedicated, dedicated.drive_profile(), dedicated.load_profile());
    for (step_s, tolerance) in [(1e-5, 5e-7), (5e-5, 5e-7), (2e-4, 1e-3)] {
        let mut force = |_: usize, view: &ContactView| plant.law(view);
        let held = HeldForces { step_s, contacts: vec![true], force: &mut force };
        let run = bench.simulate_held(&[0.0], 1e-8, held).unwrap();
        assert_eq!(run.impacts.len(), 2, "{step_s}");
        assert_balanced(&run, tolerance);
    }
}
