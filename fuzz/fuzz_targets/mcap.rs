//! Arbitrary definitions and messages in a complete MCAP file, whose checksums and lengths would
//! stop most changes of a file. The bounded run is `crates/bench/src/log/files/mcap/tests.rs`.
#![no_main]

#[allow(dead_code)]
#[path = "../../crates/bench/src/log/files/mcap/made.rs"]
mod made;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let Some((kind, data)) = data.split_first() else { return };
    let (encoding, schema) = [("ros1", "ros1msg"), ("cdr", "ros2msg"), ("json", "")][*kind as usize % 3];
    // A definition ends at the first zero; JSON has none.
    let zero = data.iter().position(|byte| *byte == 0).unwrap_or(data.len());
    let end = if schema.is_empty() { 0 } else { zero };
    let (text, message) = data.split_at(end);
    let file = made::file(encoding, (schema, text), &[message, message]);
    let _ = bench::log::RawLog::from_bytes("log", file);
});
