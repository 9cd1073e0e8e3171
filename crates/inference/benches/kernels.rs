//! Benchmark of the host's engines: one sample through the shipped pair.
//!
//! `cargo bench -p inference`. Compare figures of one run only.
#![allow(clippy::expect_used, reason = "a benchmark that cannot set itself up has nothing to measure")]

use divan::Bencher;
use inference::kernel::{Engine, Native, Portable};
use inference::{BearingMaterial, Model, Pair, Sample, shipped};

fn main() {
    divan::main();
}

#[divan::bench(types = [Native, Portable], args = ["babbitt", "plastic"])]
fn pair_step<E: Engine>(bencher: Bencher<'_, '_>, bearing: &str) {
    let bearing = BearingMaterial::ALL.into_iter().find(|known| known.name() == bearing).expect("bearing");
    let mut pair: Pair<'_, i16, E> = Pair::new(Model::load(shipped(bearing)).expect("shipped image"));
    let sample = Sample { radial_clearance_nm: 500_000, deformation_pm: 30_000_000, ..Sample::default() };
    bencher.bench_local(|| pair.step(divan::black_box(&sample)));
}
