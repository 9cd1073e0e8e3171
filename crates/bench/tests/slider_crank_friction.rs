//! Friction in the clearance joint of the slider-crank, against an independent integration, and its
//! energy balance.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]
use bench::Bench;
use bench::description::SliderCrankBench;
use bench::integrate::integrate;

const PRESET: &str = include_str!("../presets/slider-crank.toml");

fn friction(coulomb_coefficient: f64, more: &str) -> String {
    format!(
        "{PRESET}\n[friction]\ncoulomb_coefficient = {coulomb_coefficient}\n\
         static_coefficient = {coulomb_coefficient}\nstribeck_speed_m_s = 0.1\nshape = \"tustin\"\n\
         viscous_slope_s_m = 0.0\nviscous_onset_m_s = 0.0\nregularisation_m_s = 0.05\n{more}"
    )
}

fn bench(text: &str) -> SliderCrankBench {
    let Bench::SliderCrank(bench) = Bench::parse("x.toml", text).unwrap() else { panic!("slider-crank") };
    *bench
}

/// Rod and slider as free bodies: Newton and Euler about the rod's middle, the crank's force from
/// the constraint. Friction is linear in the sliding speed up to a width, then constant.
struct FreeBodies {
    coefficient: f64,
    width_m_s: f64,
}

impl FreeBodies {
    /// Rates of (rod angle, slider, their rates), the normal force, and the deformation with its
    /// rate.
    fn rates(&self, t: f64, s: [f64; 4], latched: Option<f64>) -> ([f64; 4], f64, [f64; 2]) {
        let (r, l, mass, inertia, slider) = (0.05, 0.12, 0.21, 2.5e-4, 0.14);
        let (crank, journal, clearance) = (5000.0 * std::f64::consts::PI / 30.0, 9.5e-3, 0.5e-3);
        let [angle, x, speed, v] = s;
        let (e, across) = ([angle.cos(), angle.sin()], [-angle.sin(), angle.cos()]);
        let (c, d) = ([(crank * t).cos(), (crank * t).sin()], [-(crank * t).sin(), (crank * t).cos()]);
        let end: [f64; 2] = std::array::from_fn(|i| r * c[i] + l * e[i]);
        let end_rate: [f64; 2] = std::array::from_fn(|i| r * crank * d[i] + l * speed * across[i]);
        let (gap, gap_rate) = ([end[0] - x, end[1]], [end_rate[0] - v, end_rate[1]]);
        let distance = gap[0].hypot(gap[1]);
        let n = if distance > 0.0 { [gap[0] / distance, gap[1] / distance] } else { [0.0, 0.0] };
        let depth = distance - clearance;
        let rate = n[0] * gap_rate[0] + n[1] * gap_rate[1];
        let mut normal = 0.0;
        if let Some(latched) = latched.filter(|_| depth > 0.0) {
            normal = (6.6101984e10 * depth.powf(1.5) * (1.0 + 0.15 * rate / latched)).max(0.0);
        }
        // Speed of the journal's surface: its centre's and the rod's turning.
        let surface = [gap_rate[0] - speed * journal * n[1], gap_rate[1] + speed * journal * n[0]];
        let sliding = -surface[0] * n[1] + surface[1] * n[0];
        let drag = self.coefficient * normal * (sliding / self.width_m_s).clamp(-1.0, 1.0);
        let force = [-normal * n[0] + drag * n[1], -normal * n[1] - drag * n[0]];
        let torque = -drag * journal;
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        // Euler's equation is linear in the angular acceleration: its root from two values.
        let unbalanced = |angular: f64| {
            let middle: [f64; 2] = std::array::from_fn(|i| {
                -r * crank * crank * c[i] + 0.5 * l * (angular * across[i] - speed * speed * e[i])
            });
            let pin = [mass * middle[0] - force[0], mass * middle[1] - force[1]];
            inertia * angular - 0.5 * l * (cross(e, force) - cross(e, pin)) - torque
        };
        let (at_0, at_1) = (unbalanced(0.0), unbalanced(1.0));
        ([speed, v, -at_0 / (at_1 - at_0), -force[0] / slider], normal, [depth, rate])
    }

    /// Peak forces and the state at `end_s`, by the classical Runge-Kutta method.
    fn run(&self, end_s: f64, step_s: f64) -> (Vec<f64>, [f64; 4]) {
        let crank = 5000.0 * std::f64::consts::PI / 30.0;
        let mut s = [0.0, 0.17, -0.05 * crank / 0.12, 0.0];
        let (mut latched, mut peaks): (Option<f64>, Vec<f64>) = (None, Vec::new());
        for i in 0..(end_s / step_s).round() as usize {
            let t = i as f64 * step_s;
            let (first, normal, [depth, rate]) = self.rates(t, s, latched);
            match latched {
                None if depth > 0.0 => {
                    latched = Some(rate.max(1e-3));
                    peaks.push(0.0);
                }
                Some(_) if depth <= 0.0 => latched = None,
                _ => {}
            }
            if let Some(peak) = peaks.last_mut() {
                *peak = peak.max(normal);
            }
            let along = |k: &[f64; 4], by: f64| std::array::from_fn(|j| s[j] + by * k[j]);
            let second = self.rates(t + 0.5 * step_s, along(&first, 0.5 * step_s), latched).0;
            let third = self.rates(t + 0.5 * step_s, along(&second, 0.5 * step_s), latched).0;
            let fourth = self.rates(t + step_s, along(&third, step_s), latched).0;
            let sum = |j: usize| first[j] + 2.0 * (second[j] + third[j]) + fourth[j];
            s = std::array::from_fn(|j| s[j] + step_s / 6.0 * sum(j));
        }
        (peaks, s)
    }
}

#[test]
fn friction_agrees_with_an_independent_integration_of_free_bodies() {
    for coefficient in [0.0, 0.1, 0.4] {
        let plant = bench(&friction(coefficient, "law = \"regularised-linear\"")).plant();
        let end_s = 6e-4;
        let tolerances = plant.tolerances(1e-10);
        let run =
            integrate(&plant, (0.0, end_s), plant.initial_state(), false, &[], &tolerances, |_, _, _| {})
                .unwrap();
        let (peaks, state) = FreeBodies { coefficient, width_m_s: 0.05 }.run(end_s, 5e-9);
        assert_eq!(run.impacts.len(), peaks.len(), "{coefficient}");
        for (impact, peak) in run.impacts.iter().zip(&peaks) {
            assert!((impact.peak_force_n / peak - 1.0).abs() < 1e-4, "{coefficient}: {impact:?} {peak}");
        }
        for (found, expected) in run.state.iter().zip(state) {
            assert!((found - expected).abs() < 1e-4 * expected.abs().max(1.0), "{found} {expected}");
        }
    }
    // The friction of the comparison matters.
    let at = |coefficient| FreeBodies { coefficient, width_m_s: 0.05 }.run(6e-4, 5e-8).1[2];
    assert!((at(0.4) - at(0.0)).abs() > 1e-3 * at(0.0).abs(), "{} {}", at(0.4), at(0.0));
}

#[test]
fn the_balance_closes_with_and_without_friction() {
    for (coefficient, law) in [(0.0, "regularised-linear"), (0.1, "regularised-linear"), (0.3, "threlfall")] {
        let plant = bench(&friction(coefficient, &format!("law = \"{law}\""))).plant();
        let energy = plant.audit(60.0 / 5000.0 * 0.3, 1e-10).unwrap();
        assert!(energy.residual_rel < 1e-7, "{coefficient}: {energy:?}");
        assert!(energy.damping_loss_j > 0.1 && energy.drive_work_absolute_j > 10.0, "{energy:?}");
        assert_eq!(energy.friction_heat_j > 0.01, coefficient > 0.0, "{energy:?}");
        for wrong in [
            bench::plants::energy::EnergyAudit { friction_heat_j: 1.0 + energy.friction_heat_j, ..energy },
            bench::plants::energy::EnergyAudit { damping_loss_j: 0.9 * energy.damping_loss_j, ..energy },
        ] {
            assert!(wrong.with_residuals().residual_rel > 1e-5, "{wrong:?}");
        }
    }
}

fn simulate(
    plant: &bench::plants::slider_crank::SliderCrank,
    end_s: f64,
) -> bench::integrate::Integration<4> {
    let (initial, tolerances) = (plant.initial_state(), plant.tolerances(1e-10));
    integrate(plant, (0.0, end_s), initial, false, &[], &tolerances, |_, _, _| {}).unwrap()
}

/// Coulomb's friction is the limit of a narrow linear one, also where the joint sticks.
#[test]
fn coulombs_friction_is_the_limit_of_the_regularised_one() {
    let end_s = 6e-4;
    let run = simulate(&bench(&friction(0.4, "law = \"coulomb\"")).plant(), end_s);
    assert_eq!(run.impacts[0].sticks, 1, "{:?}", run.impacts);
    let off = |width_m_s: f64| {
        let (peaks, state) = FreeBodies { coefficient: 0.4, width_m_s }.run(end_s, 5e-9);
        [(run.impacts[0].peak_force_n - peaks[0]).abs(), (run.state[2] - state[2]).abs()]
    };
    let (wide, narrow) = (off(0.05), off(5e-3));
    for ((wide, narrow), bound) in wide.into_iter().zip(narrow).zip([0.5, 0.05]) {
        assert!(narrow < bound && narrow < 0.25 * wide, "{wide} {narrow}");
    }
}

#[test]
fn the_balance_closes_with_a_joint_that_sticks() {
    let end_s = 60.0 / 5000.0 * 0.6;
    for (law, width) in [("coulomb", "0.05"), ("karnopp", "0.05"), ("karnopp", "0.5")] {
        let text = friction(0.3, &format!("law = \"{law}\""))
            .replace("static_coefficient = 0.3", "static_coefficient = 0.6")
            .replace("regularisation_m_s = 0.05", &format!("regularisation_m_s = {width}"));
        let plant = bench(&text).plant();
        let run = simulate(&plant, end_s);
        let (count, stuck_s) = run.impacts.iter().fold((0, 0.0), |(n, t), i| (n + i.sticks, t + i.stuck_s));
        assert!(count >= 3 && stuck_s > 1e-4, "{law}: {count} {stuck_s}");
        let energy = plant.audit(end_s, 1e-10).unwrap();
        assert!(energy.residual_rel < 1e-7 && energy.friction_heat_j > 0.1, "{law}: {energy:?}");
        // The level is a factor on both coefficients.
        let doubled = text
            .replace("static_coefficient = 0.6", "static_coefficient = 1.2")
            .replace("coulomb_coefficient = 0.3", "coulomb_coefficient = 0.6");
        let same = simulate(&bench(&format!("{doubled}\nlevel = 0.5")).plant(), end_s);
        let again: f64 = same.impacts.iter().map(|i| i.stuck_s).sum();
        assert!((again / stuck_s - 1.0).abs() < 1e-6, "{law}: {again} {stuck_s}");
    }
}

#[test]
fn a_law_that_the_joint_cannot_follow_is_refused() {
    for (law, expected) in [
        (
            "law = \"lugre\"\nbristle_stiffness_per_m = 1e4",
            "friction.law is lugre; expected one of coulomb, regularised-linear,",
        ),
        (
            "law = \"seven-parameter\"",
            "friction.law is seven-parameter; expected one of coulomb, regularised-linear,",
        ),
        ("viscous_damping_n_s_m = 1.0", "only `brown-mcphee` uses it"),
    ] {
        let error = Bench::parse("x.toml", &friction(0.1, law)).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}
