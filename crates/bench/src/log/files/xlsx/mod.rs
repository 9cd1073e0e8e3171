//! Workbooks of Excel 2007 and later, LibreOffice and others (`.xlsx`).
//!
//! A column is listed by its header or, where two sheets have the same one, as `sheet/header`;
//! without a header by its letters. An empty cell and an error are missing values, a formula has
//! the value that the workbook stores with it. A column of numbers with a text is refused. Dates
//! are in s since the earliest one of the workbook, times without a day in s since the first one of
//! their column.

mod column;
mod field;
mod head;
mod sheet;
#[cfg(test)]
mod tests;

use super::file::{LogFile, guarded, refused, unique_names};
use crate::log::LogError;
use calamine::{Reader, SheetType, Xlsx};
use column::Column;
use sheet::Sheet;
use std::io::{Cursor, Read};

/// First bytes of a ZIP archive, which a workbook is.
pub(super) const ZIP: &[u8] = b"PK\x03\x04";
/// Part that every workbook has.
const WORKBOOK: &str = "xl/workbook.xml";
/// Maximum unpacked size of a workbook.
const MAX_BYTES: u64 = 1 << 30;
const READABLE: &str = "a complete workbook (.xlsx)";

/// Columns of all sheets. A sheet that cannot be read is a column with its name.
pub(super) struct Workbook {
    columns: Vec<Column>,
    names: Vec<String>,
    sheets: Vec<String>,
}

impl Workbook {
    pub(super) fn open(file: &str, bytes: &[u8]) -> Result<Self, LogError> {
        let refuse = |found: String| LogError::content(file, found, READABLE);
        guarded(|| check_size(bytes)).map_err(refuse)?;
        let open = || Xlsx::new(Cursor::new(bytes));
        let mut book: Xlsx<_> = guarded(open).map_err(refuse)?;
        let (mut columns, mut places, mut cells) = (Vec::new(), Vec::new(), 0);
        let mut damage = None;
        let sheets = book.sheets_metadata().iter().filter(|sheet| sheet.typ == SheetType::WorkSheet);
        for name in sheets.map(|sheet| sheet.name.clone()).collect::<Vec<_>>() {
            let read = guarded(|| Sheet::read(&mut book, &name, &mut cells)).unwrap_or_else(|reason| {
                let reason = format!("sheet `{name}`: {reason}");
                damage.get_or_insert_with(|| reason.clone());
                vec![(name.clone(), Column::refused(reason))]
            });
            for (header, column) in read {
                places.push((name.clone(), header));
                columns.push(column);
            }
        }
        if columns.iter().all(|column| column.flaw.is_some()) {
            damage.map_or(Ok(()), |reason| Err(refuse(reason)))?;
        }
        if columns.is_empty() {
            return Err(LogError::content(file, "no sheet with columns", "a sheet with columns of numbers"));
        }
        let earliest_date = columns.iter().filter_map(Column::first_date).reduce(f64::min);
        columns.iter_mut().for_each(|column| column.count_seconds(earliest_date));
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

    fn values(&self, file: &str, index: usize, wanted: &str, _is_strict: bool) -> Result<Vec<f64>, LogError> {
        let name = self.names.get(index).map_or("", String::as_str);
        let refuse = |found: &str| refused(file, (name, wanted), found, "numbers");
        let column = self.columns.get(index).ok_or_else(|| refuse("no such column"))?;
        match &column.flaw {
            Some(flaw) => Err(refuse(flaw)),
            None => Ok(column.values.clone()),
        }
    }

    fn place(&self, row: usize) -> String {
        format!("row {} below the header", row + 1)
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
