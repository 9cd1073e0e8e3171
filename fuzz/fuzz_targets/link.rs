//! Any bytes at all through decoder and session; the promises are those of the bounded run in `firmware/tests/link`.
#![no_main]

#[allow(dead_code, reason = "the bounded run asks the subject for more")]
#[path = "../../firmware/tests/link/survives.rs"]
mod survives;

libfuzzer_sys::fuzz_target!(|data: &[u8]| survives::Subject::default().survives(data));
