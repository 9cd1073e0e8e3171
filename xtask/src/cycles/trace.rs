//! Records of the emulator's plugin `trace.c`, and the instructions of the traced image.

use super::decode::Instruction;
use crate::run::ChoreError;
use object::{Object, ObjectSection, ObjectSegment};
use std::io::{BufReader, Read};
use std::ops::Range;
use std::path::Path;

/// An access to data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Access {
    /// Address.
    pub(super) address: u32,
    /// Bytes.
    pub(super) bytes: u32,
    /// True for a store.
    pub(super) is_store: bool,
}

/// An executed instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Step {
    /// Address.
    pub(super) address: u32,
    /// The instruction.
    pub(super) instruction: Instruction,
    /// True if the next executed instruction is not the next in memory.
    pub(super) has_jumped: bool,
    first_access: u32,
    end_of_accesses: u32,
}

/// Everything that was executed between two marks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Section {
    /// Number of the section in the run, from 0.
    pub(super) index: u32,
    /// Its instructions.
    pub(super) steps: Vec<Step>,
    accesses: Vec<Access>,
}

impl Section {
    /// Returns the accesses of an instruction.
    pub(super) fn accesses(&self, step: &Step) -> &[Access] {
        self.accesses.get(step.first_access as usize..step.end_of_accesses as usize).unwrap_or_default()
    }

    /// Appends an executed instruction.
    pub(super) fn push(&mut self, address: u32, instruction: Instruction) {
        if let Some(last) = self.steps.last_mut() {
            last.has_jumped = address != last.address.wrapping_add(last.instruction.bytes.into());
        }
        let at = self.accesses.len() as u32;
        let step = Step { address, instruction, has_jumped: false, first_access: at, end_of_accesses: at };
        self.steps.push(step);
    }

    /// Appends an access of the last instruction.
    pub(super) fn push_access(&mut self, access: Access) {
        self.accesses.push(access);
        if let Some(last) = self.steps.last_mut() {
            last.end_of_accesses = self.accesses.len() as u32;
        }
    }
}

/// Code of an image, decoded at every half-word, and its symbols.
pub(super) struct Image {
    start: u32,
    code: Vec<Instruction>,
    bytes: Vec<u8>,
}

impl Image {
    /// Reads an image.
    pub(super) fn read(path: &Path) -> Result<Self, ChoreError> {
        let wrong = |found: String| ChoreError::File { file: path.into(), found, expected: "an image" };
        let bytes = std::fs::read(path).map_err(|error| wrong(error.to_string()))?;
        let file = object::File::parse(&*bytes).map_err(|error| wrong(error.to_string()))?;
        let text = file.section_by_name(".text").ok_or_else(|| wrong("no section .text".into()))?;
        let (start, data) = (text.address() as u32, text.data().map_err(|error| wrong(error.to_string()))?);
        let words: Vec<u16> =
            data.as_chunks::<2>().0.iter().map(|&half_word| u16::from_le_bytes(half_word)).collect();
        let after = |at: usize| words.get(at + 1).copied().unwrap_or_default();
        let code =
            words.iter().enumerate().map(|(at, &first)| Instruction::decode(first, after(at))).collect();
        Ok(Self { start, code, bytes })
    }

    fn file(&self) -> Option<object::File<'_>> {
        object::File::parse(&*self.bytes).ok()
    }

    /// Returns the address of the handler of an exception.
    pub(super) fn handler(&self, exception: usize) -> Option<u32> {
        let file = self.file()?;
        let table = file.section_by_name(".vector_table")?.data().ok()?;
        let word = table.as_chunks::<4>().0.get(exception)?;
        Some(u32::from_le_bytes(*word) & !1)
    }

    /// Returns the addresses of bytes that the image holds.
    pub(super) fn find(&self, wanted: &[u8]) -> Option<Range<u32>> {
        self.file()?.segments().find_map(|segment| {
            let data = segment.data().ok()?;
            let at = data.windows(wanted.len()).position(|window| window == wanted)?;
            let start = segment.address() as u32 + at as u32;
            Some(start..start + wanted.len() as u32)
        })
    }

    /// Returns the instruction at an address.
    pub(super) fn instruction(&self, address: u32) -> Option<Instruction> {
        self.code.get((address.checked_sub(self.start)? / 2) as usize).copied()
    }
}

/// Reads the sections of a trace one after the other. One that was cut off by the emulator's end is
/// left out.
pub(super) fn read(path: &Path, image: &Image, mut each: impl FnMut(&Section)) -> Result<(), ChoreError> {
    let wrong = |found: String| ChoreError::File { file: path.into(), found, expected: "a trace" };
    let file = std::fs::File::open(path).map_err(|error| wrong(error.to_string()))?;
    let mut file = BufReader::with_capacity(1 << 20, file);
    let mut bytes = Vec::new();
    loop {
        let mut header = [0; 12];
        if file.read_exact(&mut header).is_err() {
            return Ok(());
        }
        let [index, instructions, words] = [0, 4, 8].map(|at| {
            header.get(at..).and_then(|word| word.first_chunk()).map_or(0, |word| u32::from_le_bytes(*word))
        });
        bytes.resize(4 * words as usize, 0);
        if file.read_exact(&mut bytes).is_err() {
            return Ok(());
        }
        let words = bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word));
        let section = section(index, words, image).map_err(&wrong)?;
        if section.steps.len() != instructions as usize {
            return Err(wrong(format!("{} of {instructions} instructions", section.steps.len())));
        }
        each(&section);
    }
}

/// Parses the words of a section.
fn section(index: u32, mut words: impl Iterator<Item = u32>, image: &Image) -> Result<Section, String> {
    let mut section = Section { index, ..Section::default() };
    while let Some(word) = words.next() {
        if word & 1 == 1 {
            let address = word & !1;
            let instruction = image.instruction(address);
            section.push(address, instruction.ok_or_else(|| format!("code at {address:#010x}"))?);
        } else {
            let address = words.next().ok_or("no address")?;
            section.push_access(Access { address, bytes: 1 << (word >> 2 & 3), is_store: word & 2 != 0 });
        }
    }
    Ok(section)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Image of `ldr r0, [r1]` and `nop` at 0x0800_0000.
    fn image() -> Image {
        let code = [0x6808, 0xBF00].map(|first| Instruction::decode(first, 0)).to_vec();
        Image { start: 0x0800_0000, code, bytes: vec![] }
    }

    #[test]
    fn words_become_instructions_with_their_accesses() {
        let words = [0x0800_0001, 2 << 2, 0x2000_0010, 0x0800_0003, 0x0800_0001];
        let section = section(7, words.into_iter(), &image()).unwrap();
        let [load, nop, again] = &section.steps[..] else { panic!("{section:?}") };
        let access = Access { address: 0x2000_0010, bytes: 4, is_store: false };
        assert_eq!((section.index, section.accesses(load)), (7, &[access][..]));
        assert_eq!([load, nop, again].map(|step| step.has_jumped), [false, true, false]);
        assert!(section.accesses(nop).is_empty());
        assert!(super::section(0, [0x0900_0001].into_iter(), &image()).is_err());
        assert!(super::section(0, [0x0800_0001, 0].into_iter(), &image()).is_err());
    }

    #[test]
    fn a_section_that_was_cut_off_is_left_out_and_a_wrong_count_is_an_error() {
        let path = std::env::temp_dir().join(format!("pintle-trace-{}", std::process::id()));
        let whole: [u32; 5] = [3, 2, 2, 0x0800_0001, 0x0800_0003];
        let bytes = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<_>>();
        let count = |content: &[u8]| {
            std::fs::write(&path, content).unwrap();
            let mut sections = 0;
            let result = read(&path, &image(), |section| {
                assert_eq!(section.steps.len(), 2);
                sections += 1;
            });
            result.map(|()| sections)
        };
        let two = [bytes(&whole), bytes(&whole)].concat();
        assert_eq!(count(&two).unwrap(), 2);
        assert_eq!(count(&two[..two.len() - 1]).unwrap(), 1);
        assert!(count(&bytes(&[3, 1, 2, 0x0800_0001, 0x0800_0003])).is_err());
        std::fs::remove_file(&path).unwrap();
    }
}
