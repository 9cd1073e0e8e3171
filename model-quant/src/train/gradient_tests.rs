//! Tests of the gradients against finite differences in f64 and against PyTorch.

use super::lanes::Machine;
use super::{Loss, Trainer, Windows};
use crate::data::draw::{Draw, Purpose};
use crate::network::recipe::InstructionSet;
use crate::network::{ConvolutionShape, Layer, Network, Padding, Shape};
use crate::quantise::weight_grid::weight_steps;
use serde::Deserialize;

/// Reference implementation of the mean squared error in f64.
fn reference_loss(shape: &Shape, parameters: &[f64], windows: &Windows) -> f64 {
    let (mut squares, size) = (0.0, shape.columns * shape.inputs);
    let targets = windows.targets.chunks_exact(shape.outputs);
    for (window, targets) in windows.columns.chunks_exact(size).zip(targets) {
        let mut values: Vec<f64> = window.iter().map(|&x| f64::from(x)).collect();
        let mut at = 0;
        for (index, layer) in shape.layers().iter().enumerate() {
            let mut next = Vec::new();
            for position in 0..layer.positions {
                for output in 0..layer.outputs {
                    let mut sum = parameters[at + layer.weights() + output];
                    for tap in 0..layer.taps() {
                        let column = position + tap / layer.inputs;
                        if column < layer.before || column >= layer.before + layer.columns {
                            continue;
                        }
                        let value = values[(column - layer.before) * layer.inputs + tap % layer.inputs];
                        sum += parameters[at + tap * layer.outputs + output] * value;
                    }
                    next.push(if index < shape.convolutions.len() { sum.max(0.0) } else { sum });
                }
            }
            at += layer.weights() + layer.outputs;
            values = next;
        }
        squares += values.iter().zip(targets).map(|(x, y)| (x - f64::from(*y)).powi(2)).sum::<f64>();
    }
    squares / windows.targets.len() as f64
}

fn gradient(network: &Network, set: InstructionSet, windows: &Windows) -> (f64, Vec<f32>) {
    let trainer = Trainer::new(network, set, Loss::Difference);
    let (gradient, errors) =
        trainer.gradient(windows.targets.len() / network.shape().outputs, 1.0, |_, rows| {
            let (size, outputs) = (network.shape().columns * network.shape().inputs, network.shape().outputs);
            Windows {
                columns: windows.columns[rows.start * size..rows.end * size].to_vec(),
                targets: windows.targets[rows.start * outputs..rows.end * outputs].to_vec(),
            }
        });
    let filled = gradient.iter().filter(|&&gradient| gradient != 0.0).count();
    let found: Vec<f32> = trainer.layout.unpack(&gradient).parameters().collect();
    assert_eq!(
        filled,
        found.iter().filter(|&&gradient| gradient != 0.0).count(),
        "padding channels have no gradient"
    );
    (errors.squared / windows.targets.len() as f64, found)
}

fn sets() -> impl Iterator<Item = InstructionSet> {
    [InstructionSet::Portable, InstructionSet::Avx2Fma].into_iter().filter(|set| set.is_available())
}

fn shapes() -> Vec<Shape> {
    let shape = |columns, inputs, padding, convolutions: &[(usize, usize)], outputs| Shape {
        columns,
        inputs,
        padding,
        convolutions: (convolutions.iter())
            .map(|&(kernel, outputs)| ConvolutionShape { kernel, outputs })
            .collect(),
        outputs,
    };
    vec![
        shape(8, 4, Padding::Valid, &[(3, 16), (3, 16), (3, 16)], 1),
        shape(11, 6, Padding::Same, &[(5, 16), (5, 32), (3, 8)], 1),
        shape(9, 3, Padding::Same, &[(4, 5), (2, 24)], 3),
        shape(7, 2, Padding::Valid, &[(2, 7), (4, 13)], 2),
        shape(5, 3, Padding::Same, &[(7, 8)], 1),
        shape(4, 3, Padding::Valid, &[], 2),
    ]
}

#[test]
fn gradients_match_finite_differences() {
    for (index, shape) in shapes().into_iter().enumerate() {
        let mut draw = Draw::new(3, Purpose::Weights, index as u64);
        let mut network = Network::start(shape.clone(), &mut draw);
        // Makes every head weight and bias nonzero, so that every path contributes.
        for value in network.slices_mut().flatten() {
            *value += (0.1 * draw.normal()) as f32;
        }
        // 70 windows are two chunks.
        let windows = Windows {
            columns: (0..70 * shape.columns * shape.inputs).map(|_| draw.uniform(-1.0, 1.0) as f32).collect(),
            targets: (0..70 * shape.outputs).map(|_| draw.uniform(-1.0, 1.0) as f32).collect(),
        };
        let flat: Vec<f64> = network.parameters().map(f64::from).collect();
        let loss = reference_loss(&shape, &flat, &windows);
        let found: Vec<_> = sets().map(|set| (set, gradient(&network, set, &windows))).collect();
        let largest = found[0].1.1.iter().fold(0.0f32, |a, b| a.max(b.abs()));
        assert!(largest > 0.05, "the gradient is not trivial");
        for parameter in (0..flat.len()).step_by((flat.len() / 60).max(1)) {
            let mut moved = flat.clone();
            moved[parameter] += 1e-6;
            let above = reference_loss(&shape, &moved, &windows);
            moved[parameter] -= 2e-6;
            let expected = (above - reference_loss(&shape, &moved, &windows)) / 2e-6;
            for (set, (found_loss, found)) in &found {
                assert!((found_loss / loss - 1.0).abs() < 1e-5, "{shape:?}");
                assert!(
                    (expected - f64::from(found[parameter])).abs() < 2e-5 * f64::from(largest).max(1.0),
                    "{shape:?}, {}, parameter {parameter}: found {}, expected {expected}",
                    set.name(),
                    found[parameter]
                );
            }
        }
    }
}

#[derive(Deserialize)]
struct Stored {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    shape: Shape,
    windows: Vec<f32>,
    targets: Vec<f32>,
    parameters: Vec<f32>,
    outputs: Vec<f32>,
    loss: f64,
    gradient: Vec<f32>,
}

#[test]
fn gradients_agree_with_pytorch() {
    let stored: Stored = serde_json::from_str(include_str!("../../peers/gradients.json")).unwrap();
    assert_eq!(stored.cases.len(), 3);
    for case in stored.cases {
        let mut values = case.parameters.iter().copied();
        let mut take = |count| values.by_ref().take(count).collect();
        let layers = (case.shape.layers().iter())
            .map(|size| Layer { weights: take(size.weights()), biases: take(size.outputs) })
            .collect();
        let network = Network::new(case.shape.clone(), layers).unwrap();
        let size = case.shape.columns * case.shape.inputs;
        let outputs: Vec<f32> =
            case.windows.chunks(size).flat_map(|window| network.evaluate(window)).collect();
        for (found, expected) in outputs.iter().zip(&case.outputs) {
            assert!((found - expected).abs() < 1e-5 * (1.0 + expected.abs()), "{found} {expected}");
        }
        let windows = Windows { columns: case.windows, targets: case.targets };
        for set in sets() {
            let (loss, found) = gradient(&network, set, &windows);
            assert!((loss / case.loss - 1.0).abs() < 1e-6);
            assert_eq!(found.len(), case.gradient.len());
            let largest = case.gradient.iter().fold(0.0f32, |a, b| a.max(b.abs()));
            for (found, expected) in found.iter().zip(&case.gradient) {
                assert!((found - expected).abs() < 3e-6 * largest, "{}: {found} {expected}", set.name());
            }
        }
    }
}

#[test]
fn both_instruction_sets_agree_and_each_is_reproducible() {
    let shape = shapes().remove(1);
    let mut draw = Draw::new(4, Purpose::Weights, 0);
    let network = Network::start(shape.clone(), &mut draw);
    let windows = Windows {
        columns: (0..200 * shape.columns * shape.inputs).map(|_| draw.normal() as f32).collect(),
        targets: (0..200).map(|_| draw.normal() as f32).collect(),
    };
    let found: Vec<Vec<f32>> = sets().map(|set| gradient(&network, set, &windows).1).collect();
    for (set, first) in sets().zip(&found) {
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert_eq!(pool.install(|| gradient(&network, set, &windows).1), *first, "{threads} threads");
        }
    }
    for (a, b) in found[0].iter().zip(&found[found.len() - 1]) {
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
}

/// Trains some steps, half of them in fixed point; returns the bits of parameters and errors.
fn trained(mut trainer: Trainer, windows: &Windows) -> (Vec<u32>, [u64; 2]) {
    let (size, outputs) = (trainer.layout.window(), trainer.shape().outputs);
    // The last chunk and its last group are incomplete.
    let count = windows.targets.len() / outputs;
    for step in 0..6 {
        if step == 3 {
            let network = trainer.network();
            trainer.use_fixed_point_forward(&weight_steps(&network), windows);
        }
        trainer.step(count, 0.5, 3e-3, |_, rows| Windows {
            columns: windows.columns[rows.start * size..rows.end * size].to_vec(),
            targets: windows.targets[rows.start * outputs..rows.end * outputs].to_vec(),
        });
    }
    let errors = trainer.errors(windows, 0.5);
    let parameters = trainer.parameters.iter().map(|value| value.to_bits()).collect();
    (parameters, [errors.squared.to_bits(), errors.absolute.to_bits()])
}

#[test]
fn wider_vectors_train_the_same_network_to_the_bit() {
    let mut shapes = shapes();
    let wide = [(5, 16), (5, 32), (3, 56)].map(|(kernel, outputs)| ConvolutionShape { kernel, outputs });
    let padding = Padding::Same;
    shapes.push(Shape { columns: 32, inputs: 6, padding, convolutions: wide.to_vec(), outputs: 1 });
    let machines: Vec<_> = InstructionSet::Avx2Fma.machines().collect();
    if machines.len() < 2 {
        println!("not compared: this machine has one width of vectors only");
    }
    for (index, shape) in shapes.into_iter().enumerate() {
        let mut draw = Draw::new(5, Purpose::Weights, index as u64);
        let network = Network::start(shape.clone(), &mut draw);
        let windows = Windows {
            columns: (0..131 * shape.columns * shape.inputs)
                .map(|_| draw.uniform(-1.0, 1.0) as f32)
                .collect(),
            // Many targets are clamped, so some windows of a group have no gradient.
            targets: (0..131 * shape.outputs).map(|_| draw.normal().max(0.0) as f32).collect(),
        };
        let start = Trainer::new(&network, InstructionSet::Avx2Fma, Loss::Clamped);
        let run = |machine: &Machine| {
            let mut trainer = start.clone();
            trainer.machine = *machine;
            trained(trainer, &windows)
        };
        let found: Vec<_> = machines.iter().map(run).collect();
        let before: Vec<u32> = start.parameters.iter().map(|value| value.to_bits()).collect();
        for (machine, other) in machines.iter().zip(&found) {
            assert_ne!(other.0, before, "nothing was trained");
            assert!(*other == found[0], "{shape:?} on {machine:?} and {:?}", machines[0]);
        }
    }
}
