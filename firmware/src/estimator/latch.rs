//! The approach speed of a contact: latched when it begins, kept until it ends.
//!
//! A contact begins when the deformation goes from below 0 to 0 or above, with the rate of that sample (not below the
//! floor), and ends when it falls below 0. A contact whose onset was not seen, because the samples began or were
//! interrupted in it or because the rate was not yet known, has the approach speed that the configuration states for that case, and is flagged: no sensor can tell
//! afterwards, and in sustained contact the damping is inversely proportional to it.

/// Onset latch.
#[derive(Clone, Debug)]
pub struct Latch {
    floor_m_s: f32,
    unseen_m_s: f32,
    contact: Contact,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Contact {
    /// No sample yet.
    Unknown,
    /// Apart.
    Open,
    /// Touching since a sample that was not seen.
    Unseen,
    /// Touching since an onset at this speed.
    Latched(f32),
}

impl Latch {
    /// Creates a latch that has seen nothing.
    #[must_use]
    pub const fn new(floor_m_s: f32, unseen_m_s: f32) -> Self {
        Self {
            floor_m_s,
            unseen_m_s: if unseen_m_s > floor_m_s { unseen_m_s } else { floor_m_s },
            contact: Contact::Unknown,
        }
    }

    /// Forgets what was seen: the next sample may be in the middle of a contact.
    pub const fn reset(&mut self) {
        self.contact = Contact::Unknown;
    }

    /// Takes a sample; returns the approach speed in m/s and whether the contact's onset was seen (true without contact).
    pub fn update(&mut self, deformation_m: f32, rate_m_s: Option<f32>) -> (f32, bool) {
        self.contact = match self.contact {
            _ if deformation_m < 0.0 => Contact::Open,
            Contact::Unknown => Contact::Unseen,
            Contact::Open => rate_m_s.map_or(Contact::Unseen, |rate| {
                Contact::Latched(if rate > self.floor_m_s { rate } else { self.floor_m_s })
            }),
            kept => kept,
        };
        match self.contact {
            Contact::Latched(speed) => (speed, true),
            Contact::Unseen => (self.unseen_m_s, false),
            Contact::Open | Contact::Unknown => (self.floor_m_s, true),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: f32 = 1e-3;
    const UNSEEN: f32 = 3e-3;

    #[test]
    fn the_speed_of_the_onset_is_kept_until_separation() {
        let mut latch = Latch::new(FLOOR, UNSEEN);
        assert_eq!(latch.update(-1e-6, Some(0.2)), (FLOOR, true));
        assert_eq!(latch.update(1e-6, Some(0.15)), (0.15, true));
        assert_eq!(latch.update(3e-6, Some(-0.1)), (0.15, true));
        assert_eq!(latch.update(-1e-6, Some(-0.05)), (FLOOR, true));
        assert_eq!(latch.update(1e-7, Some(0.05)), (0.05, true));
    }

    #[test]
    fn the_floor_holds_for_slow_and_for_backward_onsets() {
        for rate in [2e-4, 0.0, -0.3] {
            let mut latch = Latch::new(FLOOR, UNSEEN);
            latch.update(-1e-6, Some(rate));
            assert_eq!(latch.update(0.0, Some(rate)), (FLOOR, true));
        }
    }

    #[test]
    fn a_contact_that_was_there_before_is_reported_until_it_ends() {
        let mut latch = Latch::new(FLOOR, UNSEEN);
        assert_eq!(latch.update(1e-5, Some(0.5)), (UNSEEN, false));
        assert_eq!(latch.update(1e-5, Some(0.5)), (UNSEEN, false));
        latch.update(-1e-6, Some(-0.1));
        assert_eq!(latch.update(1e-6, Some(0.1)), (0.1, true));
        latch.reset();
        assert_eq!(latch.update(1e-6, Some(0.1)), (UNSEEN, false));
    }

    #[test]
    fn an_onset_at_an_unknown_rate_counts_as_unseen() {
        let mut latch = Latch::new(FLOOR, UNSEEN);
        latch.update(-1e-6, None);
        assert_eq!(latch.update(1e-6, None), (UNSEEN, false));
        assert_eq!(latch.update(1e-6, Some(0.2)), (UNSEEN, false));
    }
}
