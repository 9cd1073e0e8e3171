//! Arbitrary bytes through decoder and session. The requirements are those of the bounded run in
//! `crates/controller/tests/link`.
#![no_main]

#[allow(dead_code, reason = "only the bounded run uses these functions")]
#[path = "../../crates/controller/tests/link/survives.rs"]
mod survives;

libfuzzer_sys::fuzz_target!(|data: &[u8]| survives::Subject::default().survives(data));
