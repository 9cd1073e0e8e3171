//! Sealed labels: what a log hides is written down before the engine sees the log and read after it has answered.
//!
//! A log is named by a hash of its cell and seed. Its label lies beside it, enciphered by a stream of the same seed, so neither
//! name nor bytes tell. [`Answer`] exists only once an answer is on the disk, and a label opens only to the answer of
//! its own name. That keeps an honest program honest; it is no protection against one that wants to cheat.

use super::CampaignError;
use crate::generator::hidden::HiddenEffect;
use bench::atomic;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::path::{Path, PathBuf};

/// What a log hides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Label {
    /// The effects; none in a clean log.
    pub effects: Vec<HiddenEffect>,
    /// Their sizes.
    pub sizes: Vec<f64>,
}

/// A sealed label.
pub struct Sealed {
    file: PathBuf,
    name: String,
    key: u64,
}

/// An answer that is written down.
pub struct Answer {
    name: String,
    file: PathBuf,
}

fn scramble(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The name of a log: tells nothing.
pub fn name_of(cell: &str, seed: u64) -> String {
    let fold = |start: u64| {
        cell.bytes()
            .fold(start ^ seed, |h, b| scramble(h.rotate_left(7) ^ u64::from(b)).wrapping_add(0x9e37_79b9))
    };
    format!("{:016x}{:016x}", fold(0x243f_6a88_85a3_08d3), fold(0x1319_8a2e_0370_7344))
}

pub(super) fn cipher(bytes: &mut [u8], key: u64) {
    for (block, chunk) in bytes.chunks_mut(8).enumerate() {
        let stream = scramble(key ^ scramble(block as u64 + 1)).to_le_bytes();
        chunk.iter_mut().zip(stream).for_each(|(b, s)| *b ^= s);
    }
}

fn failed(file: &Path, expected: &'static str) -> impl Fn(&dyn std::fmt::Display) -> CampaignError + use<> {
    let file = file.display().to_string();
    move |e| CampaignError::File { file: file.clone(), found: e.to_string(), expected }
}

impl Sealed {
    /// Writes a label under a name.
    pub fn close(folder: &Path, name: &str, key: u64, label: &Label) -> Result<Self, CampaignError> {
        let file = folder.join(format!("{name}.label"));
        let error = failed(&file, "a file that can be written");
        let mut bytes = serde_json::to_vec(label).map_err(|e| error(&e))?;
        cipher(&mut bytes, key);
        atomic::write(&file, &bytes).map_err(|e| error(&e))?;
        Ok(Self { file, name: name.into(), key })
    }

    /// Opens the label for the answer to its log.
    pub fn open(self, answer: &Answer) -> Result<Label, CampaignError> {
        if answer.name != self.name || !answer.file.is_file() {
            return Err(CampaignError::Sealed { name: self.name });
        }
        let error = failed(&self.file, "a sealed label");
        let mut bytes = std::fs::read(&self.file).map_err(|e| error(&e))?;
        cipher(&mut bytes, self.key);
        read(&bytes, &error)
    }
}

fn read<T: DeserializeOwned>(
    bytes: &[u8],
    error: &dyn Fn(&dyn std::fmt::Display) -> CampaignError,
) -> Result<T, CampaignError> {
    serde_json::from_slice(bytes).map_err(|e| error(&e))
}

impl Answer {
    /// Writes the engine's answer down.
    pub fn write(folder: &Path, name: &str, answer: &impl Serialize) -> Result<Self, CampaignError> {
        let file = folder.join(format!("{name}.answer.json"));
        let error = failed(&file, "a file that can be written");
        let bytes = serde_json::to_vec(answer).map_err(|e| error(&e))?;
        atomic::write(&file, &bytes).map_err(|e| error(&e))?;
        Ok(Self { name: name.into(), file })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label() -> Label {
        Label { effects: vec![HiddenEffect::new("breakaway", &[("excess_effort", 4.0)])], sizes: vec![0.5] }
    }

    #[test]
    fn a_label_opens_to_its_own_answer_only() {
        let folder = tempfile::tempdir().unwrap();
        let (one, two) = (name_of("cell 1", 4), name_of("cell 2", 4));
        let other = Answer::write(folder.path(), &two, &"none").unwrap();
        let sealed = Sealed::close(folder.path(), &one, 9, &label()).unwrap();
        let refused = sealed.open(&other).unwrap_err().to_string();
        assert!(refused.contains("is sealed") && refused.contains(&one), "{refused}");
        let sealed = Sealed::close(folder.path(), &one, 9, &label()).unwrap();
        let own = Answer::write(folder.path(), &one, &"none").unwrap();
        assert_eq!(sealed.open(&own).unwrap(), label());
    }

    #[test]
    fn neither_name_nor_bytes_tell_what_is_hidden() {
        let folder = tempfile::tempdir().unwrap();
        let name = name_of("breakaway", 4);
        Sealed::close(folder.path(), &name, 9, &label()).unwrap();
        let bytes = std::fs::read(folder.path().join(format!("{name}.label"))).unwrap();
        assert!(!name.contains("break") && !String::from_utf8_lossy(&bytes).contains("break"));
        assert_ne!(name_of("breakaway", 5), name);
    }
}
