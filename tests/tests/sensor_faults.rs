//! No sensor fault is silent: those among the first numbers of the long campaign, run on the
//! controller's code in this process.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use rayon::prelude::*;
use system_tests::faults::classify::{Class, Outcome};
use system_tests::faults::native::attempt;
use system_tests::faults::plan::{Fault, Kind};
use system_tests::faults::scenario::Scenario;
use system_tests::faults::table::Table;

/// Faults to draw from. Ten in forty are sensor faults; 1388 and 3668 are drifts that only the
/// load contradicts.
const NUMBERS: u64 = 4_000;

#[test]
fn no_fault_of_a_sensor_is_silent() {
    let scenario = Scenario::new(1).unwrap();
    let faults: Vec<Fault> = (0..NUMBERS).filter_map(|number| Fault::for_sensor(1, number)).collect();
    let outcomes: Vec<Outcome> =
        faults.par_iter().map(|fault| attempt(&scenario, fault)).collect::<Result<_, _>>().unwrap();
    assert_eq!(outcomes.len() as u64, NUMBERS / 4);
    let silent: Vec<_> = outcomes.iter().filter(|outcome| outcome.class == Class::Silent).collect();
    assert!(silent.is_empty(), "{silent:#?}");
    let small: Vec<_> = outcomes.iter().filter(|outcome| outcome.kind == Kind::SensorSmallOffset).collect();
    assert_eq!(small.len() as u64, NUMBERS / 40);
    println!("{}", Table::from_outcomes(&outcomes).render());
}
