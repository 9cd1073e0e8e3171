//! The documentation site: the pages of `docs`, built with mdBook, and a check that the site needs
//! no network and contains no broken link.

use crate::run::{ChoreError, of_file, output_of, root, run, succeeds, target_folder};
use regex_lite::Regex;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Expectation about every file of the site.
const READABLE: &str = "a readable file";
/// Version of mdBook with which the site was looked at.
const VERSION: &str = "0.5.4";

/// Builds the site and returns its first page.
pub(crate) fn book() -> Result<PathBuf, ChoreError> {
    let install = format!("cargo install mdbook --locked --version {VERSION}");
    let found = output_of(Command::new("mdbook").arg("--version"))
        .map_err(|_| ChoreError::ByHand(format!("mdbook is missing; type: {install}")))?;
    if !found.trim().ends_with(VERSION) {
        eprintln!("found {}; the site was tried with {VERSION}: {install}", found.trim());
    }
    let site =
        std::path::absolute(target_folder().join("book")).map_err(of_file(Path::new("book"), READABLE))?;
    run(Command::new("mdbook").current_dir(root()).args(["build", "docs", "--dest-dir"]).arg(&site))?;
    let mut faults = vec![];
    let pages = files(&site)?;
    for page in pages.iter().filter(|path| path.extension().is_some_and(|e| e == "html" || e == "css")) {
        let text = std::fs::read_to_string(page).map_err(of_file(page, READABLE))?;
        let name = page.strip_prefix(&site).unwrap_or(page).display();
        faults.extend(loaded_from_outside(&text).into_iter().map(|found| format!("{name} loads {found}")));
        let is_missing = |target: &String| !page.with_file_name(target).exists();
        faults.extend(targets(&text).into_iter().filter(is_missing).map(|t| format!("{name} links to {t}")));
    }
    if faults.is_empty() {
        return Ok(site.join("index.html"));
    }
    faults.dedup();
    let expected = "a site that loads nothing from outside, with links to its own files";
    Err(ChoreError::File { file: site, found: faults.join("\n"), expected })
}

/// Builds the site if mdBook is installed; else returns what was not checked.
pub(crate) fn check() -> Result<Option<String>, ChoreError> {
    if succeeds(Command::new("mdbook").arg("--version")) {
        return book().map(|_| None);
    }
    Ok(Some("documentation site: mdbook is not installed".into()))
}

/// Addresses of other servers from which a page or a style loads something. Links that a reader
/// follows do not count.
fn loaded_from_outside(text: &str) -> Vec<String> {
    let load = Regex::new(r#"(?:src="|<link[^>]*href="|url\(["']?|@import\s+["'])((?:https?:)?//[^"')]+)"#);
    captures(load, text)
}

/// Files of the site to which a page links, without anchors.
fn targets(text: &str) -> Vec<String> {
    let found = captures(Regex::new(r##"(?:src|href)="([^"#?]+)"##), text);
    found.into_iter().filter(|t| !t.contains(':') && !t.starts_with('/')).collect()
}

fn captures(pattern: Result<Regex, regex_lite::Error>, text: &str) -> Vec<String> {
    let Ok(pattern) = pattern else { return vec![] };
    pattern.captures_iter(text).filter_map(|c| c.get(1)).map(|found| found.as_str().to_owned()).collect()
}

/// Files below a folder.
fn files(folder: &Path) -> Result<Vec<PathBuf>, ChoreError> {
    let mut found = vec![];
    for entry in std::fs::read_dir(folder).map_err(of_file(folder, READABLE))? {
        let path = entry.map_err(of_file(folder, READABLE))?.path();
        if path.is_dir() { found.extend(files(&path)?) } else { found.push(path) }
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_page_loads_from_outside_is_found_and_links_are_not() {
        let page = r#"<a href="https://a.b/c">c</a><img src="x.svg"><script src="https://d.e/f.js"></script>
            <link rel="stylesheet" href="//g.h/i.css">"#;
        assert_eq!(loaded_from_outside(page), ["https://d.e/f.js", "//g.h/i.css"]);
        assert_eq!(loaded_from_outside("a { src: url('https://j.k/l.woff2') }"), ["https://j.k/l.woff2"]);
    }

    #[test]
    fn targets_are_the_files_of_the_site() {
        let page = r##"<a href="firmware.html#flashing"><a href="#top"><a href="mailto:x@y">
            <img src="images/a.svg">"##;
        assert_eq!(targets(page), ["firmware.html", "images/a.svg"]);
    }
}
