//! Gives the linker the memory map of the board and gives the firmware its board and its build
//! name.
//!
//! The board is `PINTLE_BOARD`, or else the first board of the table whose microcontroller's
//! feature is enabled. For the host this script does nothing.
//!
//! The linker runs in the workspace's root and resolves `INCLUDE memory.x` of cortex-m-rt's
//! `link.x` there first. For the STM32F405 that is the right map. For every other microcontroller
//! this script writes a copy of `link.x` that includes the board's own map. In both cases the
//! linker script asserts the regions' origins, so that a wrong map fails the link.

#[allow(
    dead_code,
    unreachable_pub,
    unused_imports,
    reason = "the firmware and the tools use the rest of the table"
)]
#[path = "../crates/controller/src/boards/mod.rs"]
mod boards;

use boards::{BOARDS, Board, MemoryMap};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// The map that the linker finds by itself.
const ROOT_MAP: &str = "memory.x";

fn main() -> Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=../crates/controller/src/boards");
    println!("cargo::rerun-if-env-changed=PINTLE_BOARD");
    println!("cargo::rustc-check-cfg=cfg(stack_limit_register)");
    println!("cargo::rustc-check-cfg=cfg(emulated)");
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    let root = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("..");
    let out = PathBuf::from(env::var("OUT_DIR")?);
    let board = board()?;
    println!("cargo::rustc-env=PINTLE_BOARD={}", board.name);
    if board.is_emulated {
        println!("cargo::rustc-cfg=emulated");
    }
    if env::var("TARGET")?.starts_with("thumbv8m.main") {
        println!("cargo::rustc-cfg=stack_limit_register");
    }
    if env::var_os("CARGO_FEATURE_ON_TARGET").is_some() {
        // The test harness compiles its tests only then.
        println!("cargo::rustc-cfg=test");
    }
    link(board, &root, &out)?;
    name_build(&root);
    Ok(())
}

fn board() -> Result<&'static Board> {
    let is_enabled = |board: &&Board| {
        let feature = board.microcontroller.feature.to_uppercase().replace('-', "_");
        env::var_os(format!("CARGO_FEATURE_{feature}")).is_some()
    };
    let board = match env::var("PINTLE_BOARD") {
        Ok(name) => {
            boards::find(&name).ok_or_else(|| format!("PINTLE_BOARD={name}: {}", boards::UnknownBoard))?
        }
        Err(_) => BOARDS.iter().find(is_enabled).ok_or("no feature of a microcontroller is enabled")?,
    };
    if !is_enabled(&board) {
        return Err(format!("{} requires the feature {}", board.name, board.microcontroller.feature).into());
    }
    Ok(board)
}

/// Passes the linker its scripts.
fn link(board: &Board, root: &Path, out: &Path) -> Result<()> {
    let map = board.microcontroller.memory_map;
    println!("cargo::rerun-if-changed={}", root.join(map.path).display());
    println!("cargo::rustc-link-search={}", out.display());
    let script = if map.path == ROOT_MAP {
        "link.x".into()
    } else {
        let script = out.join(format!("link-{}.x", board.microcontroller.feature));
        fs::write(&script, script_with(&map, out)?)?;
        script
    };
    let interrupts = board.microcontroller.declared_interrupts;
    let handlers: String =
        interrupts.iter().map(|name| format!("PROVIDE({name} = DefaultHandler);\n")).collect();
    // Without declared interrupts the device crate's own `device.x` must be found.
    if handlers.is_empty() {
        let _ = fs::remove_file(out.join("device.x"));
    } else {
        fs::write(out.join("device.x"), handlers)?;
    }
    fs::write(out.join("check-map.x"), assertions(board))?;
    println!("cargo::rustc-link-arg-bins=--nmagic");
    for script in [&script, Path::new("defmt.x"), Path::new("check-map.x")] {
        println!("cargo::rustc-link-arg-bins=-T{}", script.display());
    }
    Ok(())
}

/// Returns cortex-m-rt's linker script with the text of a memory map in place of `INCLUDE
/// memory.x`.
///
/// cortex-m-rt's build script, which cargo runs before this one, writes `link.x` to its output
/// folder. Of several outputs (other features, an earlier version) the newest is taken.
fn script_with(map: &MemoryMap, out: &Path) -> Result<String> {
    const INCLUDE: &str = "INCLUDE memory.x";
    let builds = out.ancestors().nth(2).ok_or("no build folder")?;
    let scripts = fs::read_dir(builds)?.flatten().map(|entry| entry.path());
    let newest = scripts
        .filter(|path| {
            path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("cortex-m-rt-"))
        })
        .map(|path| path.join("out/link.x"))
        .filter_map(|path| Some((fs::metadata(&path).ok()?.modified().ok()?, path)))
        .max()
        .ok_or_else(|| format!("no link.x of cortex-m-rt in {}", builds.display()))?;
    let script = fs::read_to_string(newest.1)?;
    if script.matches(INCLUDE).count() != 1 {
        return Err(format!("expected one `{INCLUDE}` in cortex-m-rt's link.x").into());
    }
    Ok(script.replace(INCLUDE, map.text))
}

/// Returns assertions that the linker used the board's own map.
fn assertions(board: &Board) -> String {
    let assertion = |region: boards::Region| {
        let boards::Region { name, origin, length } = region;
        format!(
            "ASSERT(ORIGIN({name}) == {origin:#x} && LENGTH({name}) == {length:#x}, \
             \"{name} is not that of {}\");\n",
            board.name
        )
    };
    board.microcontroller.memory_map.regions().map(assertion).collect()
}

/// Names the build after `git describe`. Without git (a source archive) the crate's version is
/// used.
fn name_build(root: &Path) {
    let described =
        Command::new("git").args(["describe", "--always", "--dirty", "--tags"]).current_dir(root).output();
    if let Some(name) = described.ok().filter(|git| git.status.success()) {
        println!("cargo::rustc-env=PINTLE_BUILD_ID={}", String::from_utf8_lossy(&name.stdout).trim());
        println!("cargo::rerun-if-changed={}", root.join(".git/HEAD").display());
        println!("cargo::rerun-if-changed={}", root.join(".git/refs/heads").display());
    }
}
