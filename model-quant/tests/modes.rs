//! Tests of the quantisation modes: size in bytes, error in newtons, independence of the storage
//! form.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::{BearingMaterial, ContactState, Estimate};
use model_quant::evaluate::layers::{LayerError, layer_errors};
use model_quant::evaluate::test_set::draw_test_set;
use model_quant::evaluate::verify::verify;
use model_quant::network::checkpoint::Checkpoint;
use model_quant::network::shipped::shipped_checkpoint;
use model_quant::quantise::image::{AlignedImage, AnyModel, AnyPair};
use model_quant::quantise::mode::{Mode, Packing, Plan};
use model_quant::quantise::quantise;

fn checkpoint(bearing: BearingMaterial) -> (Checkpoint, u64) {
    let bytes = shipped_checkpoint(bearing);
    (Checkpoint::from_bytes(bytes).expect("checkpoint"), Checkpoint::training_id(bytes))
}

fn image(bearing: BearingMaterial, mode: Mode, packing: Packing) -> AlignedImage {
    let (checkpoint, id) = checkpoint(bearing);
    quantise(&checkpoint, id, Plan { mode, packing }).expect("image").image
}

#[test]
fn the_storage_form_changes_the_size_and_no_estimate() {
    for bearing in BearingMaterial::ALL {
        let states: Vec<ContactState> =
            draw_test_set(&checkpoint(bearing).0, 500).into_iter().flat_map(|(_, states)| states).collect();
        for mode in [Mode::W8a16, Mode::W8a8] {
            let [fast, small] = [Packing::Speed, Packing::Flash].map(|packing| image(bearing, mode, packing));
            assert!(small.len() < fast.len(), "{} {}", small.len(), fast.len());
            let [fast, small]: [Vec<Estimate>; 2] = [&fast, &small].map(|image| {
                let mut pair = AnyPair::new(AnyModel::load(image).expect("image"));
                states.iter().map(|state| pair.push(state)).collect()
            });
            assert_eq!(fast, small, "{} {}", bearing.name(), mode.name());
            assert!(fast.iter().any(|estimate| estimate.friction_force_mn != 0));
        }
    }
}

#[test]
fn more_bits_reduce_the_quantisation_error() {
    for bearing in BearingMaterial::ALL {
        let (checkpoint, id) = checkpoint(bearing);
        let [default, compact, reference] = Mode::ALL.map(|mode| {
            let verdicts = verify(&checkpoint, id, &image(bearing, mode, Packing::Speed)).expect("image");
            verdicts.map(|verdict| verdict.mae_quantisation_n)
        });
        for network in 0..2 {
            assert!(
                4.0 * reference[network] < default[network] && 4.0 * default[network] < compact[network],
                "{}: {reference:?} {default:?} {compact:?}",
                bearing.name()
            );
        }
    }
}

#[test]
fn layers_of_16_bits_have_a_smaller_error_than_those_of_8() {
    let bearing = BearingMaterial::Plastic;
    let (checkpoint, id) = checkpoint(bearing);
    let errors = |mode| -> Vec<LayerError> {
        let plan = Plan { mode, packing: Packing::Speed };
        let quantised = quantise(&checkpoint, id, plan).expect("image");
        layer_errors(&checkpoint, &quantised, plan).expect("errors")
    };
    let (compact, reference) = (errors(Mode::W8a8), errors(Mode::W16a16));
    let mut compared = 0;
    for error in &reference {
        let name = format!("{} {}", error.network, error.quantised);
        let Some(other) =
            (compact.iter()).find(|e| (e.network, &e.quantised) == (error.network, &error.quantised))
        else {
            panic!("{name} is in one report only")
        };
        assert!(error.bands.iter().all(|band| band.mae_n <= band.largest_n), "{name}");
        if error.quantised == "features" {
            assert_eq!(error, other, "features have 16 bits in both");
        } else {
            assert!(10.0 * error.mae_n < other.mae_n, "{name}: {} {}", error.mae_n, other.mae_n);
        }
        compared += 1;
    }
    assert_eq!(compared, 22);
}
