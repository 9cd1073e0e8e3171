//! Sheets as people write them: titles, missing headers, texts among numbers, dates.

use crate::log::{LogError, LogFormat, MeasuredLog, RawLog};
use std::io::{Cursor, Write};
use zip::write::{SimpleFileOptions, ZipWriter};

/// Styles 1 to 3: a date with a time, a time of day, a duration.
const STYLES: &str = r#"<styleSheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main">
<cellXfs count="4"><xf numFmtId="0"/><xf numFmtId="22"/><xf numFmtId="21"/><xf numFmtId="46"/></cellXfs>
</styleSheet>"#;

/// Sheet of a table: lines, and cells divided by `|`. `@1.5` is a date, `^0.5` a time, `~2.5` a
/// duration, `#N/A` an error, `'1` a text.
fn sheet(table: &str) -> String {
    let cell = |text: &str, column: usize, row: usize| {
        let place = super::field::cell_name(row as u32, column);
        let (sign, rest) = text.split_at_checked(1).unwrap_or(("", ""));
        let style = match sign {
            "" => return String::new(),
            "#" => return format!(r#"<c r="{place}" t="e"><v>{text}</v></c>"#),
            "@" => 1,
            "^" => 2,
            "~" => 3,
            _ if text.parse::<f64>().is_ok() => return format!(r#"<c r="{place}"><v>{text}</v></c>"#),
            _ => {
                let text = text.trim_start_matches('\'');
                return format!(r#"<c r="{place}" t="inlineStr"><is><t>{text}</t></is></c>"#);
            }
        };
        format!(r#"<c r="{place}" s="{style}"><v>{rest}</v></c>"#)
    };
    let row = |(row, line): (usize, &str)| {
        let cells = line.split('|').enumerate().map(|(column, text)| cell(text, column, row));
        format!(r#"<row r="{}">{}</row>"#, row + 1, cells.collect::<String>())
    };
    let rows: String = table.lines().enumerate().map(row).collect();
    let main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    format!(r#"<worksheet xmlns="{main}"><sheetData>{rows}</sheetData></worksheet>"#)
}

/// Workbook of sheets with names.
fn workbook(sheets: &[(&str, String)]) -> Vec<u8> {
    let (mut list, mut relations) = (String::new(), String::new());
    let namespace = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let mut parts = Vec::new();
    for (index, (name, content)) in sheets.iter().enumerate() {
        list += &format!(r#"<sheet name="{name}" sheetId="{}" r:id="r{index}"/>"#, index + 1);
        let kind = format!("{namespace}/worksheet");
        relations +=
            &format!(r#"<Relationship Id="r{index}" Type="{kind}" Target="worksheets/{index}.xml"/>"#);
        parts.push((format!("xl/worksheets/{index}.xml"), content.clone()));
    }
    let main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    let book =
        format!(r#"<workbook xmlns="{main}" xmlns:r="{namespace}"><sheets>{list}</sheets></workbook>"#);
    let package = "http://schemas.openxmlformats.org/package/2006/relationships";
    relations += &format!(r#"<Relationship Id="s" Type="{namespace}/styles" Target="styles.xml"/>"#);
    let relations = format!(r#"<Relationships xmlns="{package}">{relations}</Relationships>"#);
    parts.push((super::WORKBOOK.into(), book));
    let kind = format!("{namespace}/officeDocument");
    let root = format!(r#"<Relationship Id="b" Type="{kind}" Target="{}"/>"#, super::WORKBOOK);
    let root = format!(r#"<Relationships xmlns="{package}">{root}</Relationships>"#);
    parts.push(("_rels/.rels".into(), root));
    parts.push(("xl/_rels/workbook.xml.rels".into(), relations));
    parts.push(("xl/styles.xml".into(), STYLES.into()));
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    for (name, content) in parts {
        archive.start_file(name, options).unwrap();
        archive.write_all(content.as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn read(sheets: &[(&str, String)]) -> Result<RawLog, LogError> {
    RawLog::from_bytes("a.xlsx", workbook(sheets))
}

fn one(table: &str) -> RawLog {
    read(&[("A", sheet(table))]).unwrap()
}

/// Columns as `name [unit]: values`.
fn columns(log: &RawLog) -> Vec<String> {
    let column = |c: &crate::log::RawColumn| format!("{} [{}]: {:?}", c.name, c.unit, c.values);
    log.columns.iter().map(column).collect()
}

fn others(log: &RawLog) -> Vec<String> {
    log.others.iter().map(|other| format!("{}: {}", other.name, other.reason)).collect()
}

#[test]
fn dates_are_in_seconds_whatever_the_row_of_units() {
    let log = one("time|x\nms|N\n@45292.5|1\n@45292.75|2\n@45293.5|3");
    assert_eq!(columns(&log), ["time [s]: [0.0, 21600.0, 86400.0]", "x [N]: [1.0, 2.0, 3.0]"]);
}

#[test]
fn the_dates_of_all_sheets_have_one_origin_and_times_of_day_their_own() {
    let first = sheet("t|x|clock|run\n@45292.5|1|^0.25|~1.5\n@45293.5|2|^0.75|~2.5");
    let second = sheet("t|y|end\n@45292.25|1|@45294.5\n@45293|2|@45295.5");
    let log = read(&[("A", first), ("B", second)]).unwrap();
    assert_eq!(
        columns(&log),
        [
            "A/t [s]: [21600.0, 108000.0]",
            "x []: [1.0, 2.0]",
            "clock [s]: [0.0, 43200.0]",
            "run [s]: [0.0, 86400.0]",
            "B/t [s]: [0.0, 64800.0]",
            "y []: [1.0, 2.0]",
            "end [s]: [194400.0, 280800.0]",
        ]
    );
}

#[test]
fn dates_among_numbers_are_refused_with_their_cell() {
    let log = one("time|x|y\n@45292.5|1|1\n45292.6|2|2\n@45292.7|@3.5|3");
    assert_eq!(columns(&log), ["y []: [1.0, 2.0, 3.0]"]);
    assert_eq!(
        others(&log),
        [
            "time: a number without the format of a date in cell A3 below a date or time",
            "x: a date or time in cell B4 below a number",
        ]
    );
}

#[test]
fn a_text_among_numbers_is_refused_with_its_cell_and_missing_values_are_read() {
    let log = one("t|a|b|c\n0|1|1|1\n1|12,5|2|nan\n2|3|defect|#N/A\n3|4|4|n/a\n4|5|5|5");
    assert_eq!(columns(&log), ["t []: [0.0, 1.0, 2.0, 3.0, 4.0]", "c []: [1.0, NaN, NaN, NaN, 5.0]"]);
    assert_eq!(others(&log), ["a: `12,5` in cell B3", "b: `defect` in cell C4"]);
    let format = LogFormat {
        columns: [("t_s", "t"), ("position_m", "a")]
            .map(|(signal, name)| (signal.to_owned(), name.to_owned().into()))
            .into(),
        ..LogFormat::default()
    };
    let bytes = workbook(&[("A", sheet("t|a\n0|1\n1|1.234,5\n2|3"))]);
    let error = crate::log::reader::from_bytes("a.xlsx", bytes, &format, false).map(|_: MeasuredLog| ());
    let expected = "a.xlsx: column `a` for position_m: `1.234,5` in cell B3; expected numbers";
    assert_eq!(error.unwrap_err().to_string(), expected);
}

#[test]
fn titles_are_skipped_and_columns_without_a_header_have_their_letter() {
    let log = one("Log of 5 May\n\nt|F||note\ns|N\n0|1|5|a\n1|2|6|b");
    assert_eq!(columns(&log), ["t [s]: [0.0, 1.0]", "F [N]: [1.0, 2.0]", "C []: [5.0, 6.0]"]);
    assert_eq!(others(&log), ["note: `a` in cell D5"]);
    let log = read(&[("A", sheet("0|1\n1|2")), ("B", sheet("0|3\n1|4"))]).unwrap();
    let names: Vec<&str> = log.columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["A/A", "A/B", "B/A", "B/B"]);
}

#[test]
fn numbers_below_the_rows_in_which_a_header_is_searched_are_read() {
    let rows: String = (0..500).map(|i| format!("\n{i}|{}", if i < 300 { "" } else { "2" })).collect();
    let log = one(&format!("t|late{rows}|7"));
    assert_eq!(log.columns.iter().map(|c| c.values.len()).collect::<Vec<_>>(), [500, 500, 500]);
    assert_eq!((log.columns[1].name.as_str(), log.columns[1].values[300]), ("late", 2.0));
    assert_eq!((log.columns[2].name.as_str(), log.columns[2].values[499]), ("C", 7.0));
}

#[test]
fn a_damaged_sheet_is_named_with_its_reason() {
    let whole = sheet("t|x\n0|1\n1|2");
    let cut = whole[..whole.len() / 2].to_owned();
    for damaged in [cut.as_str(), "<worksheet><sheetData><row r=\"1\"><c r=\"?\"", "no sheet", ""] {
        let log = read(&[("A", whole.clone()), ("B", damaged.to_owned())]).unwrap();
        assert_eq!(log.columns.len(), 2, "{damaged}");
        let [other] = log.others.as_slice() else { panic!("{:?}", log.others) };
        assert!(other.name == "B" && other.reason.starts_with("sheet `B`: "), "{damaged}: {other:?}");
        let alone = read(&[("B", damaged.to_owned())]).unwrap_err().to_string();
        assert!(alone.starts_with("a.xlsx: sheet `B`: "), "{alone}");
    }
}
