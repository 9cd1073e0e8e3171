//! Rows per second of the collision set, one thread: `cargo bench -p model-quant --bench dataset`.

use divan::Bencher;
use divan::counter::ItemsCount;
use inference::BearingMaterial;
use model_quant::data::collision::CollisionSet;
use model_quant::data::ranges::RangeKind;
use model_quant::data::sink::{Format, FormattedRows};
use model_quant::data::split::Split;

/// Rows of a block.
const ROWS: u64 = 65_536;

fn main() {
    divan::main();
}

#[divan::bench(args = [RangeKind::Paper, RangeKind::Bench])]
fn rows(bencher: Bencher, kind: RangeKind) {
    let set = CollisionSet::new(BearingMaterial::Babbitt, kind, 2);
    bencher.counter(ItemsCount::new(ROWS)).bench(|| set.block(Split::Training, 0..ROWS, false));
}

#[divan::bench(args = [RangeKind::Paper, RangeKind::Bench])]
fn rows_as_csv(bencher: Bencher, kind: RangeKind) {
    let set = CollisionSet::new(BearingMaterial::Babbitt, kind, 2);
    let block = || FormattedRows::new(set.block(Split::Training, 0..ROWS, false).0, Format::Csv);
    bencher.counter(ItemsCount::new(ROWS)).bench(block);
}

#[divan::bench]
fn windows(bencher: Bencher) {
    let set = CollisionSet::new(BearingMaterial::Babbitt, RangeKind::Bench, 2);
    bencher.counter(ItemsCount::new(ROWS / 16)).bench(|| set.block(Split::Training, 0..ROWS / 16, true));
}
