//! A short training of the rig's friction network on the forces of a briefly trained collision
//! network.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::BearingMaterial;
use model_quant::data::features::FloatFeatures;
use model_quant::data::friction::FrictionSet;
use model_quant::data::friction_source::{from_rig, truth_of_rig};
use model_quant::data::ranges::{RangeKind, header};
use model_quant::evaluate::rig::errors;
use model_quant::network::NetworkKind;
use model_quant::network::recipe::{InstructionSet, Recipe};
use model_quant::train::rig::{collision_force_n, train_on};
use model_quant::train::sources::Sources;
use model_quant::train::{Loss, Training};

#[test]
fn the_torque_of_unseen_groups_is_predicted() {
    let bearing = BearingMaterial::Babbitt;
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
    let (rows, validation) = sources.parts_for(NetworkKind::Collision);
    let mut fit =
        Training::new(&recipe, NetworkKind::Collision.shape(), (&rows, &validation), Loss::Clamped, 0);
    while !fit.is_done() {
        fit.epoch();
    }
    let collision = fit.finish().float;
    let features = FloatFeatures::from_header(&header(bearing, RangeKind::Rig));
    let force = collision_force_n(&collision, &features, 240e3);
    assert!((force / 240e3 - 1.0).abs() < 0.2, "{force} N");
    let set = FrictionSet::new(from_rig(name, bearing, 2).expect("groups"), 0.01, 2).expect("set");
    let truth = truth_of_rig(name, 2).expect("truth");
    let outcome = train_on(&set, &collision, &features, &recipe, &mut |_| ());
    let networks = [&collision, &outcome.network];
    let found = errors(&set, &truth, networks, &features).truth.expect("a truth");
    assert_eq!(found.rows, 4 * 5 * 2048);
    assert!(found.r2 > 0.99, "{found:?}");
    assert!(errors(&set, &[], networks, &features).truth.is_none());
}
