//! What an image would write: its loaded segments, the flash sectors under them, and whether a core would start from it.
//!
//! Sectors of the STM32F405: RM0090 table 5. The upper half of the flash belongs to what the controller keeps at run time and is never touched.

use super::FlashError;
use link::crc32;
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, Object, elf};
use serde::Serialize;
use std::path::Path;

/// A board that can be flashed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// Its name, as `cargo xtask firmware --board` knows it.
    pub name: &'static str,
    /// The microcontroller, as probe-rs knows it; none for a board of the emulator.
    pub chip: Option<&'static str>,
}

const CHIP: Option<&str> = Some("STM32F405RGTx");

/// Every board.
pub const BOARDS: [Board; 5] = [
    Board { name: "stm32f405", chip: CHIP },
    Board { name: "feather-stm32f405", chip: CHIP },
    Board { name: "olimex-stm32-h405", chip: CHIP },
    Board { name: "netduino-plus-2", chip: CHIP },
    Board { name: "mps2-an505", chip: None },
];

/// The firmware's part of the flash.
const FLASH: std::ops::Range<u64> = 0x0800_0000..0x0808_0000;
/// The RAM that a stack pointer may start in.
const RAM: std::ops::RangeInclusive<u32> = 0x2000_0000..=0x2002_0000;
/// First addresses of the sectors in that part, and its end.
const SECTORS: [u64; 9] = [
    0x0800_0000,
    0x0800_4000,
    0x0800_8000,
    0x0800_C000,
    0x0801_0000,
    0x0802_0000,
    0x0804_0000,
    0x0806_0000,
    0x0808_0000,
];

/// The board of a name, for the command line.
///
/// # Errors
///
/// No board has this name; the names that there are.
pub fn board(name: &str) -> Result<Board, String> {
    let names = || BOARDS.map(|board| board.name).join(", ");
    BOARDS.into_iter().find(|board| board.name == name).ok_or_else(|| format!("expected one of {}", names()))
}

/// A piece of the image.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Segment {
    /// Where it goes.
    pub address: u64,
    /// Its length.
    pub bytes: u64,
    /// CRC-32 of its content.
    pub crc32: String,
}

/// What would be written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Plan {
    /// The board.
    pub board: &'static str,
    /// Its microcontroller.
    pub chip: &'static str,
    /// The image.
    pub image: String,
    /// Bytes to write.
    pub bytes: u64,
    /// The pieces, by address.
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
    /// The file cannot be read, is no image for this board, or the board is one of the emulator's.
    pub fn of(board: Board, path: &Path) -> Result<Self, FlashError> {
        let chip = board.chip.ok_or_else(|| {
            FlashError::Board(format!(
                "{}: a board of the emulator; there is nothing to write to",
                board.name
            ))
        })?;
        let bytes =
            std::fs::read(path).map_err(|source| FlashError::Unreadable { path: path.into(), source })?;
        let wrong = |found: String, expected: &str| FlashError::Image {
            path: path.into(),
            found,
            expected: expected.into(),
        };
        let file = ElfFile32::<Endianness>::parse(&*bytes)
            .map_err(|error| wrong(error.to_string(), "a 32-bit ELF image"))?;
        let machine = file.elf_header().e_machine.get(Endianness::Little);
        if machine != elf::EM_ARM || !file.is_little_endian() {
            return Err(wrong(
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
            let (address, end) = (u64::from(address), u64::from(address) + u64::from(length));
            if address < FLASH.start || end > FLASH.end {
                return Err(wrong(
                    format!("{length} bytes at {address:#010x}"),
                    &format!(
                        "nothing outside the firmware's flash, {:#010x} to {:#010x}",
                        FLASH.start, FLASH.end
                    ),
                ));
            }
            let data = header.data(Endianness::Little, &*bytes).map_err(|()| {
                wrong(format!("a segment at {address:#010x} beyond the file's end"), "a whole image")
            })?;
            loaded.push((address, data));
        }
        loaded.sort_unstable_by_key(|(address, _)| *address);
        let start = loaded.first().filter(|(address, _)| *address == FLASH.start).map(|(_, data)| *data);
        let vectors = start.and_then(|data| data.first_chunk::<8>()).map(|[a, b, c, d, e, f, g, h]| {
            [u32::from_le_bytes([*a, *b, *c, *d]), u32::from_le_bytes([*e, *f, *g, *h])]
        });
        let Some([stack_pointer, reset]) = vectors else {
            return Err(wrong("no vector table".into(), &format!("one at {:#010x}", FLASH.start)));
        };
        if !RAM.contains(&stack_pointer) || reset & 1 == 0 || !FLASH.contains(&u64::from(reset)) {
            return Err(wrong(
                format!(
                    "a vector table with stack pointer {stack_pointer:#010x} and reset handler {reset:#010x}"
                ),
                "a stack in RAM and a Thumb handler in flash",
            ));
        }
        let covers = |range: &&[u64]| match range {
            [from, to] => loaded.iter().any(|(at, data)| at < to && at + data.len() as u64 > *from),
            _ => false,
        };
        let sectors = SECTORS.windows(2).filter(covers).filter_map(|range| range.first().copied()).collect();
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
        Plan::of(BOARDS[0], file.path()).map_err(|error| error.to_string())
    }

    const GOOD: [u32; 2] = [0x2000_8000, 0x0800_0199];

    #[test]
    fn a_sound_image_is_planned_sector_by_sector() {
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
        let missing = Plan::of(BOARDS[0], Path::new("/no/such/image")).unwrap_err();
        assert!(missing.to_string().starts_with("/no/such/image: "), "{missing}");
    }

    #[test]
    fn a_board_of_the_emulator_cannot_be_flashed() {
        let error = Plan::of(board("mps2-an505").unwrap(), Path::new("x")).unwrap_err();
        assert!(matches!(error, FlashError::Board(_)), "{error}");
        assert!(board("arduino").unwrap_err().contains("feather-stm32f405"));
    }
}
