//! The tables of boards and of their wiring in `docs/firmware.md`.

use crate::document::Block;
use crate::run::ChoreError;
use controller::boards::{BOARDS, ExternalClock, Signals};

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
    let head = "| `--board` | board | clock | light |\n|---|---|---|---|\n";
    let rows = BOARDS.iter().map(|board| {
        let clock = match board.external_clock {
            None => "-".into(),
            Some(ExternalClock::Crystal { mhz }) => format!("crystal, {mhz} MHz"),
            Some(ExternalClock::Signal { mhz }) => format!("signal, {mhz} MHz"),
        };
        let light = board.light.map_or("-".into(), |light| {
            let level = if light.is_active_low { "low" } else { "high" };
            format!("P{:?}{}, on when {level}", light.port, light.pin)
        });
        format!("| `{}` | {} | {clock} | {light} |\n", board.name, board.title)
    });
    head.to_owned() + &rows.collect::<String>()
}

/// Returns a table for each microcontroller with labelled boards.
fn wiring() -> String {
    let mut microcontrollers: Vec<&Signals> = vec![];
    for signals in BOARDS.iter().filter_map(|board| board.microcontroller.signals) {
        if !microcontrollers.contains(&signals) {
            microcontrollers.push(signals);
        }
    }
    let tables: Vec<_> = microcontrollers.into_iter().map(wiring_of).collect();
    tables.join("\n")
}

/// Returns one row for each signal, with a column for each board that has labels at these pins.
fn wiring_of(signals: &Signals) -> String {
    let boards = BOARDS.iter().filter(|board| board.microcontroller.signals == Some(signals));
    let labelled: Vec<_> = boards.filter_map(|board| Some((board.title, board.labels?))).collect();
    let titles: String = labelled.iter().map(|(title, _)| format!(" {title} |")).collect();
    let head = format!("| signal | pin |{titles}\n|---|---|{}\n", "---|".repeat(labelled.len()));
    let rows = signals.iter().enumerate().map(|(index, signal)| {
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
