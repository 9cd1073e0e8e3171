//! The counter that times a tick.

/// A free-running counter that times one tick's work.
pub trait TickSource {
    /// Returns the count at the start of the work.
    fn start(&mut self) -> u32;
    /// Returns the ticks since `start`.
    fn since(&mut self, start: u32) -> u32;
}

/// No counter: every duration is 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoTicks;

impl TickSource for NoTicks {
    fn start(&mut self) -> u32 {
        0
    }

    fn since(&mut self, _start: u32) -> u32 {
        0
    }
}
