//! The project's language rules: plain words, lines that fit the screen, functions that fit a page
//! and have few branches.
//!
//! Checks every file of Rust and Markdown, and the comments of Python, TOML, C and linker scripts,
//! `CHANGELOG.md` excepted. The words to avoid are in `terms.txt`, the functions without limits in
//! `exempt-functions.txt`.

mod functions;
mod prose;

use crate::run::{ChoreError, root};
use prose::{Rules, Text};
use std::path::{Path, PathBuf};

/// A place that departs from the rules.
struct Departure {
    /// Path relative to the workspace's root.
    file: PathBuf,
    /// Line number, from 1.
    line: usize,
    /// The finding.
    message: String,
}

/// Prints the departures, by line or as counts by file, and fails if there are any.
pub(crate) fn language(paths: &[PathBuf], by_file: bool) -> Result<(), ChoreError> {
    let departures = find(paths)?;
    if by_file {
        for group in departures.chunk_by(|a, b| a.file == b.file) {
            let file = group.first().map(|first| first.file.display().to_string());
            println!("{:5}  {}", group.len(), file.unwrap_or_default());
        }
    } else {
        for Departure { file, line, message } in &departures {
            println!("{}:{line}: {message}", file.display());
        }
    }
    match departures.len() {
        0 => Ok(()),
        count => Err(ChoreError::ByHand(format!("{count} departures from the language rules"))),
    }
}

/// Rejects a workspace that departs from the rules.
pub(crate) fn check() -> Result<(), ChoreError> {
    match find(&[])?.len() {
        0 => Ok(()),
        count => Err(ChoreError::ByHand(format!(
            "{count} departures from the language rules: cargo xtask language"
        ))),
    }
}

/// Finds the departures below some paths; below the root if none is given.
fn find(paths: &[PathBuf]) -> Result<Vec<Departure>, ChoreError> {
    let rules = Rules::read()?;
    let all = [root().to_path_buf()];
    let mut files = vec![];
    for path in if paths.is_empty() { &all[..] } else { paths } {
        collect(&std::path::absolute(path).unwrap_or_else(|_| path.clone()), &mut files)?;
    }
    files.sort();
    let mut departures = vec![];
    for (path, text) in files {
        let content = std::fs::read_to_string(&path).map_err(|error| unreadable(&path, &error))?;
        let mut found = rules.check(text, &content);
        let file = path.strip_prefix(root()).unwrap_or(&path).to_path_buf();
        if text == Text::Rust {
            found.extend(functions::check(&file.to_string_lossy(), &content));
        }
        found.sort();
        let departure = |(line, message)| Departure { file: file.clone(), line, message };
        departures.extend(found.into_iter().map(departure));
    }
    Ok(departures)
}

/// Collects the files to check: no hidden folders except cargo's, no build output.
fn collect(path: &Path, files: &mut Vec<(PathBuf, Text)>) -> Result<(), ChoreError> {
    if !path.is_dir() {
        let is_exempt = path.file_name().is_some_and(|name| name == "CHANGELOG.md");
        files.extend(Text::for_path(path).filter(|_| !is_exempt).map(|text| (path.to_path_buf(), text)));
        return Ok(());
    }
    // Cargo marks its target folders with this file.
    if path.join("CACHEDIR.TAG").exists() {
        return Ok(());
    }
    for entry in std::fs::read_dir(path).map_err(|error| unreadable(path, &error))?.flatten() {
        let name = entry.file_name();
        let is_hidden = name.to_string_lossy().starts_with('.') && name != ".cargo";
        if !is_hidden && name != "out" {
            collect(&entry.path(), files)?;
        }
    }
    Ok(())
}

fn unreadable(path: &Path, error: &std::io::Error) -> ChoreError {
    ChoreError::File { file: path.to_path_buf(), found: error.to_string(), expected: "a readable file" }
}
