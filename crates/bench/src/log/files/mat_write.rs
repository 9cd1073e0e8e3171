//! Writes a log as an uncompressed MAT-file of version 5: one column vector of doubles per signal,
//! with its name as far as MATLAB allows it.

use super::file::Written;
use crate::log::LogError;
use std::collections::HashSet;

/// Length of the header's text in bytes.
const TEXT_BYTES: usize = 116;
/// Maximum length of a name, with room for a number; MATLAB allows 63.
const MAX_LETTERS: usize = 55;

/// Returns the log as a MAT-file.
pub(super) fn bytes(file: &str, columns: &[Written<'_>]) -> Result<Vec<u8>, LogError> {
    let mut out = format!("{:<TEXT_BYTES$}", "MATLAB 5.0 MAT-file, measured log").into_bytes();
    out.extend([0; 8]);
    out.extend([0, 1, b'I', b'M']);
    let mut taken = HashSet::new();
    for Written { name, values, .. } in columns {
        let name = variable(name, &mut taken);
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

/// Name of a variable: letters, digits and `_` after a letter, each name once.
fn variable(name: &str, taken: &mut HashSet<String>) -> String {
    let valid = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
    let mut out: String = name.chars().map(valid).take(MAX_LETTERS).collect();
    if !out.starts_with(|letter: char| letter.is_ascii_alphabetic()) {
        out.insert(0, 'x');
    }
    let mut unique = out.clone();
    for number in 2.. {
        if taken.insert(unique.clone()) {
            break;
        }
        unique = format!("{out}_{number}");
    }
    unique
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_becomes_one_that_matlab_allows() {
        let mut taken = HashSet::new();
        let names = ["t_s", "Weg [mm]", "Weg (mm)", "2nd", "_x", "Kraft/N"];
        let found: Vec<String> = names.iter().map(|name| variable(name, &mut taken)).collect();
        assert_eq!(found, ["t_s", "Weg__mm_", "Weg__mm__2", "x2nd", "x_x", "Kraft_N"]);
    }
}
