//! Goals of the estimate in real worlds, each with the figures that decide it.
//!
//! The worst figure decides. Shares refer to full scale. The goals are those of the controller's
//! estimator with the networks as the source of the contact; with the drive force, of the filter.

use super::cases::{self, OperatingPoint, Set};
use super::estimators::EstimatorKind;
use super::score::Case;
use ::worlds::Bearing;
use schemars::JsonSchema;
use serde::Serialize;

/// Limit of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Limit {
    /// Largest value that meets it.
    AtMost(f64),
    /// Smallest value that meets it.
    AtLeast(f64),
    /// Values above it meet it.
    Above(f64),
    /// Smallest and largest value that meet it.
    Within(f64, f64),
}

impl Limit {
    /// Returns whether a value meets the limit; one that is not a number does not.
    fn is_met(self, value: f64) -> bool {
        match self {
            Self::AtMost(max) => value <= max,
            Self::AtLeast(min) => value >= min,
            Self::Above(bound) => value > bound,
            Self::Within(min, max) => (min..=max).contains(&value),
        }
    }

    /// Returns how bad a value is: the larger, the worse.
    fn badness(self, value: f64) -> f64 {
        if value.is_nan() {
            return f64::INFINITY;
        }
        match self {
            Self::AtMost(_) => value,
            Self::AtLeast(_) | Self::Above(_) => -value,
            Self::Within(min, max) => (min - value).max(value - max),
        }
    }
}

/// A value that a goal refers to.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Figure {
    /// The value, a share or in N.
    pub value: f64,
    /// Operating point and world.
    pub of: String,
}

/// A goal.
struct Goal {
    name: &'static str,
    what: &'static str,
    /// Unit of limit and figures; `share` is printed in percent.
    unit: &'static str,
    limit: Limit,
    figures: fn(&[Case]) -> Vec<Figure>,
}

/// Result of a goal.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Verdict {
    /// Stable name.
    pub name: &'static str,
    /// The goal in words.
    pub goal: &'static str,
    /// Unit of limit and figures.
    pub unit: &'static str,
    /// The limit.
    pub limit: Limit,
    /// True if every figure meets the limit; none without a figure.
    pub met: Option<bool>,
    /// Number of figures.
    pub figures: usize,
    /// Number of figures that meet the limit.
    pub within: usize,
    /// The median figure.
    pub median: Option<f64>,
    /// The worst figure.
    pub worst: Option<Figure>,
}

/// Returns the figures of the cases that a filter selects.
fn figures(
    cases: &[Case],
    is_chosen: impl Fn(&Case) -> bool,
    value: impl Fn(&Case) -> Option<f64>,
) -> Vec<Figure> {
    let figure = |case: &Case| Some(Figure { value: value(case)?, of: case.place() });
    cases.iter().filter(|case| is_chosen(case)).filter_map(figure).collect()
}

fn of_controller(cases: &[Case], set: Set, value: impl Fn(&Case) -> Option<f64>) -> Vec<Figure> {
    figures(cases, |case| case.set == set && case.estimator == EstimatorKind::Network, value)
}

fn single(cases: &[Case], is_mass: bool) -> Vec<Figure> {
    let chosen = |case: &Case| {
        let of_mass = case.world.starts_with("mass");
        case.set == Set::SingleParameter && case.estimator == EstimatorKind::Network && of_mass == is_mass
    };
    figures(cases, chosen, |case| Some(case.force_share()))
}

fn robust(cases: &[Case], world: &str, value: fn(&Case) -> f64) -> Vec<Figure> {
    const POINT: OperatingPoint =
        OperatingPoint { bearing: Bearing::Babbitt, clearance_mm: 0.5, load_kn: 10.0 };
    let chosen =
        |case: &Case| case.world == world && case.estimator == EstimatorKind::Network && case.point == POINT;
    figures(cases, chosen, |case| Some(value(case)))
}

/// Returns the mean of a share over the drawn worlds of each operating point: errors of one world
/// are not independent, so a coverage is a property of many worlds.
fn pooled(cases: &[Case], value: fn(&Case) -> Option<f64>) -> Vec<Figure> {
    let mean = |point: OperatingPoint| {
        let of_point = of_controller(cases, Set::Drawn, |case| value(case).filter(|_| case.point == point));
        let sum: f64 = of_point.iter().map(|figure| figure.value).sum();
        let of = || format!("{}, drawn worlds", point.name());
        (!of_point.is_empty()).then(|| Figure { value: sum / of_point.len() as f64, of: of() })
    };
    OperatingPoint::all().into_iter().filter_map(mean).collect()
}

const SHARE: &str = "share";

/// All goals.
const GOALS: &[Goal] = &[
    Goal {
        name: "exact_force",
        what: "exact world: force within .25 % rms of full scale",
        unit: SHARE,
        limit: Limit::AtMost(0.0025),
        figures: |cases| of_controller(cases, Set::Exact, |case| Some(case.force_share())),
    },
    Goal {
        name: "single_parameter_force",
        what: "any parameter but the mass one declared deviation off: force within .6 % rms",
        unit: SHARE,
        limit: Limit::AtMost(0.006),
        figures: |cases| single(cases, false),
    },
    Goal {
        name: "mass_force",
        what: "mass one declared deviation off: force within 2 % rms",
        unit: SHARE,
        limit: Limit::AtMost(0.02),
        figures: |cases| single(cases, true),
    },
    Goal {
        name: "drawn_force",
        what: "drawn worlds: force within 1.0 % rms",
        unit: SHARE,
        limit: Limit::AtMost(0.01),
        figures: |cases| of_controller(cases, Set::Drawn, |case| Some(case.force_share())),
    },
    Goal {
        name: "drawn_force_max",
        what: "drawn worlds: largest force error at most 6 %",
        unit: SHARE,
        limit: Limit::AtMost(0.06),
        figures: |cases| of_controller(cases, Set::Drawn, |case| Some(case.max_share())),
    },
    Goal {
        name: "drive_force",
        what: "with the drive force, exact and drawn worlds: force within .1 % rms",
        unit: SHARE,
        limit: Limit::AtMost(0.001),
        figures: |cases| {
            let chosen = |case: &Case| {
                let set = matches!(case.set, Set::Exact | Set::Drawn);
                set && case.estimator == EstimatorKind::LawWithDriveForce
            };
            figures(cases, chosen, |case| Some(case.force_share()))
        },
    },
    Goal {
        name: "without_contact",
        what: "exact and drawn worlds, out of contact: at most .1 % of full scale in 99.9 % of ticks",
        unit: SHARE,
        limit: Limit::AtLeast(0.999),
        figures: |cases| {
            let chosen = |case: &Case| {
                let set = matches!(case.set, Set::Exact | Set::Drawn);
                set && case.estimator == EstimatorKind::Network
            };
            figures(cases, chosen, |case| case.zero_without_contact)
        },
    },
    Goal {
        name: "force_coverage",
        what: "drawn worlds together: 2 sd cover the force in 92 to 99.9 % of ticks",
        unit: SHARE,
        limit: Limit::Within(0.92, 0.999),
        figures: |cases| pooled(cases, |case| case.inside_2sd),
    },
    Goal {
        name: "deviation",
        what: "no tick of any world with a standard deviation of 0",
        unit: "N",
        limit: Limit::Above(0.0),
        figures: |cases| {
            figures(cases, |case| case.estimator == EstimatorKind::Network, |case| case.min_sd_n)
        },
    },
    Goal {
        name: "stribeck_rise",
        what: "unmodelled Stribeck rise (Babbitt, .5 mm, +10 kN): force within 143 N rms",
        unit: "N",
        limit: Limit::AtMost(143.0),
        figures: |cases| robust(cases, cases::STRIBECK_RISE, |case| case.rms_n),
    },
    Goal {
        name: "stribeck_rise_max",
        what: "the same: largest force error at most 1880 N",
        unit: "N",
        limit: Limit::AtMost(1880.0),
        figures: |cases| robust(cases, cases::STRIBECK_RISE, |case| case.max_n),
    },
    Goal {
        name: "correlated_noise",
        what: "noise with a correlation of .9 (same point): force within 32 N rms",
        unit: "N",
        limit: Limit::AtMost(32.0),
        figures: |cases| robust(cases, cases::CORRELATED_NOISE, |case| case.rms_n),
    },
    Goal {
        name: "position_delay",
        what: "position probes 100 us late (same point): force within 65 N rms",
        unit: "N",
        limit: Limit::AtMost(65.0),
        figures: |cases| robust(cases, cases::POSITION_DELAY, |case| case.rms_n),
    },
    Goal {
        name: "law_exponent",
        what: "exponent of the law larger by .15 (same point): force within 19 N rms",
        unit: "N",
        limit: Limit::AtMost(19.0),
        figures: |cases| robust(cases, cases::LAW_EXPONENT, |case| case.rms_n),
    },
    Goal {
        name: "exact_torque",
        what: "exact world: friction torque within 3 % rms of full scale",
        unit: SHARE,
        limit: Limit::AtMost(0.03),
        figures: |cases| of_controller(cases, Set::Exact, |case| Some(case.torque_share())),
    },
    Goal {
        name: "exact_torque_reversal",
        what: "the same around reversals of sliding",
        unit: SHARE,
        limit: Limit::AtMost(0.03),
        figures: |cases| of_controller(cases, Set::Exact, Case::torque_reversal_share),
    },
    Goal {
        name: "drawn_torque",
        what: "drawn worlds: friction torque within 6 % rms",
        unit: SHARE,
        limit: Limit::AtMost(0.06),
        figures: |cases| of_controller(cases, Set::Drawn, |case| Some(case.torque_share())),
    },
    Goal {
        name: "drawn_torque_reversal",
        what: "the same around reversals of sliding",
        unit: SHARE,
        limit: Limit::AtMost(0.06),
        figures: |cases| of_controller(cases, Set::Drawn, Case::torque_reversal_share),
    },
];

/// Evaluates every goal.
pub fn verdicts(cases: &[Case]) -> Vec<Verdict> {
    GOALS.iter().map(|goal| verdict(goal, (goal.figures)(cases))).collect()
}

fn verdict(goal: &Goal, mut figures: Vec<Figure>) -> Verdict {
    let limit = goal.limit;
    let within = figures.iter().filter(|figure| limit.is_met(figure.value)).count();
    figures.sort_by(|a, b| limit.badness(a.value).total_cmp(&limit.badness(b.value)));
    Verdict {
        name: goal.name,
        goal: goal.what,
        unit: goal.unit,
        limit,
        met: (!figures.is_empty()).then_some(within == figures.len()),
        figures: figures.len(),
        within,
        median: figures.get(figures.len() / 2).map(|figure| figure.value),
        worst: figures.pop(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn goal(limit: Limit, values: &[f64]) -> Verdict {
        let goal = Goal { name: "n", what: "w", unit: "N", limit, figures: |_| Vec::new() };
        verdict(&goal, values.iter().map(|&value| Figure { value, of: value.to_string() }).collect())
    }

    #[test]
    fn the_worst_figure_decides() {
        let max = goal(Limit::AtMost(2.0), &[1.0, 3.0, 2.0]);
        assert_eq!((max.met, max.within, max.figures), (Some(false), 2, 3));
        assert_eq!((max.worst.unwrap().of.as_str(), max.median), ("3", Some(2.0)));
        let min = goal(Limit::AtLeast(2.0), &[4.0, 3.0, 2.0]);
        assert_eq!((min.met, min.worst.unwrap().value), (Some(true), 2.0));
        assert_eq!(goal(Limit::Above(0.0), &[1.0, 0.0]).met, Some(false));
        let within = goal(Limit::Within(0.9, 0.99), &[0.95, 0.995, 0.91]);
        assert_eq!((within.met, within.worst.unwrap().value), (Some(false), 0.995));
    }

    #[test]
    fn without_a_figure_nothing_is_decided_and_a_figure_that_is_no_number_is_the_worst() {
        assert_eq!(goal(Limit::AtMost(1.0), &[]).met, None);
        let bad = goal(Limit::AtMost(1.0), &[0.5, f64::NAN]);
        assert_eq!(bad.met, Some(false));
        assert!(bad.worst.unwrap().value.is_nan());
    }

    /// Every world of every operating point with a perfect estimate.
    fn perfect() -> Vec<Case> {
        let case = |point: OperatingPoint, real: &cases::RealWorld, estimator| Case {
            world: real.name.clone(),
            set: real.set,
            estimator,
            point,
            rms_n: 0.0,
            max_n: 0.0,
            full_scale_n: 1e4,
            inside_2sd: Some(0.95),
            min_sd_n: Some(1.0),
            torque_rms_nm: 0.0,
            torque_reversal_rms_nm: Some(0.0),
            torque_full_scale_nm: 100.0,
            torque_inside_2sd: Some(0.95),
            ticks_without_contact: 1,
            zero_without_contact: Some(1.0),
            course_n: Vec::new(),
        };
        let of_point = |point: OperatingPoint| {
            let of_world = |real: &cases::RealWorld| EstimatorKind::ALL.map(|kind| case(point, real, kind));
            cases::worlds(&point, 2, 1).iter().flat_map(of_world).collect::<Vec<Case>>()
        };
        OperatingPoint::all().into_iter().flat_map(of_point).collect()
    }

    #[test]
    fn a_perfect_estimate_meets_every_goal_and_each_goal_fails_in_its_own_worlds_only() {
        assert!(verdicts(&perfect()).iter().all(|verdict| verdict.met == Some(true)));
        let failing = |is_bad: &dyn Fn(&Case) -> bool, spoil: fn(&mut Case)| {
            let mut cases = perfect();
            cases.iter_mut().filter(|case| is_bad(case)).for_each(spoil);
            let failed = verdicts(&cases).into_iter().filter(|verdict| verdict.met == Some(false));
            failed.map(|verdict| verdict.name).collect::<Vec<_>>()
        };
        let in_world = |world: &'static str| {
            move |case: &Case| case.estimator == EstimatorKind::Network && case.world == world
        };
        let force: fn(&mut Case) = |case| case.rms_n = 250.0;
        assert_eq!(failing(&in_world("exact"), force), ["exact_force"]);
        assert_eq!(failing(&in_world("clearance-"), force), ["single_parameter_force"]);
        assert_eq!(failing(&in_world("mass+"), force), ["mass_force"]);
        assert_eq!(failing(&in_world("draw-2"), force), ["drawn_force"]);
        assert_eq!(failing(&in_world("draw-2"), |case| case.max_n = 601.0), ["drawn_force_max"]);
        let drive = |case: &Case| case.estimator == EstimatorKind::LawWithDriveForce;
        assert_eq!(failing(&drive, force), ["drive_force"]);
        let law = |case: &Case| case.estimator == EstimatorKind::Law;
        assert!(failing(&law, force).is_empty());
        assert_eq!(
            failing(&in_world("exact"), |case| case.zero_without_contact = Some(0.99)),
            ["without_contact"]
        );
        assert_eq!(failing(&in_world("draw-1"), |case| case.inside_2sd = Some(0.8)), ["force_coverage"]);
        assert_eq!(failing(&in_world("drive-lag"), |case| case.min_sd_n = Some(0.0)), ["deviation"]);
        for world in
            [cases::STRIBECK_RISE, cases::CORRELATED_NOISE, cases::POSITION_DELAY, cases::LAW_EXPONENT]
        {
            assert_eq!(failing(&in_world(world), force), [world.replace('-', "_")]);
        }
        let peak: fn(&mut Case) = |case| case.max_n = 1881.0;
        assert_eq!(failing(&in_world(cases::STRIBECK_RISE), peak), ["stribeck_rise_max"]);
        let torque: fn(&mut Case) = |case| case.torque_rms_nm = 6.1;
        assert_eq!(failing(&in_world("exact"), torque), ["exact_torque"]);
        assert_eq!(failing(&in_world("draw-1"), torque), ["drawn_torque"]);
        let reversal: fn(&mut Case) = |case| case.torque_reversal_rms_nm = Some(6.1);
        assert_eq!(failing(&in_world("exact"), reversal), ["exact_torque_reversal"]);
        assert_eq!(failing(&in_world("draw-1"), reversal), ["drawn_torque_reversal"]);
    }
}
