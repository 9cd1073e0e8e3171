//! Mechanisms as data: the figures of the dedicated plants, of an independent code, and closed
//! forms.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use bench::Bench;
use bench::description::{MechanismBench, TransmissionBench};
use bench::plants::mechanism::{HeldForces, MechanismRun};
use bench::plants::transmission::{ContactView, Transmission};
use bench::simulate::{run_with_held_force, run_with_law};
use contact::{Dissipation, produced_restitution};

fn text(path: &str) -> String {
    std::fs::read_to_string(format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn example(name: &str) -> MechanismBench {
    parsed(&text(&format!("../../examples/{name}.toml")))
}

fn parsed(text: &str) -> MechanismBench {
    MechanismBench::from_bench(Bench::parse("x.toml", text).unwrap(), "x.toml").unwrap()
}

fn assert_near(what: &str, found: f64, known: f64, tolerance: f64) {
    assert!((found - known).abs() <= tolerance, "{what}: {found} for {known}, {:e}", found - known);
}

fn assert_balanced(run: &MechanismRun, tolerance: f64) {
    assert!(run.energy.residual_rel() < tolerance, "{:?}", run.energy.terms());
}

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

fn hertz_depth_m(mass_kg: f64, speed_m_s: f64, coefficient: f64) -> f64 {
    (5.0 * mass_kg * speed_m_s * speed_m_s / (4.0 * coefficient)).powf(0.4)
}

/// A slider that reaches the wall of its guide without turning touches it with two corners at once:
/// Hertz' impact of half of its mass on each. The restitution is the one that the law produces,
/// whatever mass, stiffness and speed.
#[test]
fn a_slider_in_its_guide_impacts_as_in_closed_form() {
    let guide = |dissipation: &str| {
        parsed(&format!(
            r#"
plant = "mechanism"
run = {{ duration_s = 3.5e-3, closed_start = false }}
body = [{{ name = "slider", mass_kg = 2, inertia_kg_m2 = 0.01, at_m = [0, 0], velocity_m_s = [0.3, 0.5] }}]
joint = [{{ kind = "guide", first = "ground", second = "slider", at_m = [0, 0], contact = "wall",
        clearance_m = 1e-3, length_m = 0.2, height_m = 0.1 }}]
contact = [{{ name = "wall", coefficient = 1e9, restitution = 0.4, dissipation = "{dissipation}" }}]
"#
        ))
    };
    let run = guide("none").simulate(&[], 1e-11).unwrap();
    let depth_m = hertz_depth_m(1.0, 0.5, 1e9);
    // Two corners of the same wall: the order of the contacts is that of the corners.
    assert_eq!(run.impacts.iter().map(|i| i.contact).collect::<Vec<_>>(), [0, 1]);
    for impact in &run.impacts {
        assert_near("onset, s", impact.onset_s, 2e-3, 1e-12);
        assert_near("depth, m", impact.max_deformation_m, depth_m, 1e-9 * depth_m);
        assert_near("force, N", impact.peak_force_n, 1e9 * depth_m.powf(1.5), 1e-5);
        let duration_s = 2.943275184 * depth_m / 0.5;
        assert_near("duration, s", impact.duration_s().unwrap(), duration_s, 1e-8 * duration_s);
        assert_near("restitution", impact.restitution().unwrap(), 1.0, 1e-8);
    }
    assert_near("speed along the guide, m/s", run.end.bodies[0].rate[0], 0.3, 1e-12);
    let run = guide("flores").simulate(&[], 1e-12).unwrap();
    let produced = produced_restitution(Dissipation::Flores.factor(0.4));
    assert_near("restitution", run.impacts[0].restitution().unwrap(), produced, 1e-7);
    let lost_j = 0.5 * 2.0 * 0.25 * (1.0 - produced * produced);
    assert_near("loss, J", run.energy.contact_damping_j, lost_j, 1e-7 * lost_j);
    assert_balanced(&run, 1e-9);
}

/// A slider that turns touches with one corner after the other: against a fixed-step integration of
/// the equations of both corners, written here. Friction acts along the wall at each corner.
#[test]
fn a_turning_slider_follows_an_independent_integration() {
    let bench = parsed(
        r#"
plant = "mechanism"
run = { duration_s = 3e-3, closed_start = false }
body = [{ name = "slider", mass_kg = 2, inertia_kg_m2 = 0.01, at_m = [0, 0], velocity_m_s = [0.3, 0.5],
        speed_rad_s = 2 }]
joint = [{ kind = "guide", first = "ground", second = "slider", at_m = [0, 0], contact = "wall",
        clearance_m = 1e-3, length_m = 0.2, height_m = 0.1 }]
contact = [{ name = "wall", coefficient = 1e9, restitution = 0.4, dissipation = "none",
        coulomb_coefficient = 0.2, regularisation_m_s = 0.01 }]
"#,
    );
    let run = bench.simulate(&[], 1e-11).unwrap();
    assert_eq!(run.impacts.iter().map(|i| i.contact).collect::<Vec<_>>(), [0, 1]);
    let rates = |s: [f64; 6]| -> [f64; 6] {
        let (sin, cos) = s[2].sin_cos();
        let (mut along, mut across, mut torque) = (0.0, 0.0, 0.0);
        for end in [0.1, -0.1] {
            let arm = [end * cos - 0.05 * sin, end * sin + 0.05 * cos];
            let depth = (s[1] + arm[1] - 0.051).max(0.0);
            let normal = 1e9 * depth.powf(1.5);
            // The tangent of a wall above the slider points along -x.
            let sliding = -(s[3] - s[5] * arm[1]);
            let friction = 0.2 * normal * (sliding / 0.01).tanh();
            (along, across) = (along + friction, across - normal);
            torque += -arm[0] * normal - arm[1] * friction;
        }
        [s[3], s[4], s[5], along / 2.0, across / 2.0, torque / 0.01]
    };
    let mut s = [0.0, 0.0, 0.0, 0.3, 0.5, 2.0];
    let h = 3e-3 / 300_000.0;
    for _ in 0..300_000 {
        let at = |k: [f64; 6], by: f64| std::array::from_fn(|i| s[i] + by * k[i]);
        let a = rates(s);
        let b = rates(at(a, 0.5 * h));
        let c = rates(at(b, 0.5 * h));
        let d = rates(at(c, h));
        s = std::array::from_fn(|i| s[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
    }
    let end = run.end.bodies[0];
    for i in 0..3 {
        assert_near("position", end.position[i], s[i], 1e-10);
        assert_near("rate", end.rate[i], s[3 + i], 1e-6);
    }
    assert!(end.rate[1] < 0.0, "the impacts turn it back: {}", end.rate[1]);
    assert_balanced(&run, 1e-8);
}

/// One line poses a drive with backlash. The flank meets the wheel at rest as a mass `J/r^2`; an
/// elastic flank leaves it with twice the drive's speed, and the other flank catches it.
#[test]
fn a_drive_with_backlash_impacts_as_in_closed_form() {
    let bench = parsed(
        r#"
plant = "mechanism"
run = { duration_s = 0.025, closed_start = false }
body = [{ name = "wheel", mass_kg = 1, inertia_kg_m2 = 0.02, at_m = [0, 0] }]
joint = [{ kind = "revolute", first = "ground", second = "wheel", at_m = [0, 0], drive_speed = 2,
        backlash_m = 2e-3, flank_radius_m = 0.1, contact = "flank" }]
contact = [{ name = "flank", coefficient = 1e9, restitution = 1, dissipation = "none" }]
"#,
    );
    let run = bench.simulate(&[], 1e-11).unwrap();
    // The drive leads: the wheel lags to the flank of the negative side.
    let (first, second) = (run.impacts[0], run.impacts[1]);
    assert_eq!((first.contact, second.contact, run.impacts.len()), (1, 0, 2));
    let mass_kg = 0.02 / 0.01;
    assert_near("onset, s", first.onset_s, 1e-3 / 0.2, 1e-12);
    assert_near("approach speed, m/s", first.approach_speed_m_s, 0.2, 1e-12);
    let depth_m = hertz_depth_m(mass_kg, 0.2, 1e9);
    assert_near("depth, m", first.max_deformation_m, depth_m, 1e-9 * depth_m);
    let duration_s = 2.943275184 * depth_m / 0.2;
    assert_near("crossing of the play, s", second.onset_s, 5e-3 + duration_s + 0.01, 1e-10);
    assert_near("speed, rad/s", run.end.bodies[0].rate[2], 0.0, 1e-7);
    // The wheel gets the kinetic energy of twice the speed, and gives it back.
    assert_near("drive work, J", run.energy.drive_work_j, 0.0, 1e-9);
    assert_balanced(&run, 1e-9);
}

#[test]
fn springs_dampers_and_loads_move_as_in_closed_form() {
    let bench = parsed(
        r#"
plant = "mechanism"
run = { duration_s = 0.7 }
body = [
    { name = "mass", mass_kg = 2, inertia_kg_m2 = 1, at_m = [1, 0] },
    { name = "wheel", mass_kg = 1, inertia_kg_m2 = 0.5, at_m = [5, 0], speed_rad_s = 3 },
]
joint = [
    { kind = "prismatic", first = "ground", second = "mass", at_m = [1, 0] },
    { kind = "revolute", first = "ground", second = "wheel", at_m = [5, 0] },
]
spring = [
    { first = "ground", second = "mass", from_m = [0, 0], to_m = [1, 0], stiffness = 200, damping = 4,
        free_length_m = 0.9 },
    { first = "ground", second = "wheel", stiffness = 50, damping = 1 },
]
load = [{ body = "mass", force_n = [30, 7] }]
"#,
    );
    let run = bench.simulate(&[], 1e-11).unwrap();
    // Damped oscillator: decay rate, frequency, deflection from rest position, its rate.
    let damped = |m: f64, c: f64, k: f64, x: f64, v: f64| {
        let (a, t) = (0.5 * c / m, 0.7);
        let w = (k / m - a * a).sqrt();
        (-a * t).exp() * (x * (w * t).cos() + (v + a * x) / w * (w * t).sin())
    };
    // At rest the spring balances the load: 30 N / 200 N/m beyond the free length.
    let rest_m = 0.9 + 0.15;
    let mass = run.end.bodies[0].position;
    assert_near("mass, m", mass[0], rest_m + damped(2.0, 4.0, 200.0, 1.0 - rest_m, 0.0), 1e-9);
    assert_near("guided, m", mass[1], 0.0, 1e-12);
    assert_near("wheel, rad", run.end.bodies[1].position[2], damped(0.5, 1.0, 50.0, 0.0, 3.0), 1e-9);
    assert!(run.energy.damper_heat_j > 0.1 && run.energy.load_work_j > 0.1);
    assert_balanced(&run, 1e-8);
}

/// With friction that has bristles, and with every kind of loss at once, the balance still closes.
#[test]
fn the_energy_balance_closes_with_bristles_and_fails_with_a_missing_term() {
    let mut bench = example("four-bar");
    bench.run.duration_s = 0.03;
    let lugre = text("../../examples/four-bar.toml").replace(
        "coulomb_coefficient = 0.1",
        "friction = \"lugre\", bristle_stiffness_per_m = 1e4, bristle_damping_s_m = 1, \
         coulomb_coefficient = 0.1",
    );
    let mut with_bristles = parsed(&lugre);
    with_bristles.run.duration_s = 0.03;
    for bench in [bench, with_bristles] {
        let run = bench.simulate(&[], 1e-9).unwrap();
        assert_balanced(&run, 1e-6);
        assert!(run.energy.friction_heat_j > 0.05, "{:?}", run.energy.terms());
        let mut wrong = run.energy;
        wrong.friction_heat_j *= 0.5;
        assert!(wrong.residual_rel() > 1e-4, "{}", wrong.residual_rel());
    }
}

#[test]
fn a_flawed_mechanism_is_refused_with_every_flaw_and_its_line() {
    let error = Bench::parse(
        "x.toml",
        r#"plant = "mechanism"
run = { duration_s = 1.0, gravity_m_s2 = 9.81 }
body = [
    { name = "crank", mass_kg = 1, from_m = [0, 0], to_m = [0, 0] },
    { name = "crank", mass_kg = 1, at_m = [0, 0] },
]
[[joint]]
kind = "clearance"
first = "ground"
second = "rod"
at_m = [0, 0]
axis_rad = 1.0
clearance_m = 1e-3
contact = "dry"
[[joint]]
kind = "hinge"
first = "ground"
second = "crank"
at_m = [0, 1, 2]
[[spring]]
first = "ground"
second = "ground"
from_m = [0, 0]
"#,
    )
    .unwrap_err()
    .to_string();
    for expected in [
        "line 2: run.gravity_m_s2 is 9.81; expected two numbers, [x, y], -1000000 to 1000000 m/s2",
        "line 4: body.0.to_m is equal to from_m; expected the other end of the bar",
        "line 5: body.1.name is `crank`; expected a name that neither another body nor the ground has",
        "line 5: body.1.inertia_kg_m2 is missing; expected a number, which a body with `at_m` needs",
        "line 10: joint.0.second is `rod`; expected one of ground, crank, crank",
        "line 12: joint.0.axis_rad is 1; expected none: `clearance` does not use it",
        "line 7: joint.0.bearing_radius_m is missing; expected a number, which `clearance` needs",
        "line 14: joint.0.contact is `dry`; expected the name of a `[[contact]]`",
        "line 16: joint.1.kind is `hinge`; expected one of revolute, prismatic,",
        "line 19: joint.1.at_m is an array; expected two numbers",
        "line 22: spring.0.second is `ground`; expected another body than `first`",
        "spring.0.to_m is missing; expected both points",
    ] {
        assert!(error.contains(expected), "{expected}\n{error}");
    }
}

#[test]
fn what_a_mechanism_cannot_satisfy_or_does_not_use_is_refused() {
    let four_bar = text("../../examples/four-bar.toml");
    let refused = |from: &str, to: &str| {
        assert!(four_bar.contains(from), "{from}");
        Bench::parse("x.toml", &four_bar.replacen(from, to, 1)).unwrap_err().to_string()
    };
    // A bar has the direction of its ends; a journal begins within its clearance.
    let error = refused("name = \"coupler\",", "name = \"coupler\", angle_rad = 0.3,");
    assert!(error.contains("body.1.angle_rad is 0.3; expected no angle"), "{error}");
    let error = refused("kind = \"clearance\",", "kind = \"clearance\", offset_m = [0.01, 0],");
    assert!(error.contains("offset_m is a distance of 0.01 m; expected a distance of at most"), "{error}");
    // Two drives of one pin, the one faster than the other.
    let line = four_bar.lines().find(|line| line.contains("drive_speed")).unwrap();
    let (before, after) = line.split_once("drive_speed = ").unwrap();
    let twice = format!("{line}\n{before}drive_speed = 1{after}");
    let error = refused(line, &twice);
    assert!(error.contains("joint is joints and drives that contradict each other"), "{error}");
}

/// Free bodies of .1 and 1 kg that meet at .2 m/s.
fn free_pair(first: &str, second: &str) -> MechanismRun {
    parsed(&format!(
        r#"plant = "mechanism"
run = {{ duration_s = 0.02, closed_start = false }}
body = [
    {{ name = "light", mass_kg = 0.1, inertia_kg_m2 = 1, at_m = [0, 0] }},
    {{ name = "heavy", mass_kg = 1.0, inertia_kg_m2 = 1, at_m = [0, 0], velocity_m_s = [0.2, 0] }},
]
joint = [
    {{ kind = "clearance", first = "{first}", second = "{second}", at_m = [0, 0], contact = "k",
        bearing_radius_m = 0.01, clearance_m = 5e-4 }},
]
contact = [
    {{ name = "k", law = "anagnostopoulos", coefficient = 1e7, restitution = 0.5, dissipation = "none" }},
]
"#
    ))
    .simulate(&[], 1e-10)
    .unwrap()
}

/// The damped oscillation with the effective mass ends where its force would become tensile
/// (Schwager and Poeschel, Granular Matter 9, 2007), with the damping ratio of Anagnostopoulos for
/// a restitution of .5.
#[test]
fn a_law_with_the_effective_mass_rebounds_as_in_closed_form_whichever_body_is_named_first() {
    let ratio = 2.0_f64.ln() / std::f64::consts::PI.hypot(2.0_f64.ln());
    let damped = (1.0 - ratio * ratio).sqrt();
    let phase = std::f64::consts::PI - (2.0 * ratio * damped).atan2(damped * damped - ratio * ratio);
    let closed = (-ratio / damped * phase).exp();
    let peaks = [("light", "heavy"), ("heavy", "light")].map(|(first, second)| {
        let impact = free_pair(first, second).impacts[0];
        let restitution = impact.separation_speed_m_s / impact.approach_speed_m_s;
        assert_near("restitution", restitution, closed, 1e-6);
        impact.peak_force_n
    });
    assert_near("peak, N", peaks[0], peaks[1], 1e-6 * peaks[1]);
}

#[test]
fn a_mechanism_has_no_log_and_no_effects() {
    let bench = Bench::open("four-bar").unwrap();
    let error = bench::simulate::record(&bench, 1).unwrap_err().to_string();
    assert!(error.starts_with("found plant `mechanism`, which has no log"), "{error}");
    let text = format!(
        "{}\n[[effects]]\nname = \"viscous-friction\"\nviscous_n_s_m = 1.0\n",
        text("../../examples/four-bar.toml")
    );
    let error = Bench::parse("x.toml", &text).unwrap_err().to_string();
    assert!(error.contains("which has no log"), "{error}");
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

/// A slider on a turning arm flies out as `r cosh(wt)`.
#[test]
fn a_slider_on_a_turning_arm_moves_as_in_closed_form() {
    let bench = parsed(
        r#"
plant = "mechanism"
run = { duration_s = 0.5 }
body = [
    { name = "arm", mass_kg = 1, inertia_kg_m2 = 1, at_m = [0, 0] },
    { name = "slider", mass_kg = 2, inertia_kg_m2 = 0.1, at_m = [0.3, 0] },
]
joint = [
    { kind = "revolute", first = "ground", second = "arm", at_m = [0, 0], drive_speed = 4 },
    { kind = "prismatic", first = "arm", second = "slider", at_m = [0.3, 0] },
]
"#,
    );
    let run = bench.simulate(&[], 1e-11).unwrap();
    let [x, y, angle] = run.end.bodies[1].position;
    let radius_m = 0.3 * 2.0_f64.cosh();
    assert_near("x, m", x, radius_m * 2.0_f64.cos(), 1e-8);
    assert_near("y, m", y, radius_m * 2.0_f64.sin(), 1e-8);
    assert_near("angle, rad", angle, 2.0, 1e-8);
    assert_balanced(&run, 1e-8);
}

/// Two free bodies that meet in a guide on one of them keep their momentum and their moment of
/// momentum.
#[test]
fn a_guide_on_a_moving_body_conserves_the_momentum() {
    let bench = parsed(
        r#"
plant = "mechanism"
run = { duration_s = 4e-3, closed_start = false }
body = [
    { name = "frame", mass_kg = 3, inertia_kg_m2 = 0.05, at_m = [0.1, -0.2], speed_rad_s = 3 },
    { name = "slider", mass_kg = 2, inertia_kg_m2 = 0.01, at_m = [0, 0], velocity_m_s = [0.3, 1.5] },
]
joint = [{ kind = "guide", first = "frame", second = "slider", at_m = [0, 0], contact = "wall",
        clearance_m = 1e-3, length_m = 0.2, height_m = 0.1 }]
contact = [{ name = "wall", coefficient = 1e9, restitution = 0.6, dissipation = "flores",
        coulomb_coefficient = 0.2, regularisation_m_s = 0.01 }]
"#,
    );
    let run = bench.simulate(&[0.0], 1e-11).unwrap();
    assert!(run.impacts.len() >= 2, "{:?}", run.impacts);
    let momenta = |bodies: &[bench::plants::mechanism::BodyState]| {
        let of_body = |(body, (mass, inertia)): (&bench::plants::mechanism::BodyState, (f64, f64))| {
            let ([x, y, _], [vx, vy, w]) = (body.position, body.rate);
            [mass * vx, mass * vy, inertia * w + mass * (x * vy - y * vx)]
        };
        let each: Vec<[f64; 3]> = bodies.iter().zip([(3.0, 0.05), (2.0, 0.01)]).map(of_body).collect();
        [0, 1, 2].map(|k| each[0][k] + each[1][k])
    };
    let (start, end) = (momenta(&run.samples[0].bodies), momenta(&run.end.bodies));
    for (found, known) in end.iter().zip(start) {
        assert_near("momentum, N s and N m s", *found, known, 1e-9);
    }
    assert_balanced(&run, 1e-8);
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

/// Bench B as a mechanism with the channels of a dedicated log. The angle has the other sign, and
/// with it the friction torque.
fn measured_bench_b() -> String {
    let names =
        ["journal_y_m", "journal_z_m", "bearing_force_y_n", "bearing_force_z_n", "friction_torque_nm"];
    let of_joint = names.map(|name| format!("[[measured]]\nchannel = \"{name}\"\nof = \"ground_shaft\"\n"));
    text("../../examples/bench-b-mechanism.toml")
        .replace("duration_s = 1.0", "duration_s = 0.4, samples = 400")
        + &of_joint.concat()
        + "[[measured]]\nchannel = \"shaft_angle_rad\"\nof = \"shaft\"\n\
           [[measured]]\nchannel = \"shaft_speed_rad_s\"\nof = \"shaft\"\n\
           [[measured]]\nchannel = \"position_m\"\nof = \"ground_fork\"\n\
           [[measured]]\nchannel = \"velocity_m_s\"\nof = \"ground_fork\"\n\
           [[measured]]\nchannel = \"drive_force_n\"\nof = \"ground_fork\"\n"
}

#[test]
fn a_recorded_mechanism_reads_what_the_dedicated_plant_reads() {
    let mut dedicated = Bench::open("bench-b").unwrap();
    dedicated.sensors_mut().clear();
    dedicated.transmission_mut().unwrap().logging.sample_rate_hz = 1000.0;
    let known = bench::simulate::record(&dedicated, 1).unwrap();
    let found = bench::simulate::record(&Bench::parse("x.toml", &measured_bench_b()).unwrap(), 1).unwrap();
    assert_eq!((found.time_s.len(), found.channels.len()), (400, 10));
    let cases = [
        ("journal_y_m", "journal_y_m", 1.0, 1e-8),
        ("journal_z_m", "journal_z_m", 1.0, 1e-8),
        ("bearing_force_y_n", "bearing_force_y_n", 1.0, 1.0),
        ("bearing_force_z_n", "bearing_force_z_n", 1.0, 1.0),
        ("friction_torque_nm", "friction_torque_nm", -1.0, 0.05),
        ("shaft_angle_rad", "shaft_angle_rad", -1.0, 1e-7),
        ("shaft_speed_rad_s", "shaft_speed_rad_s", -1.0, 1e-5),
        ("position_m", "drive_displacement_m", 1.0, 1e-12),
        ("velocity_m_s", "drive_velocity_m_s", 1.0, 1e-12),
    ];
    for (name, of_plant, sign, tolerance) in cases {
        let channel = |name: &str| bench::signals::Channel::from_name(name).unwrap();
        let (own, other) = (&found.channels[&channel(name)], &known.channels[&channel(of_plant)]);
        let largest = other.iter().take(400).fold(0.0_f64, |most, value| most.max(value.abs()));
        assert!(largest > 100.0 * tolerance, "{name} {largest}");
        for (time_s, (own, other)) in found.time_s.iter().zip(own.iter().zip(other)) {
            assert_near(&format!("{name} at {time_s}"), sign * own, *other, tolerance);
        }
    }
}

#[test]
fn the_sensors_of_a_mechanism_add_noise_from_the_seed_and_are_simulated_without_it() {
    let text = measured_bench_b() + "[sensors.journal_y_m]\nnoise = 1e-6\noffset = 2e-6\n";
    let bench = Bench::parse("x.toml", &text).unwrap();
    let [first, again, other] = [1, 1, 2].map(|seed| bench::simulate::record(&bench, seed).unwrap());
    assert_eq!(first, again);
    let journal = |log: &bench::log::MeasuredLog| log.channels[&bench::signals::Channel::JournalY].clone();
    assert_ne!(journal(&first), journal(&other));
    assert_eq!(
        first.channels[&bench::signals::Channel::JournalZ],
        other.channels[&bench::signals::Channel::JournalZ]
    );
    let inputs = bench::simulate::Inputs::new(&bench, &first).unwrap();
    let simulated = bench::simulate::respond(&bench, &inputs).unwrap();
    // The drive's motion is an input, and the mechanism follows its description.
    assert_eq!(simulated.len(), 8);
    let read = &simulated[&bench::signals::Channel::JournalY];
    let errors: Vec<f64> = journal(&first).iter().zip(read).map(|(a, b)| a - b).collect();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    assert!((0.85e-6..1.15e-6).contains(&rms), "{rms}");
    let mut early = first;
    early.time_s[0] = -1e-3;
    let error = bench::simulate::Inputs::new(&bench, &early).unwrap_err().to_string();
    assert!(error.contains("t_s from -0.001; expected t_s from 0"), "{error}");
}

#[test]
fn wrong_channels_of_a_mechanism_are_refused() {
    let refused = |from: &str, to: &str| {
        let text = measured_bench_b();
        assert!(text.contains(from), "{from}");
        Bench::parse("x.toml", &text.replacen(from, to, 1)).unwrap_err().to_string()
    };
    let error = refused("of = \"shaft\"", "of = \"rudder\"");
    assert!(error.contains("measured.5.of is `rudder`; expected one of fork, shaft"), "{error}");
    let error = refused("\"ground_shaft\"", "\"fork\"");
    assert!(error.contains("measured.0.of is `fork`; expected one of ground_shaft"), "{error}");
    let error = refused("\"journal_y_m\"", "\"journal_z_m\"");
    assert!(
        error.contains("measured.1.channel is `journal_z_m`; expected a channel that no other"),
        "{error}"
    );
    let error = refused("\"journal_y_m\"", "\"load_force_n\"");
    assert!(error.contains("measured.0.channel is `load_force_n`; expected a channel of which"), "{error}");
    let error = refused("\"position_m\"", "\"drive_torque_nm\"");
    assert!(
        error.contains("measured.7.channel is `drive_torque_nm`; expected a channel of which"),
        "{error}"
    );
    let text = measured_bench_b() + "[sensors.bearing_temperature_c]\nnoise = 1.0\n";
    let error = Bench::parse("x.toml", &text).unwrap_err().to_string();
    assert!(error.contains("expected a channel of `[[measured]]`"), "{error}");
}
