//! Network `torch_same`: 12 columns of 6 values to 3 values.
//!
//! Written by `model-quant import` from `torch_same.onnx` (pytorch 2.15.0+cu132); do not edit.
//!
//! Needs the crate `inference` and the file `torch_same.layers` in the same directory, but
//! neither heap nor `std`. The model card is `torch_same.md`.
//!
//! ```text
//! let network = torch_same::load()?;
//! let mut window = torch_same::Window::new(network);
//! let counts = columns.map(|column| torch_same::counts(&column));
//! let (Sums(sums), clipped) = window.evaluate(&counts);
//! let values = torch_same::values(&sums);
//! ```
//!
//! `Windowed::slide` takes one column after another.

use inference::chain::{Sums, Then};
use inference::image::{checksum, load_layers, prove};
use inference::{Convolution, Head, ImageError, Same, Windowed};

/// Columns of a window, oldest first.
pub const COLUMNS: usize = 12;
/// Values of a column.
pub const INPUTS: usize = 6;
/// Values that the network gives.
pub const OUTPUTS: usize = 3;

/// The network's type.
#[rustfmt::skip]
pub type Network<'a> =
    Then<Convolution<'a, i16, i16, 6, 12, 5>,
    Then<Convolution<'a, i16, i16, 12, 7, 4>,
    Head<'a, i16, 7, 12, 3>>>;
/// The network over a window.
pub type Window<'a> = Windowed<'a, Network<'a>, i16, INPUTS, COLUMNS, Same>;

/// Full scale of every value of a column, in the unit of the network's inputs: 32767 counts.
#[rustfmt::skip]
pub const FULL_SCALE: [f32; INPUTS] = [0.52629006, 1.0546653, 2.111402, 0.53114796, 1.0612481, 2.1233985];
#[rustfmt::skip]
const FACTORS: [f32; INPUTS] = [62260.344, 31068.623, 15519.072, 61690.91, 30875.91, 15431.395];
/// Value of one count of a sum, in the unit of the network's outputs.
pub const OUTPUT_STEP: f32 = 5.038188e-7;
/// CRC-32 of the layers.
pub const CHECKSUM: u32 = 0x39304476;

const BYTES: &[u8; 2104] = include_bytes!("torch_same.layers");
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
    load_layers(&LAYERS.0, "torch_same")
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
            [-1697, 4739, -8484, -17050, -23811, 4042],
            [27234, -29903, 22699, 28530, 2614, 28880],
            [12750, 2810, -2255, -2073, 11239, -16388],
            [13411, -560, 10842, 27197, -16460, -5973],
            [-13999, -27795, 7579, 7929, 30840, 6236],
            [-6468, 24927, -30083, -12171, 15557, -20895],
            [-8639, 21690, -9642, -15857, 24120, -26084],
            [22208, -11471, -18140, -748, -1024, 28684],
            [15721, -2478, 3690, -11205, 29809, -7040],
            [24013, 9698, 25833, -8972, -5144, -8066],
            [20362, 28156, 20148, -2997, 20322, 14208],
            [1191, -19667, -16272, 12570, -18603, 3725],
        ],
        [-1375435, -1686431, -3610399],
    ),
    (
        [
            [18939, 9563, 6813, -14946, -23470, -28770],
            [-28245, -16668, 3581, -4708, -18272, -12179],
            [-2413, 18575, 9680, -28322, -1141, -19382],
            [22092, 23917, 3393, 14584, 11534, 19557],
            [-13771, -16821, 15290, 28321, -16684, 4183],
            [2753, -7857, 15534, -22717, -7918, -4255],
            [28204, 11452, 13096, 30833, -16872, 6390],
            [-24427, -20972, 12175, 20110, 8386, 4925],
            [18095, 28349, 26415, 19049, -4192, 16440],
            [-16572, 25106, -13673, 29635, -12246, -14562],
            [-10190, -923, -18610, -14576, 23727, 26623],
            [-21456, -3644, -4976, 20252, 9906, -5676],
        ],
        [-1887759, -555378, -758912],
    ),
    (
        [
            [17974, 6534, -18042, 18052, -2122, 23885],
            [10287, -21677, 15933, 5010, 2568, -4954],
            [10142, -27136, 238, 26867, -18225, -22406],
            [-5571, 1212, -7665, -991, 10786, 18072],
            [-27918, -7350, 7401, -29555, 27739, 8692],
            [-934, -3212, -21897, -26758, 11175, 26171],
            [18203, -29736, -28619, 781, 4524, 6564],
            [23411, 24722, 30374, -10263, -1942, 30470],
            [12475, -27500, 25423, 7198, -18914, -9399],
            [4835, 9492, -5542, 15075, 2027, 29305],
            [22009, -21742, -24639, 21810, 6653, 29395],
            [-3995, -19928, -28742, 16569, -25719, 8883],
        ],
        [-215959, -1427850, -1787865],
    ),
    (
        [
            [3956, 14886, 27555, -16254, -1074, 15528],
            [-18531, -25351, -22470, 26631, 17873, -18492],
            [-30141, 8564, -11055, -16783, -18553, -1714],
            [-9821, 27354, 4090, 24684, 26222, 24698],
            [-103, 5175, 2127, -29595, 27567, -21537],
            [3328, 11349, 17773, 2605, 8590, 20191],
            [8936, 10367, 21978, -26317, 1144, -29224],
            [-21705, -29297, 22735, -10504, 1305, 17731],
            [11761, 26490, -633, 12489, 22710, -24246],
            [-1877, -25601, 3536, -11514, 21026, -1952],
            [-20988, 23201, -4602, -29629, -14284, -7216],
            [-29496, -22362, -12632, -10020, -3855, -12492],
        ],
        [-1078813, 151626, -982274],
    ),
];
