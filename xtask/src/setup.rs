//! What the tests need beyond the toolchain: the controllers' targets and the emulator.
//!
//! The target comes from rustup. Where its server cannot be reached, Debian's compiler with its library sources builds the
//! core library itself; where neither is to be had, the reason is said.

use crate::run::{ChoreError, cargo, output_of, run, succeeds};
use std::process::Command;

/// The controller's target: Cortex-M4F.
pub(crate) const TARGET: &str = "thumbv7em-none-eabihf";
const DEBIAN_TOOLCHAIN: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];
pub(crate) const EMULATOR: &str = "qemu-system-arm";
/// Set to any value, rustup is left out: for trying Debian's way on a machine that has the target.
const WITHOUT_RUSTUP: &str = "PINTLE_WITHOUT_RUSTUP";

/// How the firmware is to be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// With the pinned toolchain and rustup's core library.
    Rustup,
    /// With Debian's compiler, core library built from its sources.
    Debian,
}

/// Installs everything.
pub(crate) fn setup() -> Result<Way, ChoreError> {
    let way = target(TARGET)?;
    target(crate::firmware::OTHER_CORE.target)?;
    emulator()?;
    Ok(way)
}

/// Makes sure that one can build for a target.
pub(crate) fn target(target: &str) -> Result<Way, ChoreError> {
    let allowed = std::env::var_os(WITHOUT_RUSTUP).is_none();
    if allowed
        && (target_is_there(target) || run(Command::new("rustup").args(["target", "add", target])).is_ok())
    {
        return Ok(Way::Rustup);
    }
    eprintln!("rustup gave no core library for {target}; trying Debian's compiler");
    if !debian_is_there() {
        install(&DEBIAN_TOOLCHAIN)?;
    }
    if debian_is_there() {
        Ok(Way::Debian)
    } else {
        Err(ChoreError::ByHand(format!(
            "the target {target} is missing: rustup's server gave none, and Debian's {} are not usable either. \
             With a network, type: rustup target add {target}",
            DEBIAN_TOOLCHAIN.join(", ")
        )))
    }
}

/// Whether the toolchain in use has the target's core library.
fn target_is_there(target: &str) -> bool {
    let mut rustc = Command::new("rustc");
    rustc.args(["--print", "target-libdir", "--target", target]).current_dir(crate::run::root());
    output_of(&mut rustc).is_ok_and(|folder| {
        let has_core = |entry: std::fs::DirEntry| entry.file_name().to_string_lossy().starts_with("libcore");
        std::fs::read_dir(folder.trim()).is_ok_and(|entries| entries.flatten().any(has_core))
    })
}

/// Debian's own programs, not rustup's of the same name.
pub(crate) const DEBIAN_CARGO: &str = "/usr/bin/cargo";
/// See [`DEBIAN_CARGO`].
pub(crate) const DEBIAN_RUSTC: &str = "/usr/bin/rustc";

fn debian_is_there() -> bool {
    let sources = output_of(Command::new(DEBIAN_RUSTC).args(["--print", "sysroot"])).is_ok_and(|root| {
        std::path::Path::new(root.trim()).join("lib/rustlib/src/rust/library/core").exists()
    });
    sources && succeeds(Command::new(DEBIAN_CARGO).arg("--version"))
}

/// rust-lld of the pinned toolchain, which Debian's compiler does not bring.
pub(crate) fn linker() -> Result<String, ChoreError> {
    let root = output_of(Command::new("rustc").args(["--print", "sysroot"]).current_dir(crate::run::root()))?;
    let version = output_of(cargo().arg("-vV"))?;
    let host = version.lines().find_map(|l| l.strip_prefix("host: ")).unwrap_or("x86_64-unknown-linux-gnu");
    Ok(format!("{}/lib/rustlib/{host}/bin/rust-lld", root.trim()))
}

fn emulator() -> Result<(), ChoreError> {
    if succeeds(Command::new(EMULATOR).arg("--version")) {
        return Ok(());
    }
    install(&[EMULATOR])
}

/// Installs Debian packages where that is possible, else says what to type.
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
