//! The plan of an image: its loaded segments, the flash sectors under them, and a check of its
//! vector table.
//!
//! The memory map and the flash sectors come from the table of boards. Flash outside the map's
//! `FLASH` region contains what the controller saves at run time and is never written.

use super::FlashError;
use controller::boards::{Board, Region};
use link::crc32;
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, Object, elf};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// A segment of the image.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Segment {
    /// Start address.
    pub address: u64,
    /// Its length.
    pub bytes: u64,
    /// CRC-32 of its content.
    pub crc32: String,
}

/// Content of a flash operation.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Plan {
    /// The board.
    pub board: &'static str,
    /// Its microcontroller.
    pub chip: &'static str,
    /// The image.
    pub image: String,
    /// Total number of bytes.
    pub bytes: u64,
    /// Segments by address.
    pub segments: Vec<Segment>,
    /// Start addresses of the sectors to be erased.
    pub sectors: Vec<u64>,
    /// Initial stack pointer.
    pub stack_pointer: u32,
    /// Address of the first instruction.
    pub entry: u32,
}

impl Plan {
    /// Checks an image for a board.
    ///
    /// # Errors
    ///
    /// The file cannot be read, is not an image for this board, or the board exists in the emulator
    /// only.
    pub fn for_board(board: Board, path: &Path) -> Result<Self, FlashError> {
        let chip = board.microcontroller.probe_name.ok_or_else(|| {
            FlashError::Board(format!(
                "{}: a board of the emulator; there is nothing to write to",
                board.name
            ))
        })?;
        let map = board.microcontroller.memory_map;
        let [flash, stack, ram] = ["FLASH", "STACK", "RAM"].map(|name| map.region(name));
        let (Some(flash), Some(stack), Some(ram)) = (flash, stack, ram) else {
            return Err(FlashError::Board(format!(
                "{}: found no FLASH, STACK and RAM in its memory map",
                board.name
            )));
        };
        let bytes = std::fs::read(path).map_err(|source| FlashError::unreadable(path, source))?;
        let loaded = loaded_segments(path, &bytes, flash)?;
        let Some([stack_pointer, reset]) = vectors(&loaded, flash) else {
            return Err(wrong(path, "no vector table".into(), &format!("one at {:#010x}", flash.origin)));
        };
        let is_in_ram = (stack.origin..=ram.end()).contains(&stack_pointer);
        if !is_in_ram || reset & 1 == 0 || !flash.contains(reset.into(), 1) {
            return Err(wrong(
                path,
                format!(
                    "a vector table with stack pointer {stack_pointer:#010x} and reset handler {reset:#010x}"
                ),
                "a stack in RAM and a Thumb handler in flash",
            ));
        }
        let sectors = covered_sectors(board.microcontroller.flash_sectors, flash, &loaded);
        let segments: Vec<_> = loaded
            .iter()
            .map(|(address, data)| Segment {
                address: *address,
                bytes: data.len() as u64,
                crc32: format!("{:08x}", crc32(data)),
            })
            .collect();
        Ok(Self {
            board: board.name,
            chip,
            image: path.display().to_string(),
            bytes: segments.iter().map(|segment| segment.bytes).sum(),
            segments,
            sectors,
            stack_pointer,
            entry: reset & !1,
        })
    }
}

/// Creates the error of an image that does not fit the board.
fn wrong(path: &Path, found: String, expected: &str) -> FlashError {
    FlashError::Image { path: path.into(), found, expected: expected.into() }
}

/// Returns the address and content of each loaded segment of an ELF image, in ascending order.
fn loaded_segments<'a>(
    path: &Path,
    bytes: &'a [u8],
    flash: Region,
) -> Result<Vec<(u64, &'a [u8])>, FlashError> {
    let file = ElfFile32::<Endianness>::parse(bytes)
        .map_err(|error| wrong(path, error.to_string(), "a 32-bit ELF image"))?;
    let machine = file.elf_header().e_machine.get(Endianness::Little);
    if machine != elf::EM_ARM || !file.is_little_endian() {
        return Err(wrong(
            path,
            format!("machine {machine}"),
            "an image for a little-endian ARM core (machine 40)",
        ));
    }
    let mut loaded = Vec::new();
    for header in file.elf_program_headers() {
        let (address, length) = (header.p_paddr(Endianness::Little), header.p_filesz(Endianness::Little));
        if header.p_type(Endianness::Little) != elf::PT_LOAD || length == 0 {
            continue;
        }
        let address = u64::from(address);
        if !flash.contains(address, length.into()) {
            return Err(wrong(
                path,
                format!("{length} bytes at {address:#010x}"),
                &format!(
                    "nothing outside the firmware's flash, {:#010x} to {:#010x}",
                    flash.origin,
                    flash.end()
                ),
            ));
        }
        let data = header.data(Endianness::Little, bytes).map_err(|()| {
            let found = format!("a segment at {address:#010x} beyond the file's end");
            wrong(path, found, "a complete image")
        })?;
        loaded.push((address, data));
    }
    loaded.sort_unstable_by_key(|(address, _)| *address);
    Ok(loaded)
}

/// Returns stack pointer and reset handler from the vector table at the start of the flash.
fn vectors(loaded: &[(u64, &[u8])], flash: Region) -> Option<[u32; 2]> {
    let (_, data) = loaded.first().filter(|(address, _)| *address == u64::from(flash.origin))?;
    let stack_pointer = data.first_chunk::<4>()?;
    let reset = data.get(4..)?.first_chunk::<4>()?;
    Some([*stack_pointer, *reset].map(u32::from_le_bytes))
}

/// Returns the start addresses of the flash sectors that the segments cover.
fn covered_sectors(sectors: &[u32], flash: Region, loaded: &[(u64, &[u8])]) -> Vec<u64> {
    let starts = sectors.iter().map(|&start| u64::from(start));
    let ends = starts.clone().skip(1).chain([flash.end().into()]);
    let is_covered =
        |(from, to): &(u64, u64)| loaded.iter().any(|(at, data)| at < to && at + data.len() as u64 > *from);
    starts.zip(ends).filter(is_covered).map(|(start, _)| start).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An ELF image with one segment.
    fn image(machine: u8, address: u32, vectors: [u32; 2], length: u32) -> Vec<u8> {
        let mut bytes = b"\x7fELF\x01\x01\x01".to_vec();
        bytes.resize(16, 0);
        bytes.extend([2, 0, machine, 0, 1, 0, 0, 0]);
        // Entry, program headers, section headers, flags, sizes and counts.
        bytes.extend([0_u32, 52, 0, 0x0500_0000].map(u32::to_le_bytes).as_flattened());
        bytes.extend([52_u16, 32, 1, 40, 0, 0].map(u16::to_le_bytes).as_flattened());
        bytes.extend([1, 84, address, address, length, length, 5, 4].map(u32::to_le_bytes).as_flattened());
        bytes.extend(vectors.map(u32::to_le_bytes).as_flattened());
        bytes.resize(84 + 1000, 7);
        bytes
    }

    fn plan(bytes: &[u8]) -> Result<Plan, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), bytes).unwrap();
        Plan::for_board(controller::boards::BOARDS[0], file.path()).map_err(|error| error.to_string())
    }

    const GOOD: [u32; 2] = [0x2000_8000, 0x0800_0199];

    #[test]
    fn a_valid_image_is_planned_sector_by_sector() {
        let found = plan(&image(40, 0x0800_0000, GOOD, 1000)).unwrap();
        assert_eq!((found.bytes, found.sectors, found.entry), (1000, vec![0x0800_0000], 0x0800_0198));
        assert_eq!(found.segments.len(), 1);
        assert_eq!(found.chip, "STM32F405RGTx");
    }

    #[test]
    fn an_image_for_something_else_is_refused_with_the_reason() {
        let cases = [
            (image(3, 0x0800_0000, GOOD, 1000), "machine 3"),
            (image(40, 0x1000_0000, GOOD, 1000), "1000 bytes at 0x10000000"),
            (image(40, 0x0807_FF00, GOOD, 1000), "1000 bytes at 0x0807ff00"),
            (image(40, 0x0800_4000, GOOD, 1000), "no vector table"),
            (image(40, 0x0800_0000, GOOD, 4), "no vector table"),
            (image(40, 0x0800_0000, GOOD, 100_000), "beyond the file's end"),
            (image(40, 0x0800_0000, [0x1000_0000, GOOD[1]], 1000), "stack pointer 0x10000000"),
            (image(40, 0x0800_0000, [GOOD[0], 0x0800_0198], 1000), "reset handler 0x08000198"),
            (b"no image".to_vec(), "expected a 32-bit ELF image"),
            (Vec::new(), "expected a 32-bit ELF image"),
        ];
        for (bytes, reason) in cases {
            let error = plan(&bytes).unwrap_err();
            assert!(error.contains(reason), "{error}");
        }
        let missing =
            Plan::for_board(controller::boards::BOARDS[0], Path::new("/no/such/image")).unwrap_err();
        assert!(missing.to_string().starts_with("/no/such/image: "), "{missing}");
    }

    #[test]
    fn a_board_of_the_emulator_cannot_be_flashed() {
        let error =
            Plan::for_board(*controller::boards::find("mps2-an505").unwrap(), Path::new("x")).unwrap_err();
        assert!(matches!(error, FlashError::Board(_)), "{error}");
    }
}
