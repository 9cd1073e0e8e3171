//! Other runtimes on the same parameters and the same inputs, compared bit for bit or in newtons.
//!
//! `peers/windows.bin` has, for every network of the shipped images, windows of whole-number features: some drawn over
//! the whole range of 16 bits, some from rows of the test set. A runtime writes the sums of the heads that it finds for them to a file of
//! results: `peers/onnxruntime.bin` and `peers/litert.bin` come from `peers/peers.py`; a controller can write one, too.
//! Formats: `peers/README.md`.

use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::draw::{Draw, Purpose};
use crate::float_pair::shipped as shipped_checkpoint;
use crate::quantise::roots;
use crate::verify::{mean, test_set};
use inference::chain::{Chain, Sums};
use inference::features::Features;
use inference::image::CRC_LENGTH;
use inference::{Bearing, ImageError, Model, Streaming, WINDOW, shipped};
use serde::Serialize;

/// Windows of each network drawn over the whole range.
pub const RANDOM_WINDOWS: usize = 128;
/// Windows of each network from rows of the test set, behind the others.
pub const ROW_WINDOWS: usize = 256;
/// Results checked in with the windows, and whether their sums must be equal.
pub const CHECKED_IN: [(&[u8], bool); 2] =
    [(include_bytes!("../peers/onnxruntime.bin"), true), (include_bytes!("../peers/litert.bin"), false)];

const WINDOWS_MAGIC: [u8; 8] = *b"PINTLEW\n";
const RESULTS_MAGIC: [u8; 8] = *b"PINTLER\n";
const VERSION: u32 = 1;
const NAME_LENGTH: usize = 48;

/// Windows of one network of a shipped image and what the image makes of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Windows {
    /// Bearing of the image.
    pub bearing: Bearing,
    /// `collision` or `friction`.
    pub network: &'static str,
    /// Check sum of the image.
    pub check_sum: u32,
    /// Features of a column.
    pub inputs: usize,
    /// The windows, column by column, oldest first.
    pub features: Vec<i16>,
    /// Sum of the head for each window, by the code that the controller runs.
    pub sums: Vec<i32>,
    /// The force in N of each of the windows from rows is `(sum factor)^power`.
    factors: Vec<f64>,
    power: i32,
}

/// A file of results that cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ResultsError {
    /// It does not begin as one.
    #[error("results: the first bytes are not those of a file of results of version {VERSION}")]
    Magic,
    /// It is not for these networks.
    #[error("results: found {found} networks, expected {expected}")]
    Networks {
        /// Networks found.
        found: u32,
        /// Networks expected.
        expected: usize,
    },
    /// It ends early or goes on too long.
    #[error("results: found {found} bytes, expected {expected}")]
    Length {
        /// Bytes found.
        found: usize,
        /// Bytes expected.
        expected: usize,
    },
}

/// Sums that another runtime found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Results {
    /// The runtime and its version.
    pub name: String,
    /// Whether it computes in the same whole numbers, so that a difference is an error.
    pub must_be_equal: bool,
    /// Per network: check sum of the image, sums.
    pub networks: Vec<(u32, Vec<i32>)>,
}

/// Comparison of one network with another runtime.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PeerVerdict {
    /// The runtime and its version.
    pub peer: String,
    /// Whether a difference is an error.
    pub must_be_equal: bool,
    /// Windows compared.
    pub windows: usize,
    /// Windows with another sum.
    pub different: usize,
    /// Largest difference of two sums, in counts.
    pub largest_counts: u64,
    /// Mean absolute difference of the forces over the windows from rows, in N.
    pub mean_n: f64,
    /// Largest absolute difference of the forces over the windows from rows, in N.
    pub largest_n: f64,
}

/// Why the windows could not be made.
#[derive(Debug, thiserror::Error)]
pub enum WindowsError {
    /// A shipped image.
    #[error("shipped {0}")]
    Image(#[from] ImageError),
    /// A shipped checkpoint.
    #[error("shipped {0}")]
    Checkpoint(#[from] CheckpointError),
}

fn random<const C: usize>(draw: &mut Draw) -> [[i16; C]; WINDOW] {
    core::array::from_fn(|_| core::array::from_fn(|_| (draw.below(1 << 16) as i32 - (1 << 15)) as i16))
}

fn sums<'a, N: Chain<'a, i16, C, Output = Sums<1>> + Copy, const C: usize>(
    network: N,
    windows: &[[[i16; C]; WINDOW]],
) -> Vec<i32> {
    let mut stream = Streaming::<_, i16, C>::new(network);
    (windows.iter())
        .map(|window| {
            stream.reset();
            let Sums([sum]) = window.map(|column| stream.push(&column).0)[WINDOW - 1];
            sum
        })
        .collect()
}

/// The windows of both networks of a bearing.
fn windows_of(bearing: Bearing) -> Result<[Windows; 2], WindowsError> {
    let checkpoint = Checkpoint::from_bytes(shipped_checkpoint(bearing))?;
    let image = shipped(bearing);
    let check_sum = image.last_chunk::<CRC_LENGTH>().map_or(0, |sum| u32::from_le_bytes(*sum));
    let model: Model<'_, i16> = Model::load(image)?;
    let features = Features::new(model.header());
    let draw = |lane: u64| {
        Draw::new(checkpoint.recipe.seed, Purpose::PeerWindows, u64::from(bearing.code()) << 1 | lane)
    };
    let (mut first, mut second) = (draw(0), draw(1));
    let mut collision: Vec<_> = (0..RANDOM_WINDOWS).map(|_| random(&mut first)).collect();
    let mut friction: Vec<_> = (0..RANDOM_WINDOWS).map(|_| random(&mut second)).collect();
    let [mut root_factors, mut forces] = [Vec::new(), Vec::new()];
    let set: Vec<_> = test_set(&checkpoint, ROW_WINDOWS).into_iter().map(|(_, states)| states).collect();
    roots(&model, &set, |states, roots| {
        let samples = states.map(|state| state.sample().unwrap_or_default());
        let columns = samples.map(|sample| features.collision(&sample));
        let q30 = f64::from(columns[WINDOW - 1].root_force_factor_q30) / f64::from(1u32 << 30);
        root_factors.push(q30 * model.collision().scale().to_f64());
        collision.push(columns.map(|column| column.inputs));
        let root = f64::from(roots[WINDOW - 1]) / 65536.0;
        forces.push(root * root * model.friction().scale().to_f64());
        friction.push(core::array::from_fn(|k| features.friction(roots[k], samples[k].sliding_speed_nm_s)));
    });
    Ok([
        Windows {
            bearing,
            network: "collision",
            check_sum,
            inputs: collision[0][0].len(),
            sums: sums(*model.collision(), &collision),
            features: collision.into_iter().flatten().flatten().collect(),
            factors: root_factors,
            power: 2,
        },
        Windows {
            bearing,
            network: "friction",
            check_sum,
            inputs: friction[0][0].len(),
            sums: sums(*model.friction(), &friction),
            features: friction.into_iter().flatten().flatten().collect(),
            factors: forces,
            power: 1,
        },
    ])
}

/// The windows of every network of the shipped images: bearings in the order of their codes, collision before friction.
///
/// # Errors
///
/// A shipped image or checkpoint that does not load.
pub fn windows() -> Result<Vec<Windows>, WindowsError> {
    let mut windows = Vec::new();
    for bearing in Bearing::ALL {
        windows.extend(windows_of(bearing)?);
    }
    Ok(windows)
}

/// The file of the windows.
pub fn to_bytes(windows: &[Windows]) -> Vec<u8> {
    let mut bytes = WINDOWS_MAGIC.to_vec();
    bytes.extend([VERSION, windows.len() as u32].into_iter().flat_map(u32::to_le_bytes));
    for network in windows {
        let counts = [WINDOW, network.inputs, RANDOM_WINDOWS, ROW_WINDOWS].map(|count| count as u32);
        bytes.extend([network.check_sum].into_iter().chain(counts).flat_map(u32::to_le_bytes));
        bytes.extend(network.features.iter().flat_map(|level| level.to_le_bytes()));
    }
    bytes
}

impl Results {
    /// Reads a file of results.
    ///
    /// # Errors
    ///
    /// Bytes of another kind or length.
    pub fn from_bytes(bytes: &[u8], must_be_equal: bool) -> Result<Self, ResultsError> {
        const COUNT: usize = RANDOM_WINDOWS + ROW_WINDOWS;
        let expected_networks = 2 * Bearing::ALL.len();
        let expected = 16 + NAME_LENGTH + expected_networks * (4 + 4 * COUNT);
        let rest = bytes.strip_prefix(&RESULTS_MAGIC).ok_or(ResultsError::Magic)?;
        let (words, _) = rest.as_chunks::<4>();
        let [version, networks, body @ ..] = words else { return Err(ResultsError::Magic) };
        if u32::from_le_bytes(*version) != VERSION {
            return Err(ResultsError::Magic);
        }
        let found = u32::from_le_bytes(*networks);
        if usize::try_from(found) != Ok(expected_networks) {
            return Err(ResultsError::Networks { found, expected: expected_networks });
        }
        if bytes.len() != expected {
            return Err(ResultsError::Length { found: bytes.len(), expected });
        }
        let (name, body) = body.split_at(NAME_LENGTH / 4);
        let name = String::from_utf8_lossy(name.as_flattened()).trim_end_matches('\0').to_owned();
        let networks = (body.chunks(1 + COUNT))
            .filter_map(|network| network.split_first())
            .map(|(check_sum, sums)| {
                (u32::from_le_bytes(*check_sum), sums.iter().map(|sum| i32::from_le_bytes(*sum)).collect())
            })
            .collect();
        Ok(Self { name, must_be_equal, networks })
    }

    /// Compares one network, if the results were made for the same image.
    pub fn compare(
        &self,
        all: &[Windows],
        bearing: Bearing,
        network: &str,
        image: &[u8],
    ) -> Option<PeerVerdict> {
        let check_sum = image.last_chunk::<CRC_LENGTH>().map(|sum| u32::from_le_bytes(*sum))?;
        let position = all.iter().position(|w| w.bearing == bearing && w.network == network)?;
        let (windows, (found_for, found)) = (all.get(position)?, self.networks.get(position)?);
        if *found_for != check_sum || windows.check_sum != check_sum {
            return None;
        }
        let pairs = || windows.sums.iter().copied().zip(found.iter().copied());
        let force = |sum: i32, factor: f64| (f64::from(sum.max(0)) * factor).powi(windows.power);
        let changes: Vec<f64> = (pairs().skip(RANDOM_WINDOWS).zip(&windows.factors))
            .map(|((own, peer), &factor)| (force(own, factor) - force(peer, factor)).abs())
            .collect();
        Some(PeerVerdict {
            peer: self.name.clone(),
            must_be_equal: self.must_be_equal,
            windows: found.len(),
            different: pairs().filter(|(own, peer)| own != peer).count(),
            largest_counts: pairs()
                .map(|(own, peer)| i64::from(own).abs_diff(i64::from(peer)))
                .max()
                .unwrap_or(0),
            mean_n: mean(changes.iter().copied()),
            largest_n: changes.iter().copied().fold(0.0, f64::max),
        })
    }
}
