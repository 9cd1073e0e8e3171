//! Files of logs, split into columns by name. The format is detected from the first bytes, never
//! from the name alone. A further format is a file here with a [`LogFile`], and a line in [`open`].

mod file;
mod hdf5;
mod mat;
mod mat_write;
mod mcap;
mod mdf;
mod parquet;
mod tdms;
mod text;
mod write;
mod xlsx;

use super::{LogError, TextFormat};
pub(super) use file::{LogFile, MAX_ROWS, MAX_VALUES, Written, list};
use std::fs::File;
use std::io::Read;
use std::path::Path;
pub(super) use text::number::NO_THOUSANDS;
pub(super) use write::{bytes, is_text};

/// Maximum size of a file.
const MAX_FILE_BYTES: u64 = 4 << 30;
/// Number of bytes that are searched for a zero, which no text has.
const SEARCHED_BYTES: usize = 4096;

const READABLE: &str = "CSV text, Parquet, a MAT-file of version 5 to 7.3, HDF5, MDF of version 4, TDMS, \
     MCAP or a workbook (.xlsx)";

/// Reads the bytes of a file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, LogError> {
    let file = path.display().to_string();
    let io = |source| LogError::Io { file: file.clone(), source };
    let opened = File::open(path).map_err(io)?;
    let length = opened.metadata().map_err(io)?.len();
    let bytes = read_at_most(opened, length, MAX_FILE_BYTES).map_err(io)?;
    bytes.ok_or_else(|| {
        let most = format!("at most {} MB; divide the log into several", MAX_FILE_BYTES >> 20);
        LogError::content(&file, format!("more than {} MB", MAX_FILE_BYTES >> 20), most)
    })
}

/// Reads to the end; `None` if it is after `max` bytes. The length is what the file states: a
/// device states 0.
fn read_at_most(source: impl Read, length: u64, max: u64) -> std::io::Result<Option<Vec<u8>>> {
    if length > max {
        return Ok(None);
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(usize::try_from(length).unwrap_or(0))?;
    source.take(max + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= max).then_some(bytes))
}

/// Opens a file and splits it into columns; a text in the described format or a detected one.
pub(super) fn open(
    file: &str,
    bytes: Vec<u8>,
    described: Option<&TextFormat>,
) -> Result<Box<dyn LogFile>, LogError> {
    if bytes.starts_with(parquet::PARQUET) {
        return Ok(Box::new(parquet::Table::open(file, bytes)?));
    }
    if bytes.starts_with(hdf5::MAT_73) || bytes.starts_with(hdf5::HDF5) {
        return Ok(Box::new(hdf5::Hdf5::open(file, bytes)?));
    }
    if bytes.starts_with(mdf::MDF) || bytes.starts_with(mdf::UNFINISHED) {
        return Ok(Box::new(mdf::Mdf::open(file, bytes)?));
    }
    if bytes.starts_with(tdms::TDMS) {
        return Ok(Box::new(tdms::Tdms::open(file, bytes)?));
    }
    if bytes.starts_with(mcap::MCAP) {
        return Ok(Box::new(mcap::Mcap::open(file, &bytes)?));
    }
    mcap::refuse_other(file, &bytes)?;
    if bytes.starts_with(xlsx::ZIP) {
        return Ok(Box::new(xlsx::Workbook::open(file, &bytes)?));
    }
    if mat::is_mat(&bytes) {
        return Ok(Box::new(mat::Variables::open(file, &bytes)?));
    }
    let text = decoded(bytes).ok_or_else(|| LogError::content(file, "an unknown binary file", READABLE))?;
    Ok(Box::new(text::Text::open(file, &text, described)?))
}

/// Decodes a text: UTF-16 with a byte order mark, UTF-8, else Latin-1. `None` if it contains zeros.
fn decoded(bytes: Vec<u8>) -> Option<String> {
    let utf_16 = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units = bytes.chunks_exact(2).filter_map(|pair| pair.try_into().ok()).map(unit);
        char::decode_utf16(units).map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
    };
    match bytes.as_slice() {
        [0xff, 0xfe, rest @ ..] => return Some(utf_16(rest, u16::from_le_bytes)),
        [0xfe, 0xff, rest @ ..] => return Some(utf_16(rest, u16::from_be_bytes)),
        _ if bytes.iter().take(SEARCHED_BYTES).any(|&b| b == 0) => return None,
        _ => {}
    }
    let other = |e: std::string::FromUtf8Error| {
        let bytes = e.as_bytes();
        // A byte order mark, or a last character that is cut off: UTF-8 with a damaged place.
        let is_utf_8 = bytes.starts_with(b"\xef\xbb\xbf") || e.utf8_error().error_len().is_none();
        match is_utf_8 {
            true => String::from_utf8_lossy(bytes).into_owned(),
            false => bytes.iter().copied().map(char::from).collect(),
        }
    };
    Some(String::from_utf8(bytes).unwrap_or_else(other))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reading_ends_after_the_maximum() {
        for (length, expected) in [(9, Some(9)), (10, Some(10)), (11, None)] {
            let bytes = read_at_most(&[7_u8; 11][..length], 0, 10).unwrap();
            assert_eq!(bytes.map(|bytes| bytes.len()), expected);
        }
        assert_eq!(read_at_most(std::io::repeat(0), 0, 1000).unwrap(), None);
        assert_eq!(read_at_most(std::io::empty(), 1001, 1000).unwrap(), None);
    }
}
