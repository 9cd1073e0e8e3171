//! Deepest use of the stack: the lowest word whose paint is gone.
//!
//! Start-up paints the whole stack, which grows downwards. The search ascends from the bottom, a
//! few words per call: a stack frame may leave words untouched, so a search from the top would stop
//! too early. The result is never too deep. After a full pass it is exact to the word, unless a
//! used word holds the value of the paint.

/// Value that start-up paints with (`paint-stack` of the runtime).
pub(crate) const PAINT: u32 = 0xCCCC_CCCC;

/// A search that extends over many calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark {
    words: usize,
    at: usize,
    lowest: usize,
}

impl Mark {
    /// Starts a search over a stack of `words` words.
    #[must_use]
    pub const fn new(words: usize) -> Self {
        Self { words, at: 0, lowest: words }
    }

    /// Examines the next `count` words; `read` returns the word at an index from the bottom.
    pub fn search(&mut self, count: usize, read: impl Fn(usize) -> u32) {
        for _ in 0..count {
            if self.at >= self.lowest {
                self.at = 0;
                return;
            }
            if read(self.at) != PAINT {
                self.lowest = self.at;
                self.at = 0;
                return;
            }
            self.at = self.at.saturating_add(1);
        }
    }

    /// Deepest use found so far, bytes.
    #[must_use]
    pub const fn used_bytes(&self) -> usize {
        self.words.saturating_sub(self.lowest).saturating_mul(size_of::<u32>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_pass_finds_the_lowest_word_used(
            used in prop::collection::vec(any::<bool>(), 1..80), chunk in 1_usize..9,
        ) {
            let words = used.len();
            let mut mark = Mark::new(words);
            for _ in 0..3 * words {
                mark.search(chunk, |index| if used[index] { 1 } else { PAINT });
            }
            let lowest = used.iter().position(|&used| used).unwrap_or(words);
            prop_assert_eq!(mark.used_bytes(), (words - lowest) * 4);
        }
    }

    #[test]
    fn a_deeper_use_is_found_later() {
        let mut mark = Mark::new(100);
        mark.search(1000, |index| if index >= 60 { 0 } else { PAINT });
        assert_eq!(mark.used_bytes(), 160);
        mark.search(1000, |index| if index >= 20 { 0 } else { PAINT });
        assert_eq!(mark.used_bytes(), 320);
    }
}
