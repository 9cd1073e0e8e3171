//! Keeps both sides of a lockstep on one core of the host.
//!
//! The two sides never run at the same time, so a second core gains nothing. Waking a sleeping core
//! twice per exchange costs more than the exchange itself: two thirds of it on an idle virtual
//! machine. Threads started meanwhile stay on the core too. If the system forbids it, both sides
//! run wherever the system puts them.

use rustix::thread::{CpuSet, Pid, gettid, sched_getaffinity, sched_getcpu, sched_setaffinity};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Number of this process's lockstep pairs on each core.
static PAIRS: Mutex<BTreeMap<usize, usize>> = Mutex::new(BTreeMap::new());

/// Keeps the thread that created it, and whatever that thread starts meanwhile, on one core.
#[derive(Debug)]
pub(super) struct OneCore {
    thread: Pid,
    before: CpuSet,
    core: usize,
}

impl OneCore {
    /// Pins the thread to the allowed core with the fewest pairs, preferring its current core;
    /// `None` if the system forbids it.
    pub(super) fn stay() -> Option<Self> {
        let before = sched_getaffinity(None).ok()?;
        let mut pairs = PAIRS.lock().unwrap_or_else(PoisonError::into_inner);
        let pairs_of = |core: &usize| pairs.get(core).copied().unwrap_or_default();
        let allowed = (0..CpuSet::MAX_CPU).filter(|&core| before.is_set(core));
        let own = Some(sched_getcpu()).filter(|&core| before.is_set(core));
        // Among equals, the first.
        let core = own.into_iter().chain(allowed).min_by_key(pairs_of)?;
        let mut one = CpuSet::new();
        one.set(core);
        sched_setaffinity(None, &one).ok()?;
        *pairs.entry(core).or_default() += 1;
        Some(Self { thread: gettid(), before, core })
    }
}

impl Drop for OneCore {
    fn drop(&mut self) {
        // The thread may have ended already.
        let _ = sched_setaffinity(Some(self.thread), &self.before);
        let mut pairs = PAIRS.lock().unwrap_or_else(PoisonError::into_inner);
        pairs.entry(self.core).and_modify(|count| *count = count.saturating_sub(1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn allowed() -> Vec<usize> {
        let set = sched_getaffinity(None).unwrap();
        (0..CpuSet::MAX_CPU).filter(|&core| set.is_set(core)).collect()
    }

    #[test]
    fn a_thread_is_pinned_and_released_and_two_pairs_use_two_cores() {
        let before = allowed();
        let first = OneCore::stay().unwrap();
        assert_eq!(allowed(), [first.core]);
        let other = std::thread::spawn({
            let before = before.clone();
            move || {
                // A thread inherits the cores of the thread that started it.
                let mut all = CpuSet::new();
                before.iter().for_each(|&core| all.set(core));
                sched_setaffinity(None, &all).unwrap();
                OneCore::stay().unwrap().core
            }
        });
        let other = other.join().unwrap();
        assert_eq!(other == first.core, before.len() == 1);
        drop(first);
        assert_eq!(allowed(), before);
    }
}
