//! Network `keras_valid`: 10 columns of 3 values to 2 values.
//!
//! Written by `model-quant import` from `keras_valid.onnx` (tf2onnx 1.17.0 None); do not edit.
//!
//! Needs the crate `inference` and the file `keras_valid.layers` in the same directory, but
//! neither heap nor `std`. The model card is `keras_valid.md`.
//!
//! ```text
//! let network = keras_valid::load()?;
//! let mut window = keras_valid::Window::new(network);
//! let counts = columns.map(|column| keras_valid::counts(&column));
//! let (Sums(sums), clipped) = window.evaluate(&counts);
//! let values = keras_valid::values(&sums);
//! ```
//!
//! `Streaming` takes one column after another and gives the same sums.

use inference::chain::{Sums, Then};
use inference::image::{checksum, load_layers, prove};
use inference::{Convolution, Head, ImageError, Valid, Windowed};

/// Columns of a window, oldest first.
pub const COLUMNS: usize = 10;
/// Values of a column.
pub const INPUTS: usize = 3;
/// Values that the network gives.
pub const OUTPUTS: usize = 2;

/// The network's type.
#[rustfmt::skip]
pub type Network<'a> =
    Then<Convolution<'a, i16, i8, 3, 6, 4>,
    Then<Convolution<'a, i8, i8, 6, 5, 2>,
    Head<'a, i8, 5, 6, 2>>>;
/// The network over a window.
pub type Window<'a> = Windowed<'a, Network<'a>, i16, INPUTS, COLUMNS, Valid>;

/// Full scale of every value of a column, in the unit of the network's inputs: 32767 counts.
#[rustfmt::skip]
pub const FULL_SCALE: [f32; INPUTS] = [0.52844286, 1.0615529, 2.1236703];
#[rustfmt::skip]
const FACTORS: [f32; INPUTS] = [62006.703, 30867.045, 15429.419];
/// Value of one count of a sum, in the unit of the network's outputs.
pub const OUTPUT_STEP: f32 = 0.00013669668;
/// CRC-32 of the layers.
pub const CHECKSUM: u32 = 0x3cc6ec24;

const BYTES: &[u8; 408] = include_bytes!("keras_valid.layers");
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
    load_layers(&LAYERS.0, "keras_valid")
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
            [-15803, -14379, 28090],
            [26008, 765, 3134],
            [-9102, -29107, -7725],
            [30079, 504, 18958],
            [-21027, 14456, 5573],
            [30176, -11615, -2066],
            [-14164, 14654, -26629],
            [14343, 20645, -15545],
            [-8769, -9538, 23232],
            [-21339, 25577, -25144],
        ],
        [3292, -6504],
    ),
    (
        [
            [-28704, 19248, -26825],
            [4226, 1101, 23811],
            [10811, 29762, 11204],
            [-10275, 27004, -25978],
            [11298, -24186, -19794],
            [-7049, -20, -27552],
            [-5847, 2284, -13644],
            [-5823, 17256, -19103],
            [-11843, -13823, -15495],
            [-28692, 28197, 531],
        ],
        [16678, -13426],
    ),
    (
        [
            [-10728, 23489, -29505],
            [-24431, -29708, -28971],
            [-30840, 6701, 13428],
            [-9046, 26422, 15779],
            [30255, 16563, 1385],
            [-27525, -23475, -10690],
            [-22572, 8485, -26569],
            [2632, -8442, -7166],
            [-26102, 13520, 16295],
            [-11220, -7632, 11875],
        ],
        [-3008, -7073],
    ),
    (
        [
            [-22824, 7073, -9745],
            [12429, 8365, -11616],
            [-13643, -6673, -12593],
            [16057, 17940, -279],
            [-16312, -467, 15828],
            [2824, -29909, -25452],
            [-7163, 21152, -4467],
            [7661, 3974, -25866],
            [-1391, -4220, -2594],
            [25468, -12387, 29467],
        ],
        [8505, -11689],
    ),
];
