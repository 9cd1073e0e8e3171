//! Tools that the tests need beyond the toolchain: the controllers' targets and the emulator.
//!
//! The target comes from rustup. If its server is not reachable, Debian's compiler builds the core
//! library from its sources. If neither works, the error gives the reason.

use crate::run::{ChoreError, cargo, output_of, run, succeeds};
use std::process::Command;

/// Target of the default controller: Cortex-M4F.
pub(crate) const TARGET: &str = "thumbv7em-none-eabihf";
const DEBIAN_TOOLCHAIN: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];
pub(crate) const EMULATOR: &str = "qemu-system-arm";
/// Variable that disables rustup if it is set: for testing Debian's toolchain on any machine.
const WITHOUT_RUSTUP: &str = "PINTLE_WITHOUT_RUSTUP";

/// Toolchain that builds the firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Toolchain {
    /// The pinned toolchain with rustup's core library.
    Rustup,
    /// Debian's compiler; the core library is built from its sources.
    Debian,
}

/// Installs all missing tools.
pub(crate) fn setup() -> Result<Toolchain, ChoreError> {
    let toolchain = target(TARGET)?;
    for board in &controller::boards::BOARDS {
        target(board.microcontroller.target)?;
    }
    emulator()?;
    for (name, packages) in C_TOOLS {
        // Without them only the programs in C are not tried, which the tests report.
        if let Err(error) = program(name, packages) {
            eprintln!("{name}: {error}");
        }
    }
    Ok(toolchain)
}

/// Installs a target if it is missing, and returns the toolchain to build with.
pub(crate) fn target(target: &str) -> Result<Toolchain, ChoreError> {
    let allowed = std::env::var_os(WITHOUT_RUSTUP).is_none();
    if allowed && (has_target(target) || run(Command::new("rustup").args(["target", "add", target])).is_ok())
    {
        return Ok(Toolchain::Rustup);
    }
    eprintln!("rustup has no core library for {target}; trying Debian's compiler");
    if !has_debian_toolchain() {
        install(&DEBIAN_TOOLCHAIN)?;
    }
    if has_debian_toolchain() {
        Ok(Toolchain::Debian)
    } else {
        Err(ChoreError::ByHand(format!(
            "the target {target} is missing: rustup could not install it, and Debian's packages {} \
             cannot be used either. With a network connection, type: rustup target add {target}",
            DEBIAN_TOOLCHAIN.join(", ")
        )))
    }
}

/// Returns whether the current toolchain has the target's core library.
fn has_target(target: &str) -> bool {
    let mut rustc = Command::new("rustc");
    rustc.args(["--print", "target-libdir", "--target", target]).current_dir(crate::run::root());
    output_of(&mut rustc).is_ok_and(|folder| {
        let has_core = |entry: std::fs::DirEntry| entry.file_name().to_string_lossy().starts_with("libcore");
        std::fs::read_dir(folder.trim()).is_ok_and(|entries| entries.flatten().any(has_core))
    })
}

/// Debian's cargo; rustup's may come first on the path.
pub(crate) const DEBIAN_CARGO: &str = "/usr/bin/cargo";
/// Debian's compiler; see [`DEBIAN_CARGO`].
pub(crate) const DEBIAN_RUSTC: &str = "/usr/bin/rustc";

fn has_debian_toolchain() -> bool {
    let sources = output_of(Command::new(DEBIAN_RUSTC).args(["--print", "sysroot"])).is_ok_and(|root| {
        std::path::Path::new(root.trim()).join("lib/rustlib/src/rust/library/core").exists()
    });
    sources && succeeds(Command::new(DEBIAN_CARGO).arg("--version"))
}

/// Returns the path of rust-lld in the pinned toolchain; Debian's compiler has none.
pub(crate) fn linker() -> Result<String, ChoreError> {
    let root = output_of(Command::new("rustc").args(["--print", "sysroot"]).current_dir(crate::run::root()))?;
    let version = output_of(cargo().arg("-vV"))?;
    let host = version.lines().find_map(|l| l.strip_prefix("host: ")).unwrap_or("x86_64-unknown-linux-gnu");
    Ok(format!("{}/lib/rustlib/{host}/bin/rust-lld", root.trim()))
}

fn emulator() -> Result<(), ChoreError> {
    program(EMULATOR, &[EMULATOR])
}

/// Browser that the tests of pages use if it is installed.
const BROWSER: &str = "chromium";

/// Installs the browser if it is missing; returns whether there is one.
pub(crate) fn browser() -> bool {
    succeeds(Command::new(BROWSER).arg("--version")) || install(&[BROWSER]).is_ok()
}

/// Installs the packages of a program if it does not run.
pub(crate) fn program(name: &str, packages: &[&str]) -> Result<(), ChoreError> {
    if succeeds(Command::new(name).arg("--version")) { Ok(()) } else { install(packages) }
}

/// Tools for the programs in C, which only `cargo xtask c-library --check` needs: their names and
/// packages.
pub(crate) const C_TOOLS: [(&str, &[&str]); 2] =
    [("cmake", &["cmake", "make"]), ("arm-none-eabi-gcc", &["gcc-arm-none-eabi"])];

/// Installs Debian packages; if that is not possible, the error says what to type.
fn install(packages: &[&str]) -> Result<(), ChoreError> {
    let by_hand =
        || ChoreError::ByHand(format!("missing; type: sudo apt-get install {}", packages.join(" ")));
    if !succeeds(Command::new("apt-get").arg("--version")) {
        return Err(ChoreError::ByHand(format!(
            "install {} with this system's package manager",
            packages.join(", ")
        )));
    }
    let prefix: &[&str] = if output_of(Command::new("id").arg("-u")).is_ok_and(|id| id.trim() == "0") {
        &[]
    } else if succeeds(Command::new("sudo").args(["-n", "true"])) {
        &["sudo", "-n"]
    } else {
        return Err(by_hand());
    };
    let apt = |arguments: &[&str]| {
        let mut words = prefix.iter().copied().chain(["apt-get"]);
        let mut command = Command::new(words.next().unwrap_or("apt-get"));
        command.args(words).args(arguments).env("DEBIAN_FRONTEND", "noninteractive");
        command
    };
    let install = [&["install", "-y", "--no-install-recommends"], packages].concat();
    if run(&mut apt(&install)).is_ok() {
        return Ok(());
    }
    // The list of packages may be missing or old.
    run(&mut apt(&["update"])).and_then(|()| run(&mut apt(&install))).map_err(|_| by_hand())
}
