//! Figures of the model cards: medians and largest values by bearing and set.

use super::{Accuracy, Settings};
use crate::run::conditions::BEARINGS;
use crate::run::force::{ForceSource, identity};
use model_quant::evaluate::bench_loop::{BenchLoop, LoopSet, Spread};

/// Returns the figures of the shipped image of every measured bearing.
pub(crate) fn bench_loops(runs: &[Accuracy], settings: Settings) -> Vec<BenchLoop> {
    let of = |bearing| {
        let set = |held_out| {
            let inside = |a: &&Accuracy| a.condition.bearing == bearing && a.condition.held_out == held_out;
            set(runs.iter().filter(inside).collect())
        };
        BenchLoop {
            bearing: bearing.name().to_owned(),
            image_crc: identity(ForceSource::QuantisedNet, bearing),
            step_us: 1e6 * settings.step_s,
            seed: settings.seed,
            paper: set(false),
            held_out: set(true),
        }
    };
    BEARINGS.into_iter().map(of).filter(|found| found.paper.runs > 0).collect()
}

fn set(runs: Vec<&Accuracy>) -> LoopSet {
    let spread = |read: fn(&Accuracy) -> f64| Spread::from_values(runs.iter().map(|a| read(a)));
    LoopSet {
        runs: runs.len(),
        peak_change: spread(|a| a.in_the_loop.network.peak),
        oscillation_change: spread(|a| a.in_the_loop.network.oscillation),
        held_oscillation_change: spread(|a| a.in_the_loop.held_law.oscillation),
        force_error: spread(|a| a.estimate.network.force_share),
        law_force_error: spread(|a| a.estimate.law.force_share),
        torque_error_nm: spread(|a| a.estimate.network.torque_rms_nm),
        law_wins: runs.iter().filter(|a| a.estimate.law_wins()).count(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::accuracy;
    use super::*;

    #[test]
    fn sets_are_kept_apart_and_named_by_their_image() {
        let mut runs = [accuracy(false), accuracy(false), accuracy(true)];
        runs[1].in_the_loop.network.peak = -0.03;
        runs[2].estimate.law.force_rms_n = -1.0;
        let settings = Settings { step_s: 1e-5, seed: 4, threads: 1 };
        let found = bench_loops(&runs, settings);
        assert_eq!(found.len(), 1, "plastic was not measured");
        assert_eq!((found[0].paper.runs, found[0].held_out.runs), (2, 1));
        assert_eq!(found[0].paper.peak_change.largest, 0.03);
        assert_eq!((found[0].paper.law_wins, found[0].held_out.law_wins), (0, 1));
        assert_eq!(found[0].image_crc.len(), 8);
        assert!((found[0].step_us - 10.0).abs() < 1e-9);
    }
}
