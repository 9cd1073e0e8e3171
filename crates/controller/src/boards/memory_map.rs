//! The memory map of a microcontroller, read from the linker script that the firmware links with.

/// A linker script with a `MEMORY` command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryMap {
    /// Path of the script, or of the file with its text, from the workspace's root.
    pub path: &'static str,
    /// Content of the script.
    pub text: &'static str,
}

/// A region of the `MEMORY` command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// Name, such as `FLASH`.
    pub name: &'static str,
    /// Lowest address.
    pub origin: u32,
    /// Length, bytes.
    pub length: u32,
}

impl Region {
    /// First address after the region.
    #[must_use]
    pub const fn end(&self) -> u32 {
        self.origin.saturating_add(self.length)
    }

    /// Decides whether `length` bytes from `address` on lie in the region.
    #[must_use]
    pub const fn contains(&self, address: u64, length: u64) -> bool {
        address >= self.origin as u64 && address.saturating_add(length) <= self.end() as u64
    }
}

impl MemoryMap {
    /// Returns the regions in the order of the script.
    pub fn regions(&self) -> impl Iterator<Item = Region> {
        self.text.lines().filter_map(parse_region)
    }

    /// Returns the region of a name.
    #[must_use]
    pub fn region(&self, name: &str) -> Option<Region> {
        self.regions().find(|region| region.name == name)
    }
}

/// Parses `NAME : ORIGIN = 0x08000000, LENGTH = 512K`; other lines are not regions.
fn parse_region(line: &'static str) -> Option<Region> {
    let (name, rest) = line.split_once(':')?;
    let (origin, length) = rest.trim().strip_prefix("ORIGIN =")?.split_once(',')?;
    let length = length.trim().strip_prefix("LENGTH =")?;
    Some(Region { name: name.trim(), origin: parse_number(origin)?, length: parse_number(length)? })
}

/// Parses a decimal or hexadecimal number with the suffix `K`, `M` or none.
fn parse_number(text: &str) -> Option<u32> {
    let text = text.trim();
    let (digits, unit) = match text.strip_suffix('K') {
        Some(digits) => (digits, 1024),
        None => text.strip_suffix('M').map_or((text, 1), |digits| (digits, 1024 * 1024)),
    };
    let number = match digits.strip_prefix("0x") {
        Some(hexadecimal) => u32::from_str_radix(hexadecimal, 16).ok()?,
        None => digits.parse().ok()?,
    };
    number.checked_mul(unit)
}
