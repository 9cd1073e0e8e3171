//! The image's log for a debug probe, read from the emulator's memory as a probe would and decoded
//! as `host-sim flash --follow` does.

use crate::board::Board;
use host_sim::controller::EmulatedController;
use host_sim::flash::log::Texts;
use object::{Object, ObjectSymbol};

const RAM: usize = 0x2000_0000;
const RAM_BYTES: usize = 128 * 1024;

struct Memory(Vec<u8>);

impl Memory {
    fn dump(board: &Board) -> Self {
        board.monitor(&format!("pmemsave {RAM:#x} {RAM_BYTES:#x} memory"));
        Self(std::fs::read(board.folder.path().join("memory")).unwrap())
    }

    fn bytes(&self, address: usize, count: usize) -> &[u8] {
        &self.0[address - RAM..][..count]
    }

    fn word(&self, address: usize) -> usize {
        u32::from_le_bytes(self.bytes(address, 4).try_into().unwrap()) as usize
    }
}

fn log_of(board: &Board) -> (Vec<u8>, Vec<u8>) {
    let image = std::fs::read(EmulatedController::default_elf()).unwrap();
    let file = object::File::parse(&*image).unwrap();
    let block = file.symbol_by_name("_SEGGER_RTT").unwrap().address() as usize;
    let memory = Memory::dump(board);
    assert_eq!(memory.bytes(block, 16), b"SEGGER RTT\0\0\0\0\0\0");
    assert_eq!((memory.word(block + 16), memory.word(block + 20)), (2, 1), "channels up and down");
    let [buffer, size, written, read] = [28, 32, 36, 40].map(|offset| memory.word(block + offset));
    assert_eq!(read, 0, "no byte has been read");
    assert!(written > 0 && written < size, "{written} of {size}");
    let log = memory.bytes(buffer, written).to_vec();
    (image, log)
}

#[test]
fn the_log_in_the_images_memory_reads_as_text() {
    let board = Board::start();
    // After the hello frame, the log's first line has been written.
    drop(board.attached());
    let (image, log) = log_of(&board);
    let texts = Texts::from_elf(&image).unwrap();
    let lines = texts.decoder().take(&log);
    let [started, ..] = &lines[..] else { panic!("{lines:?}") };
    assert!(started.contains("INFO started by "), "{started}");
    assert!(started.contains("; core at 168000000 Hz from "), "{started}");

    // In pieces, and after the tail of an overwritten frame.
    let mut decoder = texts.decoder();
    let pieces: Vec<String> =
        [&log[1..], &log[..]].concat().chunks(3).flat_map(|piece| decoder.take(piece)).collect();
    assert_eq!(pieces.last(), lines.last(), "{pieces:?}");
}

#[test]
fn texts_of_another_image_are_refused() {
    let error = Texts::from_elf(b"no image").err().unwrap().to_string();
    assert!(error.starts_with("the texts of the log: "), "{error}");
    let host = std::fs::read(std::env::current_exe().unwrap()).unwrap();
    assert!(Texts::from_elf(&host).err().unwrap().to_string().contains("the image has none"));
}
