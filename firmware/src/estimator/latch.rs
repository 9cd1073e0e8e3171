//! The approach speed of a contact: latched when it begins, kept until it ends.
//!
//! A contact begins when the deformation goes from below 0 to 0 or above, with the rate of that sample (not below the floor), and ends
//! when it falls below 0. A contact whose beginning was not seen, because the samples began or were interrupted in
//! it, has the floor: at a bench that starts at rest that is the right value, elsewhere it is flagged.

/// Onset latch.
#[derive(Clone, Debug)]
pub struct Latch {
    floor_m_s: f32,
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
    pub const fn new(floor_m_s: f32) -> Self {
        Self { floor_m_s, contact: Contact::Unknown }
    }

    /// Forgets what was seen: the next sample may be in the middle of a contact.
    pub const fn reset(&mut self) {
        self.contact = Contact::Unknown;
    }

    /// Takes a sample; returns the approach speed in m/s and whether the contact's onset was seen (true without contact).
    pub fn update(&mut self, deformation_m: f32, rate_m_s: f32) -> (f32, bool) {
        self.contact = match self.contact {
            _ if deformation_m < 0.0 => Contact::Open,
            Contact::Unknown => Contact::Unseen,
            Contact::Open => {
                Contact::Latched(if rate_m_s > self.floor_m_s { rate_m_s } else { self.floor_m_s })
            }
            kept => kept,
        };
        match self.contact {
            Contact::Latched(speed) => (speed, true),
            contact => (self.floor_m_s, contact != Contact::Unseen),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: f32 = 1e-3;

    #[test]
    fn the_speed_of_the_onset_is_kept_until_separation() {
        let mut latch = Latch::new(FLOOR);
        assert_eq!(latch.update(-1e-6, 0.2), (FLOOR, true));
        assert_eq!(latch.update(1e-6, 0.15), (0.15, true));
        assert_eq!(latch.update(3e-6, -0.1), (0.15, true));
        assert_eq!(latch.update(-1e-6, -0.05), (FLOOR, true));
        assert_eq!(latch.update(1e-7, 0.05), (0.05, true));
    }

    #[test]
    fn the_floor_holds_for_slow_and_for_backward_onsets() {
        for rate in [2e-4, 0.0, -0.3] {
            let mut latch = Latch::new(FLOOR);
            latch.update(-1e-6, rate);
            assert_eq!(latch.update(0.0, rate), (FLOOR, true));
        }
    }

    #[test]
    fn a_contact_that_was_there_before_is_reported_until_it_ends() {
        let mut latch = Latch::new(FLOOR);
        assert_eq!(latch.update(1e-5, 0.5), (FLOOR, false));
        assert_eq!(latch.update(1e-5, 0.5), (FLOOR, false));
        latch.update(-1e-6, -0.1);
        assert_eq!(latch.update(1e-6, 0.1), (0.1, true));
        latch.reset();
        assert_eq!(latch.update(1e-6, 0.1), (FLOOR, false));
    }
}
