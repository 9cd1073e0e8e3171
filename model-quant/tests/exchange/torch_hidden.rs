//! Network `torch_hidden`: 6 columns of 2 values to 1 values.
//!
//! Written by `model-quant import` from `torch_hidden.onnx` (pytorch 2.15.0+cu132); do not edit.
//!
//! Needs the crate `inference` and the file `torch_hidden.layers` in the same directory, but
//! neither heap nor `std`. The model card is `torch_hidden.md`.
//!
//! ```text
//! let network = torch_hidden::load()?;
//! let mut window = torch_hidden::Window::new(network);
//! let counts = columns.map(|column| torch_hidden::counts(&column));
//! let (Sums(sums), clipped) = window.evaluate(&counts);
//! let values = torch_hidden::values(&sums);
//! ```
//!
//! `Streaming` takes one column after another and gives the same sums.

use inference::chain::{Sums, Then};
use inference::image::{checksum, load_layers, prove};
use inference::{Convolution, Head, ImageError, Valid, Windowed};

/// Columns of a window, oldest first.
pub const COLUMNS: usize = 6;
/// Values of a column.
pub const INPUTS: usize = 2;
/// Values that the network gives.
pub const OUTPUTS: usize = 1;

/// The network's type.
#[rustfmt::skip]
pub type Network<'a> =
    Then<Convolution<'a, i16, i16, 2, 8, 3>,
    Then<Convolution<'a, i16, i16, 8, 10, 4>,
    Head<'a, i16, 10, 1, 1>>>;
/// The network over a window.
pub type Window<'a> = Windowed<'a, Network<'a>, i16, INPUTS, COLUMNS, Valid>;

/// Full scale of every value of a column, in the unit of the network's inputs: 32767 counts.
#[rustfmt::skip]
pub const FULL_SCALE: [f32; INPUTS] = [0.5302958, 1.0497236];
#[rustfmt::skip]
const FACTORS: [f32; INPUTS] = [61790.043, 31214.883];
/// Value of one count of a sum, in the unit of the network's outputs.
pub const OUTPUT_STEP: f32 = 3.3973342e-9;
/// CRC-32 of the layers.
pub const CHECKSUM: u32 = 0xc6262fc7;

const BYTES: &[u8; 948] = include_bytes!("torch_hidden.layers");
#[repr(C, align(4))]
struct Aligned([u8; BYTES.len()]);
static LAYERS: Aligned = Aligned(*BYTES);
/// No sum can overflow.
const _: () = assert!(prove(BYTES).is_ok());

/// Loads the network after checks of its type and its checksum.
pub fn load() -> Result<Network<'static>, ImageError> {
    let found = checksum(&LAYERS.0);
    if found != CHECKSUM {
        return Err(ImageError::Crc { found, expected: CHECKSUM });
    }
    load_layers(&LAYERS.0, "torch_hidden")
}

/// Converts a column to counts: rounded to nearest, clipped to 16 bits.
pub fn counts(column: &[f32; INPUTS]) -> [i16; INPUTS] {
    let mut counts = [0; INPUTS];
    for ((count, value), factor) in counts.iter_mut().zip(column).zip(FACTORS) {
        let scaled = value * factor;
        // A cast truncates and saturates.
        *count = if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 } as i16;
    }
    counts
}

/// Converts sums to the unit of the network's outputs.
pub fn values(sums: &[i32; OUTPUTS]) -> [f32; OUTPUTS] {
    sums.map(|sum| sum as f32 * OUTPUT_STEP)
}

/// Returns true if the network gives the expected sums for windows of its samples.
pub fn self_test(network: Network<'static>) -> bool {
    let mut window = Window::new(network);
    CHECKS.iter().all(|(columns, sums)| window.evaluate(columns).0 == Sums(*sums))
}

/// Windows of the samples in counts, and their sums.
#[rustfmt::skip]
static CHECKS: [([[i16; INPUTS]; COLUMNS], [i32; OUTPUTS]); 4] = [
    (
        [
            [15004, -12848],
            [-7963, -14650],
            [-7872, -14569],
            [20646, -21986],
            [-18049, 13365],
            [-6307, -9910],
        ],
        [107890328],
    ),
    (
        [
            [29317, 24585],
            [-17367, -21517],
            [-472, 4627],
            [-9471, 5708],
            [11010, 19642],
            [-15931, 9059],
        ],
        [421653573],
    ),
    (
        [
            [-27305, -27169],
            [-27475, -23950],
            [17410, -8062],
            [-444, -3065],
            [-18100, -28357],
            [-19660, 22368],
        ],
        [395797400],
    ),
    (
        [
            [-9971, -4961],
            [-14558, 15059],
            [12504, -7252],
            [394, -6504],
            [4531, 5843],
            [4786, 25071],
        ],
        [75072517],
    ),
];
