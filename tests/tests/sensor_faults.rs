//! No fault of a sensor is silent: those among the first numbers of the long campaign, on the controller's code in this process.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use rayon::prelude::*;
use system_tests::faults::judge::{Class, Outcome};
use system_tests::faults::native::attempt;
use system_tests::faults::plan::Fault;
use system_tests::faults::stage::Stage;

/// Nine in forty are of a sensor, drifts that only the load contradicts (1388, 3668) among them.
const NUMBERS: u64 = 4_000;

#[test]
fn no_fault_of_a_sensor_is_silent() {
    let stage = Stage::new(1).unwrap();
    let faults: Vec<Fault> = (0..NUMBERS).filter_map(|number| Fault::of_sensor(1, number)).collect();
    let outcomes: Vec<Outcome> =
        faults.par_iter().map(|fault| attempt(&stage, fault)).collect::<Result<_, _>>().unwrap();
    assert_eq!(outcomes.len() as u64, NUMBERS * 9 / 40);
    let silent: Vec<_> = outcomes.iter().filter(|outcome| outcome.class == Class::Silent).collect();
    assert!(silent.is_empty(), "{silent:#?}");
}
