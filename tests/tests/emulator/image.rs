//! Identity of the image, and the absence of a panic.

use crate::frames::configuration;
use host_sim::controller::{Controller, EmulatedController};
use inference::{BearingMaterial, Model, shipped};
use link::{ClockSource, MAGIC, ModelId, PROTOCOL_VERSION, Target};
use object::{Object, ObjectSymbol};

#[test]
fn the_hello_frame_names_the_emulator_and_the_shipped_models() {
    let elf = EmulatedController::default_elf();
    let controller = EmulatedController::start(configuration(BearingMaterial::Plastic), &elf).unwrap();
    let hello = controller.hello();
    assert_eq!((hello.magic, hello.protocol), (MAGIC, PROTOCOL_VERSION));
    assert_eq!(hello.target, Target::Emulator);
    assert_eq!(hello.clock, ClockSource::Internal, "the emulator has no PLL to bring up");
    assert_eq!(usize::from(hello.window), inference::WINDOW);
    assert!(!hello.build_id.as_str().is_empty());
    let shipped = BearingMaterial::ALL.map(|bearing| {
        let model: Model = Model::load(shipped(bearing)).unwrap();
        ModelId { crc: model.checksum(), training_id: model.header().training_id }
    });
    assert_eq!(hello.models[..shipped.len()], shipped);
}

#[test]
fn no_panic_is_reachable_in_the_image() {
    let bytes = std::fs::read(EmulatedController::default_elf()).unwrap();
    let image = object::File::parse(&*bytes).unwrap();
    let names: Vec<_> = image.symbols().filter_map(|symbol| symbol.name().ok()).collect();
    // The image has symbols, so that the absence of one is significant.
    assert!(names.contains(&"Reset") && names.contains(&"main"), "{} symbols", names.len());
    assert!(!names.contains(&"PINTLE_PANIC_MARKER"));
}
