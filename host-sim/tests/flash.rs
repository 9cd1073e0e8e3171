//! `host-sim flash` on the command line: the plan, and the refusals with their exit codes.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use std::process::Command;

fn flash(arguments: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_host-sim")).arg("flash").args(arguments).output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    (output.status.code(), String::from_utf8(text).unwrap())
}

#[test]
fn wrong_input_is_refused_before_any_probe_is_touched() {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), "no image").unwrap();
    let name = file.path().to_str().unwrap();
    let cases: [(&[&str], &str); 4] = [
        (&["--board", "arduino", "--dry-run"], "expected one of stm32f405"),
        (&["--board", "stm32f405", "--elf", "/no/such/image"], "/no/such/image"),
        (&["--board", "stm32f405", "--elf", name], "expected a 32-bit ELF image"),
        (&["--board", "mps2-an505", "--elf", name], "a board of the emulator"),
    ];
    for (arguments, expected) in cases {
        let (code, text) = flash(arguments);
        assert_eq!(code, Some(2), "{text}");
        assert!(text.contains(expected), "{text}");
    }
}
