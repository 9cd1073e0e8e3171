//! The quick matrix of hidden effects: every effect once, on the cheapest plant that shows it;
//! clean logs, deleted causes, two effects, pairs and changed questions on the axes.
//!
//! A third of the deleted causes, two effects, clean logs, changed questions and transmission
//! benches is run here, and all with `cargo xtask test --long`. No figure may miss its goal by more
//! than the golden one (`tests/golden/hidden-effects-sample.json` and `-quick.json`, written by
//! `cargo xtask hidden-effects --sample --bless` and `--quick --bless`). The full matrix is a
//! separate campaign: `docs/hidden-effects*.md`.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use rayon::prelude::*;
use std::process::Command;
use system_tests::hidden_effects::cell::Campaign;
use system_tests::hidden_effects::compare::Outcome;
use system_tests::hidden_effects::page::{page, summary};
use system_tests::hidden_effects::run::run;
use system_tests::hidden_effects::score::{Figures, figures};

#[test]
fn the_quick_matrix_is_no_worse_than_its_golden_figures() {
    let folder = tempfile::tempdir().unwrap();
    let is_long = std::env::var_os("PINTLE_LONG").is_some();
    let (campaign, golden) = if is_long {
        (Campaign::quick(), include_str!("../golden/hidden-effects-quick.json"))
    } else {
        (Campaign::sample(), include_str!("../golden/hidden-effects-sample.json"))
    };
    let outcomes: Vec<Outcome> =
        campaign.cells().par_iter().with_max_len(1).map(|cell| run(folder.path(), cell).unwrap()).collect();
    let golden: Figures = serde_json::from_str(golden).unwrap();
    let found = figures(&golden.date, &campaign, &outcomes);
    eprint!("{}", summary(&found));
    let worse = found.worse_than(&golden);
    assert!(worse.is_empty(), "{worse:#?}");
    assert!(found.out_of_reach.is_empty(), "not hidden: {:?}", found.out_of_reach);
}

#[test]
fn merged_shards_of_a_matrix_give_the_figures_of_one_machine() {
    let folder = tempfile::tempdir().unwrap();
    let run = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hidden_effects"));
        command.current_dir(&folder).args(["--plant", "linear", "--arms", "clean", "--sizes", "1"]);
        command.args(["--seeds", "1", "--date", "2026-11-28"]).args(more).output().unwrap()
    };
    let done = |more: &[&str]| {
        let output = run(more);
        assert!(output.status.success(), "{more:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let refused = |more: &[&str]| {
        let output = run(more);
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    done(&["--out", "one"]);
    let first = done(&["--shard", "1/2", "--out", "s1"]);
    assert!(first.starts_with("shard 1/2: ") && first.ends_with(" cells, 0 failed\n"), "{first}");
    assert!(!folder.path().join("s1/figures.json").exists(), "a shard has no figures");
    assert!(refused(&["--merge", "s1", "--out", "two"]).contains("missing: 1"));
    done(&["--shard", "2/2", "--out", "s2"]);
    done(&["--merge", "s1", "s2", "--out", "two"]);
    let figures = |out: &str| {
        let text = std::fs::read_to_string(folder.path().join(out).join("figures.json")).unwrap();
        let mut figures: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert!(figures.as_object_mut().unwrap().remove("engine_s").is_some(), "the longest wall time");
        figures
    };
    assert_eq!(figures("one"), figures("two"));
    assert!(refused(&["--merge", "s1", "s2", "s1", "--out", "three"]).contains("expected it once"));
    let other = refused(&["--merge", "s1", "s2", "--skip-seeds", "1", "--out", "three"]);
    assert!(other.contains("skipped_seeds") && !folder.path().join("three").exists(), "{other}");
    assert!(refused(&["--shard", "3/2"]).contains("1 <= I <= N"));
}

#[test]
fn the_published_pages_show_the_golden_figures() {
    let pages = [
        (include_str!("../golden/hidden-effects.json"), include_str!("../../docs/hidden-effects.md")),
        (
            include_str!("../golden/hidden-effects-bench.json"),
            include_str!("../../docs/hidden-effects-bench.md"),
        ),
        (
            include_str!("../golden/hidden-effects-two-plane.json"),
            include_str!("../../docs/hidden-effects-two-plane.md"),
        ),
    ];
    for (golden, published) in pages {
        let golden: Figures = serde_json::from_str(golden).unwrap();
        assert_eq!(page(&golden), published, "cargo xtask hidden-effects --bless writes both");
    }
}
