//! Trainer speed in samples/s on the reference network, one round for each line on standard input.
//!
//! `benches/peers/rounds.py` runs it alternately with other frameworks. Argument: `reference`
//! (default), `odd` (15, 30 and 30 channels) or `portable` (the reference network with portable
//! arithmetic).

use model_quant::data::draw::{Draw, Purpose};
use model_quant::network::recipe::InstructionSet;
use model_quant::network::{ConvolutionShape, Network, Padding, Shape};
use model_quant::train::{Loss, Trainer, Windows};
use std::io::BufRead;
use std::time::{Duration, Instant};

const BATCH: usize = 1024;
const ROUND: Duration = Duration::from_secs(3);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let case = std::env::args().nth(1).unwrap_or_default();
    rayon::ThreadPoolBuilder::new().num_threads(2).build_global()?;
    let channels = if case == "odd" { [15, 30, 30] } else { [16, 32, 32] };
    let set = if case == "portable" { InstructionSet::Portable } else { InstructionSet::best() };
    let convolutions = [5, 5, 3].into_iter().zip(channels);
    let shape = Shape {
        columns: 32,
        inputs: 6,
        padding: Padding::Same,
        convolutions: convolutions.map(|(kernel, outputs)| ConvolutionShape { kernel, outputs }).collect(),
        outputs: 1,
    };
    let mut draw = Draw::new(1, Purpose::Weights, 0);
    let window = shape.columns * shape.inputs;
    let columns: Vec<f32> = (0..BATCH * window).map(|_| draw.normal() as f32).collect();
    let targets: Vec<f32> = (0..BATCH).map(|_| draw.normal() as f32).collect();
    let mut trainer = Trainer::new(&Network::start(shape, &mut draw), set, Loss::Difference);
    for line in std::io::stdin().lock().lines() {
        line?;
        let (started, mut samples) = (Instant::now(), 0);
        while started.elapsed() < ROUND {
            trainer.step(BATCH, 1.0, 1e-3, |_, rows| Windows {
                columns: columns[rows.start * window..rows.end * window].to_vec(),
                targets: targets[rows].to_vec(),
            });
            samples += BATCH;
        }
        println!("{:.0}", samples as f64 / started.elapsed().as_secs_f64());
    }
    Ok(())
}
