//! Accuracy goals, evaluated on the paper's conditions and on the held-out ones, each by its worst
//! run.

use super::Accuracy;
use super::conditions::Condition;
use schemars::JsonSchema;
use serde::Serialize;

/// A goal.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Stable name.
    pub name: &'static str,
    /// The goal in words.
    pub what: &'static str,
    /// Largest magnitude that meets it.
    pub limit: f64,
    /// Unit of limit and values; `share` is printed in percent.
    pub unit: &'static str,
    /// The value of a condition.
    pub value: fn(&Accuracy) -> f64,
}

/// All goals.
pub(crate) const GOALS: [Goal; 4] = [
    Goal {
        name: "peak_change",
        what: "networks in place of the law move the peak contact force by at most 2 %",
        limit: 0.02,
        unit: "share",
        value: |a| a.in_the_loop.network.peak,
    },
    Goal {
        name: "oscillation_change",
        what: "networks in place of the law move the oscillation's rms by at most 5 %",
        limit: 0.05,
        unit: "share",
        value: |a| a.in_the_loop.network.oscillation,
    },
    Goal {
        name: "estimator_force_error",
        what: "with noisy sensors the estimator's force error is at most 3 % rms of the run's full scale",
        limit: 0.03,
        unit: "share",
        value: |a| a.estimate.network.force_share,
    },
    Goal {
        name: "without_contact",
        what: "no force without contact: networks in the loop and between contacts, estimator",
        limit: 0.0,
        unit: "N",
        value: |a| a.gap.largest_n().max(a.in_the_loop.without_contact_n),
    },
];

/// Result of a set of conditions.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Standing {
    /// True if every run meets the goal; false without runs.
    pub met: bool,
    /// Runs.
    pub runs: usize,
    /// Runs that meet it.
    pub within: usize,
    /// Median magnitude.
    pub median: f64,
    /// The value of largest magnitude.
    pub worst: f64,
    /// Condition of that value.
    pub at: Option<Condition>,
}

/// Result of a goal.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Verdict {
    /// Stable name.
    pub name: &'static str,
    /// The goal in words.
    pub goal: &'static str,
    /// Largest magnitude that meets it.
    pub limit: f64,
    /// Unit of limit and values.
    pub unit: &'static str,
    /// True if both sets meet the goal.
    pub met: bool,
    /// On the paper's clearances and loads.
    pub paper: Standing,
    /// On the held-out conditions.
    pub held_out: Standing,
}

/// Result of `host-sim accuracy`, as printed and stored.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Outcome {
    pub(crate) step_us: f64,
    pub(crate) seed: u64,
    pub(crate) goals: Vec<Verdict>,
    /// Number of runs in which the analytic law has the smaller error on the same signals.
    pub(crate) law_wins: usize,
    pub(crate) runs: Vec<Accuracy>,
}

/// Evaluates every goal.
pub(crate) fn evaluate_goals(outcomes: &[Accuracy]) -> Vec<Verdict> {
    let one = |goal: &Goal| {
        let set =
            |held_out| standing(goal, outcomes.iter().filter(|a| a.condition.held_out == held_out).collect());
        let (paper, held_out) = (set(false), set(true));
        Verdict {
            name: goal.name,
            goal: goal.what,
            limit: goal.limit,
            unit: goal.unit,
            met: paper.met && held_out.met,
            paper,
            held_out,
        }
    };
    GOALS.iter().map(one).collect()
}

fn standing(goal: &Goal, set: Vec<&Accuracy>) -> Standing {
    // A value that is not a number does not meet the goal.
    let within = set.iter().filter(|a| (goal.value)(a).abs() <= goal.limit).count();
    let mut sorted = set.clone();
    sorted.sort_by(|a, b| (goal.value)(a).abs().total_cmp(&(goal.value)(b).abs()));
    Standing {
        met: !set.is_empty() && within == set.len(),
        runs: set.len(),
        within,
        median: sorted.get(set.len() / 2).map_or(0.0, |a| (goal.value)(a).abs()),
        worst: sorted.last().map_or(0.0, |a| (goal.value)(a)),
        at: sorted.last().map(|a| a.condition),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::accuracy;
    use super::*;

    #[test]
    fn a_goal_is_met_by_the_worst_run_of_both_sets() {
        let peak = |values: [f64; 2], held_out| {
            values.map(|value| {
                let mut a = accuracy(held_out);
                a.in_the_loop.network.peak = value;
                a
            })
        };
        let outcomes = [peak([0.001, -0.019], false), peak([0.0, 0.021], true)].concat();
        let verdict = &evaluate_goals(&outcomes)[0];
        assert!(verdict.paper.met && !verdict.held_out.met && !verdict.met);
        assert_eq!((verdict.paper.worst, verdict.held_out.worst), (-0.019, 0.021));
        assert_eq!((verdict.held_out.within, verdict.held_out.runs), (1, 2));
        assert!(verdict.held_out.at.is_some_and(|c| c.held_out));
    }

    #[test]
    fn nothing_measured_and_nothing_finite_meet_no_goal() {
        assert!(evaluate_goals(&[]).iter().all(|v| !v.met));
        let mut bad = [accuracy(false), accuracy(true)];
        bad[0].estimate.network.force_share = f64::NAN;
        bad[1].gap.network_n = 0.1;
        let verdicts = evaluate_goals(&bad);
        assert!(!verdicts[2].paper.met && verdicts[2].held_out.met);
        assert!(verdicts[3].paper.met && !verdicts[3].held_out.met);
    }
}
