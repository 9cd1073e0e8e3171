//! HDF5 files, and MAT-files of version 7.3, which are HDF5.
//!
//! Data sets of numbers are listed: vectors by their path (`bench/angle`), the columns of a matrix
//! with their number from 1 (`log(:,2)`), the fields of a table with a point (`log.angle`). In a
//! MAT-file structs have points (`data.qm`), and columns are those of MATLAB, which HDF5 stores as
//! rows. The attribute `units` or `unit` is the unit. Everything else keeps its name and is refused
//! when a column asks for it: texts, references (cells, objects), arrays of more dimensions.

use super::file::{LogFile, MAX_COLUMNS, MAX_NAMES, MAX_ROWS, MAX_VALUES, guarded, refused};
use crate::log::LogError;
use half::f16;
use hdf5_pure::{AttrValue, Dataset, Datatype, DatatypeByteOrder, File, Group};
use std::cell::RefCell;
use std::collections::HashMap;

/// First bytes of a file.
pub(super) const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
/// First bytes of a MAT-file of version 7.3.
pub(super) const MAT_73: &[u8] = b"MATLAB 7.3 MAT-file";

/// Maximum depth of nested groups.
const MAX_DEPTH: usize = 16;
/// Maximum size of a data set in memory.
const MAX_BYTES: u64 = 1 << 31;
/// Groups of a MAT-file that are not variables.
const INTERNAL: [&str; 2] = ["#refs#", "#subsystem#"];
const READABLE: &str = "complete HDF5 with plain, gzip, LZF or shuffled data";
const NO_NUMBERS: &str = "no numbers (a text, references, an object, an empty array or another type)";
/// Classes of MATLAB whose variables are numbers.
const NUMBERS: [&str; 11] =
    ["double", "single", "logical", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"];
/// Attributes of variables of MATLAB that contain no plain numbers.
const OTHER_CONTENT: [&str; 3] = ["MATLAB_empty", "MATLAB_object_decode", "MATLAB_sparse"];

/// Part of a data set that is a column.
#[derive(Clone, Debug)]
enum Part {
    Whole,
    /// Column of a matrix with rows of a width.
    Column(usize, usize),
    /// Row of a matrix.
    Row(u64),
    /// Field of a table at an offset in rows of a size.
    Field(Datatype, usize, usize),
    Refused(&'static str),
}

/// Column of a file: data set, part and unit.
struct Column {
    path: String,
    part: Part,
    unit: String,
}

/// Data sets of a file.
pub(super) struct Hdf5 {
    file: File,
    is_matlab: bool,
    columns: Vec<Column>,
    names: Vec<String>,
    /// Number of groups that were listed.
    groups: usize,
    /// Values of the matrix, or bytes of the table, that was read last.
    matrix: RefCell<Option<(String, Vec<f64>)>>,
    table: RefCell<Option<(String, Vec<u8>)>>,
}

impl Hdf5 {
    pub(super) fn open(file: &str, bytes: Vec<u8>) -> Result<Self, LogError> {
        let is_matlab = bytes.starts_with(MAT_73);
        let refuse = |found: String| LogError::content(file, found, READABLE);
        let opened = guarded(|| File::from_bytes(bytes)).map_err(refuse)?;
        let mut out = Self {
            file: opened,
            is_matlab,
            columns: Vec::new(),
            names: Vec::new(),
            groups: 0,
            matrix: RefCell::default(),
            table: RefCell::default(),
        };
        let root = out.file.root();
        guarded(|| out.walk(&root, "", "", 0)).map_err(refuse)?;
        if out.columns.is_empty() {
            return Err(LogError::content(file, "no data sets", "a data set for each signal"));
        }
        Ok(out)
    }

    /// Lists a group with its groups; `path` is its place in the file, `name` as columns show it.
    fn walk(&mut self, group: &Group, path: &str, name: &str, depth: usize) -> Result<(), String> {
        if depth > MAX_DEPTH {
            return Err(format!("groups that are nested more than {MAX_DEPTH} deep"));
        }
        self.groups += 1;
        if self.groups > MAX_NAMES {
            return Err(format!("more than {MAX_NAMES} groups"));
        }
        let separator = if self.is_matlab { '.' } else { '/' };
        let below = |above: &str, separator: char, own: &str| match above {
            "" => own.to_owned(),
            above => format!("{above}{separator}{own}"),
        };
        let datasets = group.iter_datasets().map_err(|error| error.to_string())?;
        for (own, dataset) in datasets {
            self.add(&dataset, &below(path, '/', &own), &below(name, separator, &own))?;
        }
        for (own, group) in group.iter_groups().map_err(|error| error.to_string())? {
            if self.is_matlab && INTERNAL.contains(&own.as_str()) {
                continue;
            }
            let (path, name) = (below(path, '/', &own), below(name, separator, &own));
            let attributes = group.attrs().unwrap_or_default();
            if self.is_matlab && OTHER_CONTENT.iter().any(|other| attributes.contains_key(*other)) {
                self.columns.push(Column { path, part: Part::Refused(NO_NUMBERS), unit: String::new() });
                self.names.push(name);
            } else {
                self.walk(&group, &path, &name, depth + 1)?;
            }
        }
        Ok(())
    }

    /// Lists the columns of a data set.
    fn add(&mut self, dataset: &Dataset, path: &str, name: &str) -> Result<(), String> {
        let attributes = dataset.attrs().unwrap_or_default();
        let unit = text(&attributes, "units").or_else(|| text(&attributes, "unit")).unwrap_or_default();
        let class = self.is_matlab.then(|| text(&attributes, "MATLAB_class")).flatten();
        let is_marked = OTHER_CONTENT.iter().any(|other| attributes.contains_key(*other));
        let is_class = class.as_deref().is_some_and(|class| !NUMBERS.contains(&class));
        let is_other = self.is_matlab && (is_marked || is_class);
        let mut push = |name: String, part: Part| {
            self.columns.push(Column { path: path.to_owned(), part, unit: unit.clone() });
            self.names.push(name);
            if self.names.len() > MAX_NAMES {
                return Err(format!("more than {MAX_NAMES} data sets and columns"));
            }
            Ok(())
        };
        let (Ok(shape), Ok(datatype)) = (dataset.shape(), dataset.datatype()) else {
            return push(name.to_owned(), Part::Refused("a damaged data set"));
        };
        let count = shape.iter().try_fold(1_u64, |product, size| product.checked_mul(*size));
        let bytes = count.and_then(|count| count.checked_mul(dataset.element_size().ok()?.max(8)));
        let is_large = count.is_none_or(|count| count > MAX_VALUES as u64);
        if is_large || bytes.is_none_or(|bytes| bytes > MAX_BYTES) {
            return push(name.to_owned(), Part::Refused("more values than can be held"));
        }
        if is_other || count == Some(0) {
            return push(name.to_owned(), Part::Refused(NO_NUMBERS));
        }
        let lengths: Vec<u64> = shape.iter().copied().filter(|length| *length != 1).collect();
        match (&datatype, lengths.as_slice()) {
            (Datatype::Compound { .. }, _) if self.is_matlab => {
                push(name.to_owned(), Part::Refused("complex numbers"))
            }
            (Datatype::Compound { size, members }, [] | [_]) => {
                for member in members {
                    let offset = usize::try_from(member.byte_offset).map_err(|error| error.to_string())?;
                    let part = match number(&member.datatype, &[0; 8]) {
                        Some(_) => Part::Field(member.datatype.clone(), offset, *size as usize),
                        None => Part::Refused(NO_NUMBERS),
                    };
                    push(format!("{name}.{}", member.name), part)?;
                }
                Ok(())
            }
            (datatype, _) if number(datatype, &[0; 8]).is_none() => {
                push(name.to_owned(), Part::Refused(NO_NUMBERS))
            }
            (_, [] | [_]) => push(name.to_owned(), Part::Whole),
            (_, [rows, columns]) => {
                let columns = if self.is_matlab { *rows } else { *columns };
                if columns > MAX_COLUMNS as u64 {
                    return push(name.to_owned(), Part::Refused("a matrix with too many columns"));
                }
                for index in 0..columns {
                    let part = match self.is_matlab {
                        true => Part::Row(index),
                        false => Part::Column(index as usize, columns as usize),
                    };
                    push(format!("{name}(:,{})", index + 1), part)?;
                }
                Ok(())
            }
            _ => push(name.to_owned(), Part::Refused("an array of more than two dimensions")),
        }
    }

    /// Numbers of a column.
    fn numbers(&self, index: usize) -> Result<Vec<f64>, String> {
        let column = self.columns.get(index).ok_or("no such column")?;
        let path = column.path.as_str();
        let dataset = self.file.dataset(path).map_err(|error| error.to_string())?;
        match &column.part {
            Part::Refused(found) => Err((*found).into()),
            Part::Whole => values(&dataset, None),
            Part::Row(row) => values(&dataset, Some(*row)),
            Part::Column(place, width) => {
                let matrix = cached(&self.matrix, path, || values(&dataset, None))?;
                Ok(matrix.iter().skip(*place).step_by(*width).copied().collect())
            }
            Part::Field(datatype, offset, size) => {
                let read = || dataset.read_raw().map_err(|error| error.to_string());
                let table = cached(&self.table, path, read)?;
                let field = |row: &[u8]| row.get(*offset..).and_then(|bytes| number(datatype, bytes));
                let row = |row: &[u8]| field(row).ok_or_else(|| NO_NUMBERS.to_owned());
                table.chunks_exact((*size).max(1)).map(row).collect()
            }
        }
    }
}

impl LogFile for Hdf5 {
    fn format(&self) -> &'static str {
        if self.is_matlab { "MAT-file of version 7.3" } else { "HDF5" }
    }

    fn names(&self) -> &[String] {
        &self.names
    }

    /// Path of the group, or of a table.
    fn group(&self, index: usize) -> &str {
        let Some(column) = self.columns.get(index) else { return "" };
        match column.part {
            Part::Whole | Part::Refused(_) => column.path.rsplit_once('/').map_or("", |(group, _)| group),
            _ => &column.path,
        }
    }

    fn unit(&self, index: usize) -> &str {
        self.columns.get(index).map_or("", |column| &column.unit)
    }

    fn values(&self, file: &str, index: usize, wanted: &str, _: bool) -> Result<Vec<f64>, LogError> {
        let name = self.names.get(index).map_or("", String::as_str);
        let found = guarded(|| self.numbers(index));
        let refuse = |found: String| refused(file, (name, wanted), found, "a vector of numbers");
        match found {
            Ok(values) if values.len() > MAX_ROWS => Err(refuse(format!("more than {MAX_ROWS} values"))),
            found => found.map_err(refuse),
        }
    }
}

/// Returns what was read last if it is of the same data set, else reads it.
fn cached<'a, T>(
    last: &'a RefCell<Option<(String, Vec<T>)>>,
    path: &str,
    read: impl FnOnce() -> Result<Vec<T>, String>,
) -> Result<std::cell::Ref<'a, [T]>, String> {
    if last.borrow().as_ref().is_none_or(|(known, _)| known != path) {
        let found = read()?;
        *last.borrow_mut() = Some((path.to_owned(), found));
    }
    Ok(std::cell::Ref::map(last.borrow(), |last| last.as_ref().map_or(&[][..], |(_, found)| found)))
}

/// Values of a data set, or of one of its rows.
fn values(dataset: &Dataset, row: Option<u64>) -> Result<Vec<f64>, String> {
    let datatype = dataset.datatype().map_err(|error| error.to_string())?;
    // The library does not return these as numbers.
    if let Datatype::Enumeration { size, .. } | Datatype::FloatingPoint { size: size @ 2, .. } = &datatype {
        let bytes = match row {
            Some(row) => dataset.read_raw_rows(row, 1),
            None => dataset.read_raw(),
        };
        let bytes = bytes.map_err(|error| error.to_string())?;
        let value = |bytes: &[u8]| number(&datatype, bytes).ok_or_else(|| NO_NUMBERS.to_owned());
        return bytes.chunks_exact((*size as usize).max(1)).map(value).collect();
    }
    let found = match row {
        Some(row) => dataset.read_f64_rows(row, 1),
        None => dataset.read_f64(),
    };
    found.map_err(|error| error.to_string())
}

/// Number at the start of `bytes`; `None` for other content or if bytes are missing.
fn number(datatype: &Datatype, bytes: &[u8]) -> Option<f64> {
    macro_rules! read {
        ($type:ty, $order:expr) => {{
            let bytes = *bytes.first_chunk()?;
            match $order {
                DatatypeByteOrder::BigEndian => <$type>::from_be_bytes(bytes),
                DatatypeByteOrder::LittleEndian => <$type>::from_le_bytes(bytes),
                DatatypeByteOrder::Vax => return None,
            }
        }};
    }
    Some(match datatype {
        Datatype::FixedPoint { size, byte_order, layout } => {
            if layout.bit_offset != 0 || u32::from(layout.bit_precision) != 8 * size {
                return None;
            }
            match (size, layout.signed) {
                (1, true) => f64::from(read!(i8, byte_order)),
                (1, false) => f64::from(read!(u8, byte_order)),
                (2, true) => f64::from(read!(i16, byte_order)),
                (2, false) => f64::from(read!(u16, byte_order)),
                (4, true) => f64::from(read!(i32, byte_order)),
                (4, false) => f64::from(read!(u32, byte_order)),
                (8, true) => read!(i64, byte_order) as f64,
                (8, false) => read!(u64, byte_order) as f64,
                _ => return None,
            }
        }
        Datatype::FloatingPoint { size: 2, byte_order, layout } if layout.exponent_size == 5 => {
            f16::from_bits(read!(u16, byte_order)).to_f64()
        }
        Datatype::FloatingPoint { size: 4, byte_order, layout } if layout.exponent_size == 8 => {
            f64::from(read!(f32, byte_order))
        }
        Datatype::FloatingPoint { size: 8, byte_order, layout } if layout.exponent_size == 11 => {
            read!(f64, byte_order)
        }
        Datatype::Enumeration { base_type, .. } => number(base_type, bytes)?,
        _ => return None,
    })
}

/// Text of an attribute.
fn text(attributes: &HashMap<String, AttrValue>, name: &str) -> Option<String> {
    attributes.get(name)?.as_str().map(str::to_owned)
}
