//! Network `keras_hidden`: 6 columns of 4 values to 1 values.
//!
//! Written by `model-quant import` from `keras_hidden.onnx` (tf2onnx 1.17.0 None); do not edit.
//!
//! Needs the crate `inference` and the file `keras_hidden.layers` in the same directory, but
//! neither heap nor `std`. The model card is `keras_hidden.md`.
//!
//! ```text
//! let network = keras_hidden::load()?;
//! let mut window = keras_hidden::Window::new(network);
//! let counts = columns.map(|column| keras_hidden::counts(&column));
//! let (Sums(sums), clipped) = window.evaluate(&counts);
//! let values = keras_hidden::values(&sums);
//! ```
//!
//! `Streaming` takes one column after another and gives the same sums.

use inference::chain::{Sums, Then};
use inference::image::{checksum, load_layers, prove};
use inference::{Convolution, Head, ImageError, Valid, Windowed};

/// Columns of a window, oldest first.
pub const COLUMNS: usize = 6;
/// Values of a column.
pub const INPUTS: usize = 4;
/// Values that the network gives.
pub const OUTPUTS: usize = 1;

/// The network's type.
#[rustfmt::skip]
pub type Network<'a> =
    Then<Convolution<'a, i16, i16, 4, 8, 3>,
    Then<Convolution<'a, i16, i16, 8, 7, 4>,
    Head<'a, i16, 7, 1, 1>>>;
/// The network over a window.
pub type Window<'a> = Windowed<'a, Network<'a>, i16, INPUTS, COLUMNS, Valid>;

/// Full scale of every value of a column, in the unit of the network's inputs: 32767 counts.
#[rustfmt::skip]
pub const FULL_SCALE: [f32; INPUTS] = [0.525213, 1.0593381, 2.118883, 0.5286488];
#[rustfmt::skip]
const FACTORS: [f32; INPUTS] = [62388.02, 30931.578, 15464.281, 61982.55];
/// Value of one count of a sum, in the unit of the network's outputs.
pub const OUTPUT_STEP: f32 = 6.402722e-7;
/// CRC-32 of the layers.
pub const CHECKSUM: u32 = 0xb0ea5877;

const BYTES: &[u8; 496] = include_bytes!("keras_hidden.layers");
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
    load_layers(&LAYERS.0, "keras_hidden")
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
            [17549, -8254, 20042, -27297],
            [-15641, -22595, -14558, -6950],
            [-25703, 10687, 17135, -7433],
            [10602, -11912, 2965, -23720],
            [29724, -22528, -1651, -21375],
            [-23517, 5104, 29494, -14168],
        ],
        [1925832],
    ),
    (
        [
            [17631, 29719, 2071, -28528],
            [-7690, -965, -8000, -7938],
            [1254, -27459, 11657, -652],
            [-24942, -26342, -12226, -6964],
            [28503, 17995, 445, 14999],
            [2483, -6065, -19584, 25806],
        ],
        [46475],
    ),
    (
        [
            [-17208, -28281, 20074, -3336],
            [11735, -26055, 19344, -13185],
            [-12140, -23436, -28016, -12944],
            [-23601, -4562, -7464, -7103],
            [-417, 8642, -24847, 19397],
            [-18578, -10251, 11535, 30331],
        ],
        [-175061],
    ),
    (
        [
            [-21263, 25466, -19894, 5033],
            [-235, -15784, -2643, -27287],
            [25, 3814, 1456, -5594],
            [-10507, -23940, -5660, -13545],
            [-16815, 28665, 26301, -28319],
            [-18809, 29197, -30840, -20922],
        ],
        [665474],
    ),
];
