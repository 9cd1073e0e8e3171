//! The approach speed of a contact: latched when it begins, kept until it ends.
//!
//! A contact begins when the deformation goes from below 0 to 0 or above, with the rate of that sample (not below the
//! floor), and ends when it falls below 0. A contact whose onset was not seen, because the samples began or were
//! interrupted in it or because the rate was not yet known, has the approach speed that the configuration states for that case, and is flagged: no sensor can tell
//! afterwards, and in sustained contact the damping is inversely proportional to it. A latched speed of which a bit has flipped is an onset not seen. Whole numbers, nm/s; no branch on data.

use core::hash::Hash;

use super::whole::select;
use crate::constants::Sum;

/// Onset latch.
#[derive(Clone, Debug)]
pub struct Latch {
    floor_nm_s: i32,
    unseen_nm_s: i32,
    /// The last sample was a gap.
    open: bool,
    /// In contact since an onset that was seen.
    seen: bool,
    /// Speed of the contact, where there is one.
    speed_nm_s: i32,
    /// Its complement: the speed stays for as long as the contact does, and so would a flipped bit.
    complement: i32,
}

impl Latch {
    /// Creates a latch that has seen nothing. Speeds in nm/s, not negative.
    #[must_use]
    pub fn new(floor_nm_s: i32, unseen_nm_s: i32) -> Self {
        let unseen_nm_s = unseen_nm_s.max(floor_nm_s);
        Self {
            floor_nm_s,
            unseen_nm_s,
            open: false,
            seen: false,
            speed_nm_s: unseen_nm_s,
            complement: !unseen_nm_s,
        }
    }

    pub(super) fn constants(&self, sum: &mut Sum) {
        (self.floor_nm_s, self.unseen_nm_s).hash(sum);
    }

    /// Forgets what was seen: the next sample may be in the middle of a contact.
    pub const fn reset(&mut self) {
        self.open = false;
        self.seen = false;
        self.speed_nm_s = self.unseen_nm_s;
        self.complement = !self.unseen_nm_s;
    }

    /// Takes a sample, its deformation in any unit and its rate if it is known; returns the approach speed in nm/s and whether the contact's
    /// onset was seen (true without contact).
    #[inline]
    pub fn update(&mut self, deformation: i32, rate_nm_s: i32, rate_known: bool) -> (u32, bool) {
        let open = deformation < 0;
        let onset = self.open & !open;
        let latched = select(rate_known, rate_nm_s.max(self.floor_nm_s), self.unseen_nm_s);
        let whole = self.speed_nm_s == !self.complement;
        self.seen = (onset & rate_known) | (!onset & !open & self.seen & whole);
        self.speed_nm_s = select(onset, latched, select(whole, self.speed_nm_s, self.unseen_nm_s));
        self.complement = !self.speed_nm_s;
        self.open = open;
        (select(open, self.floor_nm_s, self.speed_nm_s).cast_unsigned(), self.seen | open)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FLOOR: i32 = 1_000_000;
    const UNSEEN: i32 = 3_000_000;

    #[test]
    fn the_speed_of_the_onset_is_kept_until_separation() {
        let mut latch = Latch::new(FLOOR, UNSEEN);
        assert_eq!(latch.update(-1000, 200_000_000, true), (1_000_000, true));
        assert_eq!(latch.update(1000, 150_000_000, true), (150_000_000, true));
        assert_eq!(latch.update(3000, -100_000_000, true), (150_000_000, true));
        assert_eq!(latch.update(-1000, -50_000_000, true), (1_000_000, true));
        assert_eq!(latch.update(100, 50_000_000, true), (50_000_000, true));
    }

    #[test]
    fn a_flipped_bit_of_the_latched_speed_is_an_onset_not_seen() {
        for bit in 0..32 {
            let mut latch = Latch::new(FLOOR, UNSEEN);
            latch.update(-1000, 0, true);
            latch.update(1000, 150_000_000, true);
            latch.speed_nm_s ^= 1 << bit;
            assert_eq!(latch.update(1000, 0, true), (UNSEEN as u32, false), "bit {bit}");
            assert_eq!(latch.update(1000, 0, true), (UNSEEN as u32, false), "it stays told");
            latch.update(-1000, 0, true);
            assert_eq!(latch.update(1000, 150_000_000, true), (150_000_000, true), "until the next onset");
        }
    }

    #[test]
    fn the_floor_holds_for_slow_and_for_backward_onsets() {
        for rate in [200_000, 0, -300_000_000] {
            let mut latch = Latch::new(FLOOR, UNSEEN);
            latch.update(-1000, rate, true);
            assert_eq!(latch.update(0, rate, true), (1_000_000, true));
        }
    }

    #[test]
    fn a_contact_that_was_there_before_is_reported_until_it_ends() {
        let mut latch = Latch::new(FLOOR, UNSEEN);
        assert_eq!(latch.update(10_000, 500_000_000, true), (3_000_000, false));
        assert_eq!(latch.update(10_000, 500_000_000, true), (3_000_000, false));
        latch.update(-1000, -100_000_000, true);
        assert_eq!(latch.update(1000, 100_000_000, true), (100_000_000, true));
        latch.reset();
        assert_eq!(latch.update(1000, 100_000_000, true), (3_000_000, false));
    }

    #[test]
    fn an_onset_at_an_unknown_rate_counts_as_unseen() {
        let mut latch = Latch::new(FLOOR, UNSEEN);
        latch.update(-1000, 0, false);
        assert_eq!(latch.update(1000, 0, false), (3_000_000, false));
        assert_eq!(latch.update(1000, 200_000_000, true), (3_000_000, false));
    }

    /// The rule as it is told above, state by state.
    #[derive(Clone, Copy)]
    enum Contact {
        Unknown,
        Open,
        Unseen,
        Latched(i32),
    }

    proptest! {
        #[test]
        fn the_latch_does_what_its_rule_says(samples in prop::collection::vec((-3..3_i32, any::<i32>(), any::<bool>(), 0..20_u8), 1..60)) {
            let mut latch = Latch::new(FLOOR, UNSEEN);
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
                    kept => kept,
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
