//! Files in the output folder of a command.

use crate::cli::error::CliError;
use crate::cli::provenance::{Provenance, Stamped};
use bench::atomic::{self, StagedFile};
use report::figure::{Chart, Drawing, Series};
use report::page::Page;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Writes a file completely or not at all.
pub(crate) fn write(folder: &Path, name: &str, text: &str) -> Result<(), CliError> {
    let path = folder.join(name);
    atomic::write(&path, text.as_bytes()).map_err(|e| CliError::output(&path, &e))
}

/// Checks before the work starts that files can be written to a folder. Creates nothing.
///
/// # Errors
///
/// A file is at the path or above it, or nothing can be written there.
pub(crate) fn check_folder(folder: &Path) -> Result<(), CliError> {
    // The parent of a plain file name is empty.
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let absolute = std::path::absolute(folder).map_err(|e| CliError::output(folder, &e))?;
    let Some(existing) = absolute.ancestors().find(|path| path.exists()) else { return Ok(()) };
    if !existing.is_dir() {
        let text = format!("{}: found a file; expected a folder", existing.display());
        return Err(CliError::Work(text));
    }
    tempfile::tempfile_in(existing).map(drop).map_err(|e| CliError::output(folder, &e))
}

/// Files of one result in a folder. They are complete before the first appears, so only a failure
/// between two renames could leave a part.
pub(crate) struct Files {
    folder: PathBuf,
    staged: Vec<StagedFile>,
    absent: Vec<PathBuf>,
}

impl Files {
    /// Starts a set without files.
    pub(crate) fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), staged: Vec::new(), absent: Vec::new() }
    }

    /// Adds a file. It appears with the others.
    pub(crate) fn add(&mut self, name: &str, text: &str) -> Result<(), CliError> {
        let path = self.folder.join(name);
        self.staged.push(StagedFile::write(&path, text.as_bytes()).map_err(|e| CliError::output(&path, &e))?);
        Ok(())
    }

    /// Removes a file of an earlier result that this one does not have.
    pub(crate) fn leave_out(&mut self, name: &str) {
        self.absent.push(self.folder.join(name));
    }

    /// Adds a result as JSON, with its origin. Returns the text.
    pub(crate) fn add_result(&mut self, name: &str, result: &impl Serialize) -> Result<String, CliError> {
        let text = result_json(result)?;
        self.add(name, &format!("{text}\n"))?;
        Ok(text)
    }

    /// Adds the origin as a separate file: of results that are the same bytes whether one machine
    /// or several computed them.
    pub(crate) fn add_provenance(&mut self) -> Result<(), CliError> {
        let text = json(&Provenance::of_process())?;
        self.add("provenance.json", &format!("{text}\n"))
    }

    /// Adds a page, with its origin at the end.
    pub(crate) fn add_page(&mut self, name: &str, mut page: Page) -> Result<(), CliError> {
        Provenance::of_process().add_to(&mut page);
        self.add(name, &page.render())
    }

    /// Adds each picture as a file.
    pub(crate) fn add_pictures(&mut self, pictures: &[Picture]) -> Result<(), CliError> {
        pictures.iter().try_for_each(|p| self.add(&format!("{}.svg", p.name), &p.drawing.svg))
    }

    /// Lets all files appear.
    pub(crate) fn publish(self) -> Result<(), CliError> {
        if let Some(taken) = self.staged.iter().map(StagedFile::path).find(|path| path.is_dir()) {
            let text = format!("{}: cannot be written: found a folder; expected a file", taken.display());
            return Err(CliError::Work(text));
        }
        for path in self.absent.iter().filter(|path| path.is_file()) {
            std::fs::remove_file(path).map_err(|e| CliError::output(path, &e))?;
        }
        for file in self.staged {
            let path = file.path().to_owned();
            file.publish().map_err(|e| CliError::output(&path, &e))?;
        }
        Ok(())
    }
}

/// Formats a value as indented JSON.
pub(crate) fn json(value: &impl Serialize) -> Result<String, CliError> {
    serde_json::to_string_pretty(value).map_err(|e| CliError::Work(e.to_string()))
}

/// Formats a result as indented JSON, with its origin at the end.
pub(crate) fn result_json(result: &impl Serialize) -> Result<String, CliError> {
    json(&Stamped { result, provenance: Provenance::of_process() })
}

/// A picture with file name and caption.
pub(crate) struct Picture {
    /// File name without extension.
    pub(crate) name: String,
    /// Caption.
    pub(crate) caption: String,
    /// The picture.
    pub(crate) drawing: Drawing,
}

impl Picture {
    /// Draws a picture.
    pub(crate) fn draw(
        draw: impl Fn(&Chart, &[Series]) -> Result<Drawing, String>,
        name: &str,
        chart: &Chart,
        series: &[Series],
        caption: &str,
    ) -> Result<Self, CliError> {
        let drawing = draw(chart, series).map_err(CliError::Work)?;
        Ok(Self { name: name.into(), caption: caption.into(), drawing })
    }
}

/// Adds pictures to a page, side by side where there is room.
pub(crate) fn show(page: &mut Page, pictures: &[Picture]) {
    let pairs: Vec<(Drawing, &str)> =
        pictures.iter().map(|p| (p.drawing.clone(), p.caption.as_str())).collect();
    page.figures(&pairs);
}
