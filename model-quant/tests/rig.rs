//! The friction network of the rig, trained for a short time behind a collision network trained for a shorter one.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::Bearing;
use model_quant::dataset::friction::FrictionSet;
use model_quant::dataset::friction_source::{from_rig, truth_of_rig};
use model_quant::features::FloatFeatures;
use model_quant::pipeline::Network;
use model_quant::ranges::{RangeKind, header};
use model_quant::recipe::Recipe;
use model_quant::rig::{collision_force_n, train_on};
use model_quant::shapes::collision;
use model_quant::sources::Sources;
use model_quant::train::{InstructionSet, Loss, Training};

#[test]
fn the_torque_of_groups_that_were_never_seen_is_predicted_against_the_noise_free_truth() {
    let bearing = Bearing::Babbitt;
    let name = "friction-rig-babbitt";
    let recipe = Recipe {
        range: RangeKind::Rig,
        rows: 8192,
        validation_rows: 1024,
        epochs: 8,
        grid_epochs: 0,
        instruction_set: InstructionSet::best(),
        ..Recipe::standard(bearing)
    };
    let sources = Sources::new(bearing, &recipe);
    let (rows, validation) = sources.of(Network::Collision);
    let mut fit = Training::new(&recipe, collision(), (&rows, &validation), Loss::Clamped, 0);
    while !fit.is_done() {
        fit.epoch();
    }
    let collision = fit.finish().float;
    let features = FloatFeatures::of(&header(bearing, RangeKind::Rig));
    let force = collision_force_n(&collision, &features, 240e3);
    assert!((force / 240e3 - 1.0).abs() < 0.2, "{force} N");
    let set = FrictionSet::new(from_rig(name, bearing, 2).expect("groups"), 0.01, 2).expect("set");
    let truth = truth_of_rig(name, 2).expect("truth");
    let outcome = train_on(&set, &truth, &collision, &features, &recipe, &mut |_| ());
    let found = outcome.truth.expect("a truth");
    assert_eq!(found.rows, 4 * 5 * 2048);
    assert!(found.r2 > 0.99, "{found:?}");
    assert!(train_on(&set, &[], &collision, &features, &recipe, &mut |_| ()).truth.is_none());
}
