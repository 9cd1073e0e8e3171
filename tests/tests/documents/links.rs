//! Every page is in the table of contents, and every link, picture and path leads to something.

use super::markdown::{Document, Part, documents, pages, read, root};
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

/// Folders at the root by which a code span is known as a path.
const FOLDERS: [&str; 9] =
    ["crates", "docs", "examples", "firmware", "host-sim", "model-quant", "tests", "xtask", "fuzz"];

fn links(document: &Document) -> Vec<String> {
    let link = |part| if let Part::Link(target) = part { Some(target) } else { None };
    document.parts().into_iter().filter_map(link).collect()
}

fn is_external(target: &str) -> bool {
    target.starts_with("https://")
}

/// Path without `..`, relative to the project's root; `None` if it leads out of it.
fn resolved(path: &Path) -> Option<PathBuf> {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => out.pop().then_some(())?,
            Component::CurDir => {}
            part => out.push(part),
        }
    }
    Some(out)
}

/// Why a link is wrong, if it is.
fn fault(from: &Document, target: &str) -> Option<String> {
    let (file, anchor) = target.split_once('#').map_or((target, None), |(file, a)| (file, Some(a)));
    let folder = from.path.parent()?;
    let path = if file.is_empty() { Some(from.path.clone()) } else { resolved(&folder.join(file)) };
    let Some(path) = path.filter(|path| root().join(path).exists()) else {
        return Some("no such file".into());
    };
    if folder == Path::new("docs") && !path.starts_with("docs") {
        return Some("leads out of the site; name the file by its path instead".into());
    }
    let anchor = anchor?;
    let is_known = read(&path).anchors().contains(anchor);
    (!is_known).then(|| format!("{} has no heading `{anchor}`", path.display()))
}

#[test]
fn every_page_is_once_in_the_table_of_contents() {
    let listed = links(&read("docs/SUMMARY.md"));
    let pages: Vec<PathBuf> = pages().into_iter().map(|page| page.path).collect();
    let in_docs = |name: &String| Path::new("docs").join(name);
    let unlisted: Vec<_> = pages.iter().filter(|path| !listed.iter().any(|l| in_docs(l) == **path)).collect();
    assert!(unlisted.is_empty(), "not in docs/SUMMARY.md: {unlisted:?}");
    let missing: Vec<_> = listed.iter().filter(|name| !pages.contains(&in_docs(name))).collect();
    assert!(missing.is_empty(), "docs/SUMMARY.md names pages that do not exist: {missing:?}");
    assert_eq!(listed.iter().collect::<BTreeSet<_>>().len(), listed.len(), "a page is listed twice");
    let front = links(&read("docs/README.md"));
    let unknown: Vec<_> =
        listed.iter().filter(|name| *name != "README.md" && !front.contains(name)).collect();
    assert!(unknown.is_empty(), "not on the front page docs/README.md: {unknown:?}");
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let mut faults = vec![];
    let mut count = 0;
    for document in documents() {
        for target in links(&document).iter().filter(|target| !is_external(target)) {
            count += 1;
            faults.extend(fault(&document, target).map(|why| (document.path.clone(), target.clone(), why)));
        }
    }
    assert!(faults.is_empty() && count > 100, "{count} links, of which: {faults:#?}");
}

#[test]
fn a_link_to_a_missing_file_or_heading_or_out_of_the_site_is_a_fault() {
    let page = Document { path: "docs/x.md".into(), text: String::new() };
    assert_eq!(fault(&page, "firmware.md#flashing"), None);
    assert_eq!(fault(&page, "images/bench.svg"), None);
    for wrong in ["firmwear.md", "firmware.md#flushing", "images/none.svg", "../README.md", "../../x"] {
        assert!(fault(&page, wrong).is_some(), "{wrong}");
    }
    let top = Document { path: "README.md".into(), text: String::new() };
    assert_eq!(fault(&top, "docs/firmware.md#flashing"), None);
}

#[test]
fn every_picture_is_shown_and_loads_nothing() {
    let shown: BTreeSet<PathBuf> = documents()
        .iter()
        .flat_map(|document| {
            let folder = document.path.parent().unwrap().to_owned();
            links(document).into_iter().filter_map(move |target| resolved(&folder.join(target)))
        })
        .collect();
    for entry in std::fs::read_dir(root().join("docs/images")).unwrap() {
        let name = entry.unwrap().file_name();
        let path = Path::new("docs/images").join(&name);
        assert!(shown.contains(&path), "no document shows {path:?}");
        let text = std::fs::read_to_string(root().join(&path)).unwrap();
        let loads = ["<script", "<image", "href=\"http", "@import", "url(http"];
        assert!(loads.iter().all(|part| !text.contains(part)), "{path:?} loads something");
    }
}

#[test]
fn every_path_in_code_exists() {
    let mut missing = vec![];
    for document in documents() {
        for part in document.parts() {
            let Part::Code(code) = part else { continue };
            let is_path = code.chars().all(|c| c.is_ascii_alphanumeric() || "-_./".contains(c));
            let is_known = code.split_once('/').is_some_and(|(first, _)| FOLDERS.contains(&first));
            if is_path && is_known && !root().join(&code).exists() {
                missing.push((document.path.clone(), code));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}
