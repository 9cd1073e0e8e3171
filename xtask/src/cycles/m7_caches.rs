//! Caches of the STM32H743 before its flash.
//!
//! Data sheet DS12110 and the manual of the core give their size: 16 kB each, two ways for
//! instructions, four for data, lines of 32 bytes, which are also the words of the flash. The time
//! of a fill is not documented. A read of the flash takes 5 clocks of its bus (4 wait states), the
//! other three parts of the line 3 more, and a clock of the bus is two of the core. The bounds are
//! 20 cycles, and twice that for the way through the buses. The least recently used line of a set
//! is replaced; the core does so at random.

use super::bound::Bound;
use super::trace::{Access, Step};
use std::ops::Range;

/// Bytes of a line, as a power of two.
const LINE: u32 = 5;
/// Bytes of each cache.
const BYTES: usize = 16 * 1024;
/// Address range of the flash in the traced image.
const FLASH: Range<u32> = 0x0800_0000..0x0810_0000;

/// Cache with sets of lines, the most recently used one last.
#[derive(Clone, Debug)]
struct Cache {
    ways: usize,
    sets: Vec<Vec<u32>>,
}

impl Cache {
    fn new(ways: usize) -> Self {
        Self { ways, sets: vec![Vec::with_capacity(ways + 1); (BYTES >> LINE) / ways] }
    }

    /// Reads a line. Returns whether it had to be filled.
    fn read(&mut self, line: u32) -> bool {
        let sets = self.sets.len().max(1);
        let Some(set) = self.sets.get_mut(line as usize % sets) else { return false };
        let held = set.iter().position(|&held| held == line);
        if let Some(at) = held {
            set.remove(at);
        } else if set.len() == self.ways {
            set.remove(0);
        }
        set.push(line);
        held.is_none()
    }
}

/// Both caches.
#[derive(Clone, Debug)]
pub(super) struct Caches {
    instructions: Cache,
    data: Cache,
    fill: u64,
}

impl Caches {
    /// Creates empty caches.
    pub(super) fn new(bound: Bound) -> Self {
        Self { instructions: Cache::new(2), data: Cache::new(4), fill: bound.pick(20, 40) }
    }

    /// Empties both.
    pub(super) fn clear(&mut self) {
        for set in self.instructions.sets.iter_mut().chain(&mut self.data.sets) {
            set.clear();
        }
    }

    /// Returns the cycles for which the core waits for lines of an instruction and its constants.
    pub(super) fn stall(&mut self, step: &Step, accesses: &[Access]) -> u64 {
        let mut fills = 0;
        for line in lines(step.address, step.instruction.bytes) {
            fills += u64::from(self.instructions.read(line));
        }
        for access in accesses.iter().filter(|access| FLASH.contains(&access.address)) {
            for line in lines(access.address, access.bytes as u8) {
                fills += u64::from(self.data.read(line));
            }
        }
        fills * self.fill
    }
}

/// Returns the lines of some bytes.
fn lines(address: u32, bytes: u8) -> impl Iterator<Item = u32> {
    let last = address.saturating_add(u32::from(bytes).saturating_sub(1));
    address >> LINE..=last >> LINE
}

#[cfg(test)]
mod tests {
    use super::super::m7::CortexM7;
    use super::super::tests::{Code, section};
    use super::*;

    #[test]
    fn a_line_is_filled_once_and_the_least_recently_used_one_is_replaced() {
        let mut cache = Cache::new(2);
        let sets = 256;
        assert_eq!(cache.sets.len(), sets as usize);
        assert_eq!(
            [0, 0, sets, 0, 2 * sets, 0, sets].map(|line| cache.read(line)),
            [true, false, true, false, true, false, true]
        );
    }

    #[test]
    fn code_in_flash_costs_a_fill_for_each_line() {
        // Seventeen narrow instructions lie in two lines.
        let code = [Code::Narrow(0xBF00, 0); 17];
        let [fast, slow] = Bound::ALL.map(|bound| {
            let price = |caches| CortexM7::new(bound, caches).price(&section(&code));
            price(Some(Caches::new(bound))) - price(None)
        });
        assert_eq!([fast, slow], [2 * 20, 2 * 40]);
    }
}
