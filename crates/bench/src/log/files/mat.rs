//! MAT-files of version 5 to 7 (`save -v6`, `-v7`; Octave and SciPy write them too), in either byte
//! order.
//!
//! Numeric and logical arrays are listed: vectors by the name of their variable (`qm`), fields of a
//! struct with a point (`data.qm`, also deeper), the columns of a matrix with their number
//! (`data(:,2)`). Everything else keeps its name and is refused when a column asks for it: text,
//! cells, arrays of structs, sparse or complex arrays, and objects such as `string`, `datetime` and
//! `table`.
//!
//! This is own code because the published readers do not know structs, take `int32` for `uint32`,
//! or panic on a damaged file. Layout: "MAT-File Format", MathWorks, chapter 1, "Level 5 MAT-File
//! Format". An element is a tag (type, bytes) and data padded to 8 bytes. Up to 4 bytes of data
//! share the first 8 bytes with their tag. A compressed element contains another element as zlib
//! data. Not documented there: a MATLAB object has its name where others have dimensions, and all
//! objects share a nameless last variable.

use super::file::{LogFile, MAX_COLUMNS, MAX_NAMES, MAX_VALUES};
use crate::log::LogError;
use std::io::Read;

/// First bytes of a file.
const MAT_5: &[u8] = b"MATLAB 5.0 MAT-file";
const HEADER_BYTES: usize = 128;
/// Maximum depth of nested structs.
const MAX_DEPTH: usize = 8;
/// Maximum size of a compressed element: a struct or a matrix with all signals of a long log.
const MAX_BYTES: u64 = 1 << 30;

const INT32: u32 = 5;
const UINT32: u32 = 6;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

const STRUCT: u8 = 2;
const OPAQUE: u8 = 17;
const NUMERIC: std::ops::RangeInclusive<u8> = 6..=15;
const COMPLEX: u8 = 0x08;

const NO_NUMBERS: &str = "no numbers (text, a cell, an object or a sparse array)";
const COMPLETE: &str = "a complete MAT-file of version 5 to 7";

/// Reason to stop parsing a file.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Flaw {
    Damage,
    TooLarge,
}

/// Returns whether bytes are those of a MAT-file.
pub(super) fn is_mat(bytes: &[u8]) -> bool {
    // Other writers begin with their own text; version and byte order follow at its end.
    let is_marked = matches!(bytes.get(124..128), Some([0, 1, b'I', b'M'] | [1, 0, b'M', b'I']));
    is_marked || bytes.starts_with(MAT_5)
}

/// Numeric arrays of a file.
pub(super) struct Variables {
    names: Vec<String>,
    contents: Vec<Content>,
    values: usize,
}

/// Numbers, or the name of other content.
type Content = Result<Vec<f64>, &'static str>;

impl Variables {
    pub(super) fn open(file: &str, bytes: &[u8]) -> Result<Self, LogError> {
        let mut out = Self { names: Vec::new(), contents: Vec::new(), values: 0 };
        let refused = |flaw: Flaw, at: &str| match flaw {
            Flaw::Damage => LogError::content(file, format!("damage {at}"), COMPLETE),
            Flaw::TooLarge => LogError::content(
                file,
                format!("more than can be held {at}"),
                format!(
                    "at most {} MB in a variable, {MAX_VALUES} numbers and {MAX_NAMES} names; \
                 divide the log into several",
                    MAX_BYTES >> 20
                ),
            ),
        };
        let (big, mut rest) = match (bytes.get(126..HEADER_BYTES), bytes.get(HEADER_BYTES..)) {
            (Some(b"IM"), Some(rest)) => (false, rest),
            (Some(b"MI"), Some(rest)) => (true, rest),
            _ => return Err(refused(Flaw::Damage, "in the header")),
        };
        let cut = Cut { big };
        while !rest.is_empty() {
            let at = format!("after variable {}", out.names.len());
            rest = out.variable(cut, rest).map_err(|flaw| refused(flaw, &at))?;
        }
        if out.names.is_empty() {
            return Err(LogError::content(file, "no variables", "a variable for each signal"));
        }
        Ok(out)
    }

    /// Adds the first variable and returns the bytes after it.
    fn variable<'a>(&mut self, cut: Cut, bytes: &'a [u8]) -> Result<&'a [u8], Flaw> {
        let (kind, data, after) = cut.element(bytes)?;
        if kind == COMPRESSED {
            let inflated = inflate(data, MAX_BYTES)?;
            let (kind, data, _) = cut.element(&inflated)?;
            if kind == MATRIX {
                self.add(cut, data, None, 0)?;
            }
        } else if kind == MATRIX {
            self.add(cut, data, None, 0)?;
        }
        Ok(after)
    }

    fn push(&mut self, name: String, content: Content) -> Result<(), Flaw> {
        self.names.push(name);
        self.contents.push(content);
        if self.names.len() <= MAX_NAMES { Ok(()) } else { Err(Flaw::TooLarge) }
    }

    /// Adds an array with all its content.
    fn add(&mut self, cut: Cut, data: &[u8], name: Option<String>, depth: usize) -> Result<(), Flaw> {
        if data.is_empty() {
            // An empty array inside a struct may have no content.
            return self.push(name.ok_or(Flaw::Damage)?, Err("an empty array"));
        }
        let (kind, flags, rest) = cut.element(data)?;
        if kind != UINT32 {
            return Err(Flaw::Damage);
        }
        let flags = cut.u32(flags)?;
        let (class, flags) = (flags as u8, (flags >> 8) as u8);
        let (kind, dimensions, rest) = cut.element(rest)?;
        if class == OPAQUE {
            let own = || String::from_utf8_lossy(dimensions).into_owned();
            return self.push(name.unwrap_or_else(own), Err(NO_NUMBERS));
        }
        if kind != INT32 {
            return Err(Flaw::Damage);
        }
        let dimensions: Vec<usize> =
            dimensions.chunks_exact(4).map(|d| cut.u32(d).map(|d| d as usize)).collect::<Result<_, _>>()?;
        let count = dimensions.iter().try_fold(1usize, |n, &d| n.checked_mul(d)).ok_or(Flaw::Damage)?;
        let (_, own_name, rest) = cut.element(rest)?;
        let name = name.unwrap_or_else(|| String::from_utf8_lossy(own_name).into_owned());
        match class {
            STRUCT if count == 1 && depth < MAX_DEPTH => self.fields(cut, rest, &name, depth),
            STRUCT => self.push(name, Err("an array of structs, or structs that are nested too deeply")),
            class if NUMERIC.contains(&class) && flags & COMPLEX != 0 => {
                self.push(name, Err("complex numbers"))
            }
            class if NUMERIC.contains(&class) => self.numbers(cut, rest, name, &dimensions, count),
            _ => self.push(name, Err(NO_NUMBERS)),
        }
    }

    /// Adds an array of `count` numbers.
    fn numbers(
        &mut self,
        cut: Cut,
        data: &[u8],
        name: String,
        dimensions: &[usize],
        count: usize,
    ) -> Result<(), Flaw> {
        let (kind, data, _) = cut.element(data)?;
        // Checked before the values are widened to eight bytes each.
        if count > MAX_VALUES.saturating_sub(self.values) {
            return Err(Flaw::TooLarge);
        }
        let values = cut.numbers(kind, data, count)?;
        self.values += count;
        self.columns(name, dimensions, values)
    }

    /// Adds a vector under its name, a matrix as its columns.
    fn columns(&mut self, name: String, dimensions: &[usize], values: Vec<f64>) -> Result<(), Flaw> {
        match dimensions {
            [] => Err(Flaw::Damage),
            [rows, columns] if *rows > 1 && *columns > 1 => {
                if *columns > MAX_COLUMNS {
                    return self.push(name, Err("a matrix with too many columns"));
                }
                for (i, column) in values.chunks_exact(*rows).enumerate() {
                    self.push(format!("{name}(:,{})", i + 1), Ok(column.to_vec()))?;
                }
                Ok(())
            }
            _ if dimensions.iter().filter(|d| **d != 1).count() <= 1 => {
                let content = if values.is_empty() { Err("an empty array") } else { Ok(values) };
                self.push(name, content)
            }
            _ => self.push(name, Err("an array of more than two dimensions")),
        }
    }

    /// Adds the fields of a struct.
    fn fields(&mut self, cut: Cut, data: &[u8], name: &str, depth: usize) -> Result<(), Flaw> {
        let (_, length, rest) = cut.element(data)?;
        let length = cut.u32(length)? as usize;
        let (_, names, mut rest) = cut.element(rest)?;
        if length == 0 {
            return Err(Flaw::Damage);
        }
        for field in names.chunks_exact(length) {
            let field = field.split(|&b| b == 0).next().unwrap_or_default();
            let (kind, data, after) = cut.element(rest)?;
            if kind != MATRIX {
                return Err(Flaw::Damage);
            }
            rest = after;
            self.add(cut, data, Some(format!("{name}.{}", String::from_utf8_lossy(field))), depth + 1)?;
        }
        Ok(())
    }
}

impl LogFile for Variables {
    fn format(&self) -> &'static str {
        "MAT-file of version 5 to 7"
    }

    fn names(&self) -> &[String] {
        &self.names
    }

    fn expected_name(&self, name: &str) -> String {
        format!("a variable `{name}` (a field of a struct is `data.{name}`, a column `{name}(:,1)`)")
    }

    fn place(&self, row: usize) -> String {
        format!("element {}", row + 1)
    }

    fn values(&self, file: &str, index: usize, wanted: &str, _: bool) -> Result<Vec<f64>, LogError> {
        let name = self.names.get(index).cloned().unwrap_or_else(|| index.to_string());
        let refuse = |found: &str| {
            let found = format!("variable `{name}` for {wanted}: {found}");
            LogError::content(file, found, "a real numeric vector")
        };
        match self.contents.get(index) {
            Some(Ok(values)) => Ok(values.clone()),
            Some(Err(found)) => Err(refuse(found)),
            None => Err(refuse(&format!("only {} variables", self.names.len()))),
        }
    }
}

/// Cuts bytes into elements and numbers; inconsistent bytes are damage.
#[derive(Clone, Copy)]
struct Cut {
    big: bool,
}

impl Cut {
    fn u32(self, bytes: &[u8]) -> Result<u32, Flaw> {
        let bytes: [u8; 4] = *bytes.first_chunk().ok_or(Flaw::Damage)?;
        Ok(if self.big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    /// Returns the first element: type, data and the bytes after it.
    fn element(self, bytes: &[u8]) -> Result<(u32, &[u8], &[u8]), Flaw> {
        self.element_of(self.u32(bytes)?, bytes).ok_or(Flaw::Damage)
    }

    fn element_of(self, first: u32, bytes: &[u8]) -> Option<(u32, &[u8], &[u8])> {
        let (kind, small) = (first & 0xffff, (first >> 16) as usize);
        if small > 0 {
            return (small <= 4).then_some((kind, bytes.get(4..4 + small)?, bytes.get(8..)?));
        }
        let length = self.u32(bytes.get(4..)?).ok()? as usize;
        let data = bytes.get(8..)?;
        // Compressed elements are not padded, and the last one of a file need not be.
        let padded = if kind == COMPRESSED { length } else { length.checked_next_multiple_of(8)? };
        Some((kind, data.get(..length)?, data.get(padded..).unwrap_or_default()))
    }

    /// Returns exactly `count` numbers of a storage type, which may be smaller than the array's
    /// class.
    fn numbers(self, kind: u32, data: &[u8], count: usize) -> Result<Vec<f64>, Flaw> {
        macro_rules! read {
            ($type:ty) => {{
                if data.len() / size_of::<$type>() != count {
                    return Err(Flaw::Damage);
                }
                data.chunks_exact(size_of::<$type>())
                    .filter_map(|c| c.try_into().ok())
                    .map(|c| {
                        let value =
                            if self.big { <$type>::from_be_bytes(c) } else { <$type>::from_le_bytes(c) };
                        value as f64
                    })
                    .collect()
            }};
        }
        Ok(match kind {
            1 => read!(i8),
            2 => read!(u8),
            3 => read!(i16),
            4 => read!(u16),
            INT32 => read!(i32),
            UINT32 => read!(u32),
            7 => read!(f32),
            9 => read!(f64),
            12 => read!(i64),
            13 => read!(u64),
            _ => return Err(Flaw::Damage),
        })
    }
}

/// Inflates a compressed element.
fn inflate(data: &[u8], max_bytes: u64) -> Result<Vec<u8>, Flaw> {
    let mut out = Vec::new();
    let mut inflater = flate2::read::ZlibDecoder::new(data).take(max_bytes + 1);
    inflater.read_to_end(&mut out).map_err(|_| Flaw::Damage)?;
    if out.len() as u64 > max_bytes { Err(Flaw::TooLarge) } else { Ok(out) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_above_the_limit_is_not_reported_as_damage() {
        let mut zipped = flate2::read::ZlibEncoder::new(&[7; 1000][..], flate2::Compression::fast());
        let mut bytes = Vec::new();
        zipped.read_to_end(&mut bytes).unwrap();
        assert_eq!(inflate(&bytes, 1000), Ok(vec![7; 1000]));
        assert_eq!(inflate(&bytes, 999), Err(Flaw::TooLarge));
        bytes.truncate(bytes.len() / 2);
        assert_eq!(inflate(&bytes, 1000), Err(Flaw::Damage));
    }
}
