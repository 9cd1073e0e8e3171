//! Instructions of a controller tick, counted by the emulator over a cycle of bench B with either bearing.

use crate::run::{ChoreError, cargo, output_of};
use crate::{firmware, setup};
use serde::Serialize;

/// What a tick costs on the Cortex-M4.
#[derive(Serialize)]
struct Counts {
    /// Fewest instructions of any tick.
    estimator_tick_min: u64,
    /// Most instructions of any tick.
    estimator_tick_max: u64,
}

/// Builds the image, runs it in the loop and prints the counts.
pub(crate) fn insn(json: bool) -> Result<(), ChoreError> {
    let way = setup::setup()?;
    firmware::build(&way)?;
    let folder = crate::run::target_folder().join("insn");
    let mut counts = Counts { estimator_tick_min: u64::MAX, estimator_tick_max: 0 };
    for bearing in ["babbitt", "plastic"] {
        let text = output_of(
            cargo()
                .args([
                    "run",
                    "--quiet",
                    "--release",
                    "--package",
                    "host-sim",
                    "--",
                    "run",
                    "--controller",
                    "emulated",
                    "--json",
                ])
                .args(["--bearing", bearing, "--out"])
                .arg(folder.join(bearing)),
        )?;
        let count = |name: &str| {
            serde_json::from_str::<serde_json::Value>(&text)
                .ok()
                .and_then(|run| run.get("estimator")?.get(name)?.as_u64())
                .ok_or_else(|| ChoreError::File {
                    file: folder.join(bearing).join("run.json"),
                    found: format!("no `{name}`"),
                    expected: "an estimator that counts its instructions",
                })
        };
        counts.estimator_tick_min = counts.estimator_tick_min.min(count("instructions_per_tick_min")?);
        counts.estimator_tick_max = counts.estimator_tick_max.max(count("instructions_per_tick_max")?);
    }
    if json {
        println!("{}", serde_json::json!(counts));
    } else {
        println!(
            "estimator tick, Cortex-M4, instructions: {} to {}",
            counts.estimator_tick_min, counts.estimator_tick_max
        );
    }
    Ok(())
}
