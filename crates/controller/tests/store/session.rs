//! A session whose model is corrupted during a run, and one that continues with another model.

use crate::package::Package;
use controller::configuration::BENCH_B;
use controller::flags::HELD;
use controller::store::{Loaded, Models};
use controller::{Identity, NoTicks, Session};
use inference::{BearingMaterial, Flags, Model, shipped};
use link::track::SensorStatus;
use link::update::ModelSource;
use link::{BuildId, ClockSource, EstimateFrame, SensorFrame, Target, ToController, ToHost};

fn session() -> Session {
    let build_id = BuildId::new("test");
    let mut session =
        Session::new(Identity { build_id, target: Target::Native, clock: ClockSource::Host, core_hz: 0 });
    session.configure(&BENCH_B).unwrap();
    session
}

/// A journal that swings 30 um deep into the bearing at 10 Hz.
fn estimate(session: &mut Session, sequence: u32) -> EstimateFrame {
    let swing = (f64::from(sequence) * 1e-4 * 10.0 * core::f64::consts::TAU).sin();
    let frame = SensorFrame {
        sequence,
        time_us: sequence * 100,
        journal_y_nm: 500_000 + (swing * 30_000.0) as i32,
        shaft_angle_nrad: sequence as i32 * 10_000,
        ..SensorFrame::default()
    };
    match session.handle(&ToController::Sensor(frame, SensorStatus::GOOD), &mut NoTicks) {
        ToHost::Estimate(numbered) => numbered.estimate,
        other => panic!("{other:?}"),
    }
}

fn is_corrupted(estimate: &EstimateFrame) -> bool {
    Flags::from_bits(estimate.flags).contains(Flags::CORRUPTED)
}

/// Models with one bit flipped after they were loaded.
fn corrupted(bit: usize) -> Models {
    let mut image = shipped(BearingMaterial::Babbitt).to_vec();
    image[bit / 8] ^= 1 << (bit % 8);
    let loaded =
        Loaded { image: image.leak(), model: Model::load(shipped(BearingMaterial::Babbitt)).unwrap() };
    let mut package = [None; BearingMaterial::COUNT];
    package[0] = Some(loaded);
    Models::of_package(package, ModelSource::BuiltIn)
}

#[test]
fn a_corrupted_weight_is_flagged_within_two_rounds_reported_once_and_cleared_by_other_models() {
    let bytes = shipped(BearingMaterial::Babbitt).len();
    let round = bytes as u32 / 4;
    for bit in [0, 3 * 8 + 1, bytes / 2 * 8 + 5, bytes * 8 - 1] {
        let mut session = session();
        for sequence in 0..100 {
            assert!(!is_corrupted(&estimate(&mut session, sequence)));
        }
        session.switch_models(corrupted(bit));
        let noticed = (100..).find(|&sequence| is_corrupted(&estimate(&mut session, sequence))).unwrap();
        assert!(noticed - 100 < 2 * round, "bit {bit}: after {} samples", noticed - 100);
        assert!(session.take_model_corruption() && !session.take_model_corruption());
        // It stays flagged and held until an intact model is in use.
        assert!((1..=2 * round).all(|step| {
            let estimate = estimate(&mut session, noticed + step);
            is_corrupted(&estimate) && Flags::from_bits(estimate.flags).contains(HELD)
        }));
        session.switch_models(Models::built_in());
        let after = noticed + 2 * round;
        assert!((1..=3 * round).all(|step| !is_corrupted(&estimate(&mut session, after + step))));
        assert!(!session.take_model_corruption());
    }
}

#[test]
fn after_a_switch_the_networks_warm_up_and_the_estimate_continues() {
    let package = Package::new(BearingMaterial::Babbitt, 9);
    let words: Vec<u32> =
        package.payload.chunks_exact(4).map(|bytes| u32::from_le_bytes(bytes.try_into().unwrap())).collect();
    let payload: &'static [u8] = bytemuck::cast_slice(words.leak());
    let checked = model_package::check(&package.manifest, payload).unwrap();
    let (mut switched, mut other) = (session(), session());
    let hello = switched.hello(1).models;
    for sequence in 0..600 {
        assert!(estimate(&mut switched, sequence).same_bits(&estimate(&mut other, sequence)));
    }
    switched.switch_models(Models::of_package(checked, ModelSource::BuiltIn));
    assert_ne!(switched.hello(1).models[0], hello[0]);
    assert_eq!(switched.hello(1).models[1], hello[1]);
    for sequence in 600..1200 {
        let (with, without) = (estimate(&mut switched, sequence), estimate(&mut other, sequence));
        // The networks differ only in their name; while they warm up the law takes their place.
        let warming = Flags::from_bits(with.flags).contains(Flags::WARMING_UP);
        assert_eq!(warming, sequence < 600 + inference::WINDOW as u32 - 1, "sample {sequence}");
        let off_m = (with.deformation_m - without.deformation_m).abs();
        assert!(off_m < 0.5e-6, "sample {sequence}: {with:?} {without:?}");
    }
}
