//! The same recipe gives the same bytes, whatever the number of threads.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::Bearing;
use model_quant::checkpoint::Checkpoint;
use model_quant::mode::{Mode, Packing, Plan};
use model_quant::pipeline::train_both;
use model_quant::quantise::quantise;
use model_quant::recipe::Recipe;

fn small() -> Recipe {
    Recipe {
        rows: 3000,
        validation_rows: 500,
        epochs: 3,
        grid_epochs: 3,
        ..Recipe::standard(Bearing::Plastic)
    }
}

fn train(threads: usize) -> (Vec<u8>, Vec<f64>) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let mut losses = Vec::new();
    let checkpoint = pool.install(|| {
        train_both(Bearing::Plastic, &small(), &mut |_, progress| losses.push(progress.validation_loss))
    });
    (checkpoint.to_bytes().expect("bytes"), losses)
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
    // It did learn something, of both networks: the last loss is well below the first.
    for network in losses.chunks(losses.len() / 2) {
        assert!(network[network.len() - 1] < 0.5 * network[0], "{network:?}");
    }
}

#[test]
fn another_seed_gives_other_weights() {
    let recipe = |seed| Recipe { seed, epochs: 1, grid_epochs: 0, ..small() };
    let train = |seed| train_both(Bearing::Plastic, &recipe(seed), &mut |_, _| ()).collision.float;
    assert_ne!(train(1), train(2));
}
