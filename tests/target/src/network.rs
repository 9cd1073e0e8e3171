//! Reference network of the published instruction counts, and networks with random parameters.

use crate::noise::Noise;
use inference::chain::{Chain, Then};
use inference::image::write::{LayerParts, WriteError, layers};
use inference::image::{LayerKind, LayerName, LayerShape, Reader, WeightForm};
use inference::{Convolution, Head, ImageError, LayerInput, Scale};

/// Number of inputs in a column of the reference network.
pub const INPUTS: usize = 6;
/// Number of columns in its window.
pub const COLUMNS: usize = 32;

/// 32 columns of 6 -> convolution over 5 to 16 -> 5 to 32 -> 3 to 32 -> dense over all 32 columns
/// to 1.
pub type Reference<'a, A> = Then<
    Convolution<'a, i16, A, INPUTS, 16, 5>,
    Then<
        Convolution<'a, A, A, 16, 32, 5>,
        Then<Convolution<'a, A, A, 32, 32, 3>, Head<'a, A, 32, COLUMNS, 1>>,
    >,
>;

/// Returns the shapes of its layers.
pub fn reference_shapes<A: LayerInput>(first: WeightForm, others: WeightForm) -> [LayerShape; 4] {
    [
        Convolution::<i16, A, INPUTS, 16, 5>::shape(first),
        Convolution::<A, A, 16, 32, 5>::shape(others),
        Convolution::<A, A, 32, 32, 3>::shape(others),
        Head::<A, 32, COLUMNS, 1>::shape(others),
    ]
}

/// Buffer for the parameters of any network here, at an address that they can be read from.
#[derive(Clone, Debug)]
#[repr(align(4))]
pub struct Room(pub [u8; 20_000]);

/// Maximum number of weights of a layer here.
const MAX_WEIGHTS: usize = 3072;
const MAX_OUTPUTS: usize = 40;

/// Writes layers with random parameters. About half of the activations are above 0, some are
/// clipped.
///
/// # Errors
///
/// A layer is larger than those here.
pub fn random(shapes: &[LayerShape], seed: u64, room: &mut Room) -> Result<usize, WriteError> {
    let mut noise = Noise(seed);
    let mut used = 0;
    for shape in shapes {
        let (outputs, count) = (usize::from(shape.outputs), usize::from(shape.outputs) * shape.taps());
        let mut weights = [0i16; MAX_WEIGHTS];
        let weights = weights.get_mut(..count).ok_or(WriteError::Lengths)?;
        // So that no sum can overflow: sum |w| below 2^15 (wide) or w within 8 bits.
        let largest = match shape.form {
            WeightForm::Wide => 60_000 / shape.taps() as u32,
            WeightForm::Packed => 60_000 / (shape.taps() as u32).max(473),
        };
        weights.fill_with(|| noise.within(largest.min(32_000)) as i16);
        let (mut biases, mut multipliers) = ([0i32; MAX_OUTPUTS], [0i32; MAX_OUTPUTS]);
        // Sums are about weight x input x sqrt(taps); the multiplier scales them to full scale.
        let size = (u64::from(largest) * (shape.taps() as u64).isqrt()) << (shape.input_bits - 3);
        let factor = (1u64 << (32 + u64::from(shape.output_bits.min(16)) - 2)) / size.max(1);
        let factor = u32::try_from(factor).unwrap_or(u32::MAX).min(1 << 30);
        biases.fill_with(|| noise.within(1 + (size as u32 / 4).min(1 << 24)));
        multipliers.fill_with(|| factor.cast_signed() + noise.within(factor / 2) + 1);
        let convolution = shape.kind == LayerKind::Convolution;
        let parts = LayerParts {
            shape: *shape,
            biases: biases.get(..outputs).ok_or(WriteError::Lengths)?,
            multipliers: multipliers
                .get(..if convolution { outputs } else { 0 })
                .ok_or(WriteError::Lengths)?,
            scale: Scale { multiplier: 1 << 30, shift: 40 },
            weights,
        };
        used += layers(&[parts], room.0.get_mut(used..).ok_or(WriteError::NoRoom)?)?;
    }
    Ok(used)
}

/// Reads a chain of layers from their bytes and proves that no sum overflows.
///
/// # Errors
///
/// The bytes are not such a chain.
pub fn read<'a, N: Chain<'a, A, IN>, A: LayerInput, const IN: usize>(
    bytes: &'a [u8],
) -> Result<N, ImageError> {
    // Not `image::load_layers`: the instruction counts depend on this code layout.
    let layer = LayerName { network: "test", index: 0 };
    inference::image::prove(bytes).map_err(|_| ImageError::Scale { layer })?;
    N::read(&mut Reader::new(bytes), layer)
}
