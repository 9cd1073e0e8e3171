//! Runs the examples and checks their output.
#![cfg(not(miri))]
#![allow(clippy::expect_used, reason = "a test that cannot set itself up has failed")]

use std::io::Write;
use std::process::{Command, Output, Stdio};

/// Runs an example that cargo has built with the tests.
fn example(name: &str, arguments: &[&str], input: &str) -> Output {
    let test = std::env::current_exe().expect("path of this test");
    let folder = test.parent().and_then(|folder| folder.parent()).expect("folder of the profile");
    let mut child = Command::new(folder.join("examples").join(name))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the example, which `cargo test` builds unless it builds one test only");
    // An example that reads nothing may have exited already.
    let _ = child.stdin.take().map(|mut stdin| stdin.write_all(input.as_bytes()));
    child.wait_with_output().expect("output")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn own_network_agrees_in_all_modes() {
    let output = example("own_network", &[], "");
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).ends_with("stream, moved and whole windows agree\n"));
}

#[test]
fn a_press_has_a_force_that_grows_and_falls() {
    let output = example("estimate", &[], "");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let forces: Vec<f64> = (text(&output.stdout).lines().skip(1))
        .map(|line| line.split(',').next().and_then(|force| force.parse().ok()).expect("force"))
        .collect();
    assert_eq!(forces.len(), 41);
    let largest = forces.iter().copied().fold(0.0, f64::max);
    assert!(forces[0] == 0.0 && largest > 100.0 && forces[40] < 0.1 * largest, "{forces:?}");
}

#[test]
fn a_table_is_read_and_a_wrong_line_is_named() {
    let heading = "clearance,deformation,rate,approach,sliding\n";
    let output =
        example("estimate", &["plastic", "-"], &format!("{heading}5e-4,2e-5,0,1e-3,0.1\n5e-4,nan,0,0,0\n"));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let found = text(&output.stdout);
    assert_eq!(found.lines().count(), 3);
    // Not finite, and the history restarts.
    assert_eq!(found.lines().last(), Some("0.000,0.000,0xc0"));
    let output = example("estimate", &["plastic", "-"], &format!("{heading}5e-4,2e-5,0,1e-3\n"));
    assert!(!output.status.success());
    assert!(text(&output.stderr).contains("line 2"), "{}", text(&output.stderr));
    let output = example("estimate", &["wood"], "");
    assert!(text(&output.stderr).contains("expected babbitt or plastic"), "{}", text(&output.stderr));
}
