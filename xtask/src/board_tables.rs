//! The tables of boards and of their wiring in `docs/firmware.md`.

use crate::document::Block;
use crate::run::ChoreError;
use controller::boards::{BOARDS, SIGNALS};

/// Place of the table of boards.
const BOARD_TABLE: Block = Block { file: "docs/firmware.md", name: "boards" };
/// Place of the table of pins.
const WIRING_TABLE: Block = Block { file: "docs/firmware.md", name: "wiring" };

/// Writes both tables.
pub(crate) fn bless() -> Result<(), ChoreError> {
    BOARD_TABLE.write(&boards())?;
    WIRING_TABLE.write(&wiring())
}

/// Returns one row for each board.
fn boards() -> String {
    let head = "| `--board` | board | crystal | light |\n|---|---|---|---|\n";
    let rows = BOARDS.iter().map(|board| {
        let crystal = board.crystal_mhz.map_or("-".into(), |mhz| format!("{mhz} MHz"));
        let light = board.light.map_or("-".into(), |light| {
            let level = if light.is_active_low { "low" } else { "high" };
            format!("P{:?}{}, on when {level}", light.port, light.pin)
        });
        format!("| `{}` | {} | {crystal} | {light} |\n", board.name, board.title)
    });
    head.to_owned() + &rows.collect::<String>()
}

/// Returns one row for each signal, with a column for each board that has labels at its pins.
fn wiring() -> String {
    let labelled: Vec<_> = BOARDS.iter().filter_map(|board| Some((board.title, board.labels?))).collect();
    let titles: String = labelled.iter().map(|(title, _)| format!(" {title} |")).collect();
    let head = format!("| signal | pin |{titles}\n|---|---|{}\n", "---|".repeat(labelled.len()));
    let rows = SIGNALS.iter().enumerate().map(|(index, signal)| {
        let labels = labelled.iter().filter_map(|(_, labels)| Some(format!(" {} |", labels.get(index)?)));
        format!("| {} | P{:?}{} |{}\n", signal.name, signal.port, signal.pin, labels.collect::<String>())
    });
    head + &rows.collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_document_has_the_tables_of_boards_and_wiring() {
        BOARD_TABLE.check(&boards()).unwrap();
        WIRING_TABLE.check(&wiring()).unwrap();
    }
}
