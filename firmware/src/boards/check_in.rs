//! Check-ins of the parties that the watchdog supervises.

use controller::supervisor::{Attendance, Party};
#[cfg(feature = "provoke")]
use core::sync::atomic::{AtomicU8, Ordering};

use super::timer::uptime_us;

/// Bits of the parties that no longer check in.
#[cfg(feature = "provoke")]
static AWAY: AtomicU8 = AtomicU8::new(0);

/// Prevents a party from checking in.
#[cfg(feature = "provoke")]
pub(super) fn keep_away(party: Party) {
    AWAY.store(party.bit(), Ordering::Relaxed);
}

/// Notes that a party is at work.
pub fn check_in(attendance: &Attendance, party: Party) {
    #[cfg(feature = "provoke")]
    if AWAY.load(Ordering::Relaxed) & party.bit() != 0 {
        return;
    }
    attendance.check_in(party, uptime_us());
}
