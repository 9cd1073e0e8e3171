//! Tables for the terminal: columns without borders, at most 100 columns wide. Longer cells are
//! wrapped at spaces.

use comfy_table::{CellAlignment, ContentArrangement, Row, Table, presets};

/// Maximum width of a table.
const MAX_WIDTH: u16 = 100;

/// Renders a table without a line break at its end. The first `texts` columns are aligned left, the
/// others right.
pub fn text_table(header: impl Into<Row>, rows: impl IntoIterator<Item: Into<Row>>, texts: usize) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(header).add_rows(rows);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(MAX_WIDTH);
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, 2));
        column.set_cell_alignment(if index < texts { CellAlignment::Left } else { CellAlignment::Right });
    }
    table.trim_fmt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_aligned_left_and_numbers_right() {
        let table = text_table(["run", "peak, N"], [["a long name", "7"], ["b", "12345.6"]], 1);
        assert_eq!(table, "run          peak, N\na long name        7\nb            12345.6");
    }

    #[test]
    fn a_wide_table_is_wrapped_at_spaces() {
        let cell = "several words of a long heading".to_owned();
        let row = vec![cell; 6];
        let table = text_table(&row, [&row], 1);
        assert!(table.lines().all(|line| line.len() <= MAX_WIDTH.into()), "{table}");
        assert_eq!(table.matches("heading").count(), 12, "{table}");
    }
}
