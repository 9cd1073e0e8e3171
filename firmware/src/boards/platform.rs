//! The board as the link service uses it.

use controller::service::{self, LogEvent};
use controller::supervisor::paint::Mark;
use controller::supervisor::start::StartWatch;
use controller::supervisor::{Attendance, Party};
use link::start::StackReport;

use super::check_in::check_in;
use super::code::code_word;
use super::log_text as log;
use super::memory::{self, stack_used};
use super::timer::{Timer, uptime_us};

/// Register of check-ins and timer of the work in lockstep.
pub struct Platform<'a> {
    attendance: &'a Attendance,
    timer: Timer,
}

impl<'a> Platform<'a> {
    /// Creates the platform.
    #[must_use]
    pub const fn new(attendance: &'a Attendance, timer: Timer) -> Self {
        Self { attendance, timer }
    }
}

impl service::Platform for Platform<'_> {
    type Ticks = Timer;

    fn ticks(&mut self) -> &mut Timer {
        &mut self.timer
    }

    fn uptime_us(&self) -> u32 {
        uptime_us()
    }

    fn attendance(&self) -> &Attendance {
        self.attendance
    }

    fn check_in(&self, party: Party) {
        check_in(self.attendance, party);
    }

    fn code_word(&self, address: usize) -> u32 {
        code_word(address)
    }

    fn search_stack(&self, mark: &mut Mark) -> StackReport {
        stack_used(mark)
    }

    fn start_watch(&self) -> StartWatch {
        memory::start_watch()
    }

    fn set_start_watch(&self, watch: StartWatch) {
        memory::set_start_watch(watch);
    }

    fn log(&self, event: &LogEvent) {
        log::event(event);
    }
}
