//! Attacks on a controller with a key of its link.

use link::authentication::{Authentication, LinkKey, Tag};
use link::{Refusal, update::SignedManifest};
use proptest::prelude::*;

use super::*;

const KEY: LinkKey = LinkKey::new([7; 32]);

fn guarded(slots: Flash, places: Flash) -> Fixture {
    let mut fixture = fixture_with_key(Pacing::Timer, slots, places, Some(KEY));
    fixture.restore();
    fixture
}

impl Fixture {
    fn restarted_with_key(self) -> Self {
        let [slots, places] = self.service.stores.into_memories();
        guarded(slots, places)
    }

    fn places_now(&mut self) -> Vec<u8> {
        self.service.stores.values_mut().bytes.to_vec()
    }

    fn hello(&mut self) -> Hello {
        match self.ask(ToController::Identify { token: 5 })[..] {
            [ToHost::Hello(hello)] => hello,
            ref other => panic!("{other:?}"),
        }
    }

    fn start_number(&mut self) -> u32 {
        let hello = self.hello();
        match hello.authentication {
            Authentication::Required { start, tag } => {
                assert!(KEY.accepts_hello(start, hello.last_command, &tag));
                assert!(!KEY.accepts_hello(start, hello.last_command + 1, &tag), "for this number only");
                start
            }
            other => panic!("{other:?}"),
        }
    }

    /// The next command with its tag.
    fn signed(&mut self, command: Command) -> ToController {
        let hello = self.shared.session.hello(0);
        let numbered = NumberedCommand { id: hello.last_command + 1, command };
        ToController::Authenticated(numbered, KEY.command_tag(self.start_number(), &numbered).unwrap())
    }

    fn outcome(&mut self, message: ToController) -> Result<Answer, Refusal> {
        match self.ask(message)[..] {
            [ToHost::Acknowledged(acknowledgement)] => acknowledgement.outcome,
            ref other => panic!("{other:?}"),
        }
    }

    fn order_signed(&mut self, command: Command) -> Result<Answer, Refusal> {
        let message = self.signed(command);
        self.outcome(message)
    }
}

/// Commands that change the state.
fn changing(package: &SignedManifest) -> [Command; 6] {
    [
        Command::Configure(BENCH_B),
        Command::ClearTrip,
        Command::Stop,
        Command::Keep,
        Command::SampleYourself,
        Command::PermitUpdate(package.hash()),
    ]
}

#[test]
fn commands_without_a_valid_tag_change_nothing_and_those_that_only_read_are_answered() {
    let mut start = guarded(blank(), blank());
    let package = Package::new(BearingMaterial::Babbitt, 9).signed;
    let wrong = LinkKey::new([8; 32]);
    for command in changing(&package) {
        let numbered = NumberedCommand { id: 1, command };
        let attacks = [
            ToController::Command(numbered),
            ToController::Authenticated(numbered, Tag::default()),
            ToController::Authenticated(numbered, wrong.command_tag(1, &numbered).unwrap()),
            ToController::Authenticated(numbered, KEY.command_tag(2, &numbered).unwrap()),
        ];
        for attack in attacks {
            assert_eq!(start.outcome(attack), Err(Refusal::NotAuthenticated), "{command:?}");
        }
    }
    assert!(!start.shared.is_running());
    assert_eq!(start.shared.session.counters().refused_commands, 24);
    for _ in 0..100 {
        assert_eq!(start.order(Command::GetConfiguration), Answer::Configuration(None));
        assert!(matches!(start.order(Command::GetCounters), Answer::Counters(_)));
    }
    assert_eq!(start.hello().last_command, 0, "commands that only read use up no number");
}

#[test]
fn a_recorded_command_is_not_executed_a_second_time_in_its_start_or_a_later_one() {
    let mut start = guarded(blank(), blank());
    let configure = start.signed(Command::Configure(BENCH_B));
    assert!(start.outcome(configure).is_ok());
    let stop = start.signed(Command::Stop);
    assert!(start.outcome(stop).is_ok());
    assert_eq!(start.outcome(configure), Err(Refusal::OutOfOrder { expected: 3 }));
    // The last command gets its answer again.
    assert!(matches!(start.outcome(stop), Ok(Answer::Stopped(_))));
    assert!(!start.shared.is_running());
    for number in 2..5 {
        start = start.restarted_with_key();
        assert_eq!(start.start_number(), number);
        assert_eq!(start.outcome(configure), Err(Refusal::NotAuthenticated));
        assert!(start.order_signed(Command::Stop).is_ok());
    }
}

#[test]
fn every_start_has_another_number_and_commands_write_none() {
    let mut start = guarded(blank(), blank()).restarted_with_key().restarted_with_key();
    assert_eq!(start.start_number(), 3);
    let before = start.places_now();
    for command in [Command::Configure(BENCH_B), Command::ClearTrip, Command::Stop] {
        assert!(start.order_signed(command).is_ok(), "{command:?}");
    }
    assert!(start.places_now() == before, "flash is not written during a run");
}

#[test]
fn no_damage_of_a_record_brings_a_number_of_an_earlier_start_back() {
    let mut start = guarded(blank(), blank());
    // Both halves of 80 records are filled, and the first one a second time.
    for number in 1..200 {
        let used = start.start_number();
        assert_eq!(used, number);
        let [slots, places] = start.service.stores.into_memories();
        let every_tenth = number % 10 == 0;
        for (place, bit) in (0..places.bytes.len()).step_by(256).zip((0..8).cycle()).filter(|_| every_tenth) {
            let mut damaged = Flash { bytes: places.bytes.clone(), is_worn: false };
            damaged.bytes[place + 8 + bit] ^= 1 << bit;
            let mut next = guarded(blank(), damaged);
            assert!(next.start_number() > used, "record at {place}, start {used}");
        }
        start = guarded(slots, places);
    }
}

#[test]
fn no_command_is_executed_while_the_number_of_the_start_cannot_be_kept() {
    let mut start = guarded(blank(), Flash { is_worn: true, ..blank() });
    assert_eq!(start.order_signed(Command::Configure(BENCH_B)), Err(Refusal::NotKept));
    assert!(!start.shared.is_running());
}

#[test]
fn a_configuration_is_kept_beside_the_number_of_the_start() {
    let mut start = guarded(blank(), blank());
    for command in [Command::Configure(BENCH_B), Command::Stop, Command::Keep] {
        assert!(start.order_signed(command).is_ok(), "{command:?}");
    }
    let mut next = start.restarted_with_key();
    assert_eq!((next.kept(), next.start_number()), (KeptConfiguration::Restored, 2));
}

#[test]
fn an_update_begins_only_with_the_permitted_package_and_once() {
    let mut start = guarded(blank(), blank());
    let (ours, theirs) =
        (Package::new(BearingMaterial::Babbitt, 9), Package::new(BearingMaterial::Babbitt, 10));
    let refused = UpdateAnswer::Refused(UpdateRefusal::NotPermitted);
    assert_eq!(start.update(ours.begin()), refused);
    assert_eq!(start.service.stores.packages.status().slots, [SlotState::Blank; 2]);
    let permit = start.signed(Command::PermitUpdate(ours.signed.hash()));
    assert_eq!(start.outcome(permit), Ok(Answer::UpdatePermitted));
    assert_eq!(start.update(theirs.begin()), refused);
    assert_eq!(start.update(UpdateRequest::Finish), UpdateAnswer::Refused(UpdateRefusal::NotBegun));
    // An end that comes too early, from others perhaps, does not end the permission.
    start.update(ours.begin());
    let unfinished = UpdateAnswer::Refused(UpdateRefusal::Unfinished { next_offset: 0 });
    assert_eq!(start.update(UpdateRequest::Finish), unfinished);
    start.install(&ours);
    // The repetition of the last command permits nothing.
    assert_eq!(start.outcome(permit), Ok(Answer::UpdatePermitted));
    assert_eq!(start.update(ours.begin()), refused);
    assert_eq!(start.update(ours.chunk(0)), refused);
    assert_eq!(start.update(UpdateRequest::Finish), refused);
    assert_eq!(start.update(UpdateRequest::Abort), refused);
    assert_eq!(start.update(theirs.begin()), refused);
    // A permission does not outlast its start.
    start = start.restarted_with_key();
    assert!(start.order_signed(Command::PermitUpdate(theirs.signed.hash())).is_ok());
    start = start.restarted_with_key();
    assert_eq!(start.update(theirs.begin()), refused);
    assert_eq!(start.outcome(permit), Err(Refusal::NotAuthenticated));
}

#[test]
fn an_update_that_was_given_up_for_another_one_or_has_failed_needs_a_new_permission() {
    let mut start = guarded(blank(), blank());
    let (ours, other) =
        (Package::new(BearingMaterial::Babbitt, 9), Package::new(BearingMaterial::Babbitt, 10));
    assert!(start.order_signed(Command::PermitUpdate(ours.signed.hash())).is_ok());
    start.update(ours.begin());
    assert!(start.order_signed(Command::PermitUpdate(other.signed.hash())).is_ok());
    let not_begun = UpdateAnswer::Refused(UpdateRefusal::NotBegun);
    assert_eq!(start.update(UpdateRequest::Finish), not_begun);
    // A foreign chunk spoils the update, which then cannot be begun again without a command.
    start.update(other.begin());
    start.update(ours.chunk(0));
    for offset in other.offsets() {
        start.update(other.chunk(offset));
    }
    assert_eq!(start.update(UpdateRequest::Finish), UpdateAnswer::Refused(UpdateRefusal::Hash));
    let refused = UpdateAnswer::Refused(UpdateRefusal::NotPermitted);
    assert_eq!(start.update(other.begin()), refused);
    assert!(start.order_signed(Command::PermitUpdate(other.signed.hash())).is_ok());
    start.install(&other);
}

#[test]
fn without_a_key_nothing_is_required_and_tags_are_ignored() {
    let mut start = fixture(Pacing::Timer, blank());
    start.restore();
    assert_eq!(start.shared.session.hello(0).authentication, Authentication::Open);
    let numbered = NumberedCommand { id: 1, command: Command::Configure(BENCH_B) };
    assert!(start.outcome(ToController::Authenticated(numbered, Tag::default())).is_ok());
    start.order(Command::Stop);
    let package = Package::new(BearingMaterial::Babbitt, 9);
    assert_eq!(start.order(Command::PermitUpdate(package.signed.hash())), Answer::UpdatePermitted);
    start.install(&package);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn a_flipped_bit_of_a_command_or_its_tag_is_refused(
        bit in 0..128_usize, in_tag: bool, period in 51..900_u32,
    ) {
        let mut start = guarded(blank(), blank());
        let mut configuration = BENCH_B;
        configuration.bench.sample_period_us = period;
        let ToController::Authenticated(mut numbered, mut tag) =
            start.signed(Command::Configure(configuration)) else { unreachable!() };
        if in_tag {
            tag.0[bit / 8] ^= 1 << (bit % 8);
        } else {
            configuration.bench.sample_period_us ^= 1 << (bit % 32);
            numbered.command = Command::Configure(configuration);
        }
        let message = ToController::Authenticated(numbered, tag);
        prop_assert_eq!(start.outcome(message), Err(Refusal::NotAuthenticated));
    }
}
