//! Claims 12 to 14: friction torque over speed and load on the friction rig.
//!
//! The paper measured it and published no data. [`assess`] evaluates records of the simulated rigs
//! with noise, drift and outliers. The rigs' friction is an assumed law, so the verdict `assumed`
//! says that this law has the shape that the paper describes and that the shape is visible through
//! the sensors. [`assess_curves`] evaluates any other source, such as the bench's law or networks,
//! whose outputs the paper's Figs. 12 and 13 show.

use super::torque::{FrictionFacts, TorqueCurve};
use super::{Claim, Verdict, list, list_to};

const VISIBLE: f64 = 0.05;
const LEVEL: f64 = 0.02;
/// Relative increase of a band that counts as noise.
const NOISE: f64 = 0.01;
const CAVEAT: &str =
    "From records of the simulated rig, whose assumed friction replaces the paper's unpublished data";

/// Evaluates claims 12 to 14 on records of the rigs. Their law stands in for the paper's data.
pub fn assess(facts: &FrictionFacts) -> Vec<Claim> {
    let mut claims = assess_curves(facts, CAVEAT);
    claims.iter_mut().for_each(|claim| claim.verdict = claim.verdict.of_own_law());
    claims
}

/// Evaluates claims 12 to 14 on torque curves; `source` says where they come from.
pub fn assess_curves(facts: &FrictionFacts, source: &str) -> Vec<Claim> {
    vec![falls(facts, source), level_then_rises(facts, source), larger(facts, source)]
}

fn torques(curve: &TorqueCurve) -> Vec<f64> {
    curve.points.iter().map(|p| p.1).collect()
}

/// Relative change from the first to the last value.
fn change(values: &[f64]) -> f64 {
    values.first().zip(values.last()).map_or(0.0, |(a, b)| b / a - 1.0)
}

fn kilonewtons(curves: &[TorqueCurve]) -> String {
    list(curves.iter().map(|c| c.load_n * 1e-3))
}

fn falls(facts: &FrictionFacts, source: &str) -> Claim {
    let curves: Vec<Vec<f64>> = facts.babbitt.iter().map(torques).collect();
    let falling = |v: &Vec<f64>| {
        v.windows(2).all(|w| matches!(w, [a, b] if *b <= a * (1.0 + NOISE))) && change(v) <= -VISIBLE
    };
    let all_fall = !curves.is_empty() && curves.iter().all(falling);
    let depths: Vec<f64> =
        curves.iter().map(|v| v.first().zip(v.last()).map_or(0.0, |(a, b)| a - b)).collect();
    let deeper = depths.windows(2).all(|w| matches!(w, [a, b] if b > a));
    Claim {
        id: 12,
        claim: "Babbitt: the friction torque falls with the speed, more so at higher load.",
        verdict: Verdict::from_conditions(all_fall && deeper, all_fall),
        threshold: "from 1.2 mm/s to the rig's 7.3 mm/s the torque falls by 5 % at every load, no band \
                    rising by over 1 %, and further in N m at every higher load; partly: it falls",
        why: format!(
            "fall at {} kN: {} N m, which is {} %. {source}",
            kilonewtons(&facts.babbitt),
            list(depths.iter().copied()),
            list_to(1, curves.iter().map(|v| -100.0 * change(v))),
        ),
    }
}

fn level_then_rises(facts: &FrictionFacts, source: &str) -> Claim {
    let slow = |c: &TorqueCurve| -> Vec<f64> {
        let half = 0.5 * c.points.last().map_or(0.0, |p| p.0);
        c.points.iter().filter(|p| p.0 <= half).map(|p| p.1).collect()
    };
    let spread = |v: &[f64]| {
        let first = v.first().copied().unwrap_or(f64::NAN);
        v.iter().map(|t| (t / first - 1.0).abs()).fold(0.0, f64::max)
    };
    let shape = |c: &TorqueCurve| {
        let slow = slow(c);
        !slow.is_empty() && spread(&slow) <= LEVEL && change(&torques(c)) >= VISIBLE
    };
    Claim {
        id: 13,
        claim: "Plastic: the friction torque is level at low speed and rises at high speed.",
        verdict: Verdict::from_each(facts.plastic.iter().map(shape)),
        threshold: "from 1.2 mm/s to half the rig's 7.3 mm/s level within 2 %, and 5 % higher at its end, \
                    at every load; partly: at some",
        why: format!(
            "at {} kN: change over the slower half at most {} %, rise to the end {} %. {source}",
            kilonewtons(&facts.plastic),
            list_to(1, facts.plastic.iter().map(|c| 100.0 * spread(&slow(c)))),
            list_to(1, facts.plastic.iter().map(|c| 100.0 * change(&torques(c)))),
        ),
    }
}

fn larger(facts: &FrictionFacts, source: &str) -> Claim {
    let pairs: Vec<(f64, f64)> = facts
        .babbitt
        .iter()
        .zip(&facts.plastic)
        .flat_map(|(b, p)| b.points.iter().zip(&p.points).map(|(b, p)| (b.1, p.1)))
        .collect();
    let min_ratio = pairs.iter().map(|(b, p)| b / p).fold(f64::INFINITY, f64::min);
    Claim {
        id: 14,
        claim: "At the same load the friction torque of Babbitt is larger than that of plastic.",
        verdict: Verdict::from_each(pairs.iter().map(|(b, p)| b > p)),
        threshold: "larger at every load and in every band of the rig's speed; partly: at some",
        why: format!("Babbitt over plastic: at least {min_ratio:.2}. {source}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(load_n: f64, coefficient: impl Fn(f64) -> f64) -> TorqueCurve {
        let speeds = (1..=12).map(|i| f64::from(i) * 6e-4);
        TorqueCurve { load_n, points: speeds.map(|v| (v, load_n * coefficient(v))).collect() }
    }

    fn facts(babbitt: fn(f64, f64) -> f64, plastic: fn(f64, f64) -> f64) -> FrictionFacts {
        let loads = [100e3, 240e3];
        FrictionFacts {
            babbitt: loads.map(|n| curve(n, |v| babbitt(n, v))).to_vec(),
            plastic: loads.map(|n| curve(n, |v| plastic(n, v))).to_vec(),
        }
    }

    #[test]
    fn claim_12_requires_a_fall_that_deepens_with_load() {
        let verdict = |law: fn(f64, f64) -> f64| falls(&facts(law, |_, _| 0.05), "").verdict;
        assert_eq!(verdict(|_, v| 0.14 + 0.08 * (-v / 0.01).exp()), Verdict::Holds);
        assert_eq!(verdict(|n, v| 0.14 + 8e3 / n * (-v / 0.01).exp()), Verdict::Partly);
        assert_eq!(verdict(|_, v| 0.14 + v), Verdict::DoesNotHold);
    }

    #[test]
    fn claim_13_requires_a_level_and_a_rise_at_every_load() {
        let verdict = |law: fn(f64, f64) -> f64| level_then_rises(&facts(|_, _| 1.0, law), "").verdict;
        assert_eq!(verdict(|_, v| 0.08 + 6.0 * (v - 0.0035).max(0.0)), Verdict::Holds);
        let below_200_kn = |n: f64, v: f64| if n > 2e5 { 0.08 } else { 0.08 + 6.0 * (v - 0.0035).max(0.0) };
        assert_eq!(verdict(below_200_kn), Verdict::Partly);
        assert_eq!(verdict(|_, v| 0.08 + 6.0 * v), Verdict::DoesNotHold);
        assert_eq!(verdict(|_, _| 0.08), Verdict::DoesNotHold);
    }

    #[test]
    fn claim_14_compares_every_band() {
        let verdict = |law: fn(f64, f64) -> f64| larger(&facts(|_, _| 0.15, law), "").verdict;
        assert_eq!(verdict(|_, _| 0.08), Verdict::Holds);
        assert_eq!(verdict(|_, v| 0.08 + 20.0 * v), Verdict::Partly);
        assert_eq!(verdict(|_, _| 0.3), Verdict::DoesNotHold);
    }

    #[test]
    fn the_rigs_own_law_gives_assumed_and_never_holds() {
        let facts = facts(
            |_, v| 0.14 + 0.08 * (-v / 0.01).exp(),
            |_, v| if v > 4e-3 { 0.08 + 6.0 * (v - 4e-3) } else { 0.08 },
        );
        assert!(assess_curves(&facts, "").iter().all(|claim| claim.verdict == Verdict::Holds));
        assert!(assess(&facts).iter().all(|claim| claim.verdict == Verdict::Assumed));
    }
}
