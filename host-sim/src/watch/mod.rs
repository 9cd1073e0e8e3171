//! Live view of `host-sim run --watch`: draws the estimates in the terminal.
//!
//! [`scene`] contains the data and the drawing, without a terminal. This file contains the
//! terminal and the keys; `live` has the pace. `q` or escape closes the view and the run continues
//! without it; control-C ends the run.

pub mod scene;

use crate::cli::error::CliError;
use link::{EstimateFrame, ImpactRecord, SensorFrame};
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};
use scene::Scene;
use std::io::{IsTerminal, stdout};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Time between two pictures.
const PICTURE: Duration = Duration::from_millis(40);

/// An open view.
pub struct Watch {
    terminal: Option<DefaultTerminal>,
    scene: Scene,
    drawn: Option<Instant>,
}

impl Watch {
    /// Opens the terminal.
    ///
    /// # Errors
    ///
    /// The output is not a terminal.
    pub fn open(scene: Scene) -> Result<Self, CliError> {
        if !stdout().is_terminal() {
            return Err(CliError::Input("--watch: found an output that is no terminal; expected one".into()));
        }
        let terminal = ratatui::try_init().map_err(|e| CliError::Work(format!("terminal: {e}")))?;
        Ok(Self { terminal: Some(terminal), scene, drawn: None })
    }

    /// Takes a sample, its estimate and the impacts that have ended, waits until the sample is due,
    /// and draws from time to time. `Break` ends the run.
    pub fn observe(
        &mut self,
        sample: &SensorFrame,
        estimate: &EstimateFrame,
        ended: &[ImpactRecord],
        due: Instant,
    ) -> ControlFlow<()> {
        self.scene.observe(sample, estimate);
        self.scene.add_impacts(ended);
        let Some(terminal) = &mut self.terminal else { return ControlFlow::Continue(()) };
        loop {
            let now = Instant::now();
            if self.drawn.is_none_or(|drawn| now >= drawn + PICTURE) {
                self.drawn = Some(now);
                let drawn = terminal.draw(|frame| self.scene.draw(frame));
                match (drawn, key()) {
                    (Ok(_), Key::None) => {}
                    // A closed terminal does not end the run.
                    (Err(_), _) | (_, Key::Close) => {
                        self.close();
                        return ControlFlow::Continue(());
                    }
                    (_, Key::End) => {
                        self.close();
                        return ControlFlow::Break(());
                    }
                }
            }
            if now >= due {
                return ControlFlow::Continue(());
            }
            std::thread::sleep((due - now).min(PICTURE));
        }
    }

    /// Restores the terminal.
    fn close(&mut self) {
        if self.terminal.take().is_some() {
            ratatui::restore();
        }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.close();
    }
}

enum Key {
    None,
    Close,
    End,
}

/// Returns the meaning of a pressed key.
fn key() -> Key {
    match event::poll(Duration::ZERO).and_then(|ready| if ready { event::read().map(Some) } else { Ok(None) })
    {
        Ok(Some(Event::Key(key))) if key.kind == KeyEventKind::Press => match key.code {
            KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Key::End,
            KeyCode::Char('q') | KeyCode::Esc => Key::Close,
            _ => Key::None,
        },
        _ => Key::None,
    }
}
