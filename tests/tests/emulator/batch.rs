//! Images that run in one go. The link's pipes are plain files: the image reads input that was
//! written before, ends with it, and its messages are read afterwards. After a reset it starts
//! again with the same input and an empty output.

use link::{Decoder, MAX_FRAME, ToController, ToHost, encode};
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Timeout of a run; the slowest takes some seconds.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Runs an image on a machine of the emulator over messages. `command_line` is the semihosting
/// command line. Returns the exit status and the messages since the last start.
pub(crate) fn run(
    machine: &str,
    image: &Path,
    command_line: &str,
    more: &[&str],
    messages: &[ToController],
) -> (ExitStatus, Vec<ToHost>) {
    let image = image.canonicalize().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut bytes = Vec::new();
    for message in messages {
        bytes.extend_from_slice(encode(message, &mut [0; MAX_FRAME]).unwrap());
    }
    std::fs::write(folder.path().join("to-controller"), bytes).unwrap();
    std::fs::write(folder.path().join("to-host"), []).unwrap();
    let mut emulator = Command::new("qemu-system-arm")
        .args(["-M", machine, "-display", "none", "-serial", "null", "-monitor", "none"])
        .args(["-semihosting-config", &format!("enable=on,target=native,arg={command_line}")])
        .args(["-icount", "shift=6,sleep=off"])
        .args(more)
        .arg("-kernel")
        .arg(&image)
        .current_dir(folder.path())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let start = Instant::now();
    let status = loop {
        if let Some(status) = emulator.try_wait().unwrap() {
            break status;
        }
        if start.elapsed() > TIMEOUT {
            emulator.kill().unwrap();
            emulator.wait().unwrap();
            panic!("{machine}, {command_line}: no end within {TIMEOUT:?}");
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let mut decoder = Decoder::new();
    let received = std::fs::read(folder.path().join("to-host")).unwrap();
    (status, received.iter().filter_map(|&byte| decoder.push(byte)).map(Result::unwrap).collect())
}
