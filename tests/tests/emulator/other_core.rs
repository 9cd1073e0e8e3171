//! The image for another core (Cortex-M33, `cargo xtask firmware --board mps2-an505`) computes the
//! same bits as the host.

use crate::batch;
use crate::frames::{configuration, disturbed_frames};
use crate::update::package_for;
use controller::{Identity, NoTicks, Session};
use host_sim::controller::EmulatedController;
use inference::BearingMaterial;
use link::track::SensorStatus;
use link::update::{SlotState, UpdateAnswer, UpdateRefusal, UpdateRequest};
use link::{BuildId, ClockSource, Command, EstimateFrame, NumberedCommand, Target, ToController, ToHost};
use model_package::board;
use object::{Object, ObjectSymbol};
use std::path::PathBuf;

fn image() -> PathBuf {
    let default = EmulatedController::default_elf();
    let target_folder = default.ancestors().nth(3).unwrap();
    target_folder.join("thumbv8m.main-none-eabihf/firmware/estimator")
}

fn estimates(received: &[ToHost]) -> Vec<EstimateFrame> {
    let estimate = |message: &ToHost| match message {
        ToHost::Estimate(numbered) => Some(numbered.estimate),
        _ => None,
    };
    received.iter().filter_map(estimate).collect()
}

#[test]
fn another_core_estimates_the_same_bits() {
    for (bearing, seed) in [(BearingMaterial::Babbitt, 4), (BearingMaterial::Plastic, 5)] {
        let configuration = configuration(bearing);
        let configure = NumberedCommand { id: 1, command: Command::Configure(configuration) };
        let frames = disturbed_frames(&configuration, 5_000, seed);
        let sensors = frames.iter().map(|frame| ToController::Sensor(*frame, SensorStatus::GOOD));
        let messages: Vec<_> = std::iter::once(ToController::Command(configure)).chain(sensors).collect();
        let (status, received) = batch::run("mps2-an505", &image(), "", &[], &messages);
        assert!(status.success(), "{status}");
        let on_target = estimates(&received);

        let build_id = BuildId::new("host");
        let identity =
            Identity { build_id, target: Target::Native, clock: ClockSource::Host, core_hz: 168_000_000 };
        let mut session = Session::new(identity);
        let answers: Vec<_> = messages.iter().map(|message| session.handle(message, &mut NoTicks)).collect();
        let on_host = estimates(&answers);
        assert_eq!((on_host.len(), on_target.len()), (frames.len(), frames.len()));
        for (on_host, on_target) in on_host.iter().zip(&on_target) {
            assert!(on_host.same_bits(on_target), "host {on_host:?}\nmps2-an505 {on_target:?}");
        }
        assert!(on_host.iter().filter(|estimate| estimate.normal_force_n > 0.0).count() > 500, "{bearing:?}");
    }
}

#[test]
fn it_accepts_packages_for_its_board_and_refuses_and_records_others() {
    let [other, own] =
        [board::STM32F405, board::MPS2_AN505].map(|board| package_for(board, 3, BearingMaterial::Plastic));
    let requests = [
        UpdateRequest::Begin(other.signed),
        UpdateRequest::Refusals { index: 0 },
        UpdateRequest::Begin(own.signed),
    ];
    let (status, received) = batch::run("mps2-an505", &image(), "", &[], &requests.map(ToController::Update));
    assert!(status.success(), "{status}");
    let answers = received.iter().filter_map(|message| match message {
        ToHost::Update(answer) => Some(*answer),
        _ => None,
    });
    let answers: Vec<_> = answers.collect();
    let reason = UpdateRefusal::Board { found: board::STM32F405, expected: board::MPS2_AN505 };
    assert_eq!(answers[0], UpdateAnswer::Refused(reason));
    let UpdateAnswer::Record(Some(record)) = answers[1] else { panic!("{answers:?}") };
    assert_eq!((record.version, record.reason), (3, reason));
    let UpdateAnswer::Status(begun) = answers[2] else { panic!("{answers:?}") };
    assert_eq!((begun.refused, begun.last_refusal), (1, Some(record)));
    assert!(
        begun.receiving.is_some() && begun.slots == [SlotState::Unfinished, SlotState::Blank],
        "{begun:?}"
    );
}

#[test]
fn no_panic_is_reachable_on_the_other_core() {
    let bytes = std::fs::read(image()).unwrap();
    let file = object::File::parse(&*bytes).unwrap();
    let names: Vec<_> = file.symbols().filter_map(|symbol| symbol.name().ok()).collect();
    assert!(names.contains(&"Reset") && !names.contains(&"PINTLE_PANIC_MARKER"));
}
