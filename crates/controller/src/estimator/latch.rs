//! Approach speed of a contact: latched at its onset, kept until separation.
//!
//! An onset is a deformation that rises from below 0 to 0 or above; the latched speed is the rate
//! of that sample, but not less than the floor. Separation is a deformation below 0. The onset of a
//! contact is not seen if the samples began or were interrupted during the contact, or if the rate
//! was not yet known. Such a contact gets the approach speed that the configuration gives for this
//! case, and its estimates are flagged: no sensor can measure the speed afterwards, and in
//! sustained contact the damping is inversely proportional to it.
//!
//! Integers, nm/s. No branch depends on data.

use super::arithmetic::blend;
use crate::integrity::words;

/// Onset latch.
#[derive(Clone, Debug)]
pub(super) struct Latch {
    floor_nm_s: i32,
    unseen_nm_s: i32,
}
words!(Latch { floor_nm_s, unseen_nm_s });

/// State of a [`Latch`].
#[derive(Clone, Copy, Debug)]
pub(super) struct LatchState {
    /// All ones if the last sample was without contact, else 0.
    open: i32,
    /// All ones in a contact whose onset was seen, else 0.
    seen: i32,
    /// Approach speed of the contact; without contact of no meaning.
    speed_nm_s: i32,
}
words!(LatchState { open, seen, speed_nm_s });

#[cfg(test)]
impl LatchState {
    /// Number of bits.
    pub(super) const BITS: u32 = 96;

    /// Flips a bit.
    pub(super) fn flip(&mut self, bit: u32) {
        let words = [&mut self.open, &mut self.seen, &mut self.speed_nm_s];
        *words.into_iter().nth(bit as usize / 32).unwrap() ^= 1 << (bit % 32);
    }
}

impl Latch {
    /// Creates a latch. Speeds in nm/s, not negative.
    pub(super) fn new(floor_nm_s: i32, unseen_nm_s: i32) -> Self {
        Self { floor_nm_s, unseen_nm_s: unseen_nm_s.max(floor_nm_s) }
    }

    /// The state before the first sample and after an interruption: the next sample may be in the
    /// middle of a contact.
    pub(super) const fn unknown(&self) -> LatchState {
        LatchState { open: 0, seen: 0, speed_nm_s: self.unseen_nm_s }
    }

    /// Takes the deformation of a sample, in any unit, and its rate if it is known. Returns the
    /// approach speed in nm/s and whether the onset of the contact was seen (true without contact).
    #[inline]
    pub(super) fn update(
        &self,
        state: &mut LatchState,
        deformation: i32,
        rate_nm_s: i32,
        is_rate_known: bool,
    ) -> (u32, bool) {
        let open = deformation >> 31;
        let onset = state.open & !open;
        let known = i32::from(is_rate_known).wrapping_neg();
        let latched = blend(known, rate_nm_s.max(self.floor_nm_s), self.unseen_nm_s);
        state.seen = !open & blend(onset, known, state.seen);
        state.speed_nm_s = blend(onset, latched, state.speed_nm_s);
        state.open = open;
        let speed_nm_s = blend(open, self.floor_nm_s, state.speed_nm_s);
        (speed_nm_s.cast_unsigned(), state.seen | open != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FLOOR: i32 = 1_000_000;
    const UNSEEN: i32 = 3_000_000;

    /// A latch with its state.
    struct TestLatch(Latch, LatchState);

    impl TestLatch {
        fn new() -> Self {
            let latch = Latch::new(FLOOR, UNSEEN);
            let state = latch.unknown();
            Self(latch, state)
        }

        fn reset(&mut self) {
            self.1 = self.0.unknown();
        }

        fn update(&mut self, deformation: i32, rate_nm_s: i32, is_rate_known: bool) -> (u32, bool) {
            self.0.update(&mut self.1, deformation, rate_nm_s, is_rate_known)
        }
    }

    #[test]
    fn the_speed_of_the_onset_is_kept_until_separation() {
        let mut latch = TestLatch::new();
        assert_eq!(latch.update(-1000, 200_000_000, true), (1_000_000, true));
        assert_eq!(latch.update(1000, 150_000_000, true), (150_000_000, true));
        assert_eq!(latch.update(3000, -100_000_000, true), (150_000_000, true));
        assert_eq!(latch.update(-1000, -50_000_000, true), (1_000_000, true));
        assert_eq!(latch.update(100, 50_000_000, true), (50_000_000, true));
    }

    #[test]
    fn the_floor_limits_slow_and_backward_onsets() {
        for rate in [200_000, 0, -300_000_000] {
            let mut latch = TestLatch::new();
            latch.update(-1000, rate, true);
            assert_eq!(latch.update(0, rate, true), (1_000_000, true));
        }
    }

    #[test]
    fn a_contact_from_before_the_first_sample_is_unseen_until_it_ends() {
        let mut latch = TestLatch::new();
        assert_eq!(latch.update(10_000, 500_000_000, true), (3_000_000, false));
        assert_eq!(latch.update(10_000, 500_000_000, true), (3_000_000, false));
        latch.update(-1000, -100_000_000, true);
        assert_eq!(latch.update(1000, 100_000_000, true), (100_000_000, true));
        latch.reset();
        assert_eq!(latch.update(1000, 100_000_000, true), (3_000_000, false));
    }

    #[test]
    fn an_onset_at_an_unknown_rate_is_unseen() {
        let mut latch = TestLatch::new();
        latch.update(-1000, 0, false);
        assert_eq!(latch.update(1000, 0, false), (3_000_000, false));
        assert_eq!(latch.update(1000, 200_000_000, true), (3_000_000, false));
    }

    /// The rule of the module's documentation, state by state.
    #[derive(Clone, Copy)]
    enum Contact {
        Unknown,
        Open,
        Unseen,
        Latched(i32),
    }

    proptest! {
        #[test]
        fn the_latch_follows_its_rule(
            samples in prop::collection::vec((-3..3_i32, any::<i32>(), any::<bool>(), 0..20_u8), 1..60),
        ) {
            let mut latch = TestLatch::new();
            let mut contact = Contact::Unknown;
            for (deformation, rate, known, reset) in samples {
                if reset == 0 {
                    latch.reset();
                    contact = Contact::Unknown;
                }
                contact = match contact {
                    _ if deformation < 0 => Contact::Open,
                    Contact::Unknown => Contact::Unseen,
                    Contact::Open if known => Contact::Latched(rate.max(FLOOR)),
                    Contact::Open => Contact::Unseen,
                    unchanged => unchanged,
                };
                let expected = match contact {
                    Contact::Latched(speed) => (speed as u32, true),
                    Contact::Unseen => (UNSEEN as u32, false),
                    Contact::Open | Contact::Unknown => (FLOOR as u32, true),
                };
                prop_assert_eq!(latch.update(deformation, rate, known), expected);
            }
        }
    }
}
