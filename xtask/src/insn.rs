//! Instructions on the Cortex-M4, counted by the emulator: the reference network, the layers, the shipped pairs, and a controller
//! tick over a cycle of bench B with either bearing, and over troubled samples.

use crate::boards::COUNTED;
use crate::kernels::Least;
use crate::run::{ChoreError, cargo, output_of};
use crate::{firmware, setup};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Everything counted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Counts {
    /// The reference network over a whole window of 32 columns.
    pub(crate) reference_window: u64,
    /// The same as a causal stream, per new column.
    pub(crate) reference_stream: u64,
    /// The same over a window that moved on by one column, 'same' padding, exact reuse.
    pub(crate) reference_reuse: u64,
    /// Fewest instructions of any controller tick.
    pub(crate) estimator_tick_min: u64,
    /// Most instructions of any controller tick.
    pub(crate) estimator_tick_max: u64,
    /// Most instructions of a controller tick over samples with every fault there is, restarts of the history among them.
    pub(crate) troubled_tick_max: u64,
    /// RAM of the two networks of a bearing with their history, in bytes.
    pub(crate) pair_ram_bytes: u64,
    /// Flash of the least image that estimates, model included, in bytes.
    pub(crate) least_flash_bytes: u64,
    /// Every figure by name.
    pub(crate) figures: BTreeMap<String, Figure>,
}

/// One figure over 1000 random inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Figure {
    /// Fewest instructions.
    pub(crate) min: u64,
    /// Most instructions.
    pub(crate) max: u64,
    /// Multiply-accumulates.
    pub(crate) macs: u64,
}

impl Figure {
    /// A line of the image: name, min, max, multiply-accumulates.
    fn parse(line: &str) -> Option<(String, Self)> {
        let mut words = line.split_whitespace();
        let name = words.next()?.to_owned();
        let [min, max, macs] =
            [words.next()?.parse().ok()?, words.next()?.parse().ok()?, words.next()?.parse().ok()?];
        Some((name, Self { min, max, macs }))
    }
}

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
    let most = |name: &str| {
        figures.get(name).map(|figure: &Figure| figure.max).ok_or_else(|| ChoreError::File {
            file: image.clone(),
            found: format!("no `{name}`"),
            expected: "every figure",
        })
    };
    let (reference_window, reference_stream) = (most("reference_window")?, most("reference_stream")?);
    let (reference_reuse, pair_ram_bytes) = (most("reference_reuse")?, most("pair_bytes")?);
    figures.remove("pair_bytes");
    firmware::DEFAULT.build()?;
    let (estimator_tick_min, estimator_tick_max) = ticks()?;
    Ok(Counts {
        reference_window,
        reference_stream,
        reference_reuse,
        estimator_tick_min,
        estimator_tick_max,
        troubled_tick_max: troubled_ticks()?,
        pair_ram_bytes,
        least_flash_bytes: Least::of(COUNTED)?.flash_bytes,
        figures,
    })
}

/// Fewest and most instructions of a tick over a cycle of bench B, both bearings.
fn ticks() -> Result<(u64, u64), ChoreError> {
    let folder = crate::run::target_folder().join("insn");
    let (mut least, mut most) = (u64::MAX, 0);
    for bearing in ["babbitt", "plastic"] {
        let mut command = cargo();
        command.args(["run", "--quiet", "--package", "host-sim", "--", "run"]);
        command.args(["--controller", "emulated", "--json", "--bearing", bearing, "--out"]);
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
        least = least.min(count("instructions_per_tick_min")?);
        most = most.max(count("instructions_per_tick_max")?);
    }
    Ok((least, most))
}

/// What the test of the emulator's ticks says of troubled samples.
fn troubled_ticks() -> Result<u64, ChoreError> {
    const TEST: &str = "ticks::no_tick_exceeds_its_budget_and_its_cost_does_not_depend_on_the_data";
    let mut command = cargo();
    command.args(["test", "--quiet", "--package", "system-tests", "--features", "emulated"]);
    let text = output_of(command.args(["--test", "emulator", "--", "--exact", TEST, "--nocapture"]))?;
    let most = text.lines().find_map(|line| {
        let (_, most) = line.split_once("troubled ticks: ")?.1.split_once(" to ")?;
        most.strip_suffix(" instructions")?.parse().ok()
    });
    most.ok_or_else(|| ChoreError::Differs {
        what: format!("what {TEST} says"),
        found: text,
        expected: "`troubled ticks: A to B instructions`".into(),
    })
}

/// Counts and prints.
pub(crate) fn insn(json: bool) -> Result<(), ChoreError> {
    let counts = count()?;
    if json {
        println!("{}", serde_json::json!(counts));
    } else {
        print!("{}", crate::table::render(&counts));
    }
    Ok(())
}
