//! The complete chain in lockstep over one cycle, bit for bit: bench, quantised networks, emulated
//! controller.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]
#![cfg(feature = "emulated")]

use clap::Parser;
use host_sim::run::{RunArgs, execute};
use system_tests::soak::TICK_INSTRUCTIONS;

#[derive(Parser)]
struct Options {
    #[command(flatten)]
    run: RunArgs,
}

fn run(arguments: &[&str]) -> host_sim::run::summary::Summary {
    let line = std::iter::once("run").chain(arguments.iter().copied()).chain(["--json"]);
    execute(&Options::parse_from(line).run).unwrap().summary
}

#[test]
fn native_and_emulated_controller_agree_bit_for_bit_over_a_cycle_of_either_bearing() {
    for bearing in ["babbitt", "plastic"] {
        let summary = run(&["--controller", "emulated", "--bearing", bearing]);
        let estimator = summary.estimator.unwrap();
        assert_eq!(estimator.controller, "emulated");
        assert_eq!(estimator.ticks, 10_000);
        assert_eq!(estimator.native_emulated_bit_differences, Some(0), "{bearing}");
        assert_eq!(estimator.deadline_misses, 0, "{bearing}");
        let most = estimator.instructions_per_tick_max.unwrap();
        assert!((most as f64) < TICK_INSTRUCTIONS, "{bearing}: {most} instructions in a tick");
    }
}
