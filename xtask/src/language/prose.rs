//! Line rules: width, the first word of a doc comment, and terms that the project does not use.
//!
//! In Python, TOML, C and linker scripts only comments have a maximum width; the terms apply to all
//! lines.

use crate::run::ChoreError;
use regex_lite::{Regex, RegexBuilder};
use std::path::Path;

/// Maximum width of a line of code, in characters.
pub(super) const MAX_CODE_WIDTH: usize = 110;
/// Maximum width of a line of comment or Markdown prose, in characters.
pub(super) const MAX_PROSE_WIDTH: usize = 100;
/// First words that make a doc comment a riddle.
const OPENING: &str = r"^\s*//[/!]\s+(What|Whether|Where|Who|Which|How|Of)\b";
/// The terms with their replacements.
const TERMS: &str = include_str!("terms.txt");

/// Quoted names that other programs read and that therefore stay: the flag of corrupted memory.
const SERIALISED_NAMES: [&str; 2] = ["`altered`", concat!("\"", "altered", "\"")];

/// Kind of text that a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Text {
    /// Rust code with comments.
    Rust,
    /// Markdown prose with tables and code blocks.
    Markdown,
    /// Python or TOML: comments after `#`, and documentation between `"""`.
    Hash,
    /// C or a linker script: comments after `//`, and between `/*` and `*/`.
    C,
}

impl Text {
    /// Returns the kind of a file by its extension; `None` for a file that is not checked.
    pub(super) fn for_path(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()? {
            "rs" => Some(Self::Rust),
            "md" => Some(Self::Markdown),
            "py" | "toml" => Some(Self::Hash),
            "c" | "x" => Some(Self::C),
            _ => None,
        }
    }
}

/// A term that is not used, and the replacement.
struct Term {
    pattern: Regex,
    /// The text is matched as written; otherwise underscores count as spaces and case is ignored.
    is_verbatim: bool,
    replacement: &'static str,
}

/// The compiled line rules.
pub(super) struct Rules {
    opening: Regex,
    terms: Vec<Term>,
}

impl Rules {
    /// Reads the list of terms.
    pub(super) fn read() -> Result<Self, ChoreError> {
        let lines = TERMS.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
        let terms = lines.map(|line| {
            let (pattern, replacement) = line.split_once(" => ").ok_or_else(|| {
                ChoreError::ByHand(format!("terms.txt: `{line}`: expected `pattern => term`"))
            })?;
            let is_verbatim = pattern.contains('_') || pattern.chars().all(|c| c.is_ascii_uppercase());
            let pattern = compile(&format!(r"\b(?:{pattern})\b"), !is_verbatim)?;
            Ok(Term { pattern, is_verbatim, replacement })
        });
        Ok(Self { opening: compile(OPENING, false)?, terms: terms.collect::<Result<_, ChoreError>>()? })
    }

    /// Lists the departures in a file's text: line number from 1, and what is wrong.
    pub(super) fn check(&self, text: Text, content: &str) -> Vec<(usize, String)> {
        let mut departures = vec![];
        let mut is_block = false;
        for (number, line) in (1..).zip(content.lines()) {
            let was_block = is_block;
            is_block = is_block_after(text, was_block, line);
            // A fence belongs to its code block, the last line of a comment to its comment.
            let is_in_block = is_block || (was_block && text != Text::Markdown);
            let (width, max_width) = (line.chars().count(), max_width(text, is_in_block, line));
            if width > max_width {
                departures.push((number, format!("{width} characters wide; at most {max_width}")));
            }
            if text == Text::Rust
                && let Some(opening) = self.opening.captures(line).and_then(|c| c.get(1))
            {
                let opening = opening.as_str();
                departures.push((
                    number,
                    format!("a doc comment begins with `{opening}`; begin with a noun or a verb"),
                ));
            }
            departures.extend(self.terms_in(line).map(|message| (number, message)));
        }
        departures
    }

    /// Returns the terms of a line, except for the serialised names.
    fn terms_in(&self, line: &str) -> impl Iterator<Item = String> {
        let line = SERIALISED_NAMES.iter().fold(line.to_owned(), |line, name| line.replace(name, ""));
        let spaced = line.replace('_', " ");
        self.terms.iter().flat_map(move |term| {
            let line = if term.is_verbatim { &line } else { &spaced };
            let found: Vec<_> = term.pattern.find_iter(line).map(|found| found.as_str().to_owned()).collect();
            found.into_iter().map(|found| format!("`{found}`; write: {}", term.replacement))
        })
    }
}

fn compile(pattern: &str, ignores_case: bool) -> Result<Regex, ChoreError> {
    RegexBuilder::new(pattern)
        .case_insensitive(ignores_case)
        .build()
        .map_err(|error| ChoreError::ByHand(format!("`{pattern}` in the language rules: {error}")))
}

/// Returns `true` if a block continues after a line: a code block of Markdown, a documentation
/// string of Python, a comment of C.
fn is_block_after(text: Text, is_block: bool, line: &str) -> bool {
    match text {
        Text::Rust => false,
        Text::Markdown => is_block != line.trim_start().starts_with("```"),
        Text::Hash => is_block != (line.matches("\"\"\"").count() % 2 == 1),
        Text::C => match (line.rfind("/*"), line.rfind("*/")) {
            (None, None) => is_block,
            (start, end) => start > end,
        },
    }
}

/// Returns the maximum width of a line. Tables, code blocks, lines without a space to break at, and
/// code in other languages than Rust have none.
fn max_width(text: Text, is_block: bool, line: &str) -> usize {
    let trimmed = line.trim_start();
    let prose = trimmed.trim_start_matches(['/', '!', '>', '#', '*']).trim();
    let is_prose = match text {
        Text::Rust => trimmed.starts_with("//"),
        Text::Markdown => !is_block,
        Text::Hash => is_block || trimmed.starts_with('#') || trimmed.starts_with("\"\"\""),
        Text::C => is_block || ["//", "/*"].iter().any(|start| trimmed.starts_with(start)),
    };
    match text {
        _ if is_prose && (prose.starts_with('|') || !prose.contains(' ')) => usize::MAX,
        _ if is_prose => MAX_PROSE_WIDTH,
        Text::Rust => MAX_CODE_WIDTH,
        Text::Markdown | Text::Hash | Text::C => usize::MAX,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn departures(text: Text, content: &str) -> Vec<(usize, String)> {
        Rules::read().unwrap().check(text, content)
    }

    #[test]
    fn a_listed_term_is_reported_with_its_replacement_and_its_line() {
        // Put together at run time, so that this file passes its own check.
        let term = ["to", "ld"].concat();
        for line in [term.clone(), format!("fn has_{term}_it()"), format!("\"{}\"", term.to_uppercase())] {
            let found = departures(Text::Rust, &format!("\n{line}\n"));
            assert!(
                matches!(&found[..], [(2, message)] if message.ends_with("reported, known")),
                "{found:?}"
            );
        }
        assert_eq!(departures(Text::Rust, &format!("un{term}")), []);
        let constant = ["MO", "ST_STEPS"].concat();
        assert_eq!(departures(Text::Rust, &constant).len(), 1);
        assert_eq!(departures(Text::Rust, &constant.to_lowercase()), []);
    }

    #[test]
    fn width_is_checked_except_in_tables_code_blocks_and_unbreakable_lines() {
        let wide = "a ".repeat(51);
        assert_eq!(departures(Text::Markdown, &wide).len(), 1);
        assert_eq!(departures(Text::Markdown, &format!("| {wide}\n```\n{wide}\n```\n")), []);
        assert_eq!(departures(Text::Markdown, &format!("https://{}", "a".repeat(100))), []);
        assert_eq!(departures(Text::Rust, &wide), []);
        assert_eq!(departures(Text::Rust, &format!("// {wide}")).len(), 1);
        assert_eq!(departures(Text::Rust, &format!("x = {wide}{wide}")).len(), 1);
    }

    #[test]
    fn comments_of_other_languages_are_prose_and_their_code_is_not() {
        let wide = "a ".repeat(51);
        for (text, content, count) in [
            (Text::Hash, format!("# {wide}"), 1),
            (Text::Hash, format!("\"\"\"A.\n{wide}\n\"\"\"\n{wide}"), 1),
            (Text::Hash, format!("    \"\"\"{wide}\"\"\"\n{wide}"), 1),
            (Text::C, format!("/* A.\n{wide}\n{wide} */\n{wide}"), 2),
            (Text::C, format!("// {wide}\n{wide}"), 1),
            (Text::C, format!("    /* {wide} */\n{wide}"), 1),
        ] {
            assert_eq!(departures(text, &content).len(), count, "{content}");
        }
        let term = ["to", "ld"].concat();
        assert_eq!(departures(Text::Hash, &format!("{term} = 1")).len(), 1);
    }

    #[test]
    fn a_constant_is_not_named_by_a_bare_superlative() {
        for name in [["MO", "ST"].concat(), ["LEA", "ST"].concat()] {
            assert_eq!(departures(Text::Rust, &format!("const {name}: u8 = 1;")).len(), 1);
            assert_eq!(departures(Text::Rust, &format!("const {}: u8 = 1;", name.to_lowercase())), []);
        }
    }

    #[test]
    fn only_a_doc_comment_has_a_forbidden_first_word() {
        let comment = ["Whe", "ther it runs."].concat();
        assert_eq!(departures(Text::Rust, &format!("    /// {comment}")).len(), 1);
        assert_eq!(departures(Text::Rust, &format!("//! {comment}")).len(), 1);
        assert_eq!(departures(Text::Rust, &format!("// {comment}\n/// Whatever")), []);
    }
}
