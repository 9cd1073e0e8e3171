//! Passes a board's memory map to the linker.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=PINTLE_BOARD");
    let board = env::var("PINTLE_BOARD").unwrap_or("netduinoplus2".into());
    let map = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("boards").join(format!("{board}.x"));
    println!("cargo::rerun-if-changed={}", map.display());
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::copy(&map, out.join("memory.x")).map_err(|error| format!("{}: {error}", map.display()))?;
    println!("cargo::rustc-link-search={}", out.display());
    for argument in ["--nmagic", "-Tlink.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
    Ok(())
}
