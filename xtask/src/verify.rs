//! `model-quant verify` with the emulated core as one of the runtimes.

use crate::cores::COUNTED;
use crate::run::{ChoreError, of_file, run, target_folder};
use crate::workspace;
use inference::shipped;

#[path = "../../model-quant/src/evaluate/results_format.rs"]
mod results_format;

/// Name of the runtime in a file of results.
const NAME: &[u8] = b"emulated Cortex-M4";

/// Runs the windows of `model-quant/peers` on the emulated core and verifies the shipped images
/// against its results.
pub(crate) fn verify() -> Result<(), ChoreError> {
    crate::setup::setup()?;
    let image = COUNTED.build("replay")?;
    let text = COUNTED.run(&image)?;
    let sums: Option<Vec<i32>> = text.lines().map(|line| line.parse().ok()).collect();
    let networks = 2 * results_format::MATERIALS.len();
    let windows = sums.as_ref().map_or(0, |sums| sums.len() / networks);
    let sums = sums.filter(|sums| windows > 0 && sums.len() == networks * windows).ok_or_else(|| {
        ChoreError::File {
            file: image,
            found: format!("{} lines", text.lines().count()),
            expected: "an integer for every window of four networks",
        }
    })?;
    let mut bytes = results_format::MAGIC.to_vec();
    bytes.extend([results_format::VERSION, networks as u32].map(u32::to_le_bytes).as_flattened());
    bytes.extend(NAME);
    bytes.resize(bytes.len() + results_format::NAME_LENGTH - NAME.len(), 0);
    let bearings = results_format::MATERIALS.iter().flat_map(|&bearing| [bearing, bearing]);
    for (sums, bearing) in sums.chunks(windows).zip(bearings) {
        bytes.extend(shipped(bearing).last_chunk::<4>().into_iter().flatten());
        bytes.extend(sums.iter().flat_map(|sum| sum.to_le_bytes()));
    }
    let file = target_folder().join("on-target/sums.bin");
    std::fs::write(&file, bytes).map_err(of_file(&file, "a file that can be written"))?;
    run(workspace::program("model-quant")?.args(["verify", "--emulated"]).arg(&file))
}
