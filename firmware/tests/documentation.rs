//! `docs/firmware.md` against the code: every flag, every reason of a start, every party and its period.

use firmware::flags::NAMES;
use link::start::{PARTIES, ResetReason};

const TEXT: &str = include_str!("../../docs/firmware.md");

#[test]
fn every_flag_is_explained() {
    for (_, name) in NAMES {
        assert!(TEXT.contains(&format!("| `{name}` | ")), "{name}");
    }
    let section = TEXT.split("## Flags of an estimate").nth(1).unwrap().split("\n## ").next().unwrap();
    let rows = section.lines().filter(|line| line.starts_with("| `")).count();
    assert_eq!(rows, NAMES.len(), "no flag is explained that is not there");
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
