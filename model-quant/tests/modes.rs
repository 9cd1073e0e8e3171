//! The modes of quantisation: what each costs in bytes and in newtons, and that storage changes no estimate.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::{Bearing, ContactState, Estimate};
use model_quant::checkpoint::Checkpoint;
use model_quant::float_pair::shipped;
use model_quant::image::{AlignedImage, AnyModel, AnyPair};
use model_quant::layers::{LayerError, layer_errors};
use model_quant::mode::{Mode, Packing, Plan};
use model_quant::quantise::quantise;
use model_quant::verify::{test_set, verify};

fn checkpoint(bearing: Bearing) -> (Checkpoint, u64) {
    let bytes = shipped(bearing);
    (Checkpoint::from_bytes(bytes).expect("checkpoint"), Checkpoint::training_id(bytes))
}

fn image(bearing: Bearing, mode: Mode, packing: Packing) -> AlignedImage {
    let (checkpoint, id) = checkpoint(bearing);
    quantise(&checkpoint, id, Plan { mode, packing }).expect("image").image
}

#[test]
fn storage_changes_bytes_and_no_estimate() {
    for bearing in Bearing::ALL {
        let states: Vec<ContactState> =
            test_set(&checkpoint(bearing).0, 500).into_iter().flat_map(|(_, states)| states).collect();
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
fn more_bits_come_nearer_to_the_float_networks() {
    for bearing in Bearing::ALL {
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
fn layers_of_16_bits_cost_less_than_those_of_8() {
    let bearing = Bearing::Plastic;
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
