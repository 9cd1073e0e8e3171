//! Documents of the project, and what the tests need of their Markdown: code, links, headings.

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Documents outside `docs`.
const TOP: [&str; 3] = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"];
/// Languages of code blocks whose content is commands.
const SHELLS: [&str; 3] = ["sh", "bash", "console"];

/// A document.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    /// Path relative to the project's root.
    pub(crate) path: PathBuf,
    /// Content.
    pub(crate) text: String,
}

/// A part of a document that the tests look at, in reading order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// A heading's text.
    Heading(String),
    /// A fenced code block: language and content.
    Block(String, String),
    /// Code within a sentence or a cell.
    Code(String),
    /// Target of a link or an image.
    Link(String),
}

/// Returns the project's root.
pub(crate) fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// Reads a document.
pub(crate) fn read(path: impl AsRef<Path>) -> Document {
    let path = path.as_ref().to_owned();
    let text =
        std::fs::read_to_string(root().join(&path)).unwrap_or_else(|error| panic!("{path:?}: {error}"));
    Document { path, text }
}

/// Pages of the site, sorted: those in `docs` without the table of contents.
pub(crate) fn pages() -> Vec<Document> {
    let entries = std::fs::read_dir(root().join("docs")).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|n| n.ends_with(".md") && n != "SUMMARY.md").collect();
    names.sort();
    names.iter().map(|name| read(Path::new("docs").join(name))).collect()
}

/// Pages of the site and the documents at the project's root.
pub(crate) fn documents() -> Vec<Document> {
    let mut all = pages();
    all.extend(TOP.map(read));
    all
}

impl Document {
    /// Returns the parts of the document.
    pub(crate) fn parts(&self) -> Vec<Part> {
        let (mut parts, mut open) = (vec![], None);
        for event in Parser::new_ext(&self.text, Options::ENABLE_TABLES) {
            match (event, &mut open) {
                (Event::Start(Tag::Heading { .. }), _) => open = Some(Part::Heading(String::new())),
                (Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(language))), _) => {
                    open = Some(Part::Block(language.into_string(), String::new()));
                }
                (Event::End(TagEnd::Heading(_) | TagEnd::CodeBlock), _) => parts.extend(open.take()),
                (
                    Event::Text(text) | Event::Code(text),
                    Some(Part::Heading(content) | Part::Block(_, content)),
                ) => content.push_str(&text),
                (Event::Code(text), None) => parts.push(Part::Code(text.into_string())),
                (Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }), _) => {
                    parts.push(Part::Link(dest_url.into_string()));
                }
                _ => {}
            }
        }
        parts
    }

    /// Returns the anchors of the headings, as GitHub and mdBook form them.
    pub(crate) fn anchors(&self) -> BTreeSet<String> {
        let mut anchors = BTreeSet::new();
        for part in self.parts() {
            if let Part::Heading(text) = part {
                let kept = |c: char| match c {
                    ' ' => Some('-'),
                    c if c.is_alphanumeric() || c == '-' || c == '_' => Some(c),
                    _ => None,
                };
                let anchor: String = text.to_lowercase().chars().filter_map(kept).collect();
                let numbered = (1..).map(|number| format!("{anchor}-{number}"));
                let free = std::iter::once(anchor.clone()).chain(numbered).find(|a| !anchors.contains(a));
                anchors.extend(free);
            }
        }
        anchors
    }
}

/// Returns true if a code block contains commands.
pub(crate) fn is_shell(language: &str) -> bool {
    SHELLS.contains(&language)
}

/// A command of a code block, and what the block shows as its output.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Command {
    /// One logical line for the shell.
    pub(crate) line: String,
    /// Output that stands under it; empty if none is shown.
    pub(crate) output: String,
}

/// Returns the commands of a code block. A line that ends with a backslash continues. In a block
/// `console` commands begin with `$` and other lines are their output.
pub(crate) fn commands(language: &str, content: &str) -> Vec<Command> {
    let (mut found, mut is_open): (Vec<Command>, bool) = (vec![], false);
    for line in content.lines() {
        let command = line.strip_prefix("$ ");
        match (found.last_mut().filter(|_| is_open || (language == "console" && command.is_none())), is_open)
        {
            (Some(last), true) => last.line.push_str(line.trim_start()),
            (Some(last), false) => {
                last.output.push_str(line);
                last.output.push('\n');
                continue;
            }
            (None, _) => {
                let line = if language == "console" { command.unwrap_or_default() } else { line };
                if line.trim().is_empty() || line.starts_with('#') {
                    continue;
                }
                found.push(Command { line: line.trim().into(), output: String::new() });
            }
        }
        if let Some(last) = found.last_mut() {
            is_open = last.line.ends_with('\\');
            if is_open {
                last.line.pop();
            }
        }
    }
    found
}

#[test]
fn parts_are_found_in_reading_order() {
    let text = "# A `b`\n\nSee [c](d.md#e), `f` and\n\n```sh\ng\n```\n\n| `h` |\n|---|\n| ![i](j.svg) |\n";
    let document = Document { path: "x.md".into(), text: text.into() };
    let expected = [
        Part::Heading("A b".into()),
        Part::Link("d.md#e".into()),
        Part::Code("f".into()),
        Part::Block("sh".into(), "g\n".into()),
        Part::Code("h".into()),
        Part::Link("j.svg".into()),
    ];
    assert_eq!(document.parts(), expected);
    assert!(document.anchors().contains("a-b"));
}

#[test]
fn commands_are_separated_from_comments_and_outputs() {
    let command = |line: &str, output: &str| Command { line: line.into(), output: output.into() };
    let shell = commands("sh", "# comment\na --b \\\n  c\n\nd   # comment\n");
    assert_eq!(shell, [command("a --b c", ""), command("d   # comment", "")]);
    let console = commands("console", "$ a \\\n  b\nout\n$ c\n");
    assert_eq!(console, [command("a b", "out\n"), command("c", "")]);
}
