//! Comparison with other runtimes on the same parameters and inputs: sums bit for bit, forces in
//! newtons.
//!
//! `peers/windows.bin` contains windows of fixed-point features for every network of the shipped
//! images: random windows over the full 16-bit range, then windows from rows of the test set. A
//! runtime writes its sums of the heads for them to a results file. `peers/onnxruntime.bin` and
//! `peers/litert.bin` come from `peers/peers.py`; a controller can write one, too. Formats:
//! `peers/README.md`.

use super::results_format::{self, MATERIALS, NAME_LENGTH, VERSION};
use crate::data::draw::{Draw, Purpose};
use crate::data::statistics::mean;
use crate::evaluate::test_set::draw_test_set;
use crate::network::NetworkKind;
use crate::network::checkpoint::{Checkpoint, CheckpointError};
use crate::network::shipped::shipped_checkpoint;
use crate::quantise::head_sums::head_sums;
use crate::quantise::roots;
use inference::features::Features;
use inference::image::CRC_LENGTH;
use inference::{BearingMaterial, ImageError, Model, WINDOW, shipped};
use serde::Serialize;

/// Number of random windows of each network.
pub const RANDOM_WINDOWS: usize = 128;
/// Number of windows from rows of the test set, after the random ones.
pub const ROW_WINDOWS: usize = 256;
/// Checked-in results, and whether their sums must be equal to ours.
pub const CHECKED_IN: [(&[u8], bool); 2] = [
    (include_bytes!("../../peers/onnxruntime.bin"), true),
    (include_bytes!("../../peers/litert.bin"), false),
];

const WINDOWS_MAGIC: [u8; 8] = *b"PINTLEW\n";

/// PeerWindows of one network of a shipped image, with the sums that the image gives.
#[derive(Clone, Debug, PartialEq)]
pub struct PeerWindows {
    /// Bearing of the image.
    pub bearing: BearingMaterial,
    /// `collision` or `friction`.
    pub network: &'static str,
    /// Checksum of the image.
    pub checksum: u32,
    /// Features in a column.
    pub inputs: usize,
    /// Features of all windows, column by column, oldest first.
    pub features: Vec<i16>,
    /// Sum of the head for each window, computed by the controller's code.
    pub sums: Vec<i32>,
    /// Factor of each window from rows: its force in N is `(sum factor)^power`.
    factors: Vec<f64>,
    power: i32,
}

/// Reason why a results file was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ResultsError {
    /// Its first bytes are not those of a results file.
    #[error("results: the first bytes are not those of a file of results of version {VERSION}")]
    Magic,
    /// It has another number of networks.
    #[error("results: found {found} networks, expected {expected}")]
    Networks {
        /// Networks found.
        found: u32,
        /// Networks expected.
        expected: usize,
    },
    /// It is too short or too long.
    #[error("results: found {found} bytes, expected {expected}")]
    Length {
        /// Bytes found.
        found: usize,
        /// Bytes expected.
        expected: usize,
    },
}

/// Sums from another runtime.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Results {
    /// The runtime and its version.
    pub name: String,
    /// True if the runtime uses the same fixed-point arithmetic, so that a difference is an error.
    pub must_be_equal: bool,
    /// Checksum of the image and sums of each network.
    pub networks: Vec<(u32, Vec<i32>)>,
}

/// Comparison of one network with another runtime.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PeerVerdict {
    /// The runtime and its version.
    pub peer: String,
    /// True if a difference is an error.
    pub must_be_equal: bool,
    /// PeerWindows compared.
    pub windows: usize,
    /// PeerWindows with different sums.
    pub different: usize,
    /// Largest difference of two sums, in counts.
    pub largest_counts: u64,
    /// Mean absolute difference of the forces over the windows from rows, in N.
    pub mean_n: f64,
    /// Largest absolute difference of the forces over the windows from rows, in N.
    pub largest_n: f64,
}

/// Reason why the windows could not be generated.
#[derive(Debug, thiserror::Error)]
pub enum WindowsError {
    /// A shipped image does not load.
    #[error("shipped {0}")]
    Image(#[from] ImageError),
    /// A shipped checkpoint does not load.
    #[error("shipped {0}")]
    Checkpoint(#[from] CheckpointError),
}

fn random_window<const C: usize>(draw: &mut Draw) -> [[i16; C]; WINDOW] {
    core::array::from_fn(|_| core::array::from_fn(|_| (draw.below(1 << 16) as i32 - (1 << 15)) as i16))
}

/// Generates the windows of both networks of a bearing.
fn generate_windows_for(bearing: BearingMaterial) -> Result<[PeerWindows; 2], WindowsError> {
    let checkpoint = Checkpoint::from_bytes(shipped_checkpoint(bearing))?;
    let image = shipped(bearing);
    let checksum = image.last_chunk::<CRC_LENGTH>().map_or(0, |sum| u32::from_le_bytes(*sum));
    let model: Model<'_, i16> = Model::load(image)?;
    let features = Features::new(model.header());
    let draw = |network: NetworkKind| {
        let index = u64::from(bearing.code()) << 1 | network as u64;
        Draw::new(checkpoint.recipe.seed, Purpose::PeerWindows, index)
    };
    let [mut first, mut second] = NetworkKind::ALL.map(draw);
    let mut collision: Vec<_> = (0..RANDOM_WINDOWS).map(|_| random_window(&mut first)).collect();
    let mut friction: Vec<_> = (0..RANDOM_WINDOWS).map(|_| random_window(&mut second)).collect();
    let [mut root_factors, mut forces] = [Vec::new(), Vec::new()];
    let set: Vec<_> = draw_test_set(&checkpoint, ROW_WINDOWS).into_iter().map(|(_, states)| states).collect();
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
        PeerWindows {
            bearing,
            network: "collision",
            checksum,
            inputs: collision[0][0].len(),
            sums: head_sums(*model.collision(), &collision),
            features: collision.into_iter().flatten().flatten().collect(),
            factors: root_factors,
            power: 2,
        },
        PeerWindows {
            bearing,
            network: "friction",
            checksum,
            inputs: friction[0][0].len(),
            sums: head_sums(*model.friction(), &friction),
            features: friction.into_iter().flatten().flatten().collect(),
            factors: forces,
            power: 1,
        },
    ])
}

/// Generates the windows of the compared networks: bearings in the order of the files, collision
/// before friction.
///
/// # Errors
///
/// A shipped image or checkpoint does not load.
pub fn generate_windows() -> Result<Vec<PeerWindows>, WindowsError> {
    let mut windows = Vec::new();
    for bearing in MATERIALS {
        windows.extend(generate_windows_for(bearing)?);
    }
    Ok(windows)
}

/// Encodes the windows file.
pub fn to_bytes(windows: &[PeerWindows]) -> Vec<u8> {
    let mut bytes = WINDOWS_MAGIC.to_vec();
    bytes.extend([VERSION, windows.len() as u32].into_iter().flat_map(u32::to_le_bytes));
    for network in windows {
        let counts = [WINDOW, network.inputs, RANDOM_WINDOWS, ROW_WINDOWS].map(|count| count as u32);
        bytes.extend([network.checksum].into_iter().chain(counts).flat_map(u32::to_le_bytes));
        bytes.extend(network.features.iter().flat_map(|level| level.to_le_bytes()));
    }
    bytes
}

impl Results {
    /// Decodes a results file.
    ///
    /// # Errors
    ///
    /// Bytes of another kind or length.
    pub fn from_bytes(bytes: &[u8], must_be_equal: bool) -> Result<Self, ResultsError> {
        const COUNT: usize = RANDOM_WINDOWS + ROW_WINDOWS;
        let expected_networks = 2 * MATERIALS.len();
        let expected = 16 + NAME_LENGTH + expected_networks * (4 + 4 * COUNT);
        let after_magic = bytes.strip_prefix(&results_format::MAGIC).ok_or(ResultsError::Magic)?;
        let (words, _) = after_magic.as_chunks::<4>();
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
            .map(|(checksum, sums)| {
                (u32::from_le_bytes(*checksum), sums.iter().map(|sum| i32::from_le_bytes(*sum)).collect())
            })
            .collect();
        Ok(Self { name, must_be_equal, networks })
    }

    /// Compares one network; None if the results belong to another image.
    pub fn compare(
        &self,
        all: &[PeerWindows],
        bearing: BearingMaterial,
        network: &str,
        image: &[u8],
    ) -> Option<PeerVerdict> {
        let checksum = image.last_chunk::<CRC_LENGTH>().map(|sum| u32::from_le_bytes(*sum))?;
        let position = all.iter().position(|w| w.bearing == bearing && w.network == network)?;
        let (windows, (found_for, found)) = (all.get(position)?, self.networks.get(position)?);
        if *found_for != checksum || windows.checksum != checksum {
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
