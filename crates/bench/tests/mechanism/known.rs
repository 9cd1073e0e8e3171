//! Mechanisms with the figures of the dedicated plants, of an independent code, and of the other
//! method of solution.

use super::{assert_balanced, assert_near, example, parsed, text};
use bench::description::TransmissionBench;
use bench::plants::transmission::Transmission;
use bench::simulate::run_with_law;

/// Tolerances are those of the dedicated plant against the published figures.
#[test]
fn the_slider_crank_as_a_mechanism_gives_the_published_figures() {
    let run = example("slider-crank-mechanism").simulate(&[], 1e-12).unwrap();
    let first = run.impacts[0];
    assert_near("first contact, s", first.onset_s, 227.286e-6, 5e-10);
    assert_near("approach speed, m/s", first.approach_speed_m_s, 4.385783, 5e-7);
    assert_near("separation, s", first.separation_s.unwrap(), 280.763e-6, 5e-10);
    assert_eq!(run.impacts.len(), 20);
    for (impact, known) in run.impacts.iter().zip([45777.46, 20971.99, 25593.21, 6770.89, 13012.17]) {
        assert_near("peak, N", impact.peak_force_n, known, 1e-6 * known);
    }
    let slider = run.end.bodies[2];
    assert_near("x(.6 rev), m", slider.position[0], 0.0754435223, 2e-9);
    assert_near("v(.6 rev), m/s", slider.rate[0], 9.984871, 2e-5);
    assert_balanced(&run, 1e-8);
}

/// Both plants integrate the same equations in different coordinates; the figures agree to the
/// error of the integrator.
#[test]
fn the_transmission_bench_as_a_mechanism_gives_the_dedicated_plants_run() {
    let dedicated = TransmissionBench::open("bench-b").unwrap();
    let plant = Transmission::new(&dedicated, dedicated.drive_profile(), dedicated.load_profile());
    let times = dedicated.sample_times_s(10_000.0);
    let known = run_with_law(&plant, 1.0, &times, 1e-10).unwrap();
    let run = example("bench-b-mechanism").simulate(&times, 1e-10).unwrap();
    let mut peak_n: f64 = 0.0;
    for (found, known) in run.samples.iter().zip(&known.samples) {
        let shaft = found.bodies[1].position;
        assert_near("journal Y, m", shaft[0], known.y_m, 1e-9);
        assert_near("journal Z, m", shaft[1], known.z_m, 1e-9);
        assert_near("angle, rad", -shaft[2], known.angle_rad, 1e-8);
        assert_near("normal force, N", found.contacts[0].normal_n, known.forces.normal_n, 0.5);
        if found.time_s >= 0.05 {
            peak_n = peak_n.max(found.contacts[0].normal_n);
        }
    }
    assert_eq!(run.samples.len(), known.samples.len());
    assert_near("published peak, N", peak_n, 11755.0, 12.0);
    assert_eq!(run.impacts.len(), known.impacts.len());
    assert_near("heat, J", run.energy.friction_heat_j, known.energy.friction_heat_j, 1e-4);
    assert_near("drive work, J", run.energy.drive_work_j, known.energy.drive_work_j, 1e-3);
    assert_balanced(&run, 1e-7);
}

#[test]
fn a_four_bar_with_two_clearance_joints_takes_at_most_20_lines() {
    let text = text("../../examples/four-bar.toml");
    assert!(text.lines().count() <= 20, "{}", text.lines().count());
    assert_eq!(example("four-bar").contact_names(), ["crank_coupler", "rocker_coupler"]);
}

/// Rows of numbers under a header of the peer's file.
fn peer_rows(header: &str) -> Vec<Vec<f64>> {
    let text = text("benches/peers/exudyn_four_bar.csv");
    let rows = text.lines().skip_while(|line| !line.starts_with(header)).skip(1);
    let numbers = rows.map(|line| line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>());
    numbers.map_while(Result::ok).collect()
}

/// EXUDYN integrates the same four-bar with a constant step of 1 us, which locates an onset to 1 us
/// only and adds its own error. Tolerances: onsets 5 us, approach speeds 2 mm/s, peaks 1 % (0.2 %
/// above 4.5 kN), time in contact 0.1 % of the run, positions 3 um, forces 60 N in the middle of
/// impacts of up to 7.8 kN.
#[test]
fn the_four_bar_with_two_clearance_joints_agrees_with_exudyn() {
    let bench = example("four-bar");
    let (impacts, rows) = (peer_rows("contact"), peer_rows("t_s"));
    assert!(impacts.len() == 14 && rows.len() > 600, "{} {}", impacts.len(), rows.len());
    let times: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    let run = bench.simulate(&times, 1e-10).unwrap();
    assert_eq!(run.impacts.len(), impacts.len());
    let end = |separation_s: f64| if separation_s.is_nan() { bench.run.duration_s } else { separation_s };
    let mut shares = [[0.0; 2]; 2];
    for (found, known) in run.impacts.iter().zip(&impacts) {
        assert_eq!(found.contact as f64, known[0]);
        assert_near("onset, s", found.onset_s, known[1], 5e-6);
        assert_near("approach speed, m/s", found.approach_speed_m_s, known[2], 2e-3);
        let share = if known[3] > 4500.0 { 2e-3 } else { 1e-2 };
        assert_near("peak, N", found.peak_force_n, known[3], share * known[3]);
        let found_end_s = end(found.separation_s.unwrap_or(f64::NAN));
        shares[found.contact][0] += (found_end_s - found.onset_s) / bench.run.duration_s;
        shares[found.contact][1] += (end(known[4]) - known[1]) / bench.run.duration_s;
    }
    for [found, known] in shares {
        assert!(known > 0.95 && known < 0.97, "{known}");
        assert_near("share of time in contact", found, known, 1e-3);
    }
    for (sample, row) in run.samples.iter().zip(&rows) {
        let [coupler, rocker] = [sample.bodies[1].position, sample.bodies[2].position];
        assert_near("force of the first joint, N", sample.contacts[0].normal_n, row[1], 60.0);
        assert_near("force of the second joint, N", sample.contacts[1].normal_n, row[2], 60.0);
        assert_near("coupler x, m", coupler[0], row[3], 3e-6);
        assert_near("coupler y, m", coupler[1], row[4], 3e-6);
        assert_near("coupler angle, rad", coupler[2], row[5], 2e-5);
        assert_near("rocker angle, rad", rocker[2], row[6], 2e-5);
    }
}

/// A driven crank with coupler and rocker, a driven trolley with a pendulum, and a slider on a
/// spring. Every joint with the base is solved in closed form if the base is the ground, and with
/// multipliers if it is a body that is welded to it.
const ON_A_BASE: &str = r#"
plant = "mechanism"
run = { duration_s = 0.4, gravity_m_s2 = [0, -9.81], tolerance = 1e-11, largest_step_s = 1e-3 }
body = [
    { name = "base", mass_kg = 3, inertia_kg_m2 = 2, at_m = [0.1, 0.2] },
    { name = "crank", mass_kg = 0.5, from_m = [0, 0], to_m = [0, 0.1] },
    { name = "coupler", mass_kg = 1.0, from_m = [0, 0.1], to_m = [0.24, 0.2] },
    { name = "rocker", mass_kg = 0.8, from_m = [0.25, 0], to_m = [0.24, 0.2] },
    { name = "trolley", mass_kg = 2, inertia_kg_m2 = 0.1, at_m = [1, 0], angle_rad = 0.3 },
    { name = "pendulum", mass_kg = 0.7, from_m = [1.1, 0.05], to_m = [1.3, -0.2], speed_rad_s = 2 },
    { name = "slider", mass_kg = 0.4, inertia_kg_m2 = 0.1, at_m = [2, 0], velocity_m_s = [0.5, 0.5] },
]
joint = [
    { kind = "weld", first = "ground", second = "base", at_m = [0.3, 0.1] },
    { kind = "revolute", first = "coupler", second = "crank", at_m = [0, 0.1] },
    { kind = "revolute", first = "BASE", second = "crank", at_m = [0, 0], drive_speed = 7,
        drive_amplitude = 0.2, drive_period_s = 0.3 },
    { kind = "revolute", first = "rocker", second = "BASE", at_m = [0.25, 0] },
    { kind = "revolute", first = "rocker", second = "coupler", at_m = [0.24, 0.2] },
    { kind = "prismatic", first = "trolley", second = "BASE", at_m = [1, 0], axis_rad = 0.4,
        drive_stroke = 0.3, drive_period_s = 0.5 },
    { kind = "revolute", first = "trolley", second = "pendulum", at_m = [1.1, 0.05] },
    { kind = "prismatic", first = "BASE", second = "slider", at_m = [2, 0], axis_rad = 1.0 },
]
spring = [{ first = "ground", second = "slider", from_m = [1.8, 0], to_m = [2, 0], stiffness = 30 }]
load = [{ body = "pendulum", at_m = [1.3, -0.2], force_n = [3, 1] }, { body = "crank", torque_nm = 0.3 }]
"#;

/// Independent of each other: coordinates with directions and virtual power, and multipliers.
#[test]
fn joints_solved_in_closed_form_give_motion_and_drive_forces_of_the_multipliers() {
    let times: Vec<f64> = (0..40).map(|i| 0.01 * f64::from(i)).collect();
    let [closed, multipliers] = ["ground", "base"]
        .map(|base| parsed(&ON_A_BASE.replace("BASE", base)).simulate(&times, 1e-11).unwrap());
    assert_eq!(closed.samples.len(), 40);
    let mut largest_drives = [0.0_f64; 2];
    for (found, known) in closed.samples.iter().zip(&multipliers.samples) {
        for (found, known) in found.bodies.iter().zip(&known.bodies) {
            for k in 0..3 {
                assert_near("position", found.position[k], known.position[k], 1e-7);
                assert_near("rate", found.rate[k], known.rate[k], 1e-5);
            }
        }
        for (i, (found, known)) in found.drives.iter().zip(&known.drives).enumerate() {
            assert_near("drive, N or N m", *found, *known, 1e-4);
            largest_drives[i] = largest_drives[i].max(known.abs());
        }
    }
    assert!(largest_drives[0] > 1.0 && largest_drives[1] > 10.0, "{largest_drives:?}");
    assert_near("drive work, J", closed.energy.drive_work_j, multipliers.energy.drive_work_j, 1e-6);
    assert_balanced(&closed, 1e-7);
}
