//! Time of the STM32F405's memories beyond a core's own timings.
//!
//! Sources: RM0090 section 3 (flash: 128 bits wide, 5 wait states at 168 MHz and 3.3 V;
//! accelerator: 64 instruction lines and 8 data lines of 128 bits, least recently used first out,
//! one line ahead prefetched) and its bus matrix (SRAM and core-coupled memory without wait
//! states); AMBA APB specification (two bus clocks for an access).
//!
//! A line enters the instruction cache if it is missed; the manual does not say that of a
//! prefetched line, nor whether a line that the cache holds is prefetched again. The upper bound
//! stores missed lines only and prefetches always, so that data often wait for a prefetch. The
//! lower bound stores every line and prefetches what the cache lacks. A read that has begun is not
//! broken off.

use super::bound::Bound;
use std::ops::Range;

/// Bytes of a flash line, as a power of two.
const LINE: u32 = 4;
/// Lines of the instruction cache.
const INSTRUCTION_LINES: usize = 64;
/// Lines of the data cache.
const DATA_LINES: usize = 8;
/// Address range of the flash.
const FLASH: Range<u32> = 0x0800_0000..0x0810_0000;
/// Peripherals on the slow bus and core clocks per clock of that bus.
const SLOW_BUS: (Range<u32>, u64) = (0x4000_0000..0x4001_0000, 4);
/// Peripherals on the fast bus and core clocks per clock of that bus.
const FAST_BUS: (Range<u32>, u64) = (0x4001_0000..0x4002_0000, 2);

/// Cache of flash lines; the least recently used one is replaced.
#[derive(Clone, Debug)]
struct Lines {
    capacity: usize,
    /// Lines, the most recently used one last.
    lines: Vec<u32>,
}

impl Lines {
    fn new(capacity: usize) -> Self {
        Self { capacity, lines: Vec::with_capacity(capacity + 1) }
    }

    /// Returns whether the cache holds a line, and notes its use.
    fn take(&mut self, line: u32) -> bool {
        let Some(at) = self.lines.iter().rposition(|&held| held == line) else { return false };
        if let Some(recent) = self.lines.get_mut(at..) {
            recent.rotate_left(1);
        }
        true
    }

    fn insert(&mut self, line: u32) {
        if self.lines.len() == self.capacity {
            self.lines.remove(0);
        }
        self.lines.push(line);
    }
}

/// Flash with its accelerator, and the buses of the peripherals. Times are core clocks.
#[derive(Clone, Debug)]
pub(super) struct Memory {
    wait_states: u64,
    bound: Bound,
    /// Data that lie elsewhere than in the image: addresses of the image, and whether they are in
    /// flash here.
    moved: Option<(Range<u32>, bool)>,
    instructions: Lines,
    data: Lines,
    current: u32,
    /// Prefetched line with the time at which it has arrived.
    prefetched: Option<(u32, u64)>,
    /// Time at which the flash has finished its last read.
    free_at: u64,
}

impl Memory {
    /// Creates the memory with empty caches.
    pub(super) fn new(wait_states: u64, bound: Bound, moved: Option<(Range<u32>, bool)>) -> Self {
        Self {
            wait_states,
            bound,
            moved,
            instructions: Lines::new(INSTRUCTION_LINES),
            data: Lines::new(DATA_LINES),
            current: u32::MAX,
            prefetched: None,
            free_at: 0,
        }
    }

    /// Empties the caches and starts the time again.
    pub(super) fn reset(&mut self) {
        *self = Self::new(self.wait_states, self.bound, self.moved.take());
    }

    /// Reads a line at the time `now` at the earliest. Returns the time until it has arrived.
    const fn read(&mut self, now: u64) -> u64 {
        let start = if now > self.free_at { now } else { self.free_at };
        self.free_at = start + self.wait_states + 1;
        start + self.wait_states - now
    }

    /// Returns the clocks for which an instruction at an address delays the core.
    pub(super) fn fetch(&mut self, now: u64, address: u32, bytes: u32) -> u64 {
        if self.wait_states == 0 || !FLASH.contains(&address) {
            return 0;
        }
        let mut stall = 0;
        for line in address >> LINE..=(address + bytes - 1) >> LINE {
            if line != self.current {
                stall += self.enter(now + stall, line);
            }
        }
        stall
    }

    /// Makes a line the current one and prefetches the next.
    fn enter(&mut self, now: u64, line: u32) -> u64 {
        let is_cached = self.instructions.take(line);
        let stall = match self.prefetched.take() {
            _ if is_cached => 0,
            Some((held, ready)) if held == line => {
                if self.bound == Bound::Lower {
                    self.instructions.insert(line);
                }
                ready.saturating_sub(now)
            }
            _ => {
                self.instructions.insert(line);
                self.read(now)
            }
        };
        self.current = line;
        if self.bound == Bound::Upper || !self.instructions.lines.contains(&(line + 1)) {
            let now = now + stall;
            self.prefetched = Some((line + 1, now + self.read(now)));
        }
        stall
    }

    /// Returns the clocks for which an access to data delays the core.
    pub(super) fn access(&mut self, now: u64, address: u32, is_store: bool) -> u64 {
        let is_in_flash = match &self.moved {
            Some((range, is_in_flash)) if range.contains(&address) => *is_in_flash,
            _ => FLASH.contains(&address),
        };
        if is_in_flash {
            let line = address >> LINE;
            if self.wait_states == 0 || is_store || self.data.take(line) {
                return 0;
            }
            self.data.insert(line);
            return self.read(now);
        }
        let bus_clocks = match self.bound {
            Bound::Lower if is_store => 0,
            Bound::Lower => 1,
            Bound::Upper => 3,
        };
        let ratio = |(range, ratio): &(Range<u32>, u64)| range.contains(&address).then_some(*ratio);
        ratio(&SLOW_BUS).or(ratio(&FAST_BUS)).unwrap_or(0) * bus_clocks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CODE: u32 = 0x0800_1000;

    fn memory(bound: Bound) -> Memory {
        Memory::new(5, bound, None)
    }

    #[test]
    fn a_miss_waits_five_clocks_and_the_next_line_is_prefetched() {
        let mut memory = memory(Bound::Upper);
        assert_eq!(memory.fetch(0, CODE, 2), 5);
        assert_eq!(memory.fetch(6, CODE + 2, 4), 0);
        // The first line was read from 0 to 6; the second one arrives at 11.
        assert_eq!(memory.fetch(9, CODE + 16, 2), 2);
        assert_eq!(memory.fetch(40, CODE + 32, 2), 0);
        // A wide instruction across the end of a line needs both lines. The second one is
        // prefetched only now.
        assert_eq!(memory.fetch(60, CODE + 62, 4), 5);
    }

    #[test]
    fn prefetched_lines_are_cached_in_the_lower_bound_only() {
        for (bound, expected) in [(Bound::Lower, 0), (Bound::Upper, 5)] {
            let mut memory = memory(bound);
            let _ = memory.fetch(0, CODE, 2);
            let _ = memory.fetch(100, CODE + 16, 2);
            let _ = memory.fetch(200, CODE, 2);
            let _ = memory.fetch(300, CODE + 0x800, 2);
            assert_eq!(memory.fetch(400, CODE + 16, 2), expected, "{bound:?}");
        }
    }

    #[test]
    fn the_least_recently_used_of_eight_data_lines_is_replaced() {
        let mut memory = memory(Bound::Upper);
        for line in 0..8 {
            assert_eq!(memory.access(100 * u64::from(line), CODE + 16 * line, false), 5);
        }
        assert_eq!(memory.access(900, CODE, false), 0);
        assert_eq!(memory.access(1000, CODE + 16 * 8, false), 5);
        assert_eq!(memory.access(1100, CODE + 4, false), 0);
        assert_eq!(memory.access(1200, CODE + 16, false), 5);
    }

    #[test]
    fn moved_data_and_memory_without_wait_states_cost_nothing() {
        let mut memory = Memory::new(5, Bound::Upper, Some((CODE..CODE + 64, false)));
        assert_eq!(memory.access(0, CODE, false), 0);
        assert_eq!(memory.access(0, CODE + 64, false), 5);
        assert_eq!(memory.access(50, 0x2000_0000, false), 0);
        let mut memory = Memory::new(5, Bound::Upper, Some((0x2000_0000..0x2000_0040, true)));
        assert_eq!(memory.access(0, 0x2000_0010, false), 5);
        let mut memory = Memory::new(0, Bound::Upper, None);
        assert_eq!(memory.fetch(0, CODE, 4) + memory.access(0, CODE, false), 0);
    }

    #[test]
    fn a_peripheral_costs_clocks_of_its_bus() {
        let access = |bound, address| memory(bound).access(0, address, false);
        assert_eq!([Bound::Lower, Bound::Upper].map(|bound| access(bound, 0x4000_380C)), [4, 12]);
        assert_eq!([Bound::Lower, Bound::Upper].map(|bound| access(bound, 0x4001_1400)), [2, 6]);
        assert_eq!(access(Bound::Upper, 0x4002_0414), 0);
    }
}
