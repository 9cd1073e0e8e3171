//! Tests of the shipped models: made from their checkpoints byte for byte, as accurate as their
//! cards state.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::{BearingMaterial, Flags, Model, Pair, shipped};
use model_quant::evaluate::bench_loop;
use model_quant::evaluate::layers::layer_errors;
use model_quant::evaluate::limits;
use model_quant::evaluate::verdict::Verdict;
use model_quant::evaluate::verify::add_held_out_errors;
use model_quant::evaluate::verify::verify;
use model_quant::network::checkpoint::Checkpoint;
use model_quant::network::float_pair::FloatPair;
use model_quant::network::recipe::Recipe;
use model_quant::network::shipped::shipped_checkpoint;
use model_quant::quantise::image::AnyModel;
use model_quant::quantise::mode::Plan;
use model_quant::quantise::quantise;
use model_quant::report::card::{Facts, card};

fn checkpoint(bearing: BearingMaterial) -> (Checkpoint, u64) {
    let bytes = shipped_checkpoint(bearing);
    (Checkpoint::from_bytes(bytes).expect("checkpoint"), Checkpoint::training_id(bytes))
}

fn verdicts(bearing: BearingMaterial) -> [Verdict; 2] {
    let (checkpoint, id) = checkpoint(bearing);
    verify(&checkpoint, id, shipped(bearing)).expect("shipped image")
}

#[test]
fn quantising_the_shipped_checkpoint_gives_the_shipped_image() {
    for bearing in BearingMaterial::ALL {
        let (checkpoint, id) = checkpoint(bearing);
        assert_eq!(checkpoint.recipe, Recipe::standard(bearing), "the default recipe made it");
        let image = quantise(&checkpoint, id, Plan::default()).expect("image").image;
        assert!(*image == *shipped(bearing), "{}: other bytes", bearing.name());
    }
}

#[test]
fn images_follow_the_laws_on_test_rows() {
    for bearing in BearingMaterial::ALL {
        for verdict in verdicts(bearing) {
            let name = format!("{} {}", verdict.bearing, verdict.network);
            assert!(verdict.r2_quantised > 0.999, "{name}: R^2 {}", verdict.r2_quantised);
            assert!(verdict.r2_float > 0.999, "{name}: R^2 of the float networks {}", verdict.r2_float);
            assert!(verdict.working_error_median < 0.01, "{name}: {}", verdict.working_error_median);
            // Friction has a further 2 %: relative errors below 1 mm/s, where friction goes to 0
            // with the speed.
            let limit = if verdict.network == "friction" { 0.05 } else { 0.03 };
            assert!(verdict.working_error_p95 < limit, "{name}: {}", verdict.working_error_p95);
            assert_eq!(verdict.zero_contact_output, 0.0, "{name}");
            assert!(verdict.saturated_share < 0.001, "{name}: {}", verdict.saturated_share);
            assert!(verdict.image_crc_ok && verdict.image_matches_checkpoint, "{name}");
        }
    }
}

#[test]
fn cards_have_the_figures_of_the_verification() {
    for bearing in BearingMaterial::ALL {
        let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/inference/models");
        let found = std::fs::read_to_string(format!("{models}/{}.md", bearing.name())).expect("card");
        let (checkpoint, id) = checkpoint(bearing);
        let plan = Plan::default();
        let quantised = quantise(&checkpoint, id, plan).expect("image");
        let model = AnyModel::load(shipped(bearing)).expect("image");
        let sum = shipped(bearing).last_chunk::<4>().map_or(0, |sum| u32::from_le_bytes(*sum));
        let expected = card(&Facts {
            checkpoint: &checkpoint,
            plan,
            header: &model.header(),
            image: shipped(bearing),
            verdicts: &add_held_out_errors(verdicts(bearing), &checkpoint, model).expect("bench"),
            layers: &layer_errors(&checkpoint, &quantised, plan).expect("layers"),
            limits: &limits::measure(model).expect("bench"),
            bench_loop: bench_loop::for_image(&bench_loop::shipped().expect("measurements"), sum),
        });
        assert_eq!(found, expected, "{}: run `model-quant quantize`", bearing.name());
    }
}

#[test]
fn friction_opposes_the_sliding_and_is_odd_in_both_chains() {
    for bearing in BearingMaterial::ALL {
        let mut image: Pair = Pair::new(Model::load(shipped(bearing)).expect("image"));
        let mut float = FloatPair::new(bearing).expect("checkpoint");
        let state = |speed| inference::ContactState {
            radial_clearance_m: 0.5e-3,
            deformation_m: 4e-5,
            deformation_rate_m_s: 1e-4,
            approach_speed_m_s: 0.0,
            sliding_speed_m_s: speed,
        };
        for speed in [1e-4, 3e-3, 0.05, 0.2] {
            let settle = |speed| {
                let mut image = image.clone();
                let mut float = float.clone();
                for _ in 0..20 {
                    image.push(&state(speed));
                    float.push(&state(speed));
                }
                let (image, float) = (image.push(&state(speed)), float.push(&state(speed)));
                [
                    (image.normal_force_n(), image.friction_force_n(), image.flags),
                    (float.normal_force_n, float.friction_force_n, float.flags),
                ]
            };
            for (forward, backward) in settle(speed).into_iter().zip(settle(-speed)) {
                assert!(forward.1 < 0.0, "{speed}");
                assert_eq!(forward.1, -backward.1, "{speed}");
                assert_eq!(forward.0, backward.0);
                assert!(!forward.2.intersects(Flags::OUTSIDE_TRAINING));
            }
            for (_, friction, _) in settle(0.0) {
                assert_eq!(friction, 0.0, "at rest");
            }
        }
        image.reset();
        float.reset();
    }
}
