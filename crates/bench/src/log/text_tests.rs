//! Text logs in the formats of other programs without a `[log]` table, and expressions of columns.

use super::tests::own;
use super::*;
use crate::signals::Channel;
use proptest::prelude::*;
use std::collections::BTreeMap;

const PLAIN: &str = "t_s,position_m,drive_force_n\n0,1.5,-20\n0.5,2.25,\n1,-3e-3,40.125\n";

fn read(bytes: &[u8], columns: &str) -> Result<MeasuredLog, LogError> {
    let columns = parsed(columns);
    reader::from_bytes("a.csv", bytes.to_vec(), &LogFormat { columns, ..own() }, false)
}

/// Reads a `[columns]` table as a description does.
fn parsed(columns: &str) -> Columns {
    super::columns(toml::de::Deserializer::parse(columns).unwrap()).unwrap()
}

fn refused(text: &str, columns: &str) -> String {
    read(text.as_bytes(), columns).unwrap_err().to_string()
}

#[test]
fn a_description_with_expressions_survives_a_round_trip() {
    let (_, preset) = crate::PRESETS.iter().find(|(name, _)| *name == "friction-rig").unwrap();
    let text = format!("{preset}\n[columns]\nt_s = \"t / 1e3\"\ndrive_torque_nm = \"(a - `b c`) * 2\"\n");
    let bench = crate::Bench::parse("a", &text).unwrap();
    let columns = &bench.log_format().columns;
    assert_eq!(columns["drive_torque_nm"], Column::from("(a - `b c`) * 2".to_owned()));
    assert_eq!(bench.log_format().text, None);
    assert_eq!(crate::Bench::parse("b", &bench.to_toml().unwrap()).unwrap(), bench);
}

/// Times and channels as bits, which compare missing values too.
fn bits(log: &MeasuredLog) -> Vec<Vec<u64>> {
    let columns = std::iter::once(&log.time_s).chain(log.channels.values());
    columns.map(|values| values.iter().map(|value| value.to_bits()).collect()).collect()
}

#[test]
fn a_text_of_any_detected_format_is_the_same_record_to_the_bit() {
    let plain = read(PLAIN.as_bytes(), "").unwrap();
    let commas = PLAIN.replace(',', ";").replace('.', ",");
    let utf_16 = |unit: fn(u16) -> [u8; 2]| -> Vec<u8> {
        format!("\u{feff}{commas}").encode_utf16().flat_map(unit).collect()
    };
    let quoted = |line: &str| format!("\"{}\"\n", line.replace(';', "\";\""));
    for (name, bytes) in [
        ("semicolons", PLAIN.replace(',', ";").into_bytes()),
        ("decimal commas", commas.clone().into_bytes()),
        ("tabs", PLAIN.replace(',', "\t").into_bytes()),
        ("tabs and decimal commas", commas.replace(';', "\t").into_bytes()),
        ("blanks", PLAIN.replace("25,\n", "25,nan\n").replace(',', "  ").into_bytes()),
        ("blanks and decimal commas", commas.replace("25;\n", "25;nan\n").replace(';', " ").into_bytes()),
        ("quotes", commas.lines().map(quoted).collect::<String>().into_bytes()),
        ("blanks around fields", PLAIN.replace(',', " , ").into_bytes()),
        ("units", commas.replacen('\n', "\ns;m;N\n", 1).into_bytes()),
        ("units in brackets", PLAIN.replacen('\n', "\n[s],[m],\n", 1).into_bytes()),
        ("comments", format!("# a logger\n% another one, 1;2\n\n{commas}").into_bytes()),
        ("comments between rows", PLAIN.replace("\n1,", "\n# paused\n1,").into_bytes()),
        ("line ends of Windows", commas.replace('\n', "\r\n").into_bytes()),
        ("byte order mark", format!("\u{feff}{commas}").into_bytes()),
        ("separator of a spreadsheet", format!("sep=;\n{commas}").into_bytes()),
        ("UTF-16, little end first", utf_16(u16::to_le_bytes)),
        ("UTF-16, big end first", utf_16(u16::to_be_bytes)),
    ] {
        let log = read(&bytes, "").unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(bits(&log), bits(&plain), "{name}");
    }
    let headerless = commas.split_once('\n').unwrap().1;
    let columns = "t_s = { from = 0 }\nposition_m = { from = 1 }\ndrive_force_n = \"column(2)\"";
    assert_eq!(bits(&read(headerless.as_bytes(), columns).unwrap()), bits(&plain));
    let latin_1 = b"t_s;Kraft_\xe4;Winkel [\xb0]\n0;1;2\n1;2;3\n";
    let log = read(latin_1, "position_m = \"Kraft_\u{e4} - `Winkel [\u{b0}]`\"").unwrap();
    assert_eq!(log.channels[&Channel::Position], [-1.0, -1.0]);
}

#[test]
fn damaged_texts_and_commas_at_the_end_of_lines_keep_their_names() {
    let text = b"\xef\xbb\xbft_s,position_m\n0,1\n1,2\n# \xb5m\n";
    assert_eq!(read(text, "").unwrap().channels[&Channel::Position], [1.0, 2.0]);
    let cut = "t_s;Kraft_\u{e4}\n0;1\n1;2\n# \u{b0}".as_bytes();
    let log = read(&cut[..cut.len() - 1], "position_m = \"Kraft_\u{e4}\"").unwrap();
    assert_eq!(log.channels[&Channel::Position], [1.0, 2.0]);
    let log = read(b"t_s, position_m\n0, 1,\n1, 2,\n", "").unwrap();
    assert_eq!(log.channels[&Channel::Position], [1.0, 2.0]);
}

#[test]
fn a_negative_number_in_another_form_is_no_unit() {
    let log = "t;x\n-1.000,0;-1.234,5\n-999,0;0,5\n-998,0;1,5\n";
    let message = refused(log, "t_s = \"t\"\nposition_m = \"x\"");
    assert!(message.contains("line 2") && message.contains("thousands"), "{message}");
}

#[test]
fn expressions_are_the_same_in_every_file_format() {
    let log = MeasuredLog {
        source: "x".into(),
        time_s: vec![0.0, 250.0, 500.0],
        channels: BTreeMap::from([
            (Channel::Position, vec![1.0, 2.0, 4.0]),
            (Channel::Velocity, vec![0.5, f64::NAN, 2.0]),
        ]),
    };
    let columns = parsed(
        "t_s = \"t_s / 1000\"\nposition_m = \"position_m\"\n\
         velocity_m_s = \"-(velocity_m_s + column(1)) ^ 2\"\n\
         drive_force_n = { from = \"(position_m - velocity_m_s) * 4.9e-4\", scale = 10.0, offset = 1.0 }",
    );
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.csv", "a.parquet", "a.mat"] {
        let path = folder.path().join(name);
        log.write(&path).unwrap();
        let format = LogFormat { columns: columns.clone(), ..own() };
        let read = MeasuredLog::read_as_found(&path, &format).unwrap();
        assert_eq!(read.time_s, [0.0, 0.25, 0.5], "{name}");
        let (force, speed) = (&read.channels[&Channel::DriveForce], &read.channels[&Channel::Velocity]);
        assert_eq!((force[0], force[2]), (10.0 * (0.5 * 4.9e-4) + 1.0, 10.0 * (2.0 * 4.9e-4) + 1.0));
        assert_eq!((speed[0], speed[2]), (-2.25, -36.0), "{name}");
        assert!(force[1].is_nan() && speed[1].is_nan(), "{name}");
    }
}

#[test]
fn wrong_columns_are_refused_together_with_their_entries() {
    let text = "t;p_a;p B\n0;1;2\n1;2;3\n";
    let columns = "t_s = \"t_ms / 1000\"\nposition_m = \"(p_a - 1\"\nvelocity_m_s = \"x\"\n\
                   drive_force_n = \"p_a - p_b * q\"\nload_force_n = \"Druck [bar]\"";
    assert_eq!(
        refused(text, columns),
        "a.csv: 5 columns cannot be read\n  \
         columns.t_s: found `t_ms / 1000`, but no column is `t_ms`; expected columns among `t`, \
         `p_a`, `p B`\n  \
         columns.drive_force_n: found `p_a - p_b * q`, but no column is `p_b` or `q`; expected \
         columns among `t`, `p_a`, `p B`\n  \
         columns.load_force_n: `Druck [bar]` is neither a column nor an expression: at character 7 found \
         `[`; expected an operator or the end, or a column among `t`, `p_a`, `p B`\n  \
         columns.position_m: `(p_a - 1` is neither a column nor an expression: at character 9 found \
         the end; expected `)` or an operator, or a column among `t`, `p_a`, `p B`\n  \
         columns.velocity_m_s: no column `x` among `t`, `p_a`, `p B`; expected a header with `x`"
    );
    let time = "t_s = \"t\"\n";
    for (columns, expected) in [
        (
            "position_m = \"p_a - column(9)\"",
            "columns.position_m: found `p_a - column(9)`, but there is no column(9); expected columns \
             among `t`, `p_a`, `p B`",
        ),
        (
            "position_m = \"5\"",
            "columns.position_m: found `5`, an expression without a column; expected a column among `t`, \
             `p_a`, `p B`; an index is `from = 0`, or `column(0)` in an expression",
        ),
        (
            "position_m = \"p_a / t\"",
            "line 2, position_m: found inf from `p_a / t` with p_a = 1, t = 0; expected a finite number",
        ),
        (
            "position_m = \"sqrt(1 - `p B`)\"",
            "line 2, position_m: found NaN from `sqrt(1 - `p B`)` with p B = 2; expected a finite number",
        ),
        (
            "position_m = \"column(3)\"",
            "columns.position_m: found `column(3)`, but there is no column(3); expected columns among `t`, \
             `p_a`, `p B`",
        ),
    ] {
        let format = LogFormat { columns: parsed(&format!("{time}{columns}")), ..own() };
        let error = MeasuredLog::parse("a.csv", text, &format).unwrap_err().to_string();
        assert_eq!(error, format!("a.csv: {expected}"));
    }
}

#[test]
fn a_row_with_more_fields_than_the_header_is_refused_with_its_line() {
    let expected = "a.csv: 3 fields in line 3; expected at most 2, as many as columns";
    for text in ["t_s,position_m\n0,1\n1,2,999\n2,3\n3,4\n4,5\n", "0,1\n\n1,2,999\n2,3\n3,4\n4,5\n5,6\n"] {
        assert_eq!(refused(text, "t_s = \"column(0)\"\nposition_m = \"column(1)\""), expected);
        assert_eq!(RawLog::from_bytes("a.csv", text.into()).unwrap_err().to_string(), expected);
    }
    let empty = "t_s,position_m\n0,1,\n1,2,,\n2,3\n";
    assert_eq!(read(empty.as_bytes(), "").unwrap().channels[&Channel::Position], [1.0, 2.0, 3.0]);
    // Without a known format the first fields may be those of another separator.
    let error = refused("t_s,position_m\n0,a,5\n1,b,6\n2,c,7\n", "");
    assert_eq!(error, "a.csv: line 2, t_s: found 3 fields; expected at most one for each column");
}

#[test]
fn one_column_of_numbers_is_read() {
    for (text, name, unit) in [("x\nmm\n1.5\nnan\n2.5\n", "x", "mm"), ("1.5\nnan\n2.5\n", "", "")] {
        let log = RawLog::from_bytes("a.csv", text.into()).unwrap();
        let [column] = log.columns.as_slice() else { panic!("{:?}", log.columns) };
        assert_eq!((column.name.as_str(), column.unit.as_str(), column.values.len()), (name, unit, 3));
    }
}

#[test]
fn texts_of_doubtful_meaning_are_refused() {
    for (text, expected) in [
        (
            "t_s;position_m\n0,5;1.234,5\n1,5;2.345,6\n",
            "a.csv: line 2, position_m: found `1.234,5`; expected a number without separators of thousands",
        ),
        (
            "t_s;position_m\n0,5;999,5\n1,5;1.000\n2,5;1,5\n3,5;1,5\n",
            "a.csv: line 3, position_m: found `1.000`; expected a number with a decimal comma and without \
             separators of thousands",
        ),
        (
            "t_s;position_m\n0;\"1,234.5\"\n1;\"1,235.5\"\n",
            "a.csv: line 2, position_m: found `1,234.5`; expected a number without separators of thousands",
        ),
        (
            "t_s position_m\n0;x 1\n1;y 2\n",
            "a.csv: no column `t_s` among `t_s position_m`; expected a header with `t_s`; no separator \
             divides the text into columns of numbers, so commas were assumed",
        ),
        (
            "0;1\n1;2\n",
            "a.csv: no column `t_s` among 2 columns without a header; expected a header with `t_s`",
        ),
    ] {
        assert_eq!(refused(text, ""), expected);
    }
}

/// A random table in the text of a program: separator, decimal sign, line end, quotes, units.
fn written() -> impl Strategy<Value = (String, Vec<Vec<f64>>)> {
    let rows = proptest::collection::vec(proptest::collection::vec(-1e6..1e6_f64, 3), 3..20);
    let style = (0..7_usize, any::<bool>(), any::<bool>(), any::<bool>(), 0..6_usize);
    (rows, style).prop_map(|(mut rows, (style, windows, quotes, units, digits))| {
        let styles = [(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ","), ("  ", "."), (" ", ",")];
        let (separator, sign) = styles[style];
        let mut text = ["t_s", "position_m", "drive_force_n"].join(separator) + "\n";
        if units {
            text += &(["s", "m", "N"].join(separator) + "\n");
        }
        for (index, row) in rows.iter_mut().enumerate() {
            row[0] = index as f64;
            let number = |value: &mut f64| {
                let number = format!("{value:.digits$}");
                *value = number.parse().unwrap();
                let number = number.replace('.', sign);
                if quotes && separator.trim() == separator { format!("\"{number}\"") } else { number }
            };
            text += &(row.iter_mut().map(number).collect::<Vec<_>>().join(separator) + "\n");
        }
        (if windows { text.replace('\n', "\r\n") } else { text }, rows)
    })
}

proptest! {
    #[test]
    fn a_table_is_read_back_from_the_text_of_any_program((text, rows) in written()) {
        let log = MeasuredLog::parse("x", &text, &own()).unwrap();
        let column = |index: usize| rows.iter().map(|row| row[index]).collect::<Vec<f64>>();
        prop_assert_eq!(&log.time_s, &column(0), "{}", text);
        prop_assert_eq!(&log.channels[&Channel::Position], &column(1), "{}", text);
        prop_assert_eq!(&log.channels[&Channel::DriveForce], &column(2), "{}", text);
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = reader::from_bytes("x", bytes.clone(), &own(), false);
        let _ = RawLog::from_bytes("x", bytes);
    }
}
