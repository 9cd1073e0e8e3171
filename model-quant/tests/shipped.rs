//! The checked-in models: made from their checkpoints byte for byte, and as accurate as their cards say.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::{Bearing, Flags, Model, Pair, shipped};
use model_quant::card::card;
use model_quant::checkpoint::Checkpoint;
use model_quant::float_pair::{FloatPair, shipped as shipped_checkpoint};
use model_quant::quantise::quantise;
use model_quant::recipe::Recipe;
use model_quant::verify::{Verdict, verify};

fn checkpoint(bearing: Bearing) -> (Checkpoint, u64) {
    let bytes = shipped_checkpoint(bearing);
    (Checkpoint::from_bytes(bytes).expect("checkpoint"), Checkpoint::training_id(bytes))
}

fn verdicts(bearing: Bearing) -> [Verdict; 2] {
    let (checkpoint, id) = checkpoint(bearing);
    verify(&checkpoint, id, shipped(bearing)).expect("shipped image")
}

#[test]
fn quantising_the_checkpoint_again_gives_the_shipped_image() {
    for bearing in Bearing::ALL {
        let (checkpoint, id) = checkpoint(bearing);
        assert_eq!(checkpoint.recipe, Recipe::standard(bearing), "the default recipe made it");
        let image = quantise(&checkpoint, id).expect("image");
        assert!(image.as_slice() == shipped(bearing), "{}: other bytes", bearing.name());
    }
}

#[test]
fn images_follow_the_laws_on_rows_that_no_training_saw() {
    for bearing in Bearing::ALL {
        for verdict in verdicts(bearing) {
            let name = format!("{} {}", verdict.bearing, verdict.network);
            assert!(verdict.r2_quantised > 0.999, "{name}: R^2 {}", verdict.r2_quantised);
            assert!(verdict.r2_float > 0.999, "{name}: R^2 of the float networks {}", verdict.r2_float);
            assert!(verdict.working_error_median < 0.01, "{name}: {}", verdict.working_error_median);
            // Friction has a further 2 %: relative errors below 1 mm/s, where it goes to 0 with the speed.
            let limit = if verdict.network == "friction" { 0.05 } else { 0.03 };
            assert!(verdict.working_error_p95 < limit, "{name}: {}", verdict.working_error_p95);
            assert_eq!(verdict.zero_contact_output, 0.0, "{name}");
            assert!(verdict.saturated_share < 0.001, "{name}: {}", verdict.saturated_share);
            assert!(verdict.image_crc_ok && verdict.image_matches_checkpoint, "{name}");
        }
    }
}

#[test]
fn cards_say_what_verification_finds() {
    for (bearing, found) in [
        (Bearing::Babbitt, include_str!("../../crates/inference/models/babbitt.md")),
        (Bearing::Plastic, include_str!("../../crates/inference/models/plastic.md")),
    ] {
        let header = Model::load(shipped(bearing)).expect("image").header();
        let expected = card(&checkpoint(bearing).0, &header, &verdicts(bearing));
        assert_eq!(found, expected, "{}: run `model-quant quantize`", bearing.name());
    }
}

#[test]
fn friction_opposes_the_sliding_and_is_odd_in_both_chains() {
    for bearing in Bearing::ALL {
        let mut image = Pair::new(Model::load(shipped(bearing)).expect("image"));
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
                    image.step(&state(speed));
                    float.step(&state(speed));
                }
                [image.step(&state(speed)), float.step(&state(speed))]
            };
            for (forward, backward) in settle(speed).into_iter().zip(settle(-speed)) {
                assert!(forward.friction_force_n < 0.0, "{speed}");
                assert_eq!(forward.friction_force_n, -backward.friction_force_n, "{speed}");
                assert_eq!(forward.normal_force_n, backward.normal_force_n);
                assert!(!forward.flags.intersects(Flags::OUTSIDE_TRAINING));
            }
            for pair in settle(0.0) {
                assert_eq!(pair.friction_force_n, 0.0, "at rest");
            }
        }
        image.reset();
        float.reset();
    }
}
