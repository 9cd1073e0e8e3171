//! The last refused packages, each with its reason.

use heapless::Deque;
use link::update::{REFUSALS, RefusedPackage, UpdateRefusal};

/// Records of refused packages; a new one replaces the oldest.
#[derive(Debug, Default)]
pub(crate) struct Refusals {
    records: Deque<RefusedPackage, REFUSALS>,
    count: u16,
}

impl Refusals {
    /// Creates an empty list.
    #[must_use]
    pub(crate) const fn new() -> Self {
        Self { records: Deque::new(), count: 0 }
    }

    /// Adds a record and returns its reason.
    pub(crate) fn add(&mut self, slot: Option<u8>, version: u32, reason: UpdateRefusal) -> UpdateRefusal {
        if self.records.is_full() {
            self.records.pop_front();
        }
        // There is room: one was just removed.
        let _ = self.records.push_back(RefusedPackage { number: self.count, slot, version, reason });
        self.count = self.count.saturating_add(1);
        reason
    }

    /// Returns the number of refusals so far.
    #[must_use]
    pub(crate) const fn count(&self) -> u16 {
        self.count
    }

    /// Returns a record; 0 is the newest.
    #[must_use]
    pub(crate) fn get(&self, index: u8) -> Option<RefusedPackage> {
        self.records.iter().rev().nth(usize::from(index)).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_refusal_is_dropped_and_the_numbers_continue() {
        let mut refusals = Refusals::new();
        for version in 0..REFUSALS as u32 + 3 {
            refusals.add(None, version, UpdateRefusal::Signature);
        }
        assert_eq!(refusals.count(), REFUSALS as u16 + 3);
        assert_eq!(refusals.get(0).map(|record| (record.number, record.version)), Some((10, 10)));
        assert_eq!(refusals.get(REFUSALS as u8 - 1).map(|record| record.version), Some(3));
        assert_eq!(refusals.get(REFUSALS as u8), None);
    }
}
