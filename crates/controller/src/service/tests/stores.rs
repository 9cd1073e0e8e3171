//! Kept configuration and kept requirements on packages, across restarts.

use super::*;

#[test]
fn a_saved_configuration_is_restored_at_the_next_start() {
    let mut first = fixture(Pacing::Timer, blank());
    first.order(Command::Configure(BENCH_B));
    first.order(Command::Stop);
    assert_eq!(first.order(Command::Keep), Answer::Kept);
    let mut second = fixture(Pacing::Timer, first.places());
    assert!(!second.shared.is_running());
    second.restore();
    assert!(second.shared.is_running());
    assert_eq!(second.order(Command::GetConfiguration), Answer::Configuration(Some(BENCH_B)));
    assert_eq!(second.kept(), KeptConfiguration::Restored);
}

/// Memory with a kept configuration.
fn with_configuration() -> Flash {
    let mut fixture = fixture(Pacing::Timer, blank());
    fixture.order(Command::Configure(BENCH_B));
    fixture.order(Command::Stop);
    assert_eq!(fixture.order(Command::Keep), Answer::Kept);
    fixture.places()
}

/// A start after some faulted ones.
fn start_after(faulted: u8, places: Flash) -> Fixture {
    let mut start = fixture(Pacing::Timer, places);
    start.board.watch.set(StartWatch { faulted, is_watched: false });
    start.restore();
    start
}

#[test]
fn a_configuration_with_which_three_starts_faulted_is_set_aside_until_the_host_keeps_one() {
    let mut places = with_configuration();
    for faulted in 0..MAX_FAULTED_STARTS {
        let start = start_after(faulted, places);
        assert!(start.shared.is_running(), "{faulted}");
        assert_eq!(start.kept(), KeptConfiguration::Restored);
        assert_eq!(start.board.watch.get(), StartWatch { faulted, is_watched: true });
        places = start.places();
    }
    let faulted = MAX_FAULTED_STARTS;
    let mut start = start_after(faulted, places);
    assert!(!start.shared.is_running());
    assert_eq!(start.kept(), KeptConfiguration::SetAside { faulted_starts: faulted });
    // It remains set aside, however long this start runs.
    start.board.uptime_us = FAULTLESS_US;
    start.order(Command::Configure(BENCH_B));
    start.order(Command::Stop);
    assert_eq!(start.board.watch.get(), StartWatch { faulted, is_watched: false });
    assert_eq!(start.order(Command::Keep), Answer::Kept);
    assert_eq!(start.board.watch.get(), StartWatch::default());
}

#[test]
fn a_start_that_has_run_for_a_minute_has_not_faulted() {
    let mut start = start_after(2, with_configuration());
    let watched = StartWatch { faulted: 2, is_watched: true };
    for (uptime_us, expected) in [(FAULTLESS_US - 1, watched), (FAULTLESS_US, StartWatch::default())] {
        start.board.uptime_us = uptime_us;
        start.order(Command::GetCounters);
        assert_eq!(start.board.watch.get(), expected);
    }
}

#[test]
fn a_fault_with_another_configuration_does_not_count_against_the_kept_one() {
    let mut start = start_after(2, with_configuration());
    start.order(Command::Configure(BENCH_B));
    assert_eq!(start.board.watch.get(), StartWatch { faulted: 2, is_watched: false });
}

#[test]
fn a_start_without_a_kept_configuration_is_not_watched() {
    let mut start = start_after(0, blank());
    start.order(Command::Configure(BENCH_B));
    assert_eq!((start.kept(), start.board.watch.get()), (KeptConfiguration::None, StartWatch::default()));
}

impl Fixture {
    fn places(self) -> Flash {
        let [_, places] = self.service.stores.into_memories();
        places
    }

    fn restarted(self) -> Self {
        let [slots, places] = self.service.stores.into_memories();
        let mut next = fixture_with(Pacing::Timer, slots, places);
        next.restore();
        next
    }

    pub(super) fn update(&mut self, request: UpdateRequest) -> UpdateAnswer {
        match self.ask(ToController::Update(request))[..] {
            [ToHost::Update(answer)] => answer,
            ref other => panic!("{other:?}"),
        }
    }

    pub(super) fn install(&mut self, package: &Package) {
        self.update(package.begin());
        for offset in package.offsets() {
            self.update(package.chunk(offset));
        }
        let answer = self.update(UpdateRequest::Finish);
        assert!(matches!(answer, UpdateAnswer::Status(_)), "{answer:?}");
    }
}

#[test]
fn the_minimum_version_is_kept_beside_the_configuration_and_outlasts_its_slot() {
    let mut start = fixture(Pacing::Timer, with_configuration());
    start.install(&Package::new(BearingMaterial::Babbitt, 9));
    let older = Package::new(BearingMaterial::Babbitt, 2);
    start.install(&older.signed_anew(|manifest| manifest.may_be_older = true));
    // It erases the slot of version 9, and is never finished.
    start.update(Package::new(BearingMaterial::Babbitt, 10).begin());
    let mut next = start.restarted().restarted();
    assert_eq!(next.kept(), KeptConfiguration::Restored);
    let refusal = UpdateRefusal::Version { found: 3, least: 10 };
    let attack = Package::new(BearingMaterial::Babbitt, 3);
    assert_eq!(next.update(attack.begin()), UpdateAnswer::Refused(refusal));
}

#[test]
fn no_update_erases_a_slot_whose_requirements_cannot_be_kept() {
    let mut start = fixture_with(Pacing::Timer, blank(), Flash { is_worn: true, ..blank() });
    start.install(&Package::new(BearingMaterial::Babbitt, 9));
    let expected = UpdateAnswer::Refused(UpdateRefusal::Flash(FlashOperation::Program));
    let next = Package::new(BearingMaterial::Babbitt, 10);
    assert_eq!(start.update(next.begin()), expected);
    assert_eq!(start.service.stores.packages.status().refused, 1);
    assert_eq!(start.service.stores.packages.status().slots[1], SlotState::Blank);
}
