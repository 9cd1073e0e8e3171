//! Files of other programs with what only MCAP has, and hostile files.

use super::made::{channel, chunk, definition, file, message, record, whole};
use crate::log::RawLog;
use std::collections::BTreeMap;
use std::path::Path;

fn read(name: &str) -> RawLog {
    RawLog::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/logs").join(name)).unwrap()
}

fn columns(log: &RawLog) -> BTreeMap<&str, &[f64]> {
    log.columns.iter().map(|column| (column.name.as_str(), column.values.as_slice())).collect()
}

fn reason<'a>(log: &'a RawLog, name: &str) -> &'a str {
    let found = log.others.iter().find(|other| other.name == name);
    &found.unwrap_or_else(|| panic!("{name}: {:?}", log.others)).reason
}

/// Error of a file.
fn refused(bytes: Vec<u8>) -> String {
    RawLog::from_bytes("a.mcap", bytes).unwrap_err().to_string()
}

/// Error of a file with one message of ROS 1.
fn of_ros_1(text: &str, data: &[u8]) -> String {
    refused(file("ros1", ("ros1msg", text.as_bytes()), &[data]))
}

/// Column of two messages of ROS 1.
fn read_ros_1(text: &str, messages: [&[u8]; 2]) -> RawLog {
    RawLog::from_bytes("a.mcap", file("ros1", ("ros1msg", text.as_bytes()), &messages)).unwrap()
}

/// `mcap-columns.tsv` contains the numbers as mcap-ros2-support decodes them.
#[test]
fn numbers_of_every_type_are_those_of_another_decoder() {
    let (log, mut count) = (read("mcap-types.mcap"), 0);
    let found = columns(&log);
    for line in include_str!("../../../../tests/logs/mcap-columns.tsv").lines() {
        let (name, values) = line.split_once('\t').unwrap();
        let values = values.split('\t').map(|value| value.parse().unwrap_or(f64::NAN));
        let is_same = |(a, b): (&f64, f64)| *a == b || a.is_nan() && b.is_nan();
        let column = found.get(name).unwrap_or_else(|| panic!("{name}: {:?}", found.keys()));
        assert!(column.iter().zip(values).all(is_same), "{line}: {column:?}");
        count += 1;
    }
    assert_eq!((found.len(), count), (count, 36));
    let others: Vec<(&str, &str)> = log.others.iter().map(|o| (o.name.as_str(), o.reason.as_str())).collect();
    let texts =
        ["/types.list[].label", "/types.part.label", "/types.parts[].label", "/types.texts[]", "/types.word"];
    assert_eq!(others, texts.map(|name| (name, "texts")));
}

#[test]
fn topics_have_their_own_times_and_other_content_has_a_reason() {
    let log = read("ros2-zstd.mcap");
    let found = columns(&log);
    assert_eq!(found["/joints.position[elevator]"], [0.5; 100]);
    assert_eq!(found["/slow.data"], [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0]);
    assert_eq!((found["/slow.time"][0], found["/slow.time"][9]), (0.0, 0.9));
    let time_of = |name: &str| {
        let column = log.columns.iter().find(|column| column.name == name).unwrap();
        (
            log.columns.iter().find(|time| Some(time.index) == column.time).unwrap().name.as_str(),
            &*column.group,
        )
    };
    assert_eq!(time_of("/slow.data"), ("/slow.time", "/slow"));
    assert_eq!(time_of("/joints.effort[rudder]"), ("/joints.time", "/joints"));
    assert_eq!(bench_time(&log), "/joints.time");
    assert_eq!(reason(&log, "/note.data"), "texts");
    assert_eq!(reason(&log, "/other"), "messages in `protobuf`");
    let log = read("ros1-lz4.mcap");
    assert_eq!(reason(&log, "/camera.data"), "an array of more than 1000 elements");
    assert_eq!(columns(&log)["/camera.height"], [20.0; 3]);
    let log = read("json.mcap");
    let found = columns(&log);
    assert!(found["/bench.gap"][5].is_nan() && found["/bench.gap"][99] == 99.0);
    assert_eq!((found["/bench.axis.is_on"][0], found["/bench.axis.force[1]"][7]), (1.0, 7.0));
}

fn bench_time(log: &RawLog) -> &str {
    &crate::template::time_column(log).unwrap().0.name
}

const STAMPED: &str =
    "Header header\nfloat64 x\n====\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";

#[test]
fn times_of_the_header_count_unless_one_is_missing() {
    let stamped = |seconds: u32| [&[0; 4][..], &seconds.to_le_bytes(), &[0; 4], &[0; 4], &[0; 8]].concat();
    for (stamps, expected) in [([5, 7], [0.0, 2.0]), ([5, 0], [0.0, 0.01])] {
        let log = read_ros_1(STAMPED, [&stamped(stamps[0]), &stamped(stamps[1])]);
        assert_eq!(columns(&log)["/t.time"], expected);
    }
}

#[test]
fn only_distinct_printable_names_stand_for_indices() {
    let joints = |names: [&[u8]; 2]| {
        let names = names.map(|name| [&(name.len() as u32).to_le_bytes()[..], name].concat()).concat();
        [&2_u32.to_le_bytes()[..], &names, &2_u32.to_le_bytes(), &[0; 16]].concat()
    };
    for (names, expected) in [
        ([&b"a"[..], b"b"], ["/t.time", "/t.x[a]", "/t.x[b]"]),
        ([b"a", b"a"], ["/t.time", "/t.x[0]", "/t.x[1]"]),
        ([b"a", b""], ["/t.time", "/t.x[0]", "/t.x[1]"]),
        ([b"a", b"\x1b[2J"], ["/t.time", "/t.x[0]", "/t.x[1]"]),
    ] {
        let message = joints(names);
        let log = read_ros_1("string[] name\nfloat64[] x\n", [&message, &message]);
        assert_eq!(columns(&log).into_keys().collect::<Vec<_>>(), expected);
    }
}

#[test]
fn a_bag_is_refused_with_the_command_that_converts_it() {
    let bag = refused(b"#ROSBAG V2.0\nE\0\0\0".to_vec());
    assert!(bag.contains("a bag of ROS 1; expected MCAP; `mcap convert FILE.bag FILE.mcap`"), "{bag}");
    let database = refused(b"SQLite format 3\0\x10\0".to_vec());
    assert!(database.contains("`mcap convert FILE.db3 FILE.mcap`"), "{database}");
    assert!(refused(b"\x89MCAP1\r\n".to_vec()).contains("MCAP of an unknown version"));
}

#[test]
fn a_message_that_does_not_fit_its_definition_ends_its_topic() {
    for (text, data, expected) in [
        ("float64 x", &[0; 7][..], "`/t`: message 1 has content that ends too early"),
        ("float64 x", &[0; 9], "message 1 has 1 bytes after the last field"),
        ("float64[] x", &[0xff; 12], "`/t.x` with 4294967295 elements, more than the message contains"),
        ("float64[4294967295] x", &[0; 8], "`/t.x` with 4294967295 elements"),
        ("string x", &[0xff; 8], "content that ends too early"),
        ("a/T x", &[0; 8], "types that contain themselves"),
    ] {
        let found = of_ros_1(text, data);
        assert!(found.starts_with("a.mcap: no columns of numbers"), "{found}");
        assert!(found.contains(expected), "{text}: {found}");
    }
    let cdr = refused(file("cdr", ("ros2msg", b"float64 x"), &[&[0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]]));
    assert!(cdr.contains("a representation other than plain CDR"), "{cdr}");
    let idl = refused(file("cdr", ("ros2idl", b"module a {};"), &[&[0; 12]]));
    assert!(idl.contains("definitions in `ros2idl`"), "{idl}");
}

/// Elements without content would cost time but no bytes.
#[test]
fn arrays_of_empty_messages_are_passed_over() {
    let text = "float64 x\nE[4294967295] y\nE z\n====\nMSG: a/E\nF[4294967295] f\n====\nMSG: a/F\nint8 C=1\n";
    let log = read_ros_1(text, [&1.0_f64.to_le_bytes(), &2.0_f64.to_le_bytes()]);
    assert_eq!(columns(&log)["/t.x"], [1.0, 2.0]);
}

#[test]
fn more_columns_than_a_file_may_have_are_refused() {
    let fields: String = (0..101).map(|field| format!("int8 f{field}\n")).collect();
    let text = format!("P[1000] p\n====\nMSG: a/P\n{fields}");
    let found = of_ros_1(&text, &[0; 101_000]);
    assert!(found.contains("more than can be held at byte") && found.contains("100000 columns"), "{found}");
}

#[test]
fn json_that_is_nested_too_deeply_or_too_large_is_refused() {
    let json = |data: &[u8]| refused(file("json", ("", b""), &[data]));
    assert!(json("[".repeat(100_000).as_bytes()).contains("recursion limit exceeded"));
    assert!(json(&vec![b'['; (1 << 24) + 1]).contains("more than 16 MB of JSON"));
    assert!(json(b"{\"a\": ").contains("damaged JSON"));
    let long = format!("{{\"{}\": 1}}", "k".repeat(1000));
    assert!(json(long.as_bytes()).contains("a field with a name of more than 1000 bytes"));
}

/// A frame of zstd with blocks that each stand for 128 kB of one byte.
fn zstd_bomb(blocks: usize) -> Vec<u8> {
    let block = |is_last: bool| (u32::from(is_last) | 1 << 1 | (1 << 17) << 3).to_le_bytes();
    let mut out = vec![0x28, 0xb5, 0x2f, 0xfd, 0, 0x38];
    for index in 0..blocks {
        out.extend(&block(index + 1 == blocks)[..3]);
        out.push(0);
    }
    out
}

#[test]
fn a_chunk_unpacks_to_no_more_than_it_states() {
    for (compression, bomb) in [("zstd", zstd_bomb(10_000)), ("lz4", lz4(&vec![0; 1 << 24]))] {
        assert!(bomb.len() < 100_000, "{compression}: {}", bomb.len());
        let found = refused(whole(&chunk(compression, 1000, 0, &bomb)));
        assert!(found.contains("a chunk with other than the 1000 bytes that it states at byte 8"), "{found}");
        let found = refused(whole(&chunk(compression, 1 << 40, 0, &bomb)));
        assert!(
            found.contains("more than can be held at byte 8") && found.contains("256 MB in a chunk"),
            "{found}"
        );
        let found = refused(whole(&chunk(compression, 1 << 20, 0, &bomb[..bomb.len() / 2])));
        assert!(found.contains("a chunk with "), "{found}");
    }
}

/// Writers may divide a chunk into frames and pad it.
#[test]
fn a_chunk_of_several_frames_with_padding_is_read() {
    let records = [
        definition(1, "ros1msg", b"float64 x"),
        channel(1, 1, "/t", "ros1"),
        message(1, 0, &1.0_f64.to_le_bytes()),
        message(1, 1_000_000_000, &2.0_f64.to_le_bytes()),
    ]
    .concat();
    let (first, second) = records.split_at(70);
    let zstd = |part: &[u8]| {
        // One block that is not compressed.
        let block = 1 | (part.len() as u32) << 3;
        [&[0x28, 0xb5, 0x2f, 0xfd, 0, 0x38][..], &block.to_le_bytes()[..3], part].concat()
    };
    let padding = vec![0; 5];
    for (compression, data) in [
        ("zstd", [zstd(first), zstd(second), padding.clone()]),
        ("lz4", [lz4(&records), padding, Vec::new()]),
    ] {
        let file = whole(&chunk(compression, records.len() as u64, 0, &data.concat()));
        let log = RawLog::from_bytes("a.mcap", file).unwrap();
        assert_eq!((columns(&log)["/t.time"], columns(&log)["/t.x"]), (&[0.0, 1.0][..], &[1.0, 2.0][..]));
    }
}

fn lz4(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
    std::io::Write::write_all(&mut encoder, bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn damaged_records_are_refused_with_their_place() {
    let ok = definition(1, "ros1msg", b"float64 x");
    let one = channel(1, 1, "/t", "ros1");
    let mut long = chunk("", 4, 0, &[0; 4]);
    long[1..9].fill(0xff);
    for (records, expected) in [
        (long, "a record beyond the end at byte 8"),
        (chunk("", 4, 7, &[0; 4]), "a chunk with a wrong checksum at byte 8"),
        (chunk("bz2", 4, 0, &[0; 4]), "a chunk with compression `bz2`"),
        (chunk("", 21, 0, &chunk("", 0, 0, b"")), "a chunk with other than the 21 bytes"),
        (chunk("", 49, 0, &chunk("", 0, 0, b"")), "a chunk with a chunk in a chunk"),
        (record(0, b""), "a record of kind 0 at byte 8"),
        (record(3, &[1, 0, 0xff, 0xff, 0xff, 0xff]), "content that ends too early at byte 8"),
        (record(15, &7_u32.to_le_bytes()), "a wrong checksum of the data at byte 8"),
        (message(9, 0, b""), "a message of no channel 9"),
        ([ok.clone(), definition(1, "ros1msg", b"int8 x")].concat(), "another schema 1"),
        ([ok.clone(), one.clone(), channel(1, 1, "/u", "ros1")].concat(), "another channel 1"),
        ([ok.clone(), one.clone(), message(1, u64::MAX, &[0; 8])].concat(), "a time after the year 2262"),
        (ok.clone(), "no messages"),
    ] {
        let found = refused(whole(&records));
        assert!(found.contains(expected), "{expected}: {found}");
    }
    let unfinished = [b"\x89MCAP0\r\n", &*ok, &one, &message(1, 0, &[0; 8])].concat();
    let found = refused(unfinished);
    assert!(found.contains("`mcap recover` keeps the messages before a damage"), "{found}");
}

#[test]
fn definitions_of_more_than_their_limit_are_refused() {
    let text = vec![b'#'; 1 << 22];
    let records: Vec<u8> = (1..=4).flat_map(|id| definition(id, "ros1msg", &text)).collect();
    let found = refused(whole(&records));
    assert!(found.contains("more than can be held") && found.contains("16 MB of definitions"), "{found}");
}

/// Bounded run of the fuzz target `mcap`: changed definitions and messages in a file that is
/// otherwise complete.
#[test]
fn changed_definitions_and_messages_are_read_or_refused() {
    let mut seed = 1_u64;
    let mut random = move |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below
    };
    let words = [
        "[]",
        "[3]",
        "[<=2]",
        "\n",
        " ",
        "=",
        "Header",
        "a/T",
        "string",
        "float64",
        "time",
        "====\nMSG: ",
        "#",
    ];
    let samples: [(&str, &str, &str); 3] = [
        ("ros1", "ros1msg", STAMPED),
        ("cdr", "ros2msg", "string[] name\nfloat64[] x\nP[<=2] p\n====\nMSG: a/P\nint16 y\nstring z\n"),
        ("json", "", "{\"name\": [\"a\"], \"x\": [1.5], \"header\": {\"stamp\": {\"sec\": 1, \"nsec\": 2}}}"),
    ];
    for round in 0..6000 {
        let (encoding, schema, text) = samples[round % 3];
        let mut text = text.as_bytes().to_vec();
        for _ in 0..random(4) {
            let at = random(text.len());
            match random(2) {
                0 => text[at] = random(256) as u8,
                _ => drop(text.splice(at..at, words[random(words.len())].bytes())),
            }
        }
        let mut data: Vec<u8> = (0..random(80)).map(|_| [0, 0, 0, 1, 2, 0xff][random(6)]).collect();
        if encoding == "json" {
            data.clone_from(&text);
        } else if encoding == "cdr" {
            data.splice(0..0, [0, random(3) as u8, 0, 0]);
        }
        let _ = RawLog::from_bytes("a", file(encoding, (schema, &text), &[&data, &data]));
    }
}
