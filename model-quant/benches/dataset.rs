//! Rows per second of the collision set, one thread: `cargo bench -p model-quant --bench dataset`.

use divan::Bencher;
use divan::counter::ItemsCount;
use inference::Bearing;
use model_quant::dataset::collision::CollisionSet;
use model_quant::dataset::sink::{Format, Part};
use model_quant::dataset::split::Split;
use model_quant::ranges::RangeKind;

/// Rows of a block.
const ROWS: u64 = 65_536;

fn main() {
    divan::main();
}

#[divan::bench(args = [RangeKind::Paper, RangeKind::Bench])]
fn rows(bencher: Bencher, kind: RangeKind) {
    let set = CollisionSet::new(Bearing::Babbitt, kind, 2);
    bencher.counter(ItemsCount::new(ROWS)).bench(|| set.block(Split::Training, 0..ROWS, false));
}

#[divan::bench(args = [RangeKind::Paper, RangeKind::Bench])]
fn rows_as_csv(bencher: Bencher, kind: RangeKind) {
    let set = CollisionSet::new(Bearing::Babbitt, kind, 2);
    let block = || Part::new(set.block(Split::Training, 0..ROWS, false).0, Format::Csv);
    bencher.counter(ItemsCount::new(ROWS)).bench(block);
}

#[divan::bench]
fn windows(bencher: Bencher) {
    let set = CollisionSet::new(Bearing::Babbitt, RangeKind::Bench, 2);
    bencher.counter(ItemsCount::new(ROWS / 16)).bench(|| set.block(Split::Training, 0..ROWS / 16, true));
}
