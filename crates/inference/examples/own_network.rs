//! A user-defined network: its type, its bytes, and the three modes that run it.
//!
//! `cargo run -p inference --example own_network`
//!
//! Two convolutions and a head over columns of two inputs. The weights are made up. Those of a real
//! network come from training, where each layer's multiplier is (scale of its inputs x scale of its
//! weights / scale of its outputs) x 2^32.

use inference::chain::{Chain, Sums, Then};
use inference::image::write::{LayerParts, layers};
use inference::image::{WeightForm, load_layers};
use inference::{Causal, Convolution, Head, Scale, Streaming, Windowed};
use std::error::Error;

/// Number of values in an input column.
const INPUTS: usize = 2;
/// 2 inputs -> 4 over 3 columns -> 4 over 3 columns -> 1 sum over the newest 2 columns.
///
/// The values between the layers have 16 bits.
type First<'a> = Convolution<'a, i16, i16, INPUTS, 4, 3>;
type Second<'a> = Convolution<'a, i16, i16, 4, 4, 3>;
type Last<'a> = Head<'a, i16, 4, 2, 1>;
type Own<'a> = Then<First<'a>, Then<Second<'a>, Last<'a>>>;

/// Returns the network's bytes, in words so that weights can be read at their address.
fn bytes() -> Result<Vec<u32>, Box<dyn Error>> {
    let weights: Vec<i16> = (0..48).map(|tap| (tap * 37 % 101) - 40).collect();
    let shapes =
        [First::shape(WeightForm::Wide), Second::shape(WeightForm::Packed), Last::shape(WeightForm::Packed)];
    let (biases, multipliers) = ([500, -500, 1000, 0], [1 << 25; 4]);
    let parts = shapes.map(|shape| {
        let outputs = usize::from(shape.outputs);
        LayerParts {
            shape,
            biases: &biases[..outputs],
            // A head's sums are not requantised.
            multipliers: if shape.output_bits == 32 { &[] } else { &multipliers },
            // One count of the head's sum is worth 2^-10.
            scale: Scale { multiplier: 1 << 30, shift: 40 },
            weights: &weights[..outputs * shape.taps()],
        }
    });
    let mut words = vec![0; parts.iter().map(|part| part.shape.length()).sum::<usize>() / 4];
    layers(&parts, bytemuck::cast_slice_mut(&mut words))?;
    Ok(words)
}

/// Number of columns in a window: all that one result depends on.
const WINDOW: usize = <Own<'_> as Chain<'_, i16, INPUTS>>::WINDOW;

fn main() -> Result<(), Box<dyn Error>> {
    let words = bytes()?;
    let network: Own<'_> = load_layers(bytemuck::cast_slice(&words), "own")?;
    println!("{} bytes, {WINDOW} columns a window", 4 * words.len());

    let mut stream = Streaming::<_, i16, INPUTS>::new(network);
    let mut moved = Windowed::<_, i16, INPUTS, WINDOW, Causal>::new(network);
    let mut complete = Windowed::<_, i16, INPUTS, WINDOW, Causal>::new(network);
    let mut window = [[0; INPUTS]; WINDOW];
    for step in 0..20_i16 {
        let column = [1000 * (step % 7), -500 * (step % 5)];
        window.rotate_left(1);
        window[WINDOW - 1] = column;

        let (Sums([sum]), _) = stream.push(&column);
        let (moved, _) = moved.slide(&column);
        let (complete, _) = complete.evaluate(&window);
        // Before a stream has seen a full window, stream and windows have different zeros before
        // the first column.
        let full = step >= WINDOW as i16 - 1;
        let equal = moved == complete && (!full || complete == Sums([sum]));
        println!("column {step:2}: {:9.3}", f64::from(sum) * network.tail.tail.scale().to_f64());
        if !equal {
            return Err(format!("column {step}: the modes differ").into());
        }
    }
    println!("stream, moved and whole windows agree");
    Ok(())
}
