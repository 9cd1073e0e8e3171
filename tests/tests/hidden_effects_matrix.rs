//! The quick matrix of hidden effects: every effect once, on the cheapest plant that shows it;
//! clean logs, deleted causes, two effects, pairs and changed questions on the axes.
//!
//! A third of the deleted causes, two effects, clean logs and changed questions is run here, and
//! all with `cargo xtask test --long`. No figure may miss its goal by more than the golden one
//! (`tests/golden/hidden-effects-sample.json` and `-quick.json`, written by `cargo xtask
//! hidden-effects --sample --bless` and `--quick --bless`). The full matrix is a separate campaign:
//! `docs/hidden-effects*.md`.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use rayon::prelude::*;
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
