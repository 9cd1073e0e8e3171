//! Claims 12 to 14: friction torque over speed and load.
//!
//! The paper measured it on its rig and published no data. What is judged here are the friction laws of the benches at
//! the rig's loads: within the rig's speeds, and beyond them up to the bench's.

use super::facts::{FrictionFacts, TorqueCurve};
use super::{Claim, Verdict, list, list_to};

const VISIBLE: f64 = 0.05;
const LEVEL: f64 = 0.02;
const CAVEAT: &str = "These are the friction laws that stand in for the paper's unpublished measurements";

pub(super) fn judge(facts: &FrictionFacts) -> Vec<Claim> {
    vec![falls(facts), level_then_rises(facts), larger(facts)]
}

fn torques(curve: &TorqueCurve, up_to_m_s: f64) -> Vec<f64> {
    curve.points.iter().filter(|p| p.0 <= up_to_m_s * (1.0 + 1e-9)).map(|p| p.1).collect()
}

/// Fall from the first to the last, relative to the first.
fn fall(values: &[f64]) -> f64 {
    values.first().zip(values.last()).map_or(0.0, |(a, b)| (a - b) / a)
}

fn falls(facts: &FrictionFacts) -> Claim {
    let within: Vec<Vec<f64>> = facts.babbitt.iter().map(|c| torques(c, facts.rig_speed_m_s)).collect();
    let monotone = |v: &Vec<f64>| v.windows(2).all(|w| matches!(w, [a, b] if b <= a)) && fall(v) >= VISIBLE;
    let all_fall = !within.is_empty() && within.iter().all(monotone);
    let depths: Vec<f64> =
        within.iter().map(|v| v.first().zip(v.last()).map_or(0.0, |(a, b)| a - b)).collect();
    let deeper = depths.windows(2).all(|w| matches!(w, [a, b] if b > a));
    Claim {
        id: 12,
        claim: "Babbitt: the friction torque falls with the speed, more so at higher load.",
        verdict: Verdict::of(all_fall && deeper, all_fall),
        threshold: "within the rig's 6 deg/s the torque never rises and falls by 5 % at every load, in N m further at \
                    higher load; partly: it falls",
        why: format!(
            "fall at {} kN: {} N m, which is {} % at each load{}. {CAVEAT}",
            list(facts.babbitt.iter().map(|c| c.load_n * 1e-3)),
            list(depths.iter().copied()),
            list_to(1, within.iter().map(|v| 100.0 * fall(v))),
            if within.first().zip(within.last()).is_some_and(|(a, b)| (fall(a) - fall(b)).abs() < 0.01) {
                ", so relatively not more: the law's coefficient does not depend on the load"
            } else {
                ""
            }
        ),
    }
}

fn level_then_rises(facts: &FrictionFacts) -> Claim {
    // The slower half must be level; the end must stand above it.
    let shape = |curve: &TorqueCurve, up_to: f64| {
        let (slow, all) = (torques(curve, 0.5 * up_to), torques(curve, up_to));
        let flat = slow.iter().all(|v| slow.first().is_some_and(|first| (v / first - 1.0).abs() <= LEVEL));
        flat && -fall(&all) >= VISIBLE
    };
    // Level up to some speed, higher at the end, wherever the knee is.
    let knee = |curve: &TorqueCurve| {
        let first = curve.points.first().map_or(0.0, |p| p.1);
        curve.points.iter().take_while(|p| (p.1 / first - 1.0).abs() <= LEVEL).last().map_or(0.0, |p| p.0)
    };
    let on_rig = !facts.plastic.is_empty() && facts.plastic.iter().all(|c| shape(c, facts.rig_speed_m_s));
    let beyond = !facts.plastic.is_empty()
        && facts.plastic.iter().all(|c| {
            let all: Vec<f64> = c.points.iter().map(|p| p.1).collect();
            knee(c) > 0.0 && -fall(&all) >= VISIBLE
        });
    let last = facts.plastic.last();
    Claim {
        id: 13,
        claim: "Plastic: the friction torque is level at low speed and rises at high speed.",
        verdict: Verdict::of(on_rig, beyond),
        threshold: "within the rig's 6 deg/s level within 2 % over the slower half and 5 % higher at the end, at every \
                    load; partly: level and rising only over the bench's speeds",
        why: last.map_or_else(
            || "no curve".into(),
            |c| {
                let rig = torques(c, facts.rig_speed_m_s);
                let all: Vec<f64> = c.points.iter().map(|p| p.1).collect();
                format!(
                    "rise within the rig's {:.1} mm/s: {:.1} %; level up to {:.0} mm/s and then {:.0} % higher at {:.0} \
                     mm/s, the bench's speeds. {CAVEAT}",
                    1e3 * facts.rig_speed_m_s,
                    100.0 * (0.0 - fall(&rig)),
                    1e3 * knee(c),
                    100.0 * (0.0 - fall(&all)),
                    1e3 * c.points.last().map_or(0.0, |p| p.0)
                )
            },
        ),
    }
}

fn larger(facts: &FrictionFacts) -> Claim {
    let pairs: Vec<(f64, f64)> = facts
        .babbitt
        .iter()
        .zip(&facts.plastic)
        .flat_map(|(b, p)| b.points.iter().zip(&p.points).map(|(b, p)| (b.1, p.1)))
        .collect();
    let least = pairs.iter().map(|(b, p)| b / p).fold(f64::INFINITY, f64::min);
    Claim {
        id: 14,
        claim: "At the same load the friction torque of Babbitt is larger than that of plastic.",
        verdict: Verdict::of_each(pairs.iter().map(|(b, p)| b > p)),
        threshold: "larger at every load and every speed up to the bench's; partly: at some",
        why: format!("Babbitt over plastic: at least {least:.2}. {CAVEAT}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(load_n: f64, torque: impl Fn(f64) -> f64) -> TorqueCurve {
        let speeds = (0..=50).map(|i| f64::from(i) * 2e-3);
        TorqueCurve { load_n, points: speeds.map(|v| (v, load_n * torque(v))).collect() }
    }

    fn facts(babbitt: fn(f64, f64) -> f64, plastic: fn(f64) -> f64) -> FrictionFacts {
        let loads = [100e3, 240e3];
        FrictionFacts {
            babbitt: loads.map(|n| curve(n, |v| babbitt(n, v))).to_vec(),
            plastic: loads.map(|n| curve(n, plastic)).to_vec(),
            rig_speed_m_s: 0.0073,
        }
    }

    #[test]
    fn claim_12_wants_a_fall_that_deepens() {
        let verdict = |law: fn(f64, f64) -> f64| falls(&facts(law, |_| 0.05)).verdict;
        assert_eq!(verdict(|_, v| 0.14 + 0.08 * (-v / 0.01).exp()), Verdict::Holds);
        assert_eq!(verdict(|n, v| 0.14 + 8e3 / n * (-v / 0.01).exp()), Verdict::Partly);
        assert_eq!(verdict(|_, v| 0.14 + v), Verdict::DoesNotHold);
    }

    #[test]
    fn claim_13_wants_the_knee_within_the_rigs_speeds() {
        let verdict = |law: fn(f64) -> f64| level_then_rises(&facts(|_, _| 1.0, law)).verdict;
        assert_eq!(verdict(|v| 0.08 + 6.0 * (v - 0.0035).max(0.0)), Verdict::Holds);
        assert_eq!(verdict(|v| 0.08 + 0.25 * (v - 0.02).max(0.0)), Verdict::Partly);
        assert_eq!(verdict(|_| 0.08), Verdict::DoesNotHold);
    }

    #[test]
    fn claim_14_compares_every_point() {
        let verdict = |law: fn(f64) -> f64| larger(&facts(|_, _| 0.15, law)).verdict;
        assert_eq!(verdict(|_| 0.08), Verdict::Holds);
        assert_eq!(verdict(|v| 0.08 + 2.0 * v), Verdict::Partly);
        assert_eq!(verdict(|_| 0.3), Verdict::DoesNotHold);
    }
}
