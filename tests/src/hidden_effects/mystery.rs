//! A log for people: an effect that nobody tells, to be found with `host-sim diagnose`, and its label to check the answer with.
//!
//! Drawn as for the matrix. The label lies beside the log, enciphered with the eight bytes that it begins with: that keeps it from being read by
//! accident, nothing more. It opens once there is a `diagnosis.json` in the folder.

use super::CampaignError;
use super::cell::{Arm, Cell};
use super::run::hide;
use super::seal::{Label, cipher, name_of};
use crate::generator::noise::Noise;
use crate::generator::session::{Plant, Point, Session};
use crate::generator::size::Scale;
use crate::generator::vocabulary::effects;
use bench::atomic;
use std::path::Path;

/// Deviations of the real plant from its description, in declared standard deviations.
const SPREAD: f64 = 0.8;
/// One log in so many hides nothing.
const CLEAN: f64 = 8.0;
/// Effects that are tried before one is found that the plant can show as large as wanted.
const TRIES: u64 = 50;

/// The log.
pub const LOG: &str = "log.csv";
/// The user's description of the plant.
pub const BENCH: &str = "bench.toml";
/// What the log hides.
pub const SEALED: &str = "sealed.label";
/// What has to be there before the label opens.
pub const DIAGNOSIS: &str = "diagnosis.json";

fn failed(file: &Path, expected: &'static str) -> impl Fn(&dyn std::fmt::Display) -> CampaignError + use<> {
    let file = file.display().to_string();
    move |found| CampaignError::File { file: file.clone(), found: found.to_string(), expected }
}

/// Writes a log that hides an effect of a size, or nothing, with description and sealed label.
///
/// # Errors
///
/// The folder cannot be written to.
pub fn deal(folder: &Path, plant: Plant, size: f64, seed: u64) -> Result<(), CampaignError> {
    let all = effects(plant);
    let mut choice = Noise::new(seed);
    let clean = choice.uniform() * CLEAN < 1.0;
    let key = u64::from_str_radix(name_of("mystery", seed).get(..16).unwrap_or("0"), 16).unwrap_or(seed);
    for attempt in 0..TRIES {
        let effect = all[((choice.uniform() * all.len() as f64) as usize).min(all.len() - 1)];
        let (effects, sizes) = if clean { (vec![], vec![]) } else { (vec![effect.to_owned()], vec![size]) };
        let cell =
            Cell { index: 0, arm: Arm::Single, plant, effects, sizes: sizes.clone(), variant: 0, seed };
        let mut noise = Noise::new(key ^ attempt);
        let session = Session::draw(plant, SPREAD, Point::default(), &mut noise);
        let Some(effects) = hide(&cell, &Scale::new(&session), &session, &mut noise) else { continue };
        let log = session.log(&effects, &mut noise);
        let label =
            serde_json::to_vec(&Label { effects, sizes }).map_err(|e| failed(folder, "a label")(&e))?;
        let mut sealed = label;
        cipher(&mut sealed, key);
        let sealed: Vec<u8> = key.to_le_bytes().into_iter().chain(sealed).collect();
        // A diagnosis of another log would open this label.
        match std::fs::remove_file(folder.join(DIAGNOSIS)) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                return Err(failed(&folder.join(DIAGNOSIS), "a file that can be removed")(&e));
            }
            _ => {}
        }
        for (name, bytes) in
            [(LOG, log.as_bytes()), (BENCH, plant.description().as_bytes()), (SEALED, &sealed[..])]
        {
            let file = folder.join(name);
            atomic::write(&file, bytes).map_err(|e| failed(&file, "a file that can be written")(&e))?;
        }
        return Ok(());
    }
    let found = format!("no effect that is seen at size {size}");
    Err(CampaignError::File { file: plant.name().into(), found, expected: "one within its bounds" })
}

/// Opens the label of a folder that has an answer.
///
/// # Errors
///
/// There is no answer yet, or no label.
pub fn reveal(folder: &Path) -> Result<Label, CampaignError> {
    if !folder.join(DIAGNOSIS).is_file() {
        return Err(CampaignError::Sealed { name: folder.display().to_string() });
    }
    let file = folder.join(SEALED);
    let error = failed(&file, "the label of a dealt log");
    let bytes = std::fs::read(&file).map_err(|e| error(&e))?;
    let (key, label) = bytes.split_first_chunk::<8>().ok_or_else(|| error(&"fewer than 8 bytes"))?;
    let mut label = label.to_vec();
    cipher(&mut label, u64::from_le_bytes(*key));
    serde_json::from_slice(&label).map_err(|e| error(&e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_opens_after_an_answer_and_the_same_seed_deals_the_same_log() {
        let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        for folder in &folders {
            deal(folder.path(), Plant::Linear, 1.0, 7).unwrap();
        }
        let read = |i: usize, name: &str| std::fs::read(folders[i].path().join(name)).unwrap();
        assert!([LOG, BENCH, SEALED].iter().all(|name| read(0, name) == read(1, name)));
        let refused = reveal(folders[0].path()).unwrap_err().to_string();
        assert!(refused.contains("is sealed"), "{refused}");
        std::fs::write(folders[0].path().join(DIAGNOSIS), "{}").unwrap();
        let label = reveal(folders[0].path()).unwrap();
        assert!(label.effects.len() <= 1 && label.sizes.len() == label.effects.len());
        // What opened this one does not open the next.
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
