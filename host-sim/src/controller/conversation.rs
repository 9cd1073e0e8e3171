//! The host's side of the protocol, apart from any line: numbers commands, tells answers from strays, counts what was missed.
//!
//! One command at a time is on the way. It is sent again, number and all, until its answer comes; answers with another number are
//! strays of an earlier sending. Streams have numbers of their own: a gap is a loss.

use link::update::UpdateAnswer;
use link::{
    Acknowledgement, Answer, Command, EstimateFrame, Hello, NumberedCommand, NumberedEstimate, Refused,
    SlowFrame, State, ToController, ToHost,
};

/// What the line and the other side lost, as the host sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Losses {
    /// Estimates that the controller sent and that did not come.
    pub estimates_missed: u32,
    /// Estimates that the controller dropped itself, modulo 256.
    pub estimates_dropped: u8,
    /// Frames of slow telemetry that did not come.
    pub slow_missed: u32,
    /// Answers to commands sent before, or to greetings not waited for.
    pub strays: u32,
    /// Commands, greetings and samples that were sent again.
    pub sent_again: u32,
    /// Damaged frames received.
    pub damaged: u32,
}

/// A message sorted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Heard {
    /// The greeting that was asked for.
    Greeting(Hello),
    /// A greeting that nobody asked for: the controller has just started.
    Started(Hello),
    /// The answer to the command on the way.
    Outcome(Result<Answer, Refused>),
    /// An estimate.
    Estimate(EstimateFrame),
    /// Slow telemetry.
    Slow(SlowFrame),
    /// An answer about models.
    Update(UpdateAnswer),
    /// The controller could not serve a frame.
    Fault(link::Fault),
    /// An answer to something earlier.
    Stray,
}

/// The state of the conversation.
#[derive(Clone, Debug, Default)]
pub struct Conversation {
    token: u32,
    last_command: u32,
    on_the_way: Option<ToController>,
    /// Numbers of the last estimate and the last slow frame.
    estimate: Option<u32>,
    slow: Option<u32>,
    losses: Losses,
}

impl Conversation {
    /// Creates the host's side; greetings that it asks for carry the numbers after `token`.
    pub fn new(token: u32) -> Self {
        Self { token, ..Self::default() }
    }

    /// Asks who is there. The answer tells the number of the next command.
    pub fn identify(&mut self) -> ToController {
        self.token = self.token.wrapping_add(1).max(1);
        *self.on_the_way.insert(ToController::Identify { token: self.token })
    }

    /// Numbers a command.
    pub fn order(&mut self, command: Command) -> ToController {
        let id = self.last_command.wrapping_add(1);
        *self.on_the_way.insert(ToController::Command(NumberedCommand { id, command }))
    }

    /// The greeting or command that has not been answered, to be sent again.
    pub fn again(&mut self) -> Option<ToController> {
        self.losses.sent_again = self.losses.sent_again.saturating_add(u32::from(self.on_the_way.is_some()));
        self.on_the_way
    }

    /// Counts a sample that was sent again.
    pub(super) const fn count_repeated(&mut self) {
        self.losses.sent_again = self.losses.sent_again.saturating_add(1);
    }

    /// Number of the last command that the controller has carried out, as far as is known.
    pub(super) const fn last_command(&self) -> u32 {
        self.last_command
    }

    /// What was lost so far.
    pub const fn losses(&self) -> &Losses {
        &self.losses
    }

    /// Takes a message.
    pub fn hear(&mut self, message: ToHost) -> Heard {
        match message {
            ToHost::Hello(hello) => self.greeting(hello),
            ToHost::Acknowledged(Acknowledgement { id, outcome }) => match self.on_the_way {
                Some(ToController::Command(NumberedCommand { id: waiting, .. })) if id == waiting => {
                    self.on_the_way = None;
                    // A refusal for its number was not carried out: the number is still to come.
                    if !matches!(outcome, Err(Refused::OutOfOrder { .. } | Refused::NumberTaken)) {
                        self.last_command = id;
                    }
                    // A new run counts its estimates anew.
                    if matches!(outcome, Ok(Answer::Configured(_) | Answer::Stopped(_))) {
                        self.estimate = None;
                    }
                    Heard::Outcome(outcome)
                }
                _ => self.stray(),
            },
            ToHost::Estimate(NumberedEstimate { number, dropped, estimate }) => {
                self.losses.estimates_dropped = dropped;
                let missed = missed(&mut self.estimate, number);
                self.losses.estimates_missed = self.losses.estimates_missed.saturating_add(missed);
                Heard::Estimate(estimate)
            }
            ToHost::Slow(slow) => {
                let missed = missed(&mut self.slow, slow.number);
                self.losses.slow_missed = self.losses.slow_missed.saturating_add(missed);
                Heard::Slow(slow)
            }
            ToHost::Update(answer) => Heard::Update(answer),
            ToHost::Fault(fault) => Heard::Fault(fault),
        }
    }

    fn greeting(&mut self, hello: Hello) -> Heard {
        let started = hello.token == 0;
        let asked = matches!(self.on_the_way, Some(ToController::Identify { token }) if token == hello.token);
        if !(started || asked) {
            return self.stray();
        }
        self.last_command = hello.last_command;
        self.on_the_way = None;
        if hello.state == State::Waiting || started {
            (self.estimate, self.slow) = (None, None);
        }
        if started { Heard::Started(hello) } else { Heard::Greeting(hello) }
    }

    fn stray(&mut self) -> Heard {
        self.losses.strays = self.losses.strays.saturating_add(1);
        Heard::Stray
    }
}

/// How many numbers lie between the last one and this; a number from the past is a repetition, not a loss.
fn missed(last: &mut Option<u32>, number: u32) -> u32 {
    let missed = last.map_or(0, |last| number.wrapping_sub(last).wrapping_sub(1));
    if missed > u32::MAX / 2 {
        return 0;
    }
    *last = Some(number);
    missed
}
