//! Mechanisms as data: the same figures as the dedicated plants and as independent solutions.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use bench::description::MechanismBench;

fn example(name: &str) -> MechanismBench {
    MechanismBench::open(&format!("{}/../../examples/{name}.toml", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// Tolerances are those of the dedicated plant against the published figures.
#[test]
fn the_slider_crank_as_a_mechanism_gives_the_published_figures() {
    let bench = example("slider-crank-mechanism");
    let run = bench.simulate(&[], 1e-12).unwrap();
    let first = run.impacts[0];
    let near = |what: &str, found: f64, known: f64, tolerance: f64| {
        eprintln!("{what}: {found} {known} {:e}", found - known);
        assert!((found - known).abs() <= tolerance, "{what}: {found} for {known}");
    };
    near("first contact, s", first.onset_s, 227.286e-6, 5e-10);
    near("approach speed, m/s", first.approach_speed_m_s, 4.385783, 5e-7);
    near("separation, s", first.separation_s.unwrap(), 280.763e-6, 5e-10);
    assert_eq!(run.impacts.len(), 20);
    for (impact, known) in run.impacts.iter().zip([45777.46, 20971.99, 25593.21, 6770.89, 13012.17]) {
        near("peak, N", impact.peak_force_n, known, 1e-6 * known);
    }
    let slider = run.end.bodies[2];
    near("x(.6 rev), m", slider.position[0], 0.0754435223, 2e-9);
    near("v(.6 rev), m/s", slider.rate[0], 9.984871, 2e-5);
    eprintln!("{:?} {}", run.energy.terms(), run.steps);
    assert!(run.energy.residual_rel() < 1e-6, "{:?}", run.energy.terms());
}

#[test]
fn experiment() {
    for (tol, a) in
        [(1e-12, 100.0), (1e-13, 100.0), (1e-12, 0.0), (1e-12, 2000.0), (1e-13, 2000.0), (1e-11, 2000.0)]
    {
        let mut bench = example("slider-crank-mechanism");
        bench.run.stabilisation_per_s = a;
        let t = std::time::Instant::now();
        let run = bench.simulate(&[], tol).unwrap();
        let peaks: Vec<f64> = run.impacts.iter().take(5).map(|i| i.peak_force_n).collect();
        eprintln!(
            "{tol:e} {a} {peaks:?} x {} v {} n {} steps {} res {:e} {:?}",
            run.end.bodies[2].position[0],
            run.end.bodies[2].rate[0],
            run.impacts.len(),
            run.steps,
            run.energy.residual_rel(),
            t.elapsed()
        );
        eprintln!("{:?} {:?}", run.impacts[0].onset_s, run.impacts[0].separation_s);
    }
    for tol in [1e-7, 1e-8, 1e-9, 1e-10, 1e-11] {
        let bench = example("four-bar");
        let t = std::time::Instant::now();
        let run = bench.simulate(&[], tol).unwrap();
        let peaks = |c: usize| {
            run.impacts.iter().filter(|i| i.contact == c).map(|i| i.peak_force_n).fold(0.0, f64::max)
        };
        eprintln!(
            "{tol:e} {} {} n {} steps {} res {:e} {:?} rocker {}",
            peaks(0),
            peaks(1),
            run.impacts.len(),
            run.steps,
            run.energy.residual_rel(),
            t.elapsed(),
            run.end.bodies[2].position[2]
        );
        eprintln!("{:?}", run.energy.terms());
    }
}
