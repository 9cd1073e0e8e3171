//! The engines of the host against each other: the shipped pair, a sample.
//!
//! `cargo bench -p inference`. Compare figures of one run only.
#![allow(clippy::expect_used, reason = "a benchmark that cannot set itself up has nothing to measure")]

use divan::Bencher;
use inference::kernel::{Engine, Native, Portable};
use inference::{Bearing, Model, Pair, Sample, shipped};

fn main() {
    divan::main();
}

#[divan::bench(types = [Native, Portable], args = ["babbitt", "plastic"])]
fn pair_step<E: Engine>(bencher: Bencher<'_, '_>, bearing: &str) {
    let bearing = Bearing::ALL.into_iter().find(|known| known.name() == bearing).expect("bearing");
    let mut pair: Pair<'_, i16, E> = Pair::new(Model::load(shipped(bearing)).expect("shipped image"));
    let sample = Sample { radial_clearance_nm: 500_000, deformation_pm: 30_000_000, ..Sample::default() };
    bencher.bench_local(|| pair.step(divan::black_box(&sample)));
}
