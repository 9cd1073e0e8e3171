//! Supervision of the controller: check-ins before the watchdog is kicked, the fault record that
//! outlasts a reset, the reason of the last reset, the depth of the stack, the light.
//!
//! The decisions are here and tested on the host; the firmware's `boards` access the registers.
//! After a fault the handler writes a [`record`] to RAM that start-up does not clear, and the core
//! resets. The next start reads the record once ([`start::report`]), and the hello frame carries
//! it.

mod attendance;
pub mod code;
pub mod light;
pub mod paint;
pub mod record;
pub(crate) mod self_test;
pub mod start;

pub use attendance::{Attendance, Party, Periods, Verdict};
pub use code::CodeCheck;
pub(crate) use self_test::SelfTest;
