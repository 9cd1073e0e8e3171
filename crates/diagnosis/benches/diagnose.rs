//! Wall time of a diagnosis: `cargo bench -p diagnosis`.
//!
//! Logs of 25 s at 1 kHz of bench B with all channels and the complete catalogue; the allowed time
//! is 60 s on two cores. Also the friction rig over 25 cycles. Each case runs once, because a
//! diagnosis is long and deterministic. `cargo bench -p diagnosis --bench diagnose --
//! seal_friction` runs one case. On a loaded machine only the CPU time is meaningful. Measured
//! times: `docs/diagnosis.md`.

use bench::effects::Effect;
use bench::simulate::record;
use bench::{Bench, Channel, MeasuredLog};
use diagnosis::{Diagnosis, Options, diagnose};

/// Cycles of a log; a cycle of bench B lasts 1 s.
const CYCLES: u32 = 25;

/// A described bench, and a log of it with a hidden effect.
fn hidden(preset: &str, effect: Option<(&str, Option<Channel>, &str, f64)>) -> (Bench, MeasuredLog) {
    let mut bench = Bench::open(preset).unwrap_or_else(|e| unreachable!("the preset is valid: {e}"));
    bench.set_cycles(CYCLES);
    let nominal = bench.clone();
    bench.effects_mut().extend(effect.map(|(name, channel, parameter, value)| Effect {
        name: name.into(),
        channel,
        of: None,
        parameters: [(parameter.into(), value)].into(),
    }));
    let log = record(&bench, 1).unwrap_or_else(|e| unreachable!("the bench runs: {e}"));
    (nominal, log)
}

fn run((bench, log): &(Bench, MeasuredLog)) -> Option<Diagnosis> {
    diagnose(bench, std::slice::from_ref(log), &[], &Options::default()).ok()
}

#[divan::bench(sample_count = 1, sample_size = 1)]
fn clearance_wear(bencher: divan::Bencher<'_, '_>) {
    let case = hidden("bench-b", Some(("clearance-wear", None, "clearance_increase_m", 1e-4)));
    bencher.bench_local(|| run(&case));
}

#[divan::bench(sample_count = 1, sample_size = 1)]
fn sensor_delay(bencher: divan::Bencher<'_, '_>) {
    let case = hidden("bench-b", Some(("sensor-delay", Some(Channel::JournalY), "delay_s", 4e-4)));
    bencher.bench_local(|| run(&case));
}

#[divan::bench(sample_count = 1, sample_size = 1)]
fn seal_friction(bencher: divan::Bencher<'_, '_>) {
    let case = hidden("bench-b", Some(("seal-friction", None, "seal_force_n", 150.0)));
    bencher.bench_local(|| run(&case));
}

#[divan::bench(sample_count = 1, sample_size = 1)]
fn clean(bencher: divan::Bencher<'_, '_>) {
    let case = hidden("bench-b", None);
    bencher.bench_local(|| run(&case));
}

#[divan::bench(sample_count = 1, sample_size = 1)]
fn friction_rig(bencher: divan::Bencher<'_, '_>) {
    let case = hidden("friction-rig", Some(("viscous-friction", None, "viscous_effort", 400.0)));
    bencher.bench_local(|| run(&case));
}

fn main() {
    divan::main();
}
