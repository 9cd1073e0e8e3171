//! The memory of a board as a probe sees it: the firmware's own ring buffers, with the twin's port
//! at the other end.

use super::memory::Memory;
use super::twin::Port;
use controller::buffers::rtt_channel::Positions;
use host_sim::controller::EmulatedController;
use object::{Object, ObjectSection, ObjectSymbol};
use std::io::Result;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::time::{Duration, Instant};

const UP: usize = 1024;
const DOWN: usize = 512;
const UP_AT: u32 = 0x2001_0000;
const DOWN_AT: u32 = 0x2001_1000;
const LOG_AT: u32 = 0x2001_2000;
const NAME_AT: u32 = 0x2001_3000;

/// Returns the control block's address, the address of the build's name, and the name, from the
/// image.
pub(crate) fn marks() -> (u32, u32, Vec<u8>) {
    let bytes = std::fs::read(EmulatedController::default_elf()).unwrap();
    let file = object::File::parse(&*bytes).unwrap();
    let named = |name| file.symbols().find(|symbol| symbol.name() == Ok(name)).unwrap();
    let (block, build) = (named("_SEGGER_RTT").address(), named("PINTLE_BUILD_ID"));
    let section = file.section_by_index(build.section_index().unwrap()).unwrap();
    let name = section.data_range(build.address(), 32).unwrap().unwrap().to_vec();
    (block as u32, build.address() as u32, name)
}

/// The board.
pub(crate) struct Board {
    block: u32,
    build_at: u32,
    pub(crate) build: Vec<u8>,
    /// Name of the second channels.
    pub(crate) name: &'static [u8; 5],
    up: (Positions, [AtomicU8; UP]),
    down: (Positions, [AtomicU8; DOWN]),
    /// True if no probe can reach the board any more.
    gone: AtomicBool,
}

impl Board {
    pub(crate) fn new() -> Self {
        let (block, build_at, build) = marks();
        Self {
            block,
            build_at,
            build,
            name: b"link\0",
            up: (Positions::new(), [const { AtomicU8::new(0) }; UP]),
            down: (Positions::new(), [const { AtomicU8::new(0) }; DOWN]),
            gone: AtomicBool::new(false),
        }
    }

    /// Puts bytes into the down buffer, as a host that has left.
    pub(crate) fn leave(&self, bytes: &[u8]) {
        assert!(self.down.0.write(&self.down.1, bytes, 0));
    }

    /// The control block: the log's channel, the link's two.
    fn control_block(&self) -> Vec<u8> {
        let mut bytes = b"SEGGER RTT\0\0\0\0\0\0".to_vec();
        let seen = |places: &Positions| places.as_words().map(|place| place.load(Ordering::SeqCst));
        let (up, down) = (seen(&self.up.0), seen(&self.down.0));
        let words = [
            [2, 1, NAME_AT + 16, LOG_AT, 1024, 0, 0, 0].as_slice(),
            &[NAME_AT, UP_AT, UP as u32, up[0], up[1], 0],
            &[NAME_AT, DOWN_AT, DOWN as u32, down[0], down[1], 0],
        ];
        bytes.extend(words.concat().iter().flat_map(|word| word.to_le_bytes()));
        bytes
    }

    /// A byte of the memory.
    fn byte(&self, address: u32, control_block: &[u8]) -> u8 {
        let within = |from: u32| address.wrapping_sub(from) as usize;
        let of = |buffer: &[AtomicU8], from| buffer.get(within(from)).map(|byte| byte.load(Ordering::SeqCst));
        let names = [self.name.as_slice(), &[0; 11], b"defmt\0"].concat();
        of(&self.up.1, UP_AT)
            .or_else(|| of(&self.down.1, DOWN_AT))
            .or_else(|| control_block.get(within(self.block)).copied())
            .or_else(|| self.build.get(within(self.build_at)).copied())
            .or_else(|| names.get(within(NAME_AT)).copied())
            .unwrap_or(0)
    }
}

impl Memory for Arc<Board> {
    fn read(&mut self, address: u32, bytes: &mut [u8]) -> bool {
        let control_block = self.control_block();
        for (byte, at) in bytes.iter_mut().zip(address..) {
            *byte = self.byte(at, &control_block);
        }
        !self.gone.load(Ordering::SeqCst)
    }

    /// Write accesses of the probe: its read and write positions, and its data.
    fn write(&mut self, address: u32, bytes: &[u8]) -> bool {
        let word = || u32::from_le_bytes(bytes.try_into().unwrap());
        if address == self.block + 24 + 24 + 16 {
            self.up.0.as_words()[1].store(word(), Ordering::SeqCst);
        } else if address == self.block + 24 + 48 + 12 {
            self.down.0.as_words()[0].store(word(), Ordering::SeqCst);
        } else {
            assert!((DOWN_AT..DOWN_AT + DOWN as u32).contains(&address), "{address:#x}");
            for (place, byte) in self.down.1[(address - DOWN_AT) as usize..].iter().zip(bytes) {
                place.store(*byte, Ordering::SeqCst);
            }
        }
        !self.gone.load(Ordering::SeqCst)
    }
}

/// The controller's side of the ring buffers, used as in the image.
pub(crate) struct Rings(pub(crate) Arc<Board>);

impl Port for Rings {
    fn wait(&mut self, moment: Duration) -> bool {
        let [write, read] = self.0.down.0.as_words();
        let until = Instant::now() + moment;
        while write.load(Ordering::SeqCst) == read.load(Ordering::SeqCst) {
            if Instant::now() > until {
                return false;
            }
            std::thread::yield_now();
        }
        true
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let bytes = std::iter::from_fn(|| self.0.down.0.take(&self.0.down.1));
        Ok(buffer.iter_mut().zip(bytes).map(|(to, byte)| *to = byte).count())
    }

    fn write(&mut self, bytes: &[u8]) {
        let _ = self.0.up.0.write(&self.0.up.1, bytes, 0);
    }

    /// The image's start-up clears its memory.
    fn restart(&mut self) {
        for byte in self.0.up.1.iter().chain(&self.0.down.1) {
            byte.store(0, Ordering::SeqCst);
        }
        for place in self.0.up.0.as_words().into_iter().chain(self.0.down.0.as_words()) {
            place.store(0, Ordering::SeqCst);
        }
    }
}

impl Drop for Rings {
    fn drop(&mut self) {
        self.0.gone.store(true, Ordering::SeqCst);
    }
}
