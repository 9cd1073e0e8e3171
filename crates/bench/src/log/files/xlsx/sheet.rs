//! Sheet of a workbook: its rows as they are read, divided into columns.

use super::column::Column;
use super::field::{Field, letters};
use super::head::{Head, Row};
use crate::log::files::file::{MAX_COLUMNS, MAX_ROWS};
use calamine::Xlsx;
use std::io::Cursor;

/// Rows that are not empty in which the header is searched.
const EXAMINED_ROWS: usize = 100;
/// Maximum number of cells of a workbook, which bounds the memory of columns with empty cells.
const MAX_CELLS: usize = MAX_ROWS;

/// Cells of a sheet.
#[derive(Default)]
pub(super) struct Sheet {
    /// First rows, until the header is known.
    first_rows: Vec<Row>,
    head: Option<Head>,
    /// Row of the first sample.
    first_data: Option<u32>,
    columns: Vec<Column>,
    /// Number of samples.
    length: usize,
}

impl Sheet {
    /// Reads the columns of a sheet with their names; `cells` counts those of the workbook.
    pub(super) fn read(
        book: &mut Xlsx<Cursor<&[u8]>>,
        name: &str,
        cells: &mut usize,
    ) -> Result<Vec<(String, Column)>, String> {
        let mut reader = book.worksheet_cells_reader(name).map_err(|error| error.to_string())?;
        let mut sheet = Self::default();
        let mut row: Row = (0, Vec::new());
        while let Some(cell) = reader.next_cell().map_err(|error| error.to_string())? {
            let (at, column) = cell.get_position();
            let (column, field) = (column as usize, Field::from_cell(cell.get_value()));
            if field.is_empty() {
                continue;
            }
            if column >= MAX_COLUMNS {
                return Err(format!("more than {MAX_COLUMNS} columns"));
            }
            if at < row.0 {
                return Err(format!("row {} below row {}", u64::from(at) + 1, u64::from(row.0) + 1));
            }
            if at > row.0 {
                sheet.examine(std::mem::replace(&mut row, (at, Vec::new())), cells)?;
            }
            row.1.resize(row.1.len().max(column + 1), Field::Empty);
            if let Some(own) = row.1.get_mut(column) {
                *own = field;
            }
        }
        sheet.examine(row, cells)?;
        sheet.find_head(cells)?;
        Ok(sheet.named_columns())
    }

    /// Keeps the first rows until the header is known, and adds the others.
    fn examine(&mut self, row: Row, cells: &mut usize) -> Result<(), String> {
        if row.1.is_empty() {
            return Ok(());
        }
        if self.head.is_some() {
            return self.add(&row, cells);
        }
        self.first_rows.push(row);
        if self.first_rows.len() < EXAMINED_ROWS { Ok(()) } else { self.find_head(cells) }
    }

    /// Finds the header, and adds the rows of data among the first ones.
    fn find_head(&mut self, cells: &mut usize) -> Result<(), String> {
        let rows = std::mem::take(&mut self.first_rows);
        if self.head.is_none() {
            let head = self.head.insert(Head::find(&rows));
            let above = head.rows;
            for row in rows.iter().skip(above) {
                self.add(row, cells)?;
            }
        }
        Ok(())
    }

    /// Adds a row of data.
    fn add(&mut self, (at, row): &Row, cells: &mut usize) -> Result<(), String> {
        let index = (at - *self.first_data.get_or_insert(*at)) as usize;
        if index >= MAX_ROWS {
            return Err(format!("more than {MAX_ROWS} rows"));
        }
        self.length = index + 1;
        if self.columns.len() < row.len() {
            self.columns.resize_with(row.len(), Column::default);
        }
        for (place, (field, column)) in row.iter().zip(&mut self.columns).enumerate() {
            let before = column.values.len();
            if !field.is_empty() {
                *cells += (index + 1).saturating_sub(before);
            }
            if *cells > MAX_CELLS {
                return Err(format!("more than {MAX_CELLS} cells"));
            }
            column.add(index, (*at, place), field);
        }
        Ok(())
    }

    /// Columns with a header or with content, all of the sheet's length. A column without a header
    /// is called by its letters.
    fn named_columns(mut self) -> Vec<(String, Column)> {
        let head = self.head.unwrap_or_default();
        self.columns.resize_with(self.columns.len().max(head.names.len()), Column::default);
        let named = |(place, mut column): (usize, Column)| {
            let text = |texts: &[String]| texts.get(place).cloned().unwrap_or_default();
            let mut name = text(&head.names);
            if name.is_empty() && column.is_empty() {
                return None;
            }
            if name.is_empty() {
                name = letters(place);
            }
            column.unit = text(&head.units);
            column.values.resize(self.length, f64::NAN);
            Some((name, column))
        };
        self.columns.into_iter().enumerate().filter_map(named).collect()
    }
}
