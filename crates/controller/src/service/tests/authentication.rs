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

    fn start_number(&self) -> u32 {
        match self.shared.session.hello(0).authentication {
            Authentication::Required { start, tag } if KEY.accepts_start(start, &tag) => start,
            other => panic!("{other:?}"),
        }
    }

    /// The next command with its tag.
    fn signed(&self, command: Command) -> ToController {
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
fn commands_without_a_valid_tag_change_nothing_and_questions_are_answered() {
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
    assert_eq!(start.service.stores.last_start(), 0, "nothing is written for an attack");
    assert_eq!(start.order(Command::GetConfiguration), Answer::Configuration(None));
    assert!(matches!(start.order(Command::GetCounters), Answer::Counters(_)));
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
fn a_start_without_an_executed_command_leaves_its_number_to_the_next_one() {
    let start = guarded(blank(), blank()).restarted_with_key().restarted_with_key();
    assert_eq!(start.start_number(), 1);
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
    let next = start.restarted_with_key();
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
    start.install(&ours);
    assert_eq!(start.update(ours.begin()), refused);
    assert_eq!(start.update(theirs.begin()), refused);
    // A permission does not outlast its start.
    start = start.restarted_with_key();
    assert!(start.order_signed(Command::PermitUpdate(theirs.signed.hash())).is_ok());
    start = start.restarted_with_key();
    assert_eq!(start.update(theirs.begin()), refused);
    assert_eq!(start.outcome(permit), Err(Refusal::NotAuthenticated));
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
