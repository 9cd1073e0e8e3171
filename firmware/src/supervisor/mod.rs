//! What watches over the controller: attendance before the watchdog is kicked, the fault record that survives a reset, the reason of
//! the last reset, the depth of the stack, the light.
//!
//! Pure decisions, tested on the host; `boards` has the registers. The order of things after a fault: the handler writes a
//! [`record`] into RAM that no start-up clears, the core resets, the next start reads it once ([`start::report`]) and the greeting carries it.

pub mod attendance;
pub mod code;
pub mod light;
pub mod paint;
pub mod record;
pub mod self_test;
pub mod start;

pub use attendance::{Attendance, Party, Periods, Verdict};
pub use code::CodeCheck;
pub use self_test::SelfTest;
