//! Arbitrary bytes through the readers of logs. The bounded run is
//! `crates/bench/tests/log_files.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = bench::log::RawLog::from_bytes("log", data.to_vec());
});
