//! Tests of keys and packages on the command line: written files, refused inputs, messages.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use std::path::Path;
use std::process::{Command, Output, Stdio};

fn model_quant(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_model-quant"));
    command.current_dir(folder).args(arguments).output().expect("model-quant")
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = model_quant(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let output = model_quant(folder, arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("json")
}

#[test]
fn a_package_is_signed_for_its_key_and_reproducible() {
    let directory = tempfile::tempdir().expect("directory");
    let folder = directory.path();
    let public = json(folder, &["key", "--out", "one.key", "--json"])["public_key"].clone();
    assert_eq!(json(folder, &["key", "--show", "one.key", "--json"])["public_key"], public);
    let make = |out: &str| {
        let made = json(folder, &["package", "--version", "4", "--key", "one.key", "--out", out, "--json"]);
        (made, std::fs::read(folder.join(out)).expect("package"))
    };
    let ((made, bytes), (_, repeated)) = (make("a.package"), make("b.package"));
    assert_eq!(bytes, repeated);
    assert_eq!((&made["signed_for"], made["version"].as_u64()), (&public, Some(4)));
    assert_eq!(made["images"].as_array().map(Vec::len), Some(inference::BearingMaterial::COUNT));
    let foreign = json(folder, &["package", "--show", "a.package", "--json"]);
    assert!(foreign["signed_for"].is_null(), "the development key is not the one it was signed with");
    // An existing key is never replaced.
    assert!(refused(folder, &["key", "--out", "one.key"]).contains("one.key"));
}

#[cfg(unix)]
#[test]
fn of_concurrent_processes_one_makes_the_key_and_only_its_owner_may_read_it() {
    use std::os::unix::fs::PermissionsExt;
    let directory = tempfile::tempdir().expect("directory");
    let folder = directory.path();
    let spawn = |_| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_model-quant"));
        command.current_dir(folder).args(["key", "--out", "one.key"]);
        command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("model-quant")
    };
    let all: Vec<_> = (0..12).map(spawn).collect();
    let outputs: Vec<Output> = all.into_iter().map(|one| one.wait_with_output().expect("end")).collect();
    let made: Vec<&Output> = outputs.iter().filter(|output| output.status.success()).collect();
    let shown = model_quant(folder, &["key", "--show", "one.key"]);
    assert_eq!(made.len(), 1, "a key that was printed must be the one in the file");
    assert_eq!(made[0].stdout, shown.stdout);
    let mode = folder.join("one.key").metadata().expect("file").permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
    assert_eq!(folder.read_dir().expect("folder").count(), 1, "no other file remains");
    // A dangling link is not replaced, either.
    std::os::unix::fs::symlink("nowhere", folder.join("link.key")).expect("link");
    assert!(refused(folder, &["key", "--out", "link.key"]).contains("a file that does not exist yet"));
    assert!(folder.join("link.key").is_symlink());
}

#[test]
fn a_key_of_a_link_is_shown_as_its_file_has_it_and_is_never_replaced() {
    let directory = tempfile::tempdir().expect("directory");
    let folder = directory.path();
    let made = model_quant(folder, &["key", "--link", "--out", "link.key"]);
    assert_eq!(String::from_utf8_lossy(&made.stdout), "link.key\n", "the key itself is not printed");
    let text = std::fs::read_to_string(folder.join("link.key")).expect("file");
    let shown = json(folder, &["key", "--link", "--show", "link.key", "--json"]);
    assert_eq!(shown["link_key"].as_str(), text.lines().last());
    assert!(refused(folder, &["key", "--link", "--out", "link.key"]).contains("does not exist yet"));
    assert_eq!(std::fs::read_to_string(folder.join("link.key")).expect("file"), text);
}

#[test]
fn files_other_than_images_keys_and_packages_are_refused_by_name() {
    let directory = tempfile::tempdir().expect("directory");
    let folder = directory.path();
    std::fs::write(folder.join("wrong"), "# a remark\nzz\n").expect("file");
    let message = refused(folder, &["package", "--version", "1", "--key", "wrong", "--out", "x"]);
    assert!(message.contains("wrong: line 2") && message.contains("64 hexadecimal digits"), "{message}");
    assert!(refused(folder, &["package", "wrong", "--version", "1", "--out", "x"]).contains("model image"));
    assert!(refused(folder, &["package", "--show", "wrong"]).contains("expected 160"));
    assert!(refused(folder, &["package", "--version", "0", "--out", "x"]).contains("--version"));
    assert!(refused(folder, &["package", "--show", "nothing"]).contains("nothing"));
    assert!(!folder.join("x").exists());
}
