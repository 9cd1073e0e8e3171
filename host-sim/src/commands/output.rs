//! What a command leaves in its folder.

use crate::error::CliError;
use crate::figure::{Chart, Series};
use crate::page::Page;
use bench::atomic;
use serde::Serialize;
use std::path::Path;

/// Writes a file whole or not at all.
pub(super) fn write(folder: &Path, name: &str, text: &str) -> Result<(), CliError> {
    let path = folder.join(name);
    atomic::write(&path, text.as_bytes()).map_err(|e| CliError::output(&path, &e))
}

/// Makes the folder and sees that it can be written to, before the work and not after it.
pub(super) fn ready(folder: &Path) -> Result<(), CliError> {
    let tried = std::fs::create_dir_all(folder).and_then(|()| tempfile::tempfile_in(folder));
    tried.map(drop).map_err(|e| CliError::output(folder, &e))
}

/// A value as indented JSON.
pub(super) fn json(value: &impl Serialize) -> Result<String, CliError> {
    serde_json::to_string_pretty(value).map_err(|e| CliError::Work(e.to_string()))
}

/// A picture: file name without extension, caption, SVG.
pub(super) struct Picture {
    /// File name without extension.
    pub(super) name: String,
    /// Caption.
    pub(super) caption: String,
    /// The picture.
    pub(super) svg: String,
}

impl Picture {
    /// Draws a picture.
    pub(super) fn draw(
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

/// Puts pictures on a page, side by side where there is room.
pub(super) fn show(page: &mut Page, pictures: &[Picture]) {
    let pairs: Vec<(String, &str)> = pictures.iter().map(|p| (p.svg.clone(), p.caption.as_str())).collect();
    page.figures(&pairs);
}

/// Writes pictures as files of their own.
pub(super) fn save(folder: &Path, pictures: &[Picture]) -> Result<(), CliError> {
    pictures.iter().try_for_each(|p| write(folder, &format!("{}.svg", p.name), &p.svg))
}
