//! Blocks of documents that are written from golden figures or from a run.
//!
//! A block lies between `<!-- NAME: cargo xtask bless -->` and `<!-- end of NAME -->`.

use crate::run::{ChoreError, root, write_atomically};
use std::path::PathBuf;

/// A block of a document.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    /// Path of the document, relative to the workspace.
    pub(crate) file: &'static str,
    /// Name in the markers.
    pub(crate) name: &'static str,
}

impl Block {
    fn path(self) -> PathBuf {
        root().join(self.file)
    }

    /// Returns the document as it is, and as it would be with this content.
    fn texts(self, content: &str) -> Result<[String; 2], ChoreError> {
        let wrong = |found: String| ChoreError::File {
            file: self.path(),
            found,
            expected: "a document with the block's two marker comments",
        };
        let text = std::fs::read_to_string(self.path()).map_err(|error| wrong(error.to_string()))?;
        let filled = fill(&text, self.name, content)
            .ok_or_else(|| wrong(format!("no place for the block `{}`", self.name)))?;
        Ok([text, filled])
    }

    /// Writes the document with this content.
    pub(crate) fn write(self, content: &str) -> Result<(), ChoreError> {
        let [_, filled] = self.texts(content)?;
        write_atomically(self.path(), filled)
    }

    /// Rejects a document with another content.
    pub(crate) fn check(self, content: &str) -> Result<(), ChoreError> {
        let [found, expected] = self.texts(content)?;
        if found == expected {
            return Ok(());
        }
        let what =
            format!("{}, block `{}`; if the change is intended: cargo xtask bless", self.file, self.name);
        Err(ChoreError::Differs { what, found, expected })
    }
}

fn fill(text: &str, name: &str, content: &str) -> Option<String> {
    let begin = format!("<!-- {name}: cargo xtask bless -->\n");
    let end = format!("<!-- end of {name} -->\n");
    let (before, rest) = text.split_once(&begin)?;
    let (_, after) = rest.split_once(&end)?;
    Some(format!("{before}{begin}\n{}\n\n{end}{after}", content.trim_end()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_named_block_is_replaced() {
        let text = "a\n<!-- x: cargo xtask bless -->\nold\n<!-- end of x -->\nb\n";
        let filled = fill(text, "x", "new\n").unwrap();
        assert_eq!(filled, "a\n<!-- x: cargo xtask bless -->\n\nnew\n\n<!-- end of x -->\nb\n");
        assert_eq!(fill(&filled, "x", "new").unwrap(), filled);
        assert_eq!(fill(text, "y", "new"), None);
    }
}
