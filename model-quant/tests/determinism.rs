//! Tests that the same recipe gives the same bytes on any number of threads.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::BearingMaterial;
use model_quant::data::draw::{Draw, Purpose};
use model_quant::network::NetworkKind;
use model_quant::network::checkpoint::Checkpoint;
use model_quant::network::checkpoint::Trained;
use model_quant::network::recipe::{GridMethod, Recipe, TrainingSet};
use model_quant::quantise::mode::{Mode, Packing, Plan};
use model_quant::quantise::quantise;
use model_quant::train::pipeline::{TrainError, train_both};
use model_quant::train::sources::Sources;
use model_quant::train::{Loss, Progress, Source, StateError, Training, Windows};
use std::ops::ControlFlow;

fn small() -> Recipe {
    Recipe {
        rows: 3000,
        validation_rows: 500,
        epochs: 3,
        grid_epochs: 3,
        ..Recipe::standard(BearingMaterial::Plastic)
    }
}

fn train(threads: usize) -> (Vec<u8>, Vec<f64>) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let mut losses = Vec::new();
    let mut report = |_, progress: Progress| {
        losses.push(progress.validation_loss);
        ControlFlow::Continue(())
    };
    let outcome =
        pool.install(|| train_both(BearingMaterial::Plastic, &small(), None, &mut report)).expect("training");
    (outcome.checkpoint.to_bytes().expect("bytes"), losses)
}

#[test]
fn the_receiver_of_the_reports_can_end_a_training() {
    let mut epochs = 0;
    let mut report = |_, progress: Progress| {
        epochs = progress.epoch;
        if epochs == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let ended = train_both(BearingMaterial::Plastic, &small(), None, &mut report);
    assert!(matches!(ended, Err(TrainError::Ended)) && epochs == 2);
}

#[test]
fn training_and_quantising_do_not_depend_on_the_number_of_threads() {
    let (one, losses) = train(1);
    for threads in [2, 5] {
        assert_eq!(train(threads), (one.clone(), losses.clone()), "{threads} threads");
    }
    let checkpoint = Checkpoint::from_bytes(&one).expect("checkpoint");
    let id = Checkpoint::training_id(&one);
    for mode in Mode::ALL {
        let image =
            || quantise(&checkpoint, id, Plan { mode, packing: Packing::Speed }).expect("image").image;
        assert_eq!(image(), image());
    }
    // Both networks learn: the last loss is far below the first.
    for network in losses.chunks(losses.len() / 2) {
        assert!(network[network.len() - 1] < 0.5 * network[0], "{network:?}");
    }
}

#[test]
fn another_seed_gives_other_weights() {
    let recipe = |seed| Recipe { seed, epochs: 1, grid_epochs: 0, ..small() };
    let train = |seed| {
        let outcome =
            train_both(BearingMaterial::Plastic, &recipe(seed), None, &mut |_, _| ControlFlow::Continue(()))
                .expect("training");
        outcome.checkpoint.collision.float
    };
    assert_ne!(train(1), train(2));
}

/// Trains some epochs, saves the state and continues from it.
fn in_two_parts(recipe: &Recipe, first: usize) -> Trained {
    let sources = Sources::new(BearingMaterial::Plastic, recipe);
    let (rows, validation) = sources.parts_for(NetworkKind::Collision);
    let start = || {
        let parts: (&dyn Source, &dyn Source) = (&rows, &validation);
        Training::new(recipe, NetworkKind::Collision.shape(), parts, Loss::Clamped, 0)
    };
    let mut training = start();
    for _ in 0..first {
        training.epoch();
    }
    let bytes = training.to_bytes().expect("bytes");
    let mut training = start();
    training.resume_from(&bytes).expect("state");
    assert_eq!(training.history().len(), first);
    while !training.is_done() {
        training.epoch();
    }
    training.finish()
}

#[test]
fn a_resumed_training_gives_the_same_bytes_and_the_full_set_continues_the_drawn_one() {
    for grid_method in [GridMethod::Freeze, GridMethod::Exact, GridMethod::ExactFreeze] {
        let recipe = Recipe { rows: 2000, grid_method, ..small() };
        let uninterrupted = in_two_parts(&recipe, 0);
        for first in [1, 3, 4, 6] {
            assert_eq!(
                in_two_parts(&recipe, first),
                uninterrupted,
                "{grid_method:?}, stopped after {first} epochs"
            );
        }
    }
    let full = Recipe { set: TrainingSet::Full, ..small() };
    let sources = Sources::new(BearingMaterial::Plastic, &full);
    let (rows, validation) = sources.parts_for(NetworkKind::Collision);
    assert_eq!((rows.count(), validation.count()), (10_000_000, 500));
    let drawn = Recipe { rows: 60, ..small() };
    let in_memory = Sources::new(BearingMaterial::Plastic, &drawn);
    let window = |part: &dyn Source| {
        let mut windows = Windows::default();
        part.add(57, &mut Draw::new(1, Purpose::Histories, 0), &mut windows);
        windows.columns
    };
    assert_eq!(
        window(&rows),
        window(&in_memory.parts_for(NetworkKind::Collision).0),
        "row for row those of the drawn set"
    );
}

#[test]
fn a_state_of_another_training_is_refused() {
    let recipe = Recipe { rows: 1000, ..small() };
    let sources = Sources::new(BearingMaterial::Plastic, &recipe);
    let (rows, validation) = sources.parts_for(NetworkKind::Collision);
    let parts: (&dyn Source, &dyn Source) = (&rows, &validation);
    let mut training = Training::new(&recipe, NetworkKind::Collision.shape(), parts, Loss::Clamped, 0);
    training.epoch();
    let bytes = training.to_bytes().expect("bytes");
    for length in (0..bytes.len()).step_by(509) {
        assert!(training.resume_from(&bytes[..length]).is_err(), "{length} bytes");
    }
    for at in (0..bytes.len()).step_by(257) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 4;
        assert!(training.resume_from(&damaged).is_err(), "byte {at}");
    }
    let other = Recipe { seed: 3, ..recipe.clone() };
    let mut training = Training::new(&other, NetworkKind::Collision.shape(), parts, Loss::Clamped, 0);
    assert!(matches!(training.resume_from(&bytes), Err(StateError::Other { .. })));
}

#[test]
fn without_improvement_the_free_epochs_end_and_the_best_weights_are_returned() {
    let recipe = Recipe { rows: 512, epochs: 60, patience: Some(2), learning_rate: 0.05, ..small() };
    let outcome = train_both(BearingMaterial::Plastic, &recipe, None, &mut |_, _| ControlFlow::Continue(()))
        .expect("training");
    for epochs in &outcome.histories {
        let free: Vec<f64> = epochs.iter().filter(|e| !e.on_grid).map(|e| e.validation_loss).collect();
        assert!((3..60).contains(&free.len()), "{} epochs", free.len());
        let best = free.iter().copied().fold(f64::INFINITY, f64::min);
        assert_eq!(free[free.len() - 3], best, "two epochs after the best one it ends");
        assert_eq!(epochs.len(), free.len() + recipe.grid_epochs);
    }
}
