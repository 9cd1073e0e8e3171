//! The host's side of the protocol, independent of the line: numbers commands, matches answers,
//! counts losses.
//!
//! One command or request at a time is pending. The host repeats it, a command with the same
//! number, until its answer arrives. Answers with another number belong to earlier sendings and are
//! counted as strays. Estimates and slow telemetry are numbered separately: a gap is a loss.

use link::authentication::{Authentication, LinkKey};
use link::update::{UpdateAnswer, UpdateRequest};
use link::{
    Acknowledgement, Answer, BlockSummary, Command, EstimateFrame, Hello, ImpactRecord, NumberedCommand,
    NumberedEstimate, Refusal, SlowFrame, State, ToController, ToHost,
};

/// Losses on the line and on the controller, as the host sees them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct Losses {
    /// Estimates that the controller sent and the host did not receive.
    pub estimates_missed: u32,
    /// Estimates that the controller dropped, modulo 256.
    pub estimates_dropped: u8,
    /// Frames of slow telemetry that the host did not receive.
    pub slow_missed: u32,
    /// Records of impacts that the controller made and the host did not receive.
    pub impacts_missed: u32,
    /// Answers to earlier sendings of a command or request.
    pub strays: u32,
    /// Commands, requests and samples that the host repeated.
    pub sent_again: u32,
    /// Damaged frames received.
    pub damaged: u32,
}

/// A received message, classified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Received {
    /// The hello that answers the pending identify request.
    Identified(Hello),
    /// A hello without a request: the controller has just started.
    Started(Hello),
    /// The answer to the pending command.
    Outcome(Result<Answer, Refusal>),
    /// An estimate.
    Estimate(EstimateFrame),
    /// Slow telemetry.
    Slow(SlowFrame),
    /// A recorded impact.
    Impact(ImpactRecord),
    /// The summary of the estimates up to a sent one.
    Block(BlockSummary),
    /// An answer about models.
    Update(UpdateAnswer),
    /// The controller could not serve a frame.
    Fault(link::Fault),
    /// An answer to an earlier sending.
    Stray,
}

/// State of the conversation.
#[derive(Clone, Debug, Default)]
pub struct Conversation {
    token: u32,
    last_command: u32,
    pending: Option<ToController>,
    key: Option<LinkKey>,
    authentication: Authentication,
    /// Number of the last command in the last hello, which its tag covers.
    introduced: u32,
    /// Numbers of the last estimate, the last slow frame and the last impact.
    estimate: Option<u32>,
    slow: Option<u32>,
    impact: Option<u32>,
    losses: Losses,
}

impl Conversation {
    /// Creates the host's side. Its identify requests carry the numbers after `token`.
    pub fn new(token: u32) -> Self {
        Self { token, ..Self::default() }
    }

    /// Creates an identify request. Its answer contains the number of the last command.
    pub fn identify(&mut self) -> ToController {
        self.token = self.token.wrapping_add(1).max(1);
        *self.pending.insert(ToController::Identify { token: self.token })
    }

    /// Numbers a command.
    pub fn order(&mut self, command: Command) -> ToController {
        let numbered = NumberedCommand { id: self.last_command.wrapping_add(1), command };
        let tag = match (self.key, self.authentication) {
            (Some(key), Authentication::Required { start, .. }) if command.changes_state() => {
                key.command_tag(start, &numbered)
            }
            _ => None,
        };
        *self.pending.insert(match tag {
            Some(tag) => ToController::Authenticated(numbered, tag),
            None => ToController::Command(numbered),
        })
    }

    /// Sets the key for commands that a controller executes only with a tag.
    pub const fn set_key(&mut self, key: Option<LinkKey>) {
        self.key = key;
    }

    /// Decides whether the controller requires a key and this is another one.
    pub(super) fn has_wrong_key(&self) -> bool {
        match (self.key, self.authentication) {
            (Some(key), Authentication::Required { start, tag }) => {
                !key.accepts_hello(start, self.introduced, &tag)
            }
            _ => false,
        }
    }

    /// Decides whether a key was given for a controller that requires none.
    pub(super) const fn has_needless_key(&self) -> bool {
        self.key.is_some() && !self.is_key_required()
    }

    /// Decides whether the controller requires a key.
    pub(super) const fn is_key_required(&self) -> bool {
        matches!(self.authentication, Authentication::Required { .. })
    }

    /// Makes a request about models the pending one.
    pub fn request(&mut self, request: UpdateRequest) -> ToController {
        *self.pending.insert(ToController::Update(request))
    }

    /// Returns the pending request or command for a repetition.
    pub fn repeat(&mut self) -> Option<ToController> {
        self.losses.sent_again = self.losses.sent_again.saturating_add(u32::from(self.pending.is_some()));
        self.pending
    }

    /// Counts a repeated sample.
    pub(super) const fn count_repeated(&mut self) {
        self.losses.sent_again = self.losses.sent_again.saturating_add(1);
    }

    /// Number of the last command that the controller is known to have carried out.
    pub(super) const fn last_command(&self) -> u32 {
        self.last_command
    }

    /// Losses so far.
    pub const fn losses(&self) -> &Losses {
        &self.losses
    }

    /// Classifies a message.
    pub fn receive(&mut self, message: ToHost) -> Received {
        match message {
            ToHost::Hello(hello) => self.receive_hello(hello),
            ToHost::Acknowledged(Acknowledgement { id, outcome }) => match self.pending {
                Some(
                    ToController::Command(NumberedCommand { id: waiting, .. })
                    | ToController::Authenticated(NumberedCommand { id: waiting, .. }, _),
                ) if id == waiting => {
                    let is_tagged = matches!(self.pending.take(), Some(ToController::Authenticated(..)));
                    // A command refused because of its number or tag was not carried out: the
                    // number is still free. If a key is required, other commands do not count.
                    let counts = is_tagged || !self.is_key_required();
                    if counts && !outcome.is_err_and(|refusal| is_number_free(&refusal)) {
                        self.last_command = id;
                    }
                    // A new run numbers its estimates and impacts from the start.
                    if matches!(outcome, Ok(Answer::Configured(_) | Answer::Stopped(_))) {
                        (self.estimate, self.impact) = (None, None);
                    }
                    Received::Outcome(outcome)
                }
                _ => self.stray(),
            },
            ToHost::Estimate(NumberedEstimate { number, dropped, estimate }) => {
                self.losses.estimates_dropped = dropped;
                let missed = missed(&mut self.estimate, number);
                self.losses.estimates_missed = self.losses.estimates_missed.saturating_add(missed);
                Received::Estimate(estimate)
            }
            ToHost::Slow(slow) => {
                let missed = missed(&mut self.slow, slow.number);
                self.losses.slow_missed = self.losses.slow_missed.saturating_add(missed);
                Received::Slow(slow)
            }
            ToHost::Impact(impact) => {
                let missed = missed(&mut self.impact, impact.number);
                self.losses.impacts_missed = self.losses.impacts_missed.saturating_add(missed);
                Received::Impact(impact)
            }
            ToHost::Block(block) => Received::Block(block),
            ToHost::Update(answer) => {
                self.pending.take_if(|pending| matches!(pending, ToController::Update(_)));
                Received::Update(answer)
            }
            ToHost::Fault(fault) => Received::Fault(fault),
        }
    }

    fn receive_hello(&mut self, hello: Hello) -> Received {
        let is_start = hello.token == 0;
        let is_requested =
            matches!(self.pending, Some(ToController::Identify { token }) if token == hello.token);
        if !(is_start || is_requested) {
            return self.stray();
        }
        self.last_command = hello.last_command;
        (self.authentication, self.introduced) = (hello.authentication, hello.last_command);
        // The hello of a start does not answer a pending `Identify`; that answer is still to come.
        if is_requested || !matches!(self.pending, Some(ToController::Identify { .. })) {
            self.pending = None;
        }
        if hello.state == State::Waiting || is_start {
            (self.estimate, self.slow, self.impact) = (None, None, None);
        }
        if is_start { Received::Started(hello) } else { Received::Identified(hello) }
    }

    fn stray(&mut self) -> Received {
        self.losses.strays = self.losses.strays.saturating_add(1);
        Received::Stray
    }
}

/// Decides whether a command that was refused was not carried out under its number.
pub(super) const fn is_number_free(refusal: &Refusal) -> bool {
    matches!(refusal, Refusal::OutOfOrder { .. } | Refusal::NumberTaken | Refusal::NotAuthenticated)
}

/// Returns how many numbers lie between the last one and this. A number from the past is a
/// repetition, not a loss.
fn missed(last: &mut Option<u32>, number: u32) -> u32 {
    let missed = last.map_or(0, |last| number.wrapping_sub(last).wrapping_sub(1));
    if missed > u32::MAX / 2 {
        return 0;
    }
    *last = Some(number);
    missed
}
