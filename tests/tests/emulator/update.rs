//! The emulated controller accepts a model package over the link while it estimates, and rejects
//! others.

use crate::frames::{configuration, disturbed_frames};
use controller::store::{Loaded, Models};
use controller::{Identity, NoTicks, Session};
use ed25519_dalek::SigningKey;
use host_sim::controller::{Controller, EmulatedController, RemoteController};
use host_sim::device::update::{Ask, refusals, runs, update};
use inference::{BearingMaterial, shipped};
use link::track::SensorStatus;
use link::update::{ModelMemory, ModelSource, UpdateAnswer, UpdateRefusal, UpdateRequest};
use link::{BuildId, ClockSource, EstimateFrame, SensorFrame, Target, ToController, ToHost};
use model_quant::exchange::package::{Package, PackageProperties};
use model_quant::quantise::image::AlignedImage;
use std::path::Path;

const BOARD: u16 = model_package::board::STM32F405;

/// Returns the shipped networks with one bias of the first layer changed: another valid model.
fn other_image(bearing: BearingMaterial) -> AlignedImage {
    let mut image = shipped(bearing).to_vec();
    for (byte, new) in image.iter_mut().skip(64 + 12).zip(12_345_i32.to_le_bytes()) {
        *byte = new;
    }
    inference::image::write::seal(&mut image);
    AlignedImage::copy(&image)
}

fn development_key() -> SigningKey {
    model_quant::exchange::key::parse(model_quant::exchange::key::DEVELOPMENT).unwrap()
}

pub(crate) fn package(version: u32, bearing: BearingMaterial) -> Package {
    package_for(BOARD, version, bearing)
}

pub(crate) fn package_for(board: u16, version: u32, bearing: BearingMaterial) -> Package {
    let purpose = PackageProperties { board, version, may_be_older: false, revokes_older_keys: false };
    Package::new(purpose, &[other_image(bearing)], &development_key()).unwrap()
}

fn start() -> RemoteController {
    EmulatedController::start(configuration(BearingMaterial::Babbitt), &EmulatedController::default_elf())
        .unwrap()
}

/// Returns the same firmware in this process.
fn native() -> Session {
    let build_id = BuildId::new("test");
    let identity = Identity { build_id, target: Target::Emulator, clock: ClockSource::Host, core_hz: 0 };
    let mut session = Session::new(identity);
    session.configure(&configuration(BearingMaterial::Babbitt)).unwrap();
    session
}

fn estimate(session: &mut Session, frame: &SensorFrame) -> EstimateFrame {
    match session.handle(&ToController::Sensor(*frame, SensorStatus::GOOD), &mut NoTicks) {
        ToHost::Estimate(numbered) => numbered.estimate,
        other => panic!("{other:?}"),
    }
}

fn models(package: &Package) -> Models {
    let package = Box::leak(Box::new(package.clone()));
    let checked: [Option<Loaded>; BearingMaterial::COUNT] =
        model_package::check(&package.manifest, &package.payload).unwrap();
    Models::of_package(checked, ModelSource::BuiltIn)
}

/// A controller that gets a sample after every request: estimates continue during the update.
struct Beside<'a, 'f> {
    controller: &'a mut RemoteController,
    native: &'a mut Session,
    frames: std::slice::Iter<'f, SensorFrame>,
    package: &'a Package,
    switched: bool,
    exchanged: u32,
}

impl Ask for Beside<'_, '_> {
    fn ask(&mut self, request: UpdateRequest) -> Result<UpdateAnswer, host_sim::controller::ControllerError> {
        let answer = self.controller.ask(request)?;
        if let UpdateAnswer::Status(status) = answer
            && runs(&status, self.package)
            && !self.switched
        {
            self.switched = true;
            self.native.switch_models(models(self.package));
        }
        let frame = self.frames.next().unwrap();
        let emulated = self.controller.exchange(frame)?;
        let expected = estimate(self.native, frame);
        assert!(emulated.same_bits(&expected), "sample {}: {emulated:?} {expected:?}", frame.sequence);
        self.exchanged += 1;
        Ok(answer)
    }
}

#[test]
fn estimates_continue_during_an_update_and_equal_those_of_the_new_model_after_it() {
    let frames = disturbed_frames(&configuration(BearingMaterial::Babbitt), 6000, 4);
    let package = package(7, BearingMaterial::Babbitt);
    let (mut controller, mut session) = (start(), native());
    let mut beside = Beside {
        controller: &mut controller,
        native: &mut session,
        frames: frames.iter(),
        package: &package,
        switched: false,
        exchanged: 0,
    };
    let updated = update(&mut beside, &package, |_| {}).unwrap();
    assert_eq!((updated.before.running, updated.repeated), (ModelSource::BuiltIn, 0));
    assert_eq!(updated.after.memory, ModelMemory::Volatile);
    assert!(beside.switched && beside.exchanged > package.payload.len() as u32 / 128);
    // All kinds of samples with the new model, which differs from the old one.
    let (mut differs, mut built_in) = (0, native());
    let rest = beside.frames.as_slice();
    for frame in rest {
        let emulated = controller.exchange(frame).unwrap();
        let expected = estimate(&mut session, frame);
        assert!(emulated.same_bits(&expected), "sample {}", frame.sequence);
        differs += u32::from(!emulated.same_bits(&estimate(&mut built_in, frame)));
    }
    assert!(differs > 500, "{differs} of {}", rest.len());
    Box::new(controller).finish().unwrap();
}

#[test]
fn packages_that_are_unsigned_corrupted_older_or_for_another_board_are_refused_and_recorded() {
    let mut controller = start();
    let good = package(7, BearingMaterial::Plastic);
    update(&mut controller, &good, |_| {}).unwrap();
    let refused =
        |controller: &mut RemoteController, package: &Package| match update(controller, package, |_| {}) {
            Err(host_sim::device::update::UpdateError::Refused(reason)) => reason,
            other => panic!("{other:?}"),
        };
    let mut unsigned = package(8, BearingMaterial::Plastic);
    unsigned.signed.signature = [[0; 32]; 2];
    assert_eq!(refused(&mut controller, &unsigned), UpdateRefusal::Signature);
    let foreign = Package::new(
        PackageProperties { board: BOARD, version: 8, may_be_older: false, revokes_older_keys: false },
        &[other_image(BearingMaterial::Plastic)],
        &SigningKey::from_bytes(&[3; 32]),
    );
    assert_eq!(refused(&mut controller, &foreign.unwrap()), UpdateRefusal::Signature);
    let older = package(6, BearingMaterial::Babbitt);
    assert_eq!(refused(&mut controller, &older), UpdateRefusal::Version { found: 6, least: 8 });
    let other_board = Package::new(
        PackageProperties { board: 0x2350, version: 8, may_be_older: false, revokes_older_keys: false },
        &[other_image(BearingMaterial::Plastic)],
        &development_key(),
    );
    let expected = UpdateRefusal::Board { found: 0x2350, expected: BOARD };
    assert_eq!(refused(&mut controller, &other_board.unwrap()), expected);
    // Corrupted after signing: detected when the package is complete.
    let mut corrupted = package(8, BearingMaterial::Plastic);
    corrupted.payload.bytes_mut()[4000] ^= 1;
    assert!(update(&mut controller, &corrupted, |_| {}).is_err());
    let reasons: Vec<_> = refusals(&mut controller).unwrap().iter().map(|record| record.reason).collect();
    assert!(reasons.starts_with(&[UpdateRefusal::Hash]), "{reasons:?}");
    assert!(reasons.contains(&expected) && reasons.contains(&UpdateRefusal::Signature), "{reasons:?}");
    // The accepted model still runs.
    let UpdateAnswer::Status(status) = controller.ask(UpdateRequest::Status).unwrap() else {
        panic!("no status")
    };
    assert!(runs(&status, &good));
    assert_eq!(usize::from(status.refused.min(8)), reasons.len());
}

#[test]
fn an_interrupted_update_is_continued() {
    struct Breaks<'a>(&'a mut RemoteController, u32);
    impl Ask for Breaks<'_> {
        fn ask(
            &mut self,
            request: UpdateRequest,
        ) -> Result<UpdateAnswer, host_sim::controller::ControllerError> {
            self.1 = self.1.saturating_sub(1);
            if self.1 == 0 {
                let cause = "The cable was pulled.";
                return Err(host_sim::controller::ControllerError::TimedOut {
                    waiting_for: "the models",
                    timeout_s: 5,
                    last_sequence: None,
                    cause,
                });
            }
            self.0.ask(request)
        }
    }
    let mut controller = start();
    let package = package(2, BearingMaterial::Babbitt);
    assert!(update(&mut Breaks(&mut controller, 30), &package, |_| {}).is_err());
    controller.ask(UpdateRequest::Abort).unwrap();
    let updated = update(&mut controller, &package, |_| {}).unwrap();
    // Written chunks are still in the slot; the last one is sent again.
    assert!(updated.resumed_at >= 20 * 128, "{updated:?}");
    let length = package.manifest.length().next_multiple_of(128);
    assert_eq!(updated.sent_bytes, length - updated.resumed_at);
}

#[test]
fn the_command_makes_a_package_s_model_run() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("test.package");
    std::fs::write(&file, package(3, BearingMaterial::Plastic).to_bytes()).unwrap();
    let arguments = |file: &Path| host_sim::commands::update::UpdateArgs {
        package: Some(file.into()),
        controller: host_sim::controller::choice::RemoteKind::Emulated,
        port: None,
        connection: host_sim::controller::choice::ConnectionOptions::default(),
        elf: None,
        stop_run: false,
        status: false,
        json: true,
    };
    host_sim::commands::update::run(&arguments(&file)).unwrap();
    std::fs::write(&file, b"no package").unwrap();
    let error = host_sim::commands::update::run(&arguments(&file)).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("10 bytes"), "{error}");
}
