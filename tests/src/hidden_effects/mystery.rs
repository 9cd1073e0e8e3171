//! A log for a person: it hides an effect, to be found with `host-sim diagnose`.
//!
//! The effect is drawn as for the matrix. The label is plain JSON in the folder `label` beside the
//! log, so that it is not read by accident. The command shows it once there is a `diagnosis.json`.

use super::CampaignError;
use super::cell::{Arm, Cell, hash};
use super::cell_run::hide;
use crate::generator::hidden::HiddenEffect;
use crate::generator::noise::Noise;
use crate::generator::plant::Plant;
use crate::generator::record::{Point, Record};
use crate::generator::size::Scale;
use crate::generator::vocabulary::effects;
use bench::atomic;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Maximum deviation of the real plant from its description, in declared standard deviations.
const SPREAD: f64 = 0.8;
/// One log in this many hides no effect.
const CLEAN: f64 = 8.0;
/// Maximum number of effects to try until the plant can show one at the requested size.
const MAX_TRIES: u64 = 50;

/// File of the log.
pub const LOG: &str = "log.csv";
/// File of the user's description of the plant.
pub const BENCH: &str = "bench.toml";
/// File of the label.
pub(crate) const LABEL: &str = "label/label.json";
/// File that must exist before the label is shown.
pub(crate) const DIAGNOSIS: &str = "diagnosis.json";

/// Content of a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Label {
    /// Hidden effects; none in a clean log.
    pub effects: Vec<HiddenEffect>,
    /// Their sizes.
    pub sizes: Vec<f64>,
}

fn failed(file: &Path, expected: &'static str) -> impl Fn(&dyn std::fmt::Display) -> CampaignError + use<> {
    let file = file.display().to_string();
    move |found| CampaignError::File { file: file.clone(), found: found.to_string(), expected }
}

/// Writes a log that hides an effect of a size, or none, with description and label.
///
/// # Errors
///
/// The folder cannot be written to, or the plant shows no effect at the size.
pub fn deal(folder: &Path, plant: Plant, size: f64, seed: u64) -> Result<(), CampaignError> {
    let all = effects(plant);
    let mut choice = Noise::new(seed);
    let clean = choice.uniform() * CLEAN < 1.0;
    for attempt in 0..MAX_TRIES {
        let effect = all[((choice.uniform() * all.len() as f64) as usize).min(all.len() - 1)];
        let (effects, sizes) = if clean { (vec![], vec![]) } else { (vec![effect.to_owned()], vec![size]) };
        let cell =
            Cell { index: 0, arm: Arm::Single, plant, effects, sizes: sizes.clone(), variant: 0, seed };
        let mut noise = Noise::new(hash("mystery", seed) ^ attempt);
        let record = Record::draw(plant, SPREAD, Point::default(), &mut noise);
        let Some(effects) = hide(&cell, &Scale::new(&record), &record, &mut noise) else { continue };
        let log = record.log(&effects, &mut noise);
        let label = serde_json::to_vec_pretty(&Label { effects, sizes })
            .map_err(|error| failed(folder, "a label")(&error))?;
        return write(folder, &log, plant, &label);
    }
    let found = format!("no effect that is visible at size {size}");
    Err(CampaignError::File { file: plant.name().into(), found, expected: "an effect within its bounds" })
}

fn write(folder: &Path, log: &str, plant: Plant, label: &[u8]) -> Result<(), CampaignError> {
    // The diagnosis of an earlier log would show this label.
    match std::fs::remove_file(folder.join(DIAGNOSIS)) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(failed(&folder.join(DIAGNOSIS), "a file that can be removed")(&error));
        }
        _ => {}
    }
    for (name, bytes) in [(LOG, log.as_bytes()), (BENCH, plant.description().as_bytes()), (LABEL, label)] {
        let file = folder.join(name);
        atomic::write(&file, bytes).map_err(|error| failed(&file, "a file that can be written")(&error))?;
    }
    Ok(())
}

/// Reads the label of a folder that has a diagnosis.
///
/// # Errors
///
/// There is no diagnosis yet, or no label.
pub fn reveal(folder: &Path) -> Result<Label, CampaignError> {
    if !folder.join(DIAGNOSIS).is_file() {
        return Err(CampaignError::NoDiagnosis { name: folder.display().to_string() });
    }
    let file = folder.join(LABEL);
    let error = failed(&file, "the label of a log of `cargo xtask mystery`");
    let bytes = std::fs::read(&file).map_err(|found| error(&found))?;
    serde_json::from_slice(&bytes).map_err(|found| error(&found))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_is_shown_after_a_diagnosis_and_a_seed_gives_the_same_log() {
        let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        for folder in &folders {
            deal(folder.path(), Plant::Linear, 1.0, 7).unwrap();
        }
        let read = |i: usize, name: &str| std::fs::read(folders[i].path().join(name)).unwrap();
        assert!([LOG, BENCH, LABEL].iter().all(|name| read(0, name) == read(1, name)));
        let refused = reveal(folders[0].path()).unwrap_err().to_string();
        assert!(refused.contains("found no diagnosis.json"), "{refused}");
        std::fs::write(folders[0].path().join(DIAGNOSIS), "{}").unwrap();
        let label = reveal(folders[0].path()).unwrap();
        assert!(label.effects.len() <= 1 && label.sizes.len() == label.effects.len());
        // A new log removes the diagnosis of the earlier one.
        deal(folders[0].path(), Plant::Linear, 1.0, 8).unwrap();
        assert!(reveal(folders[0].path()).is_err());
    }

    #[test]
    fn some_logs_hide_nothing_and_others_different_things() {
        let folder = tempfile::tempdir().unwrap();
        let mut hidden = std::collections::BTreeSet::new();
        for seed in 0..24 {
            deal(folder.path(), Plant::Linear, 1.0, seed).unwrap();
            std::fs::write(folder.path().join(DIAGNOSIS), "{}").unwrap();
            let label = reveal(folder.path()).unwrap();
            hidden.insert(label.effects.first().map(|e| e.effect.clone()));
        }
        assert!(hidden.contains(&None) && hidden.len() > 6, "{hidden:?}");
    }
}
