//! A flash memory whose power can fail in the middle of any operation.
//!
//! Programming a word and erasing a part of a sector are steps. At the step where the power fails,
//! only some of the bits have changed. Every later operation fails until [`Flash::restart`].
//! Programming only clears bits; an attempt to set one is an error of the code under test.
//!
//! Words of more than 4 bytes have an error correction code, as on the STM32H743. They must not be
//! programmed twice between two erasures, and one that was interrupted may be unreadable.

use controller::store::SlotMemory;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use link::update::ModelMemory;
use std::cell::RefCell;
use std::collections::HashSet;

/// Bytes of a half: a slot, or a place of the configuration.
pub(crate) const HALF: usize = 12 * 1024;
/// Steps of an erasure.
const ERASE_STEPS: usize = 8;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Failure {
    /// The power has failed.
    Power,
    /// Access that is not aligned or out of bounds.
    Bounds,
    /// The memory is worn out and can no longer be erased.
    Worn,
    /// The error correction of a word failed.
    Unreadable,
}

impl NorFlashError for Failure {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Flash<const BYTES: usize, const WORD: usize = 4> {
    pub(crate) bytes: Vec<u8>,
    /// Steps taken since the last restart.
    pub(crate) steps: usize,
    /// Step at which the power fails.
    pub(crate) fails_at: Option<usize>,
    pub(crate) worn: bool,
    pub(crate) stalls: bool,
    /// Number of writes before one that fails after some words, and the number of these words.
    pub(crate) failing_write: Option<(usize, usize)>,
    /// Words that were programmed since their erasure.
    programmed: Vec<bool>,
    /// Words whose error correction fails.
    unreadable: Vec<bool>,
    noise: u64,
}

impl<const BYTES: usize, const WORD: usize> Flash<BYTES, WORD> {
    pub(crate) fn new() -> Self {
        Self {
            bytes: vec![0xFF; BYTES],
            steps: 0,
            fails_at: None,
            worn: false,
            stalls: false,
            failing_write: None,
            programmed: vec![false; BYTES / WORD],
            unreadable: vec![false; BYTES / WORD],
            noise: 1,
        }
    }

    /// Restores the power; it fails again at a step, or not.
    pub(crate) fn restart(mut self, fails_at: Option<usize>, seed: u64) -> Self {
        (self.steps, self.fails_at, self.noise) = (0, fails_at, seed | 1);
        self
    }

    /// Makes the word at an address unreadable.
    pub(crate) fn lose(&mut self, at: usize) {
        self.unreadable[at / WORD] = true;
    }

    fn is_readable(&self, start: usize, length: usize) -> bool {
        !self.unreadable[start / WORD..(start + length).div_ceil(WORD)].contains(&true)
    }

    fn noise(&mut self) -> u8 {
        // xorshift64
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 7;
        self.noise ^= self.noise << 17;
        (self.noise >> 32) as u8
    }

    /// Changes bytes by `changed`; with failing power only some of their bits.
    fn step(
        &mut self,
        range: std::ops::Range<usize>,
        changed: impl Fn(usize, u8) -> u8,
    ) -> Result<(), Failure> {
        if self.fails_at.is_some_and(|step| self.steps > step) {
            return Err(Failure::Power);
        }
        let fails = self.fails_at == Some(self.steps);
        self.steps += 1;
        for word in range.start / WORD..range.end / WORD {
            self.unreadable[word] = WORD > 4 && fails && self.noise() % 2 == 0;
        }
        for at in range {
            let (old, new) = (self.bytes[at], changed(at, self.bytes[at]));
            let mask = if fails { self.noise() } else { 0xFF };
            self.bytes[at] = old & !mask | new & mask;
        }
        if fails { Err(Failure::Power) } else { Ok(()) }
    }
}

impl<const BYTES: usize, const WORD: usize> ErrorType for Flash<BYTES, WORD> {
    type Error = Failure;
}

impl<const BYTES: usize, const WORD: usize> ReadNorFlash for Flash<BYTES, WORD> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Failure> {
        let start = offset as usize;
        bytes.copy_from_slice(self.bytes.get(start..start + bytes.len()).ok_or(Failure::Bounds)?);
        if self.is_readable(start, bytes.len()) { Ok(()) } else { Err(Failure::Unreadable) }
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl<const BYTES: usize, const WORD: usize> NorFlash for Flash<BYTES, WORD> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = BYTES / 2;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Failure> {
        let (from, to) = (from as usize, to as usize);
        if from >= to || to > BYTES || !from.is_multiple_of(BYTES / 2) || !to.is_multiple_of(BYTES / 2) {
            return Err(Failure::Bounds);
        }
        if self.worn {
            return Err(Failure::Worn);
        }
        let part = (to - from) / ERASE_STEPS;
        (from..to).step_by(part).try_for_each(|start| {
            self.step(start..start + part, |_, _| 0xFF)?;
            self.programmed[start / WORD..(start + part) / WORD].fill(false);
            Ok(())
        })
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Failure> {
        let offset = offset as usize;
        if !offset.is_multiple_of(WORD) || !bytes.len().is_multiple_of(WORD) || offset + bytes.len() > BYTES {
            return Err(Failure::Bounds);
        }
        let failing = self.failing_write;
        self.failing_write = failing.and_then(|(writes, words)| Some((writes.checked_sub(1)?, words)));
        let words = failing.filter(|(writes, _)| *writes == 0).map(|(_, words)| words);
        for (at, word) in (offset..).step_by(WORD).zip(bytes.chunks(WORD)).take(words.unwrap_or(usize::MAX)) {
            let was_programmed = std::mem::replace(&mut self.programmed[at / WORD], true);
            assert!(WORD == 4 || !was_programmed, "the word at {at} is programmed twice");
            self.step(at..at + WORD, |index, old| old & word[index - at])?;
        }
        if words.is_some() { Err(Failure::Worn) } else { Ok(()) }
    }
}

thread_local! {
    /// Payloads that were returned. They are never freed, but few of them differ.
    static HANDED_OUT: RefCell<HashSet<&'static [u32]>> = RefCell::default();
}

impl<const BYTES: usize, const WORD: usize> SlotMemory for Flash<BYTES, WORD> {
    const IS_WRITE_ONCE: bool = WORD > 4;

    fn kind(&self) -> ModelMemory {
        ModelMemory::Flash
    }

    fn stalls_the_core(&self) -> bool {
        self.stalls
    }

    /// Returns a copy at an aligned address: the networks' data stay unchanged while this memory
    /// changes.
    fn in_place(&self, offset: u32, length: u32) -> &'static [u8] {
        if !self.is_readable(offset as usize, length as usize) {
            return &[];
        }
        let bytes = &self.bytes[offset as usize..(offset + length) as usize];
        let words: Vec<u32> =
            bytes.chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect();
        HANDED_OUT.with_borrow_mut(|all| {
            let kept = all.get(&words[..]).copied().unwrap_or_else(|| {
                let kept: &'static [u32] = words.leak();
                all.insert(kept);
                kept
            });
            aligned_bytes(kept)
        })
    }
}

fn aligned_bytes(words: &'static [u32]) -> &'static [u8] {
    bytemuck::cast_slice(words)
}
