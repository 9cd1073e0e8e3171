//! The journal of a campaign. Its header holds the checksum of the running program beside the
//! campaign's own identity, so results of another build belong to another campaign.

pub use host_sim::journal::{Journal, JournalError};

use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;

/// CRC-32 of Ethernet.
const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// First line of the file.
#[derive(Serialize)]
struct Header<C> {
    campaign: C,
    program: u32,
}

/// Opens the journal of a campaign, new or existing, and returns the results in it.
pub fn open<C: Serialize, R: DeserializeOwned>(
    path: &Path,
    campaign: C,
) -> Result<(Journal, Vec<R>), JournalError> {
    Journal::open(path, &header(campaign)?)
}

/// Header of the journals of a campaign that this program runs.
pub fn header<C: Serialize>(campaign: C) -> Result<impl Serialize, JournalError> {
    let program = std::env::current_exe().map_err(|source| unusable(Path::new("this program"), source))?;
    Ok(Header { campaign, program: checksum(&program)? })
}

/// Checksum of a file.
pub fn checksum(path: &Path) -> Result<u32, JournalError> {
    let bytes = std::fs::read(path).map_err(|source| unusable(path, source))?;
    Ok(CRC.checksum(&bytes))
}

fn unusable(path: &Path, source: std::io::Error) -> JournalError {
    JournalError::Unusable { file: path.display().to_string(), source }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_of_another_build_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let open = |campaign: u32| open::<u32, (u32, f64)>(&path, campaign);
        open(2).unwrap().0.append(&(7, 0.5)).unwrap();
        assert_eq!(open(2).unwrap().1, [(7, 0.5)]);
        assert!(open(3).unwrap_err().to_string().contains("campaign: found 2, expected 3"));
        let text = std::fs::read_to_string(&path).unwrap();
        let program = format!("\"program\":{}", checksum(&std::env::current_exe().unwrap()).unwrap());
        assert!(text.contains(&program), "{text}");
        std::fs::write(&path, text.replacen(&program, "\"program\":1", 1)).unwrap();
        assert!(open(2).unwrap_err().to_string().contains("program: found 1"));
    }
}
