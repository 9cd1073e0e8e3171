//! The release archive: programs, firmware of every board, completions, manual pages, documents.
//!
//! The archive contains no path of the machine that built it, and its bytes do not depend on the
//! time of the build.

use crate::c_library;
use crate::compile::host;
use crate::firmware::{self, Firmware};
use crate::fmu;
use crate::run::{
    ChoreError, cargo, copy, of_file, output_of, root, run, succeeds, target_folder, write_atomically,
};
use controller::boards::BOARDS;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Expectation about every file of the archive.
const COPIED: &str = "a file that can be read and copied";
/// Programs of the archive, each a package of the same name.
const PROGRAMS: [&str; 2] = ["host-sim", "model-quant"];
/// Files and folders of the workspace that are copied beside the programs' documents.
const DOCUMENTS: [&str; 7] =
    ["README.md", "CHANGELOG.md", "ARCHITECTURE.md", "LICENSE-APACHE", "LICENSE-MIT", "docs", "examples"];
/// Completions: shell, folder in the archive, and file name around the program's name.
const COMPLETIONS: [(&str, &str, &str, &str); 3] = [
    ("bash", "share/bash-completion/completions", "", ""),
    ("zsh", "share/zsh/site-functions", "_", ""),
    ("fish", "share/fish/vendor_completions.d", "", ".fish"),
];

/// Builds the archive and its checksum, and returns the path of the archive. Its firmware trusts
/// the keys of `PINTLE_MODEL_KEY`, which must not be the development key.
pub(crate) fn archive() -> Result<PathBuf, ChoreError> {
    firmware::require_own_keys()?;
    firmware::refuse_link_key()?;
    let name = format!("pintle-{}-{}", env!("CARGO_PKG_VERSION"), host()?);
    let folder = target_folder().join("archive");
    let tree = folder.join(&name);
    if tree.exists() {
        std::fs::remove_dir_all(&tree).map_err(of_file(&tree, COPIED))?;
    }
    let built = programs(&folder.join("build"))?;
    for (program, path) in PROGRAMS.iter().zip(&built) {
        copy(path, &tree.join("bin").join(program))?;
    }
    firmware_images(&tree.join("share/pintle/firmware"))?;
    copy_tree(&c_library::build()?, &tree.join("share/pintle/c-libraries"))?;
    copy_tree(&fmu::build()?, &tree.join("share/pintle/fmu-libraries"))?;
    shells(&tree)?;
    for document in DOCUMENTS {
        copy_tree(&root().join(document), &tree.join("share/doc/pintle").join(document))?;
    }
    check_programs(&tree.join("bin"))?;
    pack(&folder, &name)
}

/// Builds the programs without a path of this machine and returns where they are.
fn programs(folder: &Path) -> Result<Vec<PathBuf>, ChoreError> {
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| std::env::home_dir().map(|home| home.join(".cargo"))).unwrap_or_default();
    let flags = format!(
        "--remap-path-prefix={}=pintle --remap-path-prefix={}=cargo",
        root().display(),
        home.display()
    );
    let mut command = cargo();
    command.args(["build", "--release", "--locked", "--features", "host-sim/probe"]);
    for program in PROGRAMS {
        command.args(["--package", program]);
    }
    run(command.env("RUSTFLAGS", flags).env("CARGO_TARGET_DIR", folder))?;
    Ok(PROGRAMS.iter().map(|program| folder.join("release").join(program)).collect())
}

/// Builds the image of every board of silicon, that of the default board last: the emulator's tests
/// expect it in the target folder.
fn firmware_images(folder: &Path) -> Result<(), ChoreError> {
    for board in BOARDS.iter().rev().filter(|board| !board.microcontroller.is_emulated_only()) {
        let image = Firmware(board).build()?;
        copy(&image, &folder.join(board.image_name().to_string()))?;
    }
    Ok(())
}

/// Writes completions and manual pages.
fn shells(tree: &Path) -> Result<(), ChoreError> {
    for program in PROGRAMS {
        let path = tree.join("bin").join(program);
        for (shell, folder, before, after) in COMPLETIONS {
            let script = output_of(Command::new(&path).args(["completions", shell]))?;
            let file = tree.join(folder).join(format!("{before}{program}{after}"));
            create_parent(&file)?;
            write_atomically(file, script)?;
        }
        run(Command::new(&path).arg("man").arg("--out").arg(tree.join("share/man/man1")))?;
    }
    Ok(())
}

/// Runs the programs outside the workspace, the firmware of the archive in the emulator too if that
/// is installed, and searches them for a path of this machine.
fn check_programs(folder: &Path) -> Result<(), ChoreError> {
    let source = root().to_string_lossy();
    for program in PROGRAMS {
        let path = folder.join(program);
        run(Command::new(&path).arg("--version").current_dir(std::env::temp_dir()))?;
        let bytes = std::fs::read(&path).map_err(of_file(&path, COPIED))?;
        if bytes.windows(source.len()).any(|window| window == source.as_bytes()) {
            return Err(ChoreError::File {
                file: path,
                found: format!("contains the path {source}"),
                expected: "a program without the paths of the machine that built it",
            });
        }
    }
    if !succeeds(Command::new("qemu-system-arm").arg("--version")) {
        println!("not tried: the firmware in the emulator, which is not installed");
        return Ok(());
    }
    let mut link = Command::new(folder.join("host-sim"));
    link.args(["link", "--controller", "emulated", "--quiet"]);
    run(link.current_dir(std::env::temp_dir()).env_remove("CARGO_TARGET_DIR"))
}

/// Packs the folder `name` in `folder`. Names are sorted, and times and owners are 0.
fn pack(folder: &Path, name: &str) -> Result<PathBuf, ChoreError> {
    let packed = format!("{name}.tar.gz");
    let options = ["--sort=name", "--mtime=@0", "--owner=0", "--group=0", "--numeric-owner"];
    let mut tar = Command::new("tar");
    tar.current_dir(folder).args(options).args(["--use-compress-program", "gzip -n", "-cf", &packed, name]);
    run(&mut tar)?;
    let sum = output_of(Command::new("sha256sum").current_dir(folder).arg(&packed))?;
    write_atomically(folder.join(format!("{packed}.sha256")), sum)?;
    Ok(folder.join(packed))
}

fn create_parent(file: &Path) -> Result<(), ChoreError> {
    file.parent().map_or(Ok(()), |parent| std::fs::create_dir_all(parent).map_err(of_file(parent, COPIED)))
}

/// Copies a file, or a folder with everything in it.
fn copy_tree(from: &Path, to: &Path) -> Result<(), ChoreError> {
    if !from.is_dir() {
        return copy(from, to);
    }
    for entry in std::fs::read_dir(from).map_err(of_file(from, COPIED))? {
        let name = entry.map_err(of_file(from, COPIED))?.file_name();
        copy_tree(&from.join(&name), &to.join(&name))?;
    }
    Ok(())
}
