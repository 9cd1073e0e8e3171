//! The short fault campaign and the short soak; the long ones are `cargo xtask faults` and `cargo xtask soak`.

use host_sim::controller::EmulatedController;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use system_tests::faults::campaign::Campaign;
use system_tests::faults::judge::Class;
use system_tests::faults::table::{Counts, Table};
use system_tests::soak::Soaked;

/// Faults of the short campaign.
const FAULTS: u64 = 300;
/// Its seed.
const SEED: u64 = 1;

#[test]
fn no_fault_of_the_short_campaign_is_silent_and_the_counts_are_those_checked_in() {
    let campaign = Campaign::prepare(&EmulatedController::default_elf(), SEED).unwrap();
    let outcomes = campaign.run(0..FAULTS, None, |_| {}).unwrap();
    let table = Table::of(&outcomes);
    println!("{}", table.render());
    let silent: Vec<_> = outcomes.iter().filter(|outcome| outcome.class == Class::Silent).collect();
    assert!(silent.is_empty(), "{silent:#?}");
    assert_eq!(table.all.not_struck, 0);
    // Every kind came, most of what lives was noticed, and a fault repeats itself.
    assert_eq!(table.kinds.len(), system_tests::faults::plan::Kind::ALL.len());
    let told: BTreeSet<_> = outcomes.iter().filter_map(|outcome| outcome.told.as_deref()).collect();
    assert!(told.len() > 10, "{told:?}");
    for number in [1, 2, 3, 5, 8] {
        assert_eq!(campaign.fault(number).unwrap(), outcomes[number as usize]);
    }
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/faults.json");
    let golden: Counts = serde_json::from_str(&std::fs::read_to_string(golden).unwrap()).unwrap();
    let found = Counts::of(&table);
    assert_eq!(found, golden, "if the change is meant: cargo xtask faults --bless");
}

#[test]
fn a_short_soak_over_the_ends_of_sequence_and_time_differs_in_no_bit() {
    // In a process of its own: what it measures of this one's memory other tests would grow.
    let begin = [u32::MAX - 9_000, u32::MAX - 1_500_000].map(|number| number.to_string());
    let output = Command::new(env!("CARGO_BIN_EXE_soak"))
        .args(["--json", "--ticks", "40000", "--seed", "5", "--sequence", &begin[0], "--time-us", &begin[1]])
        .arg("--elf")
        .arg(EmulatedController::default_elf())
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    let soaked: Soaked = serde_json::from_slice(&output.stdout).unwrap();
    println!("{soaked:?}");
    assert_eq!((soaked.sequence_wraps, soaked.time_wraps), (1, 1));
    // Going round is no gap and no leap in time: what is marked is the begin and the seams of the repeated cycle.
    assert!(soaked.marked < soaked.ticks / 5, "{soaked:?}");
}
