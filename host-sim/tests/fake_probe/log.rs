//! The controller's log through the fake probe of the probe library, over the memory that the image
//! has in the emulator after its start.
//!
//! The fake executes no code, so no flash is written. Its memory does not change, so the log is
//! read once.

use controller::boards::parse as parse_board;
use controller::emulator::MACHINE;
use host_sim::controller::EmulatedController;
use host_sim::flash::Plan;
use host_sim::flash::probe::follow;
use object::{Object, ObjectSymbol};
use probe_rs::Permissions;
use probe_rs::probe::fake_probe::FakeProbe;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::PoisonError;
use std::time::{Duration, Instant};

const RAM: u32 = 0x2000_0000;
const RAM_BYTES: u32 = 128 * 1024;

/// Offset of the write position in the log's control block.
const WRITTEN: usize = 36;
/// Maximum number of reads of the memory, and the pause between two reads.
const LOOKS: u32 = 600;
const PAUSE: Duration = Duration::from_millis(100);

/// Returns the RAM of the image once its log contains data; `block` is the offset of the log's
/// control block.
fn memory(folder: &Path, block: usize) -> Vec<u8> {
    let _alone = crate::emulated::ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut emulator = Command::new("qemu-system-arm")
        .args(["-M", MACHINE, "-display", "none", "-serial", "null", "-monitor", "stdio"])
        .args(["-semihosting-config", "enable=on,target=native", "-icount", "shift=2,sleep=off", "-kernel"])
        .arg(std::path::absolute(EmulatedController::default_elf()).unwrap())
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut monitor = emulator.stdin.take().unwrap();
    let look = |look: u32| {
        // The monitor would parse a slash in the path as a division, so the emulator runs in the
        // folder.
        let name = format!("memory-{look}");
        writeln!(monitor, "pmemsave {RAM:#x} {RAM_BYTES:#x} {name}").unwrap();
        std::thread::sleep(PAUSE);
        let memory = std::fs::read(folder.join(name)).unwrap_or_default();
        let has_said = memory.get(block + WRITTEN..block + WRITTEN + 4).is_some_and(|word| word != [0; 4]);
        (memory.len() == RAM_BYTES as usize && has_said).then_some(memory)
    };
    let memory = (0..LOOKS).find_map(look);
    writeln!(monitor, "quit").unwrap();
    emulator.wait().unwrap();
    memory.unwrap()
}

/// Writes an ELF file with one segment and one section, from which the fake reads its memory.
fn as_elf(folder: &Path, memory: &[u8]) -> PathBuf {
    let length = memory.len() as u32;
    let mut bytes = b"\x7fELF\x01\x01\x01".to_vec();
    bytes.resize(16, 0);
    bytes.extend([2, 0, 40, 0, 1, 0, 0, 0]);
    // Entry, program headers, section headers after the data, flags.
    bytes.extend([0, 52, 84 + length, 0x0500_0000].map(u32::to_le_bytes).as_flattened());
    bytes.extend([52_u16, 32, 1, 40, 3, 2].map(u16::to_le_bytes).as_flattened());
    bytes.extend([1, 84, RAM, RAM, length, length, 6, 4].map(u32::to_le_bytes).as_flattened());
    bytes.extend(memory);
    bytes.extend([0; 40]);
    // The memory, and the section names, which are all empty.
    bytes.extend([0, 1, 3, RAM, 84, length, 0, 0, 4, 0].map(u32::to_le_bytes).as_flattened());
    bytes.extend([0, 3, 0, 0, 84 + length, 1, 0, 0, 1, 0].map(u32::to_le_bytes).as_flattened());
    let path = folder.join("memory.elf");
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Returns the log's lines from such a memory, and the error after the last one.
fn followed(folder: &Path, memory: &[u8]) -> (Vec<String>, String) {
    let image = EmulatedController::default_elf();
    let plan = Plan::for_board(parse_board("stm32f405").unwrap(), &image).unwrap();
    let probe = FakeProbe::with_mocked_core_and_binary(&as_elf(folder, memory)).into_probe();
    let mut session = probe.attach(plan.chip, Permissions::default()).unwrap();
    let mut lines = Vec::new();
    let error = follow(&mut session, &image, |line| lines.push(line.to_owned())).unwrap_err();
    (lines, error.to_string())
}

#[test]
fn the_log_is_found_where_the_image_says_and_reads_as_text() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = std::fs::read(EmulatedController::default_elf()).unwrap();
    let image = object::File::parse(&*bytes).unwrap();
    let block = image.symbols().find(|symbol| symbol.name() == Ok("_SEGGER_RTT")).unwrap();
    let block = (block.address() - u64::from(RAM)) as usize;
    let mut memory = memory(folder.path(), block);
    // The control block of an earlier image.
    let stale = memory.len() - 4096;
    memory.copy_within(block..block + 16, stale);
    let (lines, error) = followed(folder.path(), &memory);
    let [line, ..] = &lines[..] else { panic!("{lines:?}, {error}") };
    assert!(line.contains("; core at 168000000 Hz from "), "{line}");
    // The fake does not accept the new read position.
    assert!(error.starts_with("reading the log: "), "{error}");

    memory[block] = 0;
    let started = Instant::now();
    let (lines, error) = followed(folder.path(), &memory);
    assert!(lines.is_empty() && error.starts_with("finding the log: "), "{lines:?}, {error}");
    assert!(started.elapsed() < Duration::from_secs(20), "{:?}", started.elapsed());
}
