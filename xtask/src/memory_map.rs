//! Check of an image against the memory map of its board.

use crate::run::ChoreError;
use controller::boards::MemoryMap;
use object::{Object, ObjectSection, ObjectSegment, ObjectSymbol, SectionFlags, elf};
use std::path::Path;

/// Refuses an image with a segment, an allocated section or a stack outside the regions of a memory
/// map.
pub(crate) fn check(image: &Path, map: &MemoryMap) -> Result<(), ChoreError> {
    let failed = |found: String| ChoreError::File {
        file: image.into(),
        found,
        expected: "an image within the board's memory map",
    };
    let bytes = std::fs::read(image).map_err(|error| failed(error.to_string()))?;
    let file = object::File::parse(&*bytes).map_err(|error| failed(error.to_string()))?;
    check_file(&file, map).map_err(failed)
}

fn check_file(file: &object::File<'_>, map: &MemoryMap) -> Result<(), String> {
    let is_inside = |address: u64, length: u64| map.regions().any(|region| region.contains(address, length));
    for segment in file.segments().filter(|segment| segment.size() > 0) {
        if !is_inside(segment.address(), segment.size()) {
            return Err(format!("a segment of {} bytes at {:#010x}", segment.size(), segment.address()));
        }
    }
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else { continue };
        let is_allocated = sh_flags & u64::from(elf::SHF_ALLOC) != 0 && section.size() > 0;
        if is_allocated && !is_inside(section.address(), section.size()) {
            let name = section.name().unwrap_or("?");
            return Err(format!("section {name} of {} bytes at {:#010x}", section.size(), section.address()));
        }
    }
    let address = |name: &str| {
        let symbol = file.symbols().find(|symbol| symbol.name() == Ok(name));
        symbol.map(|symbol| symbol.address()).ok_or_else(|| format!("no symbol {name}"))
    };
    let vectors = file.section_by_name(".vector_table").ok_or("no section .vector_table")?.address();
    let (flash, stack) = (map.region("FLASH"), map.region("STACK"));
    if flash.is_none_or(|flash| u64::from(flash.origin) != vectors) {
        return Err(format!("a vector table at {vectors:#010x}"));
    }
    let ends = [address("_stack_end")?, address("_stack_start")?];
    if stack.is_none_or(|stack| [stack.origin, stack.end()].map(u64::from) != ends) {
        return Err(format!("a stack from {:#010x} to {:#010x}", ends[0], ends[1]));
    }
    Ok(())
}
