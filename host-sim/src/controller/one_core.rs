//! Both sides of a lockstep on one core of the host.
//!
//! They never work at the same time, so a second core wins nothing, and waking one that has gone to sleep, twice an exchange, costs more
//! than the exchange: on an otherwise idle virtual machine two thirds of it. Without the system's leave they run where they are put. Threads that
//! are started meanwhile stay there too.

use rustix::thread::{CpuSet, Pid, gettid, sched_getaffinity, sched_getcpu, sched_setaffinity};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// How many of this process' lockstep pairs each core has.
static PAIRS: Mutex<BTreeMap<usize, usize>> = Mutex::new(BTreeMap::new());

/// Keeps the thread that made it, and whatever it starts meanwhile, on one core.
#[derive(Debug)]
pub(super) struct OneCore {
    thread: Pid,
    before: CpuSet,
    core: usize,
}

impl OneCore {
    /// Stays on the core with the fewest pairs of those that are allowed, this thread's own first; `None` if the system does not let it.
    pub(super) fn stay() -> Option<Self> {
        let before = sched_getaffinity(None).ok()?;
        let mut pairs = PAIRS.lock().unwrap_or_else(PoisonError::into_inner);
        let pairs_of = |core: &usize| pairs.get(core).copied().unwrap_or_default();
        let allowed = (0..CpuSet::MAX_CPU).filter(|&core| before.is_set(core));
        let own = Some(sched_getcpu()).filter(|&core| before.is_set(core));
        // The first of equals.
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
        // A thread that has ended needs nothing any more.
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
    fn it_stays_and_is_let_go_and_two_pairs_take_two_cores() {
        let before = allowed();
        let first = OneCore::stay().unwrap();
        assert_eq!(allowed(), [first.core]);
        let other = std::thread::spawn({
            let before = before.clone();
            move || {
                // A thread starts with the cores of the one that started it.
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
