//! Host and session over a line that loses, damages, repeats and reorders frames in both
//! directions: every command is executed once and in order, and both ends agree on their state.
#![expect(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use controller::configuration::BENCH_B;
use controller::{Identity, NoTicks, Session};
use host_sim::controller::{Conversation, Received};
use link::track::SensorStatus;
use link::{
    Answer, BuildId, ClockSource, Command, ControllerConfiguration, Decoder, MAX_FRAME, Refusal, SensorFrame,
    SlowReport, State, Target, ToController, ToHost, encode,
};
use proptest::prelude::*;
use std::collections::VecDeque;

/// Effect of the line on a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fate {
    Arrives,
    IsLost,
    IsDamaged(u8),
    ComesTwice,
    /// Arrives after the given number of later frames.
    IsOvertaken(u8),
}

/// One direction of the line. It works without errors once its list of fates is used up.
struct Line {
    frames: VecDeque<Vec<u8>>,
    overtaken: Vec<(u8, Vec<u8>)>,
    fates: std::vec::IntoIter<Fate>,
}

impl Line {
    fn new(fates: Vec<Fate>) -> Self {
        Self { frames: VecDeque::new(), overtaken: Vec::new(), fates: fates.into_iter() }
    }

    fn put(&mut self, mut frame: Vec<u8>) {
        match self.fates.next().unwrap_or(Fate::Arrives) {
            Fate::Arrives => self.frames.push_back(frame),
            Fate::IsLost => {}
            Fate::IsDamaged(at) => {
                let at = usize::from(at) % frame.len();
                frame[at] ^= 0x21;
                self.frames.push_back(frame);
            }
            Fate::ComesTwice => self.frames.extend([frame.clone(), frame]),
            Fate::IsOvertaken(by) => self.overtaken.push((by, frame)),
        }
    }

    fn take(&mut self) -> Option<Vec<u8>> {
        let frame = self.frames.pop_front()?;
        for (left, _) in &mut self.overtaken {
            *left = left.saturating_sub(1);
        }
        for (_, late) in self.overtaken.extract_if(.., |(left, _)| *left == 0) {
            self.frames.push_back(late);
        }
        Some(frame)
    }
}

fn fates() -> impl Strategy<Value = Vec<Fate>> {
    let fate = prop_oneof![
        3 => Just(Fate::Arrives),
        2 => Just(Fate::IsLost),
        1 => any::<u8>().prop_map(Fate::IsDamaged),
        2 => Just(Fate::ComesTwice),
        2 => (1..6_u8).prop_map(Fate::IsOvertaken),
    ];
    prop::collection::vec(fate, 0..80)
}

fn command() -> impl Strategy<Value = Command> {
    let configure = |change: fn(&mut ControllerConfiguration)| {
        let mut configuration = BENCH_B;
        change(&mut configuration);
        Just(Command::Configure(configuration))
    };
    prop_oneof![
        configure(|_| {}),
        configure(|c| c.bench.radial_clearance_nm = 700_000),
        configure(|c| c.bench.bearing = 1),
        configure(|c| c.limits.stuck_samples = 0),
        Just(Command::GetConfiguration),
        Just(Command::GetCounters),
        Just(Command::ClearTrip),
        Just(Command::Keep),
        Just(Command::Stop),
        Just(Command::SampleYourself),
        prop::sample::select(link::ReportKind::ALL.to_vec()).prop_map(Command::GetReport),
    ]
}

fn frame<M: serde::Serialize>(message: &M) -> Vec<u8> {
    encode(message, &mut [0; MAX_FRAME]).unwrap().to_vec()
}

fn session() -> Session {
    let build_id = BuildId::new("test");
    Session::new(Identity { build_id, target: Target::Native, clock: ClockSource::Host, core_hz: 0 })
}

/// The two ends and the line between them.
struct World {
    session: Session,
    to_controller: Line,
    to_host: Line,
    at_controller: Decoder,
    at_host: Decoder,
}

impl World {
    fn new(to_controller: Vec<Fate>, to_host: Vec<Fate>) -> Self {
        Self {
            session: session(),
            to_controller: Line::new(to_controller),
            to_host: Line::new(to_host),
            at_controller: Decoder::new(),
            at_host: Decoder::new(),
        }
    }

    /// Transfers one frame; returns false if none is in transit.
    fn carry(&mut self, conversation: &mut Conversation, heard: &mut Vec<Received>) -> bool {
        if let Some(bytes) = self.to_controller.take() {
            for byte in bytes {
                let answer = match self.at_controller.push::<ToController>(byte) {
                    None => continue,
                    Some(Ok(message)) => self.session.handle(&message, &mut NoTicks),
                    Some(Err(error)) => self.session.bad_frame(error),
                };
                self.to_host.put(frame(&answer));
            }
            return true;
        }
        if let Some(bytes) = self.to_host.take() {
            for byte in bytes {
                if let Some(Ok(message)) = self.at_host.push::<ToHost>(byte) {
                    heard.push(conversation.receive(message));
                }
            }
            return true;
        }
        false
    }

    /// Sends a message until it is answered.
    fn ask(
        &mut self,
        conversation: &mut Conversation,
        message: ToController,
        is_answer: fn(&Received) -> bool,
    ) -> Received {
        let mut next = Some(message);
        for _ in 0..1_000 {
            if let Some(message) = next.take() {
                self.to_controller.put(frame(&message));
            }
            let mut heard = Vec::new();
            if !self.carry(conversation, &mut heard) {
                next = conversation.repeat();
            }
            if let Some(answer) = heard.into_iter().find(is_answer) {
                return answer;
            }
        }
        panic!("no answer to {message:?}");
    }

    fn greet(&mut self, conversation: &mut Conversation) {
        let asking = conversation.identify();
        self.ask(conversation, asking, |heard| matches!(heard, Received::Identified(_)));
    }

    fn order(&mut self, conversation: &mut Conversation, command: Command) -> Result<Answer, Refusal> {
        loop {
            let message = conversation.order(command);
            match self.ask(conversation, message, |heard| matches!(heard, Received::Outcome(_))) {
                // Only after a change of hosts: a command of the earlier one was still in transit.
                Received::Outcome(Err(Refusal::OutOfOrder { .. } | Refusal::NumberTaken)) => {
                    self.greet(conversation)
                }
                Received::Outcome(outcome) => return outcome,
                other => panic!("{other:?}"),
            }
        }
    }

    /// Sends a sample that the line does not disturb. It would reveal a run that was restarted by
    /// mistake.
    fn sample(&mut self, sequence: u32) -> bool {
        let frame = SensorFrame { sequence, time_us: sequence * 100, ..SensorFrame::default() };
        let message = ToController::Sensor(frame, SensorStatus::GOOD);
        matches!(self.session.handle(&message, &mut NoTicks), ToHost::Estimate(_))
    }
}

/// An outcome without the counters that a bad line changes.
fn run_counters(mut outcome: Result<Answer, Refusal>) -> Result<Answer, Refusal> {
    if let Ok(
        Answer::Counters(counters)
        | Answer::Stopped(counters)
        | Answer::Report(SlowReport::Counters(counters)),
    ) = &mut outcome
    {
        counters.bad_frames = link::BadFrames::default();
        (counters.repeated_commands, counters.refused_commands) = (0, 0);
    }
    outcome
}

/// Sends commands over a line; returns every outcome and the final state.
fn played(
    commands: &[Command],
    to_controller: Vec<Fate>,
    to_host: Vec<Fate>,
) -> (Vec<Result<Answer, Refusal>>, State, u32, u32) {
    let mut world = World::new(to_controller, to_host);
    let mut conversation = Conversation::new(100);
    world.greet(&mut conversation);
    let outcomes = (0..)
        .zip(commands)
        .map(|(sequence, command)| {
            let outcome = world.order(&mut conversation, *command);
            world.sample(sequence);
            run_counters(outcome)
        })
        .collect();
    let hello = world.session.hello(0);
    (outcomes, hello.state, hello.configuration_crc, hello.last_command)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn commands_have_the_same_outcomes_on_a_bad_line_as_on_a_good_one(
        commands in prop::collection::vec(command(), 1..12),
        to_controller in fates(),
        to_host in fates(),
    ) {
        prop_assert_eq!(played(&commands, to_controller, to_host), played(&commands, vec![], vec![]));
    }

    #[test]
    fn a_host_that_takes_over_agrees_with_the_session(
        first in prop::collection::vec(command(), 1..6),
        abandoned in command(),
        second in prop::collection::vec(command(), 1..6),
        to_controller in fates(),
        to_host in fates(),
    ) {
        let mut world = World::new(to_controller, to_host);
        let mut old = Conversation::new(100);
        world.greet(&mut old);
        for command in first {
            let _ = world.order(&mut old, command);
        }
        // The old host ends while its last command is in transit.
        let last = old.order(abandoned);
        world.to_controller.put(frame(&last));
        let mut new = Conversation::new(5_000);
        world.greet(&mut new);
        for command in second {
            let _ = world.order(&mut new, command);
        }
        // Deliver all frames that are still in transit.
        let mut heard = Vec::new();
        while world.carry(&mut new, &mut heard) {}
        let answer = world.order(&mut new, Command::GetConfiguration);
        let crc = match answer {
            Ok(Answer::Configuration(configuration)) => {
                configuration.as_ref().map_or(0, controller::configuration::checksum)
            }
            other => panic!("{other:?}"),
        };
        let hello = world.session.hello(0);
        prop_assert_eq!(hello.configuration_crc, crc);
        let before = hello.last_command;
        let _ = world.order(&mut new, Command::GetCounters);
        prop_assert_eq!(world.session.hello(0).last_command, before + 1, "the next command is taken at once");
    }
}
