//! Check-ins that are required before the watchdog is kicked.
//!
//! Four parties ([`Party`]) check in from their tasks. [`Attendance::review`] runs once per timer
//! tick. It returns [`Verdict::Kick`] only while every expected party has checked in within its
//! period. Otherwise it returns the missing parties, and continues to do so until the reset: a late
//! check-in does not undo it. The board then records the fault and resets. If not even the review
//! runs, the hardware watchdog is not kicked and resets the core.
//!
//! Times are the controller's uptime in us, modulo 2^32; a period is at most [`MAX_US`]. A resting
//! party (sampling and inference before a configuration) is not expected until it checks in again.
//! All accesses are atomic loads and stores of words, so parties in different interrupts need no
//! lock.

use core::sync::atomic::{AtomicU32, Ordering};

use link::start::{MISSING_INFERENCE, MISSING_LINK, MISSING_SAMPLING, MISSING_SELF_TEST, Presence};

/// Longest period, us. It is short enough that the wrap of the time cannot hide a missing party.
const MAX_US: u32 = 600_000_000;

/// A party whose work must not stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Party {
    /// The sample source was read.
    Sampling,
    /// A sample was estimated.
    Inference,
    /// The link was served.
    Link,
    /// A round of the self-test passed.
    SelfTest,
}

impl Party {
    /// Every party, in the order of [`link::start::PARTIES`].
    pub const ALL: [Self; 4] = [Self::Sampling, Self::Inference, Self::Link, Self::SelfTest];

    /// Returns the party's bit in a mask of missing parties.
    #[must_use]
    pub const fn bit(self) -> u8 {
        match self {
            Self::Sampling => MISSING_SAMPLING,
            Self::Inference => MISSING_INFERENCE,
            Self::Link => MISSING_LINK,
            Self::SelfTest => MISSING_SELF_TEST,
        }
    }
}

/// Longest absence of each party, us.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Periods {
    /// [`Party::Sampling`].
    pub sampling_us: u32,
    /// [`Party::Inference`].
    pub inference_us: u32,
    /// [`Party::Link`].
    pub link_us: u32,
    /// [`Party::SelfTest`].
    pub self_test_us: u32,
}

/// Result of a review.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The watchdog may be kicked.
    Kick,
    /// The fault must be recorded and the core reset.
    Starved {
        /// Bits of the parties that were missing when it was detected.
        missing: u8,
    },
}

/// One party's state.
#[derive(Debug)]
struct Watch {
    period_us: u32,
    last_us: AtomicU32,
    expected: AtomicU32,
    /// Longest absence seen by [`Attendance::look`].
    longest_us: AtomicU32,
}

impl Watch {
    const fn new(period_us: u32) -> Self {
        let period_us = if period_us < MAX_US { period_us } else { MAX_US };
        Self {
            period_us,
            last_us: AtomicU32::new(0),
            expected: AtomicU32::new(0),
            longest_us: AtomicU32::new(0),
        }
    }

    fn missing(&self, now_us: u32) -> bool {
        let expected = self.expected.load(Ordering::Relaxed) != 0;
        let away_us = now_us.wrapping_sub(self.last_us.load(Ordering::Relaxed));
        // A check-in after the caller read the clock lies in the future: the party is not missing.
        expected && away_us > self.period_us && away_us < u32::MAX / 2
    }

    fn presence(&self, now_us: u32) -> Presence {
        let expected = self.expected.load(Ordering::Acquire) != 0;
        let away_us = now_us.wrapping_sub(self.last_us.load(Ordering::Relaxed));
        // As above; a resting party is not away.
        let away_us = if expected && away_us < u32::MAX / 2 { away_us } else { 0 };
        let longest_us = self.longest_us.load(Ordering::Relaxed).max(away_us);
        self.longest_us.store(longest_us, Ordering::Relaxed);
        Presence { expected, away_us, longest_us, period_us: self.period_us }
    }
}

/// The register of check-ins.
#[derive(Debug)]
pub struct Attendance {
    sampling: Watch,
    inference: Watch,
    link: Watch,
    self_test: Watch,
    missed: AtomicU32,
}

impl Attendance {
    /// Creates a register in which no party is expected.
    #[must_use]
    pub const fn new(periods: Periods) -> Self {
        Self {
            sampling: Watch::new(periods.sampling_us),
            inference: Watch::new(periods.inference_us),
            link: Watch::new(periods.link_us),
            self_test: Watch::new(periods.self_test_us),
            missed: AtomicU32::new(0),
        }
    }

    const fn watch(&self, party: Party) -> &Watch {
        match party {
            Party::Sampling => &self.sampling,
            Party::Inference => &self.inference,
            Party::Link => &self.link,
            Party::SelfTest => &self.self_test,
        }
    }

    /// Notes that a party is at work. It is expected again within its period.
    pub fn check_in(&self, party: Party, now_us: u32) {
        let watch = self.watch(party);
        watch.last_us.store(now_us, Ordering::Relaxed);
        watch.expected.store(1, Ordering::Release);
    }

    /// Stops expecting a party until it checks in again.
    pub fn stop_expecting(&self, party: Party) {
        self.watch(party).expected.store(0, Ordering::Relaxed);
    }

    /// Returns every party in the order of [`link::start::PARTIES`]. It also determines the longest
    /// absences, so one caller must call it often and before its own check-in.
    pub(crate) fn look(&self, now_us: u32) -> [Presence; 4] {
        Party::ALL.map(|party| self.watch(party).presence(now_us))
    }

    /// Decides whether the watchdog may be kicked.
    pub fn review(&self, now_us: u32) -> Verdict {
        let missing = Party::ALL
            .into_iter()
            .filter(|&party| self.watch(party).missing(now_us))
            .fold(0, |mask, party| mask | party.bit());
        if missing != 0 && self.missed.load(Ordering::Relaxed) == 0 {
            self.missed.store(u32::from(missing), Ordering::Relaxed);
        }
        match self.missed.load(Ordering::Relaxed).to_le_bytes() {
            [0, ..] => Verdict::Kick,
            [missing, ..] => Verdict::Starved { missing },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PERIODS: Periods =
        Periods { sampling_us: 1_000, inference_us: 2_000, link_us: 50_000, self_test_us: 5_000_000 };

    #[test]
    fn a_party_is_missing_once_its_period_has_passed_and_only_then() {
        for (party, period) in Party::ALL.into_iter().zip([1_000, 2_000, 50_000, 5_000_000]) {
            for start in [0, 77, u32::MAX - 500] {
                let register = Attendance::new(PERIODS);
                register.check_in(party, start);
                assert_eq!(register.review(start.wrapping_add(period)), Verdict::Kick, "{party:?}");
                let missing = party.bit();
                let late = start.wrapping_add(period + 1);
                assert_eq!(register.review(late), Verdict::Starved { missing }, "{party:?}");
                // Too late: the reset is due.
                register.check_in(party, late);
                assert_eq!(register.review(late), Verdict::Starved { missing }, "{party:?}");
            }
        }
    }

    #[test]
    fn every_missing_task_is_named() {
        let register = Attendance::new(PERIODS);
        for party in Party::ALL {
            register.check_in(party, 0);
        }
        register.stop_expecting(Party::Inference);
        let missing = Party::Sampling.bit() | Party::Link.bit();
        assert_eq!(register.review(60_000), Verdict::Starved { missing });
    }

    #[test]
    fn the_report_names_the_expected_tasks_and_the_longest_absence() {
        let register = Attendance::new(PERIODS);
        register.check_in(Party::Link, 1_000);
        let [sampling, _, link, _] = register.look(31_000);
        assert_eq!(
            (sampling, sampling.period_us),
            (Presence { period_us: 1_000, ..Presence::default() }, 1_000)
        );
        assert_eq!((link.expected, link.away_us, link.longest_us), (true, 30_000, 30_000));
        register.check_in(Party::Link, 31_000);
        let [_, _, link, _] = register.look(31_100);
        assert_eq!((link.away_us, link.longest_us, link.margin_us()), (100, 30_000, 20_000));
        // The clock was read before the check-in.
        register.check_in(Party::Link, 31_300);
        assert_eq!(register.look(31_200)[2].away_us, 0);
        register.stop_expecting(Party::Link);
        let [_, _, link, _] = register.look(5_000_000);
        assert_eq!((link.expected, link.away_us, link.longest_us), (false, 0, 30_000));
    }

    #[test]
    fn the_bits_match_the_names_in_link() {
        for (index, party) in Party::ALL.into_iter().enumerate() {
            assert_eq!(party.bit(), 1 << index);
            let name = format!("{party:?}").to_lowercase();
            assert_eq!(name, link::start::PARTIES[index].replace('-', ""));
        }
    }

    proptest! {
        /// Comparison with the plain definition, with times that wrap.
        #[test]
        fn the_watchdog_is_kicked_exactly_while_all_parties_check_in_on_time(
            begin in any::<u32>(),
            events in prop::collection::vec((0_usize..4, 0_u32..30_000, any::<bool>()), 1..60),
        ) {
            let register = Attendance::new(PERIODS);
            let (mut now, mut starved) = (0_u64, None);
            let mut last: [Option<u64>; 4] = [None; 4];
            let periods = [1_000_u64, 2_000, 50_000, 5_000_000];
            for (index, step, is_stopped) in events {
                now += u64::from(step);
                let stamp = begin.wrapping_add(now as u32);
                let missing = (0..4)
                    .filter(|&i| last[i].is_some_and(|at| now - at > periods[i]))
                    .fold(0, |mask, i| mask | Party::ALL[i].bit());
                starved = starved.or((missing != 0).then_some(missing));
                let expected = starved.map_or(Verdict::Kick, |missing| Verdict::Starved { missing });
                prop_assert_eq!(register.review(stamp), expected);
                if is_stopped {
                    register.stop_expecting(Party::ALL[index]);
                    last[index] = None;
                } else {
                    register.check_in(Party::ALL[index], stamp);
                    last[index] = Some(now);
                }
            }
        }
    }
}
