//! The seal of an image: the word with which the firmware's sum over its own code comes to what it expects.
//!
//! What is summed up is told in `firmware/src/boards/code.rs`: vector table and code, then the constants around the built-in networks.

use crate::run::{ChoreError, write_whole};
use ::firmware::supervisor::code::sealing;
use object::{Object, ObjectSection, ObjectSymbol};
use std::ops::Range;
use std::path::Path;

/// The symbol of the word.
const SEAL: &str = "PINTLE_CODE_SEAL";
/// Parts of the names of the networks' symbols.
const NETWORKS: [&str; 2] = ["9inference7bearing7BABBITT", "9inference7bearing7PLASTIC"];

/// A section's bytes in memory and in the file.
struct Section {
    addresses: Range<u64>,
    file: u64,
}

/// Seals an image. Sealing it again changes nothing. Where vector table and code do not touch, what lies between them is erased flash on a board
/// and 0 in the emulator: only an image that is never flashed may have such a gap.
pub(crate) fn seal(image: &Path, is_only_emulated: bool) -> Result<(), ChoreError> {
    let failed = |found: String| ChoreError::File {
        file: image.into(),
        found,
        expected: "an image of this firmware that can be sealed",
    };
    let mut bytes = std::fs::read(image).map_err(|error| failed(error.to_string()))?;
    let (place, word) = word(&bytes, is_only_emulated).map_err(failed)?;
    let at = bytes.get_mut(place..place + 4).ok_or_else(|| failed("a seal beyond its end".into()))?;
    at.copy_from_slice(&word.to_le_bytes());
    // Not in place: cargo keeps another name of this very file, which half an image must not get.
    write_whole(image.into(), bytes)
}

/// Where in the file the seal is, and what it must be.
fn word(bytes: &[u8], is_only_emulated: bool) -> Result<(usize, u32), String> {
    let file = object::File::parse(bytes).map_err(|error| error.to_string())?;
    let section = |name: &str| {
        let section = file.section_by_name(name).ok_or_else(|| format!("no section {name}"))?;
        let (begin, _) = section.file_range().ok_or_else(|| format!("nothing in {name}"))?;
        Ok::<_, String>(Section {
            addresses: section.address()..section.address() + section.size(),
            file: begin,
        })
    };
    let sections = [section(".vector_table")?, section(".text")?, section(".rodata")?];
    let symbol = |part: &str| {
        // Of a name that is both a reference's and that of what it refers to, the latter.
        let found = file.symbols().filter(|symbol| symbol.name().is_ok_and(|name| name.contains(part)));
        let symbol = found.max_by_key(|symbol| symbol.size()).ok_or_else(|| format!("no symbol {part}"))?;
        Ok::<_, String>(symbol.address()..symbol.address() + symbol.size())
    };
    let seal = symbol(SEAL)?.start;
    let networks = [symbol(NETWORKS[0])?, symbol(NETWORKS[1])?];
    let place = |address: u64| {
        let section = sections.iter().find(|section| section.addresses.contains(&address))?;
        usize::try_from(section.file + (address - section.addresses.start)).ok()
    };
    let [vectors, code, constants] = &sections;
    let gap = vectors.addresses.end..code.addresses.start;
    if !gap.is_empty() && !is_only_emulated {
        return Err(format!("{} bytes between vector table and code", gap.end - gap.start));
    }
    let word_at = |address: u64| match place(address) {
        Some(place) => bytes.get(place..place + 4)?.try_into().ok().map(u32::from_le_bytes),
        None => gap.contains(&address).then_some(0),
    };
    let code = vectors.addresses.start..code.addresses.end;
    let addresses = [code, constants.addresses.clone()].into_iter().flat_map(|range| range.step_by(4));
    let covered = addresses.filter(|address| !networks.iter().any(|network| network.contains(address)));
    let covered: Vec<u64> = covered.collect();
    let words = |of: &[u64]| {
        let words = of.iter().map(|&address| word_at(address)).collect::<Option<Vec<u32>>>();
        words.ok_or_else(|| "sections that are no whole words".to_owned())
    };
    let middle =
        covered.iter().position(|&address| address == seal).ok_or("a seal outside of the constants")?;
    let (before, behind) = covered.split_at(middle);
    let word = sealing(words(before)?.into_iter(), words(behind.get(1..).unwrap_or_default())?.into_iter());
    Ok((place(seal).ok_or("a seal outside of the file")?, word))
}
