//! The documents: every page is in the site, every link leads somewhere, every command works, and
//! the pages that describe the code equal it.
//!
//! The commands are those of the code blocks `sh`, `bash` and `console`. They run in the programs
//! of the target folder, which `cargo test --workspace --test documents --test cli` builds.
//! `WRITE_REFERENCE=1` writes the generated pages.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

mod commands;
mod links;
mod markdown;
mod programs;
mod reference;
