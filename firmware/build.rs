//! Hands the board's memory map to the linker and the build's name to the greeting; does nothing for the host.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// Default handlers of the interrupts that `boards/mps2_an505.rs` lists; other devices bring theirs.
const AN505_INTERRUPTS: &str = "PROVIDE(SERIAL = DefaultHandler);\n";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=PINTLE_BOARD");
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    let root = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("..");
    let out = PathBuf::from(env::var("OUT_DIR")?);
    let an505 = env::var_os("CARGO_FEATURE_MPS2_AN505").is_some();
    // Not at the workspace's root: the linker would look there first, whatever the board.
    let map = root.join("firmware/memory").join(if an505 { "mps2-an505.x" } else { "stm32f405.x" });
    fs::copy(&map, out.join("memory.x"))?;
    if an505 {
        fs::write(out.join("device.x"), AN505_INTERRUPTS)?;
    }
    println!("cargo::rerun-if-changed={}", map.display());
    println!("cargo::rustc-link-search={}", out.display());
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }

    // Without git (a source archive) the crate's version has to do.
    let described =
        Command::new("git").args(["describe", "--always", "--dirty", "--tags"]).current_dir(&root).output();
    if let Some(name) = described.ok().filter(|git| git.status.success()) {
        println!("cargo::rustc-env=PINTLE_BUILD_ID={}", String::from_utf8_lossy(&name.stdout).trim());
        println!("cargo::rerun-if-changed={}", root.join(".git/HEAD").display());
        println!("cargo::rerun-if-changed={}", root.join(".git/refs/heads").display());
    }
    Ok(())
}
