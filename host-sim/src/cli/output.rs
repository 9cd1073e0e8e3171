//! Files in the output folder of a command.

use crate::cli::error::CliError;
use bench::atomic;
use report::figure::{Chart, Series};
use report::page::Page;
use serde::Serialize;
use std::path::Path;

/// Writes a file completely or not at all.
pub(crate) fn write(folder: &Path, name: &str, text: &str) -> Result<(), CliError> {
    let path = folder.join(name);
    atomic::write(&path, text.as_bytes()).map_err(|e| CliError::output(&path, &e))
}

/// Creates the folder and checks that it can be written, before the work starts.
pub(crate) fn prepare_folder(folder: &Path) -> Result<(), CliError> {
    let tried = std::fs::create_dir_all(folder).and_then(|()| tempfile::tempfile_in(folder));
    tried.map(drop).map_err(|e| CliError::output(folder, &e))
}

/// Formats a value as indented JSON.
pub(crate) fn json(value: &impl Serialize) -> Result<String, CliError> {
    serde_json::to_string_pretty(value).map_err(|e| CliError::Work(e.to_string()))
}

/// A picture with file name and caption.
pub(crate) struct Picture {
    /// File name without extension.
    pub(crate) name: String,
    /// Caption.
    pub(crate) caption: String,
    /// The picture.
    pub(crate) svg: String,
}

impl Picture {
    /// Draws a picture.
    pub(crate) fn draw(
        draw: impl Fn(&Chart, &[Series]) -> Result<String, String>,
        name: &str,
        chart: &Chart,
        series: &[Series],
        caption: &str,
    ) -> Result<Self, CliError> {
        let svg = draw(chart, series).map_err(CliError::Work)?;
        Ok(Self { name: name.into(), caption: caption.into(), svg })
    }
}

/// Adds pictures to a page, side by side where there is room.
pub(crate) fn show(page: &mut Page, pictures: &[Picture]) {
    let pairs: Vec<(String, &str)> = pictures.iter().map(|p| (p.svg.clone(), p.caption.as_str())).collect();
    page.figures(&pairs);
}

/// Writes each picture as a file.
pub(crate) fn save(folder: &Path, pictures: &[Picture]) -> Result<(), CliError> {
    pictures.iter().try_for_each(|p| write(folder, &format!("{}.svg", p.name), &p.svg))
}
