//! Memories for models and configuration: the board's flash, or RAM if it has none to write.
//!
//! The emulator ignores stores to flash, and the MPS2 has no flash. There RAM that start-up does
//! not clear replaces it. It outlasts a reset but not a loss of power; everything else works the
//! same.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use link::update::ModelMemory;

use controller::store::SlotMemory;
use controller::store::controller::FlashError;
use controller::store::keeper::{Kind, RECORD};

use super::microcontroller::Sectors;

/// Bytes of both halves for the kept values: one of each kind in a half.
const HALVES: usize = 2 * Kind::ALL.len() * RECORD;
/// Bytes of both slots in RAM. Images that no emulator runs have none.
const SLOTS: usize = if cfg!(emulated) { 2 * 20 * 1024 } else { 0 };
/// Bytes of both halves in RAM, likewise.
const PLACES: usize = if cfg!(emulated) { HALVES } else { 0 };
/// Mark of RAM that has been initialised since power-on.
const IN_USE: u32 = 0x9E1D_57A7;

/// RAM that a single [`Memory`] accesses.
#[repr(C, align(8))]
struct Retained<const BYTES: usize> {
    in_use: UnsafeCell<MaybeUninit<u32>>,
    bytes: UnsafeCell<MaybeUninit<[u8; BYTES]>>,
}

#[expect(unsafe_code, reason = "start-up gives each of them out once, to one owner")]
unsafe impl<const BYTES: usize> Sync for Retained<BYTES> {}

impl<const BYTES: usize> Retained<BYTES> {
    const fn new() -> Self {
        Self { in_use: UnsafeCell::new(MaybeUninit::uninit()), bytes: UnsafeCell::new(MaybeUninit::uninit()) }
    }

    /// Returns the address. After power-on the RAM is blank.
    fn address(&'static self) -> usize {
        let (in_use, bytes) = (self.in_use.get().cast::<u32>(), self.bytes.get().cast::<u8>());
        #[expect(unsafe_code, reason = "any bits are a number, and the bytes are this object's own")]
        unsafe {
            if in_use.read_volatile() != IN_USE {
                bytes.write_bytes(0xFF, BYTES);
                in_use.write_volatile(IN_USE);
            }
        }
        bytes as usize
    }
}

#[expect(unsafe_code, reason = "sections that start-up leaves alone")]
#[unsafe(link_section = ".uninit.slots")]
static RAM_SLOTS: Retained<SLOTS> = Retained::new();

#[expect(unsafe_code, reason = "as above")]
#[unsafe(link_section = ".uninit.places")]
static RAM_PLACES: Retained<PLACES> = Retained::new();

/// One memory of this board.
#[derive(Debug)]
pub struct Memory {
    start: usize,
    length: usize,
    /// Flash sectors; `None` for RAM.
    sectors: Option<Sectors>,
}

/// The memories of this board.
pub struct Storage {
    /// Memory with the two model slots.
    pub slots: Memory,
    /// Memory with the two halves for the configuration.
    pub places: Memory,
}

impl Storage {
    /// Takes the flash sectors for models and configuration, or else RAM. To be called once.
    pub(super) fn new(flash: Option<[Sectors; 2]>) -> Self {
        let [slots, places] = match flash {
            Some(sectors) => sectors.map(Memory::in_flash),
            None => [(RAM_SLOTS.address(), SLOTS), (RAM_PLACES.address(), PLACES)].map(Memory::in_ram),
        };
        Self { slots, places }
    }
}

impl Memory {
    fn in_flash(sectors: Sectors) -> Self {
        Self { start: sectors.start(), length: sectors.length(), sectors: Some(sectors) }
    }

    fn in_ram((start, length): (usize, usize)) -> Self {
        Self { start, length, sectors: None }
    }

    /// Returns the address of a range within the memory.
    fn range(&self, offset: u32, length: usize) -> Result<usize, FlashError> {
        let offset = offset as usize;
        if offset.saturating_add(length) <= self.length {
            Ok(self.start.wrapping_add(offset))
        } else {
            Err(FlashError::OutOfBounds)
        }
    }

    /// Decides whether every byte of a range within the memory can be read.
    fn is_readable(&self, start: usize, length: usize) -> bool {
        self.sectors.as_ref().is_none_or(|sectors| sectors.is_readable(start, length))
    }
}

impl ErrorType for Memory {
    type Error = FlashError;
}

impl ReadNorFlash for Memory {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        let start = self.range(offset, bytes.len())?;
        if !self.is_readable(start, bytes.len()) {
            return Err(FlashError::Unreadable);
        }
        let from = start as *const u8;
        for (index, byte) in bytes.iter_mut().enumerate() {
            #[expect(
                unsafe_code,
                reason = "inside this memory; volatile, because programming goes past the compiler"
            )]
            unsafe {
                *byte = from.wrapping_add(index).read_volatile();
            }
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.length
    }
}

impl NorFlash for Memory {
    const WRITE_SIZE: usize = Sectors::WORD_LENGTH;
    /// Smallest unit that both kinds can erase; flash refuses anything but complete sectors.
    const ERASE_SIZE: usize = HALVES / 2;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        let length = to.checked_sub(from).ok_or(FlashError::OutOfBounds)? as usize;
        let start = self.range(from, length)?;
        if let Some(sectors) = &mut self.sectors {
            return sectors.erase(start, length);
        }
        #[expect(
            unsafe_code,
            reason = "inside this memory, written by its owner only; the slot is not in use"
        )]
        unsafe {
            (start as *mut u8).write_bytes(0xFF, length);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let start = self.range(offset, bytes.len())?;
        if let Some(sectors) = &mut self.sectors {
            return sectors.program(start, bytes);
        }
        for (index, byte) in bytes.iter().enumerate() {
            let to = (start as *mut u8).wrapping_add(index);
            #[expect(unsafe_code, reason = "as for `erase`; as flash does, bits are only cleared")]
            unsafe {
                to.write_volatile(to.read_volatile() & byte);
            }
        }
        Ok(())
    }
}

impl SlotMemory for Memory {
    const IS_WRITE_ONCE: bool = Sectors::IS_WRITE_ONCE;

    fn kind(&self) -> ModelMemory {
        if self.stalls_the_core() { ModelMemory::Flash } else { ModelMemory::Volatile }
    }

    fn stalls_the_core(&self) -> bool {
        self.sectors.is_some()
    }

    fn in_place(&self, offset: u32, length: u32) -> &'static [u8] {
        let Ok(start) = self.range(offset, length as usize) else { return &[] };
        if !self.is_readable(start, length as usize) {
            return &[];
        }
        #[expect(
            unsafe_code,
            reason = "inside initialised memory that is never freed; the store does not write a slot in use"
        )]
        unsafe {
            core::slice::from_raw_parts(start as *const u8, length as usize)
        }
    }
}
