//! The short fault campaign and the short soak; the long ones are `cargo xtask faults` and `cargo
//! xtask soak`.

use host_sim::controller::EmulatedController;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use system_tests::faults::campaign::Campaign;
use system_tests::faults::classify::Class;
use system_tests::faults::table::{Counts, Table};
use system_tests::soak::SoakResult;

/// Number of faults.
const FAULTS: u64 = 300;
/// Seed of the campaign.
const SEED: u64 = 1;

#[test]
fn no_fault_of_the_short_campaign_is_silent_and_the_counts_are_the_golden_ones() {
    let campaign = Campaign::prepare(&EmulatedController::default_elf(), SEED).unwrap();
    let outcomes = campaign.run(0..FAULTS, None, |_| {}).unwrap();
    let table = Table::from_outcomes(&outcomes);
    println!("{}", table.render());
    let silent: Vec<_> = outcomes.iter().filter(|outcome| outcome.class == Class::Silent).collect();
    assert!(silent.is_empty(), "{silent:#?}");
    assert_eq!(table.all.not_struck, 0);
    // Every kind occurs, the reports are diverse, and a fault repeats exactly.
    assert_eq!(table.kinds.len(), system_tests::faults::plan::Kind::ALL.len());
    let reports: BTreeSet<_> =
        outcomes.iter().filter_map(|outcome| outcome.first_report.as_deref()).collect();
    assert!(reports.len() > 10, "{reports:?}");
    for number in [1, 2, 3, 5, 8] {
        assert_eq!(campaign.fault(number).unwrap(), outcomes[number as usize]);
    }
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/faults.json");
    let golden: Counts = serde_json::from_str(&std::fs::read_to_string(golden).unwrap()).unwrap();
    let found = Counts::from_table(&table);
    assert_eq!(found, golden, "if the change is intended: cargo xtask faults --bless");
}

#[test]
fn a_short_soak_across_the_wraps_of_sequence_and_time_differs_in_no_bit() {
    // In a separate process: other tests would change the measured memory of this one.
    let begin = [u32::MAX - 9_000, u32::MAX - 1_500_000].map(|number| number.to_string());
    let output = Command::new(env!("CARGO_BIN_EXE_soak"))
        .args(["--json", "--ticks", "40000", "--seed", "5", "--sequence", &begin[0], "--time-us", &begin[1]])
        .arg("--elf")
        .arg(EmulatedController::default_elf())
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    let result: SoakResult = serde_json::from_slice(&output.stdout).unwrap();
    println!("{result:?}");
    assert_eq!((result.sequence_wraps, result.time_wraps), (1, 1));
    // A wrap is neither a gap nor a jump in time: only the start and the seams of the repeated
    // cycle are marked.
    assert!(result.marked < result.ticks / 5, "{result:?}");
}
