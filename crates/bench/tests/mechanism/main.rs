//! Mechanisms as data.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

mod closed_form;
mod held;
mod known;
mod log;
mod refusals;

use bench::Bench;
use bench::description::MechanismBench;
use bench::plants::mechanism::MechanismRun;

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
