//! Results of a diagnosis apart from the name of the cause: noise, probabilities, intervals,
//! identifiability, proposed experiments. The plant is a driven axis, which is inexpensive to
//! simulate.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

mod ambiguous;
mod axis_terms;
mod coverage;
mod identifiability;
mod imitation;
mod intervals;
mod late;
mod log_nuisances;
mod noise;
mod pairs;
mod probabilities;

use bench::effects::Effect;
use bench::simulate::record;
use bench::{Bench, Channel, MeasuredLog};
use diagnosis::{Diagnosis, Options, diagnose};

/// An effect with one parameter.
fn effect(name: &str, channel: Option<Channel>, parameter: &str, value: f64) -> Effect {
    Effect { name: name.into(), channel, of: None, parameters: [(parameter.to_owned(), value)].into() }
}

/// A bench with one more effect.
fn with(bench: &Bench, effect: Effect) -> Bench {
    let mut bench = bench.clone();
    effect.check(&bench).unwrap();
    bench.effects_mut().push(effect);
    bench
}

/// A linear axis of 40 kg over some cycles of 2 s at constant load; its force sensor has 1 N of
/// noise.
fn axis(cycles: u32) -> Bench {
    let text = r#"
plant = "friction-rig"
[axis]
kind = "linear"
inertia = 40.0
friction_radius_m = 1.0
load_gain = 1.0
coulomb_effort = 30.0
viscous_effort = 100.0
load_coefficient = 0.0
regularisation_m_s = 3e-3
period_s = 2.0
amplitude = 0.1
[load]
force_n = 500.0
ramp_s = 0.05
[logging]
sample_rate_hz = 200.0
[sensors]
drive_force_n = { noise = 1.0 }
[uncertain]
"axis.inertia" = 1.0
"axis.viscous_effort" = 3.0
"#;
    let mut bench = Bench::parse("axis", text).unwrap();
    bench.set_cycles(cycles);
    bench
}

/// A log of a bench without the ramp of the load, so that the load is constant.
fn logged(bench: &Bench, seed: u64) -> MeasuredLog {
    let mut log = record(bench, seed).unwrap();
    let ramp = log.time_s.partition_point(|&t| t < 0.06);
    log.time_s.drain(..ramp);
    log.channels.values_mut().for_each(|values| drop(values.drain(..ramp)));
    log
}

/// Diagnoses with the effects of `library`; an empty one stands for all.
fn diagnosed(bench: &Bench, logs: &[MeasuredLog], library: &[&str]) -> Diagnosis {
    let others = bench::effects::CATALOGUE.iter().map(|k| k.name).filter(|name| !library.contains(name));
    let exclude: Vec<String> =
        if library.is_empty() { Vec::new() } else { others.map(str::to_owned).collect() };
    diagnose(bench, logs, &[], &Options { exclude: &exclude, ..Options::default() }).unwrap()
}
