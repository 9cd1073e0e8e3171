//! Sealing an image: setting the word that holds the CRC-32 of the firmware's code.
//!
//! The CRC covers vector table, code and the constants around the built-in model images and the
//! seal. The firmware names two symbols for this module in `firmware/src/boards/code.rs`: the word
//! itself and a table with the places of the model images.

use crate::run::{ChoreError, write_atomically};
use controller::supervisor::code::{UNSEALED, seal_of, spans};
use inference::{BearingMaterial, shipped};
use object::{Object, ObjectSection, ObjectSymbol};
use std::ops::Range;
use std::path::Path;

/// Symbol of the word to set.
const SEAL: &str = "PINTLE_CODE_SEAL";
/// Symbol of the table of model images: address and length of each, 32 bits each, in the order of
/// the material codes.
const MODEL_IMAGES: &str = "PINTLE_MODEL_IMAGES";

/// Seals an image in its file. Sealing it again changes nothing.
///
/// A gap between vector table and code is erased flash on a board and 0 in the emulator. Therefore
/// only an image for the emulator may have one.
pub(crate) fn seal(image: &Path, is_emulated_only: bool) -> Result<(), ChoreError> {
    let failed = |found: String| ChoreError::File {
        file: image.into(),
        found,
        expected: "an image of this firmware that can be sealed",
    };
    let mut bytes = std::fs::read(image).map_err(|error| failed(error.to_string()))?;
    let (place, word) = find_seal(&bytes, is_emulated_only).map_err(failed)?;
    let at = bytes.get_mut(place..place + 4).ok_or_else(|| failed("a seal after its end".into()))?;
    at.copy_from_slice(&word.to_le_bytes());
    // Replaced, not edited: cargo links another name to this file, which must not become an
    // incomplete image.
    write_atomically(image.into(), bytes)
}

/// Returns the seal's offset in the file and the value that it must have.
fn find_seal(bytes: &[u8], is_emulated_only: bool) -> Result<(usize, u32), String> {
    let elf = Elf::parse(bytes)?;
    let seal = elf.symbol(SEAL)?.start;
    let gap = elf.vectors.addresses.end..elf.code.addresses.start;
    if !gap.is_empty() && !is_emulated_only {
        return Err(format!("{} bytes between vector table and code", gap.end - gap.start));
    }
    if !elf.constants.addresses.contains(&seal) {
        return Err("a seal outside of the constants".into());
    }
    let offset = elf.offset(seal).ok_or("a seal outside of the file")?;
    let code = elf.vectors.addresses.start..elf.code.addresses.end;
    let addresses = spans(code, &elf.constants.addresses, &elf.model_images()?, seal).into_iter();
    let word_at = |address: usize| {
        let word = if gap.contains(&address) { Some(0) } else { elf.word(address) };
        word.ok_or_else(|| format!("no word at {address:#010x}"))
    };
    let words = addresses.flat_map(|span| span.step_by(4)).map(word_at);
    match seal_of(words.collect::<Result<Vec<u32>, String>>()?.into_iter()) {
        UNSEALED => Err("a CRC that looks like no seal".into()),
        crc => Ok((offset, crc)),
    }
}

/// Section in memory and in the file.
struct Section {
    addresses: Range<usize>,
    offset: usize,
}

/// ELF file of the firmware.
struct Elf<'a> {
    bytes: &'a [u8],
    file: object::File<'a>,
    vectors: Section,
    code: Section,
    constants: Section,
}

impl<'a> Elf<'a> {
    fn parse(bytes: &'a [u8]) -> Result<Self, String> {
        let file = object::File::parse(bytes).map_err(|error| error.to_string())?;
        let section = |name: &str| {
            let section = file.section_by_name(name).ok_or_else(|| format!("no section {name}"))?;
            let (offset, length) = section.file_range().ok_or_else(|| format!("an empty section {name}"))?;
            let start = section.address() as usize;
            Ok::<_, String>(Section { addresses: start..start + length as usize, offset: offset as usize })
        };
        let (vectors, code, constants) = (section(".vector_table")?, section(".text")?, section(".rodata")?);
        Ok(Self { bytes, file, vectors, code, constants })
    }

    /// Addresses of a symbol.
    fn symbol(&self, name: &str) -> Result<Range<usize>, String> {
        let symbol = self.file.symbols().find(|symbol| symbol.name() == Ok(name));
        let symbol = symbol.ok_or_else(|| format!("no symbol {name}"))?;
        let start = symbol.address() as usize;
        Ok(start..start + symbol.size() as usize)
    }

    /// Offset of an address in the file.
    fn offset(&self, address: usize) -> Option<usize> {
        let sections = [&self.vectors, &self.code, &self.constants];
        let section = sections.into_iter().find(|section| section.addresses.contains(&address))?;
        Some(section.offset + (address - section.addresses.start))
    }

    fn word(&self, address: usize) -> Option<u32> {
        let offset = self.offset(address)?;
        self.bytes.get(offset..offset + 4)?.try_into().ok().map(u32::from_le_bytes)
    }

    /// Addresses of the built-in model images, which must be the shipped ones.
    fn model_images(&self) -> Result<[Range<usize>; BearingMaterial::COUNT], String> {
        let table = self.symbol(MODEL_IMAGES)?;
        if table.len() != 8 * BearingMaterial::COUNT {
            return Err(format!("{} bytes of {MODEL_IMAGES}", table.len()));
        }
        let mut images = [const { 0..0 }; BearingMaterial::COUNT];
        for (row, (range, material)) in table.step_by(8).zip(images.iter_mut().zip(BearingMaterial::ALL)) {
            let word = |address| self.word(address).ok_or("a table of model images outside of the constants");
            let (start, length) = (word(row)? as usize, word(row + 4)? as usize);
            let found = self.offset(start).and_then(|offset| self.bytes.get(offset..offset + length));
            if found != Some(shipped(material)) {
                return Err(format!("no shipped {} model at {start:#010x}", material.name()));
            }
            *range = start..start + length;
        }
        Ok(images)
    }
}
