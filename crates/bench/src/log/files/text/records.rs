//! Splitting of a text into rows of fields, without its comments.

use crate::log::Separator;
use csv::StringRecord;
use std::borrow::Cow;

/// Reason to refuse a text: the content found and expected.
pub(super) type Refusal = (String, &'static str);

/// Calls `add` with the line from 1 and the trimmed fields of each row that is not empty.
pub(super) fn for_each_row(
    text: &str,
    separator: Separator,
    mut add: impl FnMut(u64, &StringRecord) -> Result<(), Refusal>,
) -> Result<(), Refusal> {
    let mut record = StringRecord::new();
    let delimiter = match separator {
        Separator::Whitespace => {
            for (line, text) in (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty()) {
                record.clear();
                text.split_whitespace().for_each(|field| record.push_field(field));
                add(line, &record)?;
            }
            return Ok(());
        }
        Separator::Comma => b',',
        Separator::Semicolon => b';',
        Separator::Tab => b'\t',
    };
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .delimiter(delimiter)
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    while reader.read_record(&mut record).map_err(|error| (error.to_string(), "readable CSV"))? {
        let line = record.position().map_or(0, |start| start.line() + empty_lines(text, start.byte()));
        add(line, &record)?;
    }
    Ok(())
}

/// Number of empty lines from a byte, which the reader counts as the begin of the next row.
fn empty_lines(text: &str, byte: u64) -> u64 {
    let rest = usize::try_from(byte).ok().and_then(|start| text.as_bytes().get(start..));
    let ends = rest.into_iter().flatten().take_while(|byte| matches!(byte, b'\r' | b'\n'));
    ends.filter(|byte| **byte == b'\n').count() as u64
}

/// Fields of a row.
pub(super) fn fields(record: &StringRecord) -> Vec<String> {
    record.iter().map(str::to_owned).collect()
}

/// Removes the byte order mark and replaces comments by empty lines, so that the other lines keep
/// their numbers. The separator that a spreadsheet states in the first line counts as a comment
/// too, a line that begins with a quote does not.
pub(super) fn without_comments(text: &str) -> Cow<'_, str> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    // `%name` may be the name of a column.
    let is_comment = |line: &str| {
        let after = |sign| line.strip_prefix(sign);
        after('#').is_some()
            || after('%').is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric()))
    };
    let is_separator = text.starts_with("sep=") && text.lines().next().is_some_and(|line| line.len() == 5);
    if !is_separator && !text.lines().any(is_comment) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len());
    for (index, line) in text.lines().enumerate() {
        if !(is_comment(line) || is_separator && index == 0) {
            out.push_str(line);
        }
        out.push('\n');
    }
    Cow::Owned(out)
}

/// Begin of the header and of the units where names or units look like numbers; `log convert`
/// writes it.
pub(in crate::log::files) const MARK: &str = "\" ";

/// Number of leading lines with the mark of a header and of units, if the line after them has no
/// quotes.
pub(super) fn marked_lines(text: &str) -> usize {
    let mut lines = text.lines().filter(|line| !line.is_empty());
    let mut count = 0;
    loop {
        match lines.next() {
            Some(line) if line.starts_with(MARK) && count < 2 => count += 1,
            Some(line) if !line.contains('"') => return count,
            _ => return 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_after_empty_lines_and_comments_have_their_line() {
        let text = "# a\n\nt,x\n\"0\n\",1\r\n\r\n# b\r\n2,3\n4,5";
        let mut lines = Vec::new();
        let add = |line, _: &StringRecord| {
            lines.push(line);
            Ok(())
        };
        for_each_row(&without_comments(text), Separator::Comma, add).unwrap();
        assert_eq!(lines, [3, 4, 8, 9]);
    }

    #[test]
    fn marked_lines_are_those_before_lines_without_quotes() {
        for (text, count) in [
            ("\" 1\",\" 2\"\n0,1\n", 1),
            ("\" 1\",\" 2\"\n\" s\",\n0,1\n", 2),
            ("1,2\n", 0),
            ("\" 1\",\" 2\"\n\" 1\",\" 2\"\n\" 1\",\" 2\"\n", 0),
            ("\"1\",\"2\"\n0,1\n", 0),
            ("\" 1\",\" 2\"\n\"0\",1\n", 0),
            ("", 0),
        ] {
            assert_eq!(marked_lines(text), count, "{text}");
        }
    }
}
