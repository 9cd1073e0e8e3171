//! Functions of an image: addresses, stack frames and callees.
//!
//! The mapping symbols `$t` and `$d` separate code from tables within it. Stack frames are those
//! that the compiler records (`.stack_sizes`). Assembly and the compiler's runtime library have no
//! records; for them, everything by which their instructions lower the stack pointer is added up.

use super::thumb::{Effect, effect, is_wide};
use crate::run::ChoreError;
use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A function.
#[derive(Clone, Debug, Default)]
pub(super) struct Function {
    /// Its name, one of several perhaps.
    pub(super) name: String,
    /// Bytes of stack that it takes itself.
    pub(super) frame: u32,
    /// Start addresses of those that it calls or ends in.
    pub(super) callees: BTreeSet<u32>,
}

/// The functions of an image by address.
pub(super) struct Functions {
    /// Address to function.
    pub(super) by_address: BTreeMap<u32, Function>,
    /// Words of the vector table: the initial stack pointer, then handlers.
    pub(super) vectors: Vec<u32>,
    /// Room for the stack, bytes.
    pub(super) reserved: u32,
    /// Room for the emergency stack, bytes.
    pub(super) emergency: u32,
}

impl Functions {
    /// Reads an image.
    pub(super) fn read(path: &Path) -> Result<Self, ChoreError> {
        let wrong = |found: String| ChoreError::File {
            file: path.into(),
            found,
            expected: "an image whose use of the stack can be computed",
        };
        let bytes = std::fs::read(path).map_err(|error| wrong(error.to_string()))?;
        let file = object::File::parse(&*bytes).map_err(|error| wrong(error.to_string()))?;
        let section = |name: &str| {
            let section = file.section_by_name(name).ok_or_else(|| wrong(format!("no section {name}")))?;
            let data = section.data().map_err(|error| wrong(error.to_string()))?;
            Ok((section.address() as u32, data))
        };
        let symbols: Vec<_> = file
            .symbols()
            .filter_map(|symbol| {
                // The alternate form is the path without the compiler's hash.
                let name = format!("{:#}", rustc_demangle::demangle(symbol.name().ok()?));
                Some((symbol.address() as u32, symbol.size() as u32, symbol.kind(), name))
            })
            .collect();
        let find = |wanted: &str| {
            symbols
                .iter()
                .find(|(.., name)| name == wanted)
                .ok_or_else(|| wrong(format!("no symbol {wanted}")))
        };

        let sizes =
            stack_sizes(section(".stack_sizes")?.1).ok_or_else(|| wrong("broken .stack_sizes".into()))?;
        let text = section(".text")?;
        let data_in_code: BTreeMap<u32, bool> = symbols
            .iter()
            .filter(|(.., name)| name.starts_with("$t") || name.starts_with("$d"))
            .map(|(address, .., name)| (address & !1, name.starts_with("$d")))
            .collect();
        let extents: BTreeMap<u32, (u32, &str)> = symbols
            .iter()
            .filter(|(_, size, kind, _)| *kind == SymbolKind::Text && *size > 0)
            .map(|(address, size, _, name)| (address & !1, (*size, name.as_str())))
            .collect();
        let mut by_address = BTreeMap::new();
        for (&start, &(size, name)) in &extents {
            let code = Code { text, data_in_code: &data_in_code, start, size };
            let function = code.function(name, sizes.get(&start).copied(), &extents).map_err(&wrong)?;
            by_address.insert(start, function);
        }
        let vectors = section(".vector_table")?
            .1
            .as_chunks::<4>()
            .0
            .iter()
            .map(|word| u32::from_le_bytes(*word))
            .collect();
        let reserved = find("_stack_start")?.0.saturating_sub(find("_stack_end")?.0);
        let emergency = find("firmware::boards::memory::EMERGENCY")?.1;
        Ok(Self { by_address, vectors, reserved, emergency })
    }
}

/// Parses `.stack_sizes`: pairs of an address and a size in ULEB128.
fn stack_sizes(mut bytes: &[u8]) -> Option<BTreeMap<u32, u32>> {
    let mut sizes = BTreeMap::new();
    while let Some((address, rest)) = bytes.split_first_chunk::<4>() {
        let length = rest.iter().position(|byte| byte & 0x80 == 0)? + 1;
        let (number, rest) = rest.split_at_checked(length)?;
        let size = number.iter().rev().fold(0_u32, |sum, byte| sum << 7 | u32::from(byte & 0x7F));
        sizes.insert(u32::from_le_bytes(*address) & !1, size);
        bytes = rest;
    }
    bytes.is_empty().then_some(sizes)
}

/// The bytes of one function.
struct Code<'a> {
    text: (u32, &'a [u8]),
    data_in_code: &'a BTreeMap<u32, bool>,
    start: u32,
    size: u32,
}

impl Code<'_> {
    fn half_word(&self, address: u32) -> Option<u16> {
        let at = address.checked_sub(self.text.0)? as usize;
        self.text.1.get(at..)?.first_chunk().map(|bytes| u16::from_le_bytes(*bytes))
    }

    fn is_data(&self, address: u32) -> bool {
        self.data_in_code.range(..=address).next_back().is_some_and(|(_, &is_data)| is_data)
    }

    fn function(
        &self,
        name: &str,
        recorded: Option<u32>,
        extents: &BTreeMap<u32, (u32, &str)>,
    ) -> Result<Function, String> {
        let mut function = Function { name: name.into(), ..Function::default() };
        let (mut address, mut lowered) = (self.start, 0);
        let end = self.start + self.size;
        while address < end {
            if self.is_data(address) {
                address += 2;
                continue;
            }
            let (first, second) = (self.half_word(address), self.half_word(address + 2));
            let first = first.ok_or_else(|| format!("{name} outside the code"))?;
            let what = effect(address, first, second.unwrap_or_default());
            let inside = |target: u32| (self.start..end).contains(&target);
            match what {
                Effect::None => {}
                Effect::Lower(bytes) => lowered += bytes,
                // The fault handler switches to its separate stack and lowers nothing before.
                Effect::Sets if recorded.is_some() || name == "HardFault" => {}
                Effect::Sets => {
                    return Err(format!("{name} at {address:#x}: a stack pointer from a register"));
                }
                Effect::Indirect => return Err(format!("{name} at {address:#x}: a call through a register")),
                Effect::Jump(target) if inside(target) => {}
                // A call to oneself is recursion, and shows as a cycle.
                Effect::Call(target) | Effect::Jump(target) => {
                    if !extents.contains_key(&target) {
                        return Err(format!(
                            "{name} at {address:#x}: a call to {target:#x}, which is no function"
                        ));
                    }
                    function.callees.insert(target);
                }
            }
            address += if is_wide(first) { 4 } else { 2 };
        }
        function.frame = recorded.unwrap_or(lowered);
        Ok(function)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_a_broken_table_is_refused() {
        let bytes = [1, 0, 0, 8, 0x88, 0x02, 4, 1, 0, 8, 0];
        let sizes = stack_sizes(&bytes).unwrap();
        assert_eq!(sizes, BTreeMap::from([(0x0800_0000, 264), (0x0800_0104, 0)]));
        assert_eq!(stack_sizes(&bytes[..5]), None);
        assert_eq!(stack_sizes(&bytes[..8]), None);
    }
}
