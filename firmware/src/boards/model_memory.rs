//! What models and configuration are kept in on this board: its flash, or RAM where there is none to write.
//!
//! The emulator ignores stores to flash, and the MPS2 has none. There RAM that no start-up clears stands in, so that everything but the
//! keeping over a loss of power works the same; a reset leaves it as it was.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use embedded_storage::nor_flash::{ErrorType, MultiwriteNorFlash, NorFlash, ReadNorFlash};
use link::update::ModelMemory;

use crate::store::SlotMemory;
use crate::store::controller::FlashError;

#[cfg(feature = "stm32f405")]
use super::stm32f405::Sectors;

/// Bytes of the two slots in RAM.
const SLOTS: usize = 2 * 20 * 1024;
/// Bytes of the two places for the configuration in RAM.
const PLACES: usize = 2 * 512;
/// What stands before RAM that has been in use since power came.
const IN_USE: u32 = 0x9E1D_57A7;

/// RAM that one [`Memory`] alone touches.
#[repr(C, align(8))]
struct Kept<const BYTES: usize> {
    in_use: UnsafeCell<MaybeUninit<u32>>,
    bytes: UnsafeCell<MaybeUninit<[u8; BYTES]>>,
}

#[expect(unsafe_code, reason = "start-up gives each of them out once, to one owner")]
unsafe impl<const BYTES: usize> Sync for Kept<BYTES> {}

impl<const BYTES: usize> Kept<BYTES> {
    const fn new() -> Self {
        Self { in_use: UnsafeCell::new(MaybeUninit::uninit()), bytes: UnsafeCell::new(MaybeUninit::uninit()) }
    }

    /// Its address; blank when power has just come.
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
static RAM_SLOTS: Kept<SLOTS> = Kept::new();

#[expect(unsafe_code, reason = "as above")]
#[unsafe(link_section = ".uninit.places")]
static RAM_PLACES: Kept<PLACES> = Kept::new();

/// A memory of this board.
#[derive(Debug)]
pub struct Memory {
    start: usize,
    length: usize,
    #[cfg(feature = "stm32f405")]
    sectors: Option<Sectors>,
}

/// The memories of this board: the models' slots, the configuration's places.
pub struct Storage {
    /// Two slots.
    pub slots: Memory,
    /// Two places.
    pub places: Memory,
}

impl Storage {
    /// Those in RAM. To be called once.
    pub(super) fn in_ram() -> Self {
        let memory = |start, length| Memory {
            start,
            length,
            #[cfg(feature = "stm32f405")]
            sectors: None,
        };
        Self { slots: memory(RAM_SLOTS.address(), SLOTS), places: memory(RAM_PLACES.address(), PLACES) }
    }

    /// Those in flash. To be called once.
    #[cfg(feature = "stm32f405")]
    pub(super) fn in_flash() -> Self {
        let memory = |sectors: Sectors| Memory {
            start: sectors.start(),
            length: sectors.length(),
            sectors: Some(sectors),
        };
        Self { slots: memory(Sectors::MODELS), places: memory(Sectors::CONFIGURATION) }
    }
}

impl Memory {
    /// Address of a range; an error if it is not all inside.
    fn range(&self, offset: u32, length: usize) -> Result<usize, FlashError> {
        let offset = offset as usize;
        if offset.saturating_add(length) <= self.length {
            Ok(self.start.wrapping_add(offset))
        } else {
            Err(FlashError::OutOfBounds)
        }
    }
}

impl ErrorType for Memory {
    type Error = FlashError;
}

impl ReadNorFlash for Memory {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        let from = self.range(offset, bytes.len())? as *const u8;
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
    const WRITE_SIZE: usize = 4;
    /// What both kinds can be asked for is their half; flash refuses anything but whole sectors.
    const ERASE_SIZE: usize = PLACES / 2;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        let length = to.checked_sub(from).ok_or(FlashError::OutOfBounds)? as usize;
        let start = self.range(from, length)?;
        #[cfg(feature = "stm32f405")]
        if let Some(sectors) = &mut self.sectors {
            return sectors.erase(start, length);
        }
        #[expect(
            unsafe_code,
            reason = "inside this memory, which nobody else writes; the slot is not in use"
        )]
        unsafe {
            (start as *mut u8).write_bytes(0xFF, length);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let start = self.range(offset, bytes.len())?;
        #[cfg(feature = "stm32f405")]
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

impl MultiwriteNorFlash for Memory {}

impl SlotMemory for Memory {
    fn kind(&self) -> ModelMemory {
        if self.stalls_the_core() { ModelMemory::Flash } else { ModelMemory::Volatile }
    }

    fn stalls_the_core(&self) -> bool {
        #[cfg(feature = "stm32f405")]
        return self.sectors.is_some();
        #[cfg(not(feature = "stm32f405"))]
        return false;
    }

    fn in_place(&self, offset: u32, length: u32) -> &'static [u8] {
        let Ok(start) = self.range(offset, length as usize) else { return &[] };
        #[expect(
            unsafe_code,
            reason = "inside a memory that is there for good, and initialised; the store never writes the slot whose bytes are in use"
        )]
        unsafe {
            core::slice::from_raw_parts(start as *const u8, length as usize)
        }
    }
}
