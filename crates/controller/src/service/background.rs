//! Checks that run beside the link: self-test, code in flash, configuration in RAM, depth of the
//! stack.

use link::start::StackReport;
use rtic_core::Mutex;

use super::journal::LogEvent;
use super::pace::Pacing;
use super::shared_session::{SampleSource, SharedSession};
use crate::session::{Session, TickSource};
use crate::supervisor::paint::Mark;
use crate::supervisor::self_test::Progress;
use crate::supervisor::start::StartWatch;
use crate::supervisor::{Attendance, CodeCheck, Party, SelfTest};

/// Number of passes in lockstep per pass of the self-test, which must not slow down the
/// exchange of frames.
const LOCKSTEP_PASSES_PER_SELF_TEST: u32 = 16;
/// Words of code that are checked in one pass.
const CODE_WORDS_PER_PASS: usize = 64;

/// Functions that the service requires of its board.
pub trait Platform {
    /// Counter that times a tick.
    type Ticks: TickSource;

    /// Returns the counter that times a tick in lockstep.
    fn ticks(&mut self) -> &mut Self::Ticks;
    /// Returns the time since the start, us, modulo 2^32.
    fn uptime_us(&self) -> u32;
    /// Returns the register of check-ins.
    fn attendance(&self) -> &Attendance;
    /// Notes that a party is at work.
    fn check_in(&self, party: Party) {
        self.attendance().check_in(party, self.uptime_us());
    }
    /// Reads a word of the flash.
    fn code_word(&self, address: usize) -> u32;
    /// Searches further for the deepest use of the stack and reports the result so far.
    fn search_stack(&self, mark: &mut Mark) -> StackReport;
    /// Returns the count of faulted starts.
    fn start_watch(&self) -> StartWatch {
        StartWatch::default()
    }
    /// Stores the count of faulted starts for the next start.
    fn set_start_watch(&self, _watch: StartWatch) {}
    /// Writes a line to the log.
    fn log(&self, _event: &LogEvent) {}
}

/// State of the background checks.
pub struct Background {
    self_test: SelfTest,
    /// `None` if the code was corrupted at the start: then every run is refused.
    code: Option<CodeCheck>,
    stack: Mark,
    passes: u32,
}

impl Background {
    /// Checks the code once and reports the depth of the stack to the session.
    pub fn start(
        mut code: CodeCheck,
        mut stack: Mark,
        session: &mut Session,
        platform: &impl Platform,
    ) -> Self {
        session.set_stack_report(platform.search_stack(&mut stack));
        let is_corrupted = code.pass(|address| platform.code_word(address));
        if is_corrupted {
            session.mark_code_corrupted();
        }
        Self { self_test: SelfTest::new(), code: (!is_corrupted).then_some(code), stack, passes: 0 }
    }

    /// Checks configuration and code, and advances the self-test and the search for the stack's
    /// depth. Returns true if configuration or code are corrupted. The next start finds corrupted
    /// code as well and refuses every run.
    pub(super) fn step<S: SampleSource>(
        &mut self,
        pacing: Pacing,
        shared: &mut impl Mutex<T = SharedSession<S>>,
        platform: &impl Platform,
    ) -> bool {
        let is_code_corrupted = self
            .code
            .as_mut()
            .is_some_and(|code| code.step(CODE_WORDS_PER_PASS, |address| platform.code_word(address)));
        if is_code_corrupted || shared.lock(|shared| shared.session.is_configuration_corrupted()) {
            return true;
        }
        self.passes = self.passes.wrapping_add(1);
        if pacing == Pacing::Timer || self.passes.is_multiple_of(LOCKSTEP_PASSES_PER_SELF_TEST) {
            if self.self_test.step() == Progress::Passed {
                platform.check_in(Party::SelfTest);
            }
            let stack = platform.search_stack(&mut self.stack);
            shared.lock(|shared| shared.session.set_stack_report(stack));
        }
        false
    }
}
