//! `docs/firmware.md` compared with the code: every flag, every reason of a start, every task of
//! the supervisor, every field of monitor and wiring, every counter.

use controller::configuration::BENCH_B;
use controller::flags::NAMES;
use link::start::{PARTIES, ResetReason};

const TEXT: &str = include_str!("../../../docs/firmware.md");

#[test]
fn every_flag_is_explained() {
    for (flag, name) in NAMES {
        let bit = flag.bits().trailing_zeros();
        assert!(TEXT.contains(&format!("| `{name}` | {bit} | ")), "{name}");
    }
    let section = TEXT.split("## Flags of an estimate").nth(1).unwrap().split("\n## ").next().unwrap();
    let rows = section.lines().filter(|line| line.starts_with("| `")).count();
    assert_eq!(rows, NAMES.len(), "every row explains an existing flag");
}

#[test]
fn every_reason_of_a_start_is_named() {
    let all = [
        ResetReason::Unknown,
        ResetReason::PowerOn,
        ResetReason::BrownOut,
        ResetReason::Pin,
        ResetReason::Software,
        ResetReason::Watchdog,
        ResetReason::WindowWatchdog,
        ResetReason::LowPower,
        ResetReason::Fault,
        ResetReason::Starved,
    ];
    for reason in all {
        assert!(TEXT.contains(&format!("`{reason:?}`")), "{reason:?}");
    }
}

#[test]
fn every_party_has_its_row() {
    for party in PARTIES {
        assert!(TEXT.contains(&format!("| `{party}` | ")), "{party}");
    }
}

/// Names of a structure's fields, read from its debug format.
fn fields(structure: &impl core::fmt::Debug) -> Vec<String> {
    let text = format!("{structure:#?}");
    let names = text.lines().filter(|line| line.starts_with("    ") && !line.starts_with("     "));
    names.filter_map(|line| line.split_once(':')).map(|(name, _)| name.trim().into()).collect()
}

#[test]
fn every_field_of_monitor_and_wiring_and_every_counter_is_explained() {
    let all = [fields(&BENCH_B.monitor), fields(&BENCH_B.wiring), fields(&link::Counters::default())];
    assert_eq!(all.each_ref().map(Vec::len), [30, 11, 19]);
    for name in all.concat() {
        assert!(TEXT.contains(&format!("`{name}`")), "{name}");
    }
}
