//! Files of logs, split into columns by name. The format is detected from the first bytes, never
//! from the name alone. A further format is a file here with a [`LogFile`], and a line in [`open`].

mod file;
mod hdf5;
mod mat;
mod mat_write;
mod mdf;
mod parquet;
mod tdms;
mod text;
mod write;
mod xlsx;

use super::{LogError, TextFormat};
pub(super) use file::{LogFile, MAX_ROWS, MAX_VALUES, list};
pub(super) use text::number::NO_THOUSANDS;
pub(super) use write::{Written, bytes, is_text};

/// Maximum size of a file.
const MAX_FILE_BYTES: u64 = 4 << 30;
/// Number of bytes that are searched for a zero, which no text has.
const SEARCHED_BYTES: usize = 4096;

const READABLE: &str =
    "CSV text, Parquet, a MAT-file of version 5 to 7.3, HDF5, MDF of version 4, TDMS or a workbook (.xlsx)";

/// Reads the bytes of a file.
pub(super) fn read(path: &std::path::Path) -> Result<Vec<u8>, LogError> {
    let file = path.display().to_string();
    let io = |source| LogError::Io { file: file.clone(), source };
    let length = std::fs::metadata(path).map_err(io)?.len();
    if length > MAX_FILE_BYTES {
        let most = format!("at most {} MB; divide the log into several", MAX_FILE_BYTES >> 20);
        return Err(LogError::content(&file, format!("{} MB", length >> 20), most));
    }
    std::fs::read(path).map_err(io)
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
