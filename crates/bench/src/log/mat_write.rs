//! Writes a log as an uncompressed MAT-file of version 5: one column vector of doubles per signal,
//! named after its channel.

use super::{LogError, MeasuredLog};
use crate::log::TIME;

/// Length of the header's text in bytes.
const TEXT_BYTES: usize = 116;

/// Returns the log as a MAT-file.
pub(super) fn bytes(file: &str, log: &MeasuredLog) -> Result<Vec<u8>, LogError> {
    let mut out = format!("{:<TEXT_BYTES$}", "MATLAB 5.0 MAT-file, measured log").into_bytes();
    out.extend([0; 8]);
    out.extend([0, 1, b'I', b'M']);
    let signals = log.channels.iter().map(|(channel, values)| (channel.name(), values));
    for (name, values) in std::iter::once((TIME, &log.time_s)).chain(signals) {
        let too_long =
            |_| LogError::content(file, format!("{} rows", values.len()), "fewer than 2^28 for a MAT-file");
        let rows = i32::try_from(values.len()).map_err(too_long)?;
        let mut array = Vec::with_capacity(8 * values.len() + 96);
        // Class double, no flags.
        element(&mut array, 6, &[6_u32.to_le_bytes(), [0; 4]].concat()).map_err(too_long)?;
        element(&mut array, 5, &[rows.to_le_bytes(), 1_i32.to_le_bytes()].concat()).map_err(too_long)?;
        element(&mut array, 1, name.as_bytes()).map_err(too_long)?;
        let numbers: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        element(&mut array, 9, &numbers).map_err(too_long)?;
        element(&mut out, 14, &array).map_err(too_long)?;
    }
    Ok(out)
}

fn element(out: &mut Vec<u8>, kind: u32, data: &[u8]) -> Result<(), std::num::TryFromIntError> {
    out.extend(kind.to_le_bytes());
    out.extend(u32::try_from(data.len())?.to_le_bytes());
    out.extend(data);
    out.resize(out.len().next_multiple_of(8), 0);
    Ok(())
}
