//! Training steps of 1024 windows: the reference network, one with odd channels, and the shipped
//! shape.
//!
//! `cargo bench -p model-quant --bench training`; `benches/peers/` compares with other frameworks
//! in one interleaved run.

use divan::Bencher;
use divan::counter::ItemsCount;
use model_quant::data::draw::{Draw, Purpose};
use model_quant::network::recipe::InstructionSet;
use model_quant::network::{ConvolutionShape, Network, NetworkKind, Padding, Shape};
use model_quant::train::{Loss, Trainer, Windows};

const BATCH: usize = 1024;

fn main() {
    divan::main();
}

fn reference(channels: [usize; 3]) -> Shape {
    let convolutions = [5, 5, 3].into_iter().zip(channels);
    Shape {
        columns: 32,
        inputs: 6,
        padding: Padding::Same,
        convolutions: convolutions.map(|(kernel, outputs)| ConvolutionShape { kernel, outputs }).collect(),
        outputs: 1,
    }
}

fn run(bencher: Bencher<'_, '_>, shape: Shape, set: InstructionSet) {
    let mut draw = Draw::new(1, Purpose::Weights, 0);
    let window = shape.columns * shape.inputs;
    let columns: Vec<f32> = (0..BATCH * window).map(|_| draw.normal() as f32).collect();
    let targets: Vec<f32> = (0..BATCH).map(|_| draw.normal() as f32).collect();
    let mut trainer = Trainer::new(&Network::start(shape, &mut draw), set, Loss::Difference);
    bencher.counter(ItemsCount::new(BATCH)).bench_local(|| {
        trainer.step(BATCH, 1.0, 1e-3, |_, rows| Windows {
            columns: columns[rows.start * window..rows.end * window].to_vec(),
            targets: targets[rows].to_vec(),
        })
    });
}

#[divan::bench(args = [InstructionSet::Avx2Fma, InstructionSet::Portable])]
fn reference_network(bencher: Bencher<'_, '_>, set: InstructionSet) {
    run(bencher, reference([16, 32, 32]), set);
}

/// 15, 30 and 30 channels, padded to 16, 32 and 32.
#[divan::bench(args = [InstructionSet::Avx2Fma, InstructionSet::Portable])]
fn odd_channels(bencher: Bencher<'_, '_>, set: InstructionSet) {
    run(bencher, reference([15, 30, 30]), set);
}

#[divan::bench(args = [InstructionSet::Avx2Fma, InstructionSet::Portable])]
fn shipped_collision_network(bencher: Bencher<'_, '_>, set: InstructionSet) {
    run(bencher, NetworkKind::Collision.shape(), set);
}
