//! Steps that all kinds of cells share: files, the engine, the draw of hidden effects.

use super::CampaignError;
use super::cell::Cell;
use crate::generator::hidden::HiddenEffect;
use crate::generator::noise::Noise;
use crate::generator::record::Record;
use crate::generator::size::Scale;
use crate::generator::vocabulary::draw;
use bench::effects::CATALOGUE;
use bench::{Bench, MeasuredLog};
use diagnosis::{Diagnosis, Options, diagnose};
use std::path::{Path, PathBuf};

/// Folder of a cell's files, and the cell.
pub(super) struct CellRun<'a> {
    pub(super) folder: &'a Path,
    pub(super) cell: &'a Cell,
}

impl CellRun<'_> {
    pub(super) fn failed(&self, error: &dyn std::fmt::Display) -> CampaignError {
        CampaignError::Engine { cell: self.cell.index, found: error.to_string() }
    }

    /// Returns the user's description of the plant.
    pub(super) fn bench(&self) -> Result<Bench, CampaignError> {
        let description = self.cell.conditions().description(self.cell.plant);
        Bench::parse("bench.toml", description).map_err(|e| self.failed(&e))
    }

    /// Writes a log and reads it back as a user of the engine would.
    pub(super) fn log(&self, name: &str, text: &str, bench: &Bench) -> Result<MeasuredLog, CampaignError> {
        let file: PathBuf = self.folder.join(format!("{name}.csv"));
        bench::atomic::write(&file, text.as_bytes()).map_err(|e| self.failed(&e))?;
        let text = std::fs::read_to_string(&file).map_err(|e| self.failed(&e))?;
        MeasuredLog::parse(&format!("{name}.csv"), &text, &bench.log_format()).map_err(|e| self.failed(&e))
    }

    /// Returns the engine's answer to logs.
    pub(super) fn diagnose(
        &self,
        bench: &Bench,
        logs: &[MeasuredLog],
        exclude: &[String],
    ) -> Result<Diagnosis, CampaignError> {
        diagnose(bench, logs, &[], &Options { exclude, ..Options::default() }).map_err(|e| self.failed(&e))
    }

    /// Calibrates the bench with a log; no effect may be named.
    pub(super) fn calibrate(&self, bench: &Bench, log: &MeasuredLog) -> Result<Diagnosis, CampaignError> {
        let every: Vec<String> = CATALOGUE.iter().map(|kind| kind.name.to_owned()).collect();
        self.diagnose(bench, std::slice::from_ref(log), &every)
    }
}

/// Draws the effects of a cell at their sizes; `None` if the plant cannot show one of them as
/// large.
pub(super) fn hide(
    cell: &Cell,
    scale: &Scale<'_>,
    record: &Record,
    noise: &mut Noise,
) -> Option<Vec<HiddenEffect>> {
    let base = record.readings(&record.off, &[]);
    let one = |(effect, size): (&String, &f64)| {
        let drawn = draw(effect, record, &base, noise)?;
        let magnitude = scale.magnitude(|m| drawn.at(m), drawn.guess, drawn.most, *size)?;
        Some(drawn.at(magnitude))
    };
    cell.effects.iter().zip(&cell.sizes).map(one).collect()
}
