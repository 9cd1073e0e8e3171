//! Workbooks of Excel 2007 and later, LibreOffice and others (`.xlsx`).
//!
//! The first row of a sheet with a text names the columns; a row of units may follow, and numbers
//! below. A column is listed by its header or, where two sheets have the same one, as
//! `sheet/header`. An empty cell is a missing value, a formula has the value that the workbook
//! stores with it. Dates and times are in s since the first one of their column.

use super::file::{LogFile, MAX_COLUMNS, MAX_ROWS, guarded, refused, unique_names};
use super::text::number::{is_missing, is_units, parse};
use crate::log::LogError;
use calamine::{DataRef, Reader, Xlsx};
use std::io::{Cursor, Read};

/// First bytes of a ZIP archive, which a workbook is.
pub(super) const ZIP: &[u8] = b"PK\x03\x04";
/// Part that every workbook has.
const WORKBOOK: &str = "xl/workbook.xml";
/// Maximum unpacked size of a workbook.
const MAX_BYTES: u64 = 1 << 30;
/// Maximum number of cells, which bounds the memory of columns with empty cells.
const MAX_CELLS: usize = MAX_ROWS;
const READABLE: &str = "a complete workbook (.xlsx)";
const SECONDS_PER_DAY: f64 = 86_400.0;

/// Column of a sheet.
#[derive(Default)]
struct Column {
    unit: String,
    values: Vec<f64>,
    /// Row and content of the first cell that is no number.
    text: Option<(u32, String)>,
}

/// Columns of all sheets.
pub(super) struct Workbook {
    columns: Vec<Column>,
    names: Vec<String>,
    sheets: Vec<String>,
}

impl Workbook {
    pub(super) fn open(file: &str, bytes: &[u8]) -> Result<Self, LogError> {
        let refuse = |found: String| LogError::content(file, found, READABLE);
        guarded(|| check_size(bytes)).map_err(refuse)?;
        let (mut columns, mut places, mut cells) = (Vec::new(), Vec::new(), 0);
        guarded(|| {
            let mut book: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).map_err(|e| e.to_string())?;
            for name in book.sheet_names() {
                let Ok(sheet) = Sheet::read(&mut book, &name, &mut cells)? else { continue };
                for (header, column) in sheet.columns() {
                    places.push((name.clone(), header));
                    columns.push(column);
                }
            }
            Ok::<(), String>(())
        })
        .map_err(refuse)?;
        if columns.is_empty() {
            return Err(LogError::content(
                file,
                "no sheet with columns",
                "a row of headers, and numbers below",
            ));
        }
        let names = unique_names(&places);
        Ok(Self { columns, names, sheets: places.into_iter().map(|(sheet, _)| sheet).collect() })
    }
}

impl LogFile for Workbook {
    fn format(&self) -> &'static str {
        "workbook (.xlsx)"
    }

    fn names(&self) -> &[String] {
        &self.names
    }

    fn group(&self, index: usize) -> &str {
        self.sheets.get(index).map_or("", String::as_str)
    }

    fn unit(&self, index: usize) -> &str {
        self.columns.get(index).map_or("", |column| &column.unit)
    }

    fn values(&self, file: &str, index: usize, wanted: &str, is_strict: bool) -> Result<Vec<f64>, LogError> {
        let name = self.names.get(index).map_or("", String::as_str);
        let refuse = |found: String| refused(file, (name, wanted), found, "numbers");
        let column = self.columns.get(index).ok_or_else(|| refuse("no such column".into()))?;
        match &column.text {
            Some((row, text)) if is_strict || column.values.iter().all(|value| value.is_nan()) => {
                Err(refuse(format!("`{text}` in row {row}")))
            }
            _ => Ok(column.values.clone()),
        }
    }

    fn place(&self, row: usize) -> String {
        format!("row {} below the header", row + 1)
    }
}

/// Cells of a sheet by row, as they are read.
#[derive(Default)]
struct Sheet {
    /// Header row from 0, and its texts by column.
    header: Option<(u32, Vec<String>)>,
    units: Vec<String>,
    /// True as soon as a row below the header had numbers.
    has_numbers: bool,
    columns: Vec<Column>,
    /// First date or time of each column.
    origins: Vec<Option<f64>>,
}

impl Sheet {
    /// Reads a sheet; the inner error is a sheet without cells, such as a chart.
    fn read(
        book: &mut Xlsx<Cursor<&[u8]>>,
        name: &str,
        cells: &mut usize,
    ) -> Result<Result<Self, ()>, String> {
        let Ok(mut reader) = book.worksheet_cells_reader(name) else { return Ok(Err(())) };
        let mut sheet = Self::default();
        let mut row: (u32, Vec<Field>) = (0, Vec::new());
        while let Some(cell) = reader.next_cell().map_err(|e| format!("sheet `{name}`: {e}"))? {
            let (at, place) = cell.get_position();
            let field = Field::of(cell.get_value());
            if matches!(field, Field::Empty) {
                continue;
            }
            if place as usize >= MAX_COLUMNS {
                return Err(format!("sheet `{name}`: more than {MAX_COLUMNS} columns"));
            }
            if at != row.0 {
                sheet.add(row.0, &row.1, cells)?;
                row = (at, Vec::new());
            }
            row.1.resize(row.1.len().max(place as usize + 1), Field::Empty);
            if let Some(own) = row.1.get_mut(place as usize) {
                *own = field;
            }
        }
        sheet.add(row.0, &row.1, cells)?;
        Ok(Ok(sheet))
    }

    /// Adds a row: the header, the units below it, or numbers.
    fn add(&mut self, at: u32, row: &[Field], cells: &mut usize) -> Result<(), String> {
        let texts = || row.iter().map(Field::text).collect::<Vec<_>>();
        let Some((header, _)) = &self.header else {
            if row.iter().any(|field| matches!(field, Field::Text(_))) {
                self.columns.resize_with(row.len(), Column::default);
                self.origins.resize(row.len(), None);
                self.header = Some((at, texts()));
            }
            return Ok(());
        };
        if !self.has_numbers && self.units.is_empty() && is_units(&texts(), false) {
            self.units = texts();
            return Ok(());
        }
        let first = *header + 1 + u32::from(!self.units.is_empty());
        let position = at.checked_sub(first).ok_or("rows that do not ascend")? as usize;
        for (place, field) in row.iter().enumerate() {
            let (Some(column), Some(origin)) = (self.columns.get_mut(place), self.origins.get_mut(place))
            else {
                continue;
            };
            let value = match field {
                Field::Empty => continue,
                Field::Number(value) => *value,
                Field::Days(days) => (days - *origin.get_or_insert(*days)) * SECONDS_PER_DAY,
                Field::Text(text) => parse(text, false).unwrap_or(f64::NAN),
            };
            if let Field::Text(text) = field
                && value.is_nan()
                && !is_missing(text)
            {
                column.text.get_or_insert_with(|| (at + 1, text.clone()));
            }
            self.has_numbers |= value.is_finite();
            *cells += (position + 1).saturating_sub(column.values.len());
            if *cells > MAX_CELLS {
                return Err(format!("more than {MAX_CELLS} cells"));
            }
            column.values.resize(position, f64::NAN);
            column.values.push(value);
        }
        Ok(())
    }

    /// Columns with a header or numbers, all of the sheet's length.
    fn columns(mut self) -> Vec<(String, Column)> {
        let length = self.columns.iter().map(|column| column.values.len()).max().unwrap_or(0);
        let headers = self.header.map(|(_, texts)| texts).unwrap_or_default();
        for (column, unit) in self.columns.iter_mut().zip(self.units) {
            column.unit = unit;
        }
        let named = headers.into_iter().zip(self.columns).filter(|(header, _)| !header.is_empty());
        named
            .map(|(header, mut column)| {
                column.values.resize(length, f64::NAN);
                (header, column)
            })
            .collect()
    }
}

/// Content of a cell.
#[derive(Clone)]
enum Field {
    Empty,
    Number(f64),
    /// Date or duration in days.
    Days(f64),
    Text(String),
}

impl Field {
    fn of(value: &DataRef<'_>) -> Self {
        match value {
            DataRef::Int(value) => Self::Number(*value as f64),
            DataRef::Float(value) => Self::Number(*value),
            DataRef::Bool(value) => Self::Number(f64::from(u8::from(*value))),
            DataRef::DateTime(time) => Self::Days(time.as_f64()),
            DataRef::String(text) | DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => {
                Self::Text(text.trim().to_owned())
            }
            DataRef::SharedString(text) => Self::Text(text.trim().to_owned()),
            DataRef::Error(error) => Self::Text(error.to_string()),
            DataRef::Empty => Self::Empty,
        }
    }

    fn text(&self) -> String {
        match self {
            Self::Empty => String::new(),
            Self::Number(value) | Self::Days(value) => value.to_string(),
            Self::Text(text) => text.clone(),
        }
    }
}

/// Unpacks an archive without keeping it: the sizes that it states may be wrong.
fn check_size(bytes: &[u8]) -> Result<(), String> {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    if archive.index_for_name(WORKBOOK).is_none() {
        return Err("a ZIP archive that is no workbook".into());
    }
    let mut left = MAX_BYTES;
    for index in 0..archive.len() {
        let part = archive.by_index(index).map_err(|error| error.to_string())?;
        let size = std::io::copy(&mut part.take(left + 1), &mut std::io::sink());
        left = left
            .checked_sub(size.map_err(|error| error.to_string())?)
            .ok_or_else(|| format!("more than {} MB unpacked", MAX_BYTES >> 20))?;
    }
    Ok(())
}
