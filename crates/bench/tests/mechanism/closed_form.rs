//! Mechanisms whose motion has a closed form or a balance.

use super::{assert_balanced, assert_near, example, parsed, text};
use bench::plants::mechanism::MechanismRun;
use contact::{Dissipation, produced_restitution};

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
