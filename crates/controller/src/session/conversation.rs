//! The conversation with the host: the hello frame and the last command.

use link::authentication::Authentication;
use link::start::{KeptConfiguration, StackReport, StartReport};
use link::{
    Answer, BuildId, ClockSource, Hello, MAGIC, ModelId, NumberedCommand, PROTOCOL_VERSION, Refusal, State,
    Target,
};

use inference::WINDOW;

/// Identity of the controller in its [`Hello`].
#[derive(Clone, Copy, Debug)]
pub struct Identity {
    /// Name of the build.
    pub build_id: BuildId,
    /// Host process, emulator or silicon.
    pub target: Target,
    /// Clock source of the core.
    pub clock: ClockSource,
    /// Core frequency, Hz.
    pub core_hz: u32,
}

/// Consequence of a command's number for its execution.
pub(super) enum Execution {
    /// The next command: it is to be executed.
    Next,
    /// The last command again: its outcome is repeated.
    Repeated(Result<Answer, Refusal>),
    /// The command is refused.
    Refused(Refusal),
}

/// State of the conversation.
#[derive(Debug)]
pub(super) struct Conversation {
    hello: Hello,
    /// The last executed command with its outcome.
    last_command: Option<(NumberedCommand, Result<Answer, Refusal>)>,
    /// True if the code in flash was corrupted at the start.
    pub(super) is_code_corrupted: bool,
}

impl Conversation {
    pub(super) fn new(identity: Identity, models: [ModelId; link::MODELS]) -> Self {
        let hello = Hello {
            magic: MAGIC,
            protocol: PROTOCOL_VERSION,
            build_id: identity.build_id,
            target: identity.target,
            clock: identity.clock,
            core_hz: identity.core_hz,
            window: WINDOW as u16,
            models,
            token: 0,
            last_command: 0,
            state: State::Waiting,
            configuration_crc: 0,
            start: StartReport::default(),
            stack: StackReport::default(),
            authentication: Authentication::Open,
        };
        Self { hello, last_command: None, is_code_corrupted: false }
    }

    /// Returns the hello frame's content. `token` is that of the request, 0 without one.
    pub(super) fn hello(&self, token: u32, state: State) -> Hello {
        Hello { token, last_command: self.last_number(), state, ..self.hello }
    }

    pub(super) const fn target(&self) -> Target {
        self.hello.target
    }

    /// Core frequency, Hz; 0 where time has no meaning.
    pub(super) fn timed_hz(&self) -> u32 {
        if self.hello.target == Target::Emulator { 0 } else { self.hello.core_hz }
    }

    /// Sets the models of the hello frame. With corrupted code it names none.
    pub(super) const fn set_models(&mut self, models: [ModelId; link::MODELS]) {
        if !self.is_code_corrupted {
            self.hello.models = models;
        }
    }

    pub(super) const fn mark_code_corrupted(&mut self) {
        self.set_models([ModelId::NONE; link::MODELS]);
        self.is_code_corrupted = true;
    }

    pub(super) const fn set_start_report(&mut self, start: StartReport) {
        self.hello.start = start;
    }

    pub(super) const fn set_kept_configuration(&mut self, kept: KeptConfiguration) {
        self.hello.start.kept = kept;
    }

    pub(super) const fn set_authentication(&mut self, authentication: Authentication) {
        self.hello.authentication = authentication;
    }

    /// Decides whether commands that change the state must be authenticated.
    pub(super) fn is_authenticated(&self) -> bool {
        self.hello.authentication != Authentication::Open
    }

    pub(super) const fn set_stack_report(&mut self, stack: StackReport) {
        self.hello.stack = stack;
    }

    pub(super) const fn set_configuration_crc(&mut self, crc: u32) {
        self.hello.configuration_crc = crc;
    }

    pub(super) const fn start_and_stack(&self) -> (StartReport, StackReport) {
        (self.hello.start, self.hello.stack)
    }

    /// Number of the last executed command; 0 before the first.
    fn last_number(&self) -> u32 {
        self.last_command.as_ref().map_or(0, |(numbered, _)| numbered.id)
    }

    /// Number of the command that would be executed next.
    pub(super) fn next_number(&self) -> u32 {
        self.last_number().wrapping_add(1)
    }

    /// Decides by its number whether a command is executed, repeated or refused.
    pub(super) fn decide_execution(&self, numbered: &NumberedCommand) -> Execution {
        let expected = self.next_number();
        match &self.last_command {
            _ if numbered.id == expected => Execution::Next,
            Some((last, outcome)) if last == numbered => Execution::Repeated(*outcome),
            Some((last, _)) if last.id == numbered.id => Execution::Refused(Refusal::NumberTaken),
            _ => Execution::Refused(Refusal::OutOfOrder { expected }),
        }
    }

    /// Records an executed command.
    pub(super) const fn record(&mut self, numbered: NumberedCommand, outcome: Result<Answer, Refusal>) {
        self.last_command = Some((numbered, outcome));
    }
}
