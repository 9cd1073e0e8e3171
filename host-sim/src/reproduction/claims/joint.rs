//! Claim 11: the joint's acceleration, on the published slider-crank and on the bench.

use super::facts::JointFacts;
use super::{Claim, Verdict};

const SEVERAL: f64 = 3.0;
const TENS: f64 = 100.0;

pub(super) fn evaluate(facts: &JointFacts) -> Claim {
    let within = |ratio: f64| (SEVERAL..=TENS).contains(&ratio);
    let slider_crank = within(facts.slider_crank);
    let largest = facts.bench.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
    let bench = largest.is_some_and(|(_, ratio)| within(ratio));
    Claim {
        id: 11,
        claim: "A clearance multiplies the acceleration at the joint several to tens of times.",
        verdict: Verdict::from_conditions(slider_crank && bench, slider_crank || bench),
        threshold: "largest acceleration 3 to 100 times that of the joint without clearance, on the \
                    slider-crank with repeated impacts and on the bench; partly: on one of them",
        why: format!(
            "slider-crank {:.1}; bench {}. The bench's journal stays in contact, so it swings instead of \
             bouncing",
            facts.slider_crank,
            largest.map_or_else(|| "not run".into(), |(c, r)| format!("at most {r:.2}, at {c:.2} mm"))
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn claim_11_asks_both_mechanisms() {
        let verdict = |slider_crank, bench| {
            evaluate(&JointFacts { slider_crank, bench: vec![(0.1, 1.0), (1.0, bench)] }).verdict
        };
        assert_eq!(verdict(16.8, 4.0), Verdict::Holds);
        assert_eq!(verdict(16.8, 1.5), Verdict::Partly);
        assert_eq!(verdict(1.2, 1.5), Verdict::DoesNotHold);
        assert_eq!(verdict(1000.0, 1.5), Verdict::DoesNotHold);
    }
}
