//! Instructions on the Cortex-M4, counted by the emulator.
//!
//! Counted are the reference network, its layers, the shipped pairs of networks, and a controller
//! tick. The tick runs over a cycle of bench B with either bearing, and over disturbed samples.

use crate::cores::COUNTED;
use crate::counts::{Counts, Figure};
use crate::kernels::SmallestImage;
use crate::run::{ChoreError, output_of};
use crate::{firmware, setup, workspace};
use inference::BearingMaterial;
use std::collections::BTreeMap;

/// Counts everything.
pub(crate) fn count() -> Result<Counts, ChoreError> {
    setup::setup()?;
    let image = COUNTED.build("count")?;
    let text = COUNTED.run(&image)?;
    let mut figures = BTreeMap::new();
    for line in text.lines() {
        let (name, figure) = Figure::parse(line).ok_or_else(|| ChoreError::File {
            file: image.clone(),
            found: format!("it printed `{line}`"),
            expected: "a name and three numbers",
        })?;
        figures.insert(name, figure);
    }
    let max = |name: &str| {
        figures.get(name).map(|figure: &Figure| figure.max).ok_or_else(|| ChoreError::File {
            file: image.clone(),
            found: format!("no `{name}`"),
            expected: "all figures",
        })
    };
    let (reference_window, reference_stream) = (max("reference_window")?, max("reference_stream")?);
    let (reference_reuse, pair_ram_bytes) = (max("reference_reuse")?, max("pair_bytes")?);
    figures.remove("pair_bytes");
    firmware::DEFAULT.build()?;
    let (estimator_tick_min, estimator_tick_max) = ticks()?;
    Ok(Counts {
        reference_window,
        reference_stream,
        reference_reuse,
        estimator_tick_min,
        estimator_tick_max,
        disturbed_tick_max: disturbed_ticks()?,
        pair_ram_bytes,
        smallest_flash_bytes: SmallestImage::build(COUNTED)?.flash_bytes,
        figures,
    })
}

/// Returns the minimum and maximum instructions of a tick over a cycle of bench B, for both
/// bearings.
fn ticks() -> Result<(u64, u64), ChoreError> {
    let folder = crate::run::target_folder().join("insn");
    let (mut min, mut max) = (u64::MAX, 0);
    for bearing in BearingMaterial::ALL.map(BearingMaterial::name) {
        let mut command = workspace::program("host-sim")?;
        command.args(["run", "--controller", "emulated", "--json", "--bearing", bearing, "--out"]);
        let text = output_of(command.arg(folder.join(bearing)))?;
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
        min = min.min(count("instructions_per_tick_min")?);
        max = max.max(count("instructions_per_tick_max")?);
    }
    Ok((min, max))
}

/// Reads the maximum over disturbed samples from the output of the test that measures it.
fn disturbed_ticks() -> Result<u64, ChoreError> {
    const TEST: &str = "ticks::no_tick_exceeds_its_budget_whatever_the_samples";
    let text = output_of(workspace::emulator_test(TEST).arg("--nocapture"))?;
    let max = text.lines().find_map(|line| {
        let (_, max) = line.split_once("disturbed ticks: ")?.1.split_once(" to ")?;
        max.strip_suffix(" instructions")?.parse().ok()
    });
    max.ok_or_else(|| ChoreError::Differs {
        what: format!("output of {TEST}"),
        found: text,
        expected: "`disturbed ticks: A to B instructions`".into(),
    })
}

/// Counts and prints the figures.
pub(crate) fn insn(json: bool) -> Result<(), ChoreError> {
    let counts = count()?;
    if json {
        println!("{}", serde_json::json!(counts));
    } else {
        print!("{}", crate::table::render(&counts));
    }
    Ok(())
}
