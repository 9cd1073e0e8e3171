//! Claim 6: the frequency of the fluctuation and its causes.

use super::facts::{BearingFacts, MotionFacts, RunFacts};
use super::{Claim, Verdict};
use crate::reproduction::swing::power_law;

const FASTER: f64 = 1.05;

/// Exponent of the swing frequency over the clearance or over the swing's radius.
fn swing_exponent(bearing: &BearingFacts, over: impl Fn(&RunFacts) -> f64) -> Option<f64> {
    let points: Vec<(f64, f64)> =
        bearing.clearance.iter().filter_map(|r| Some((over(r), r.swing_hz?))).collect();
    power_law(&points).map(|(p, _)| p)
}

pub(super) fn evaluate(facts: &MotionFacts) -> Claim {
    let (babbitt, plastic) = (&facts.babbitt, &facts.plastic);
    let each = babbitt
        .clearance
        .iter()
        .zip(&plastic.clearance)
        .map(|(b, p)| b.fluctuation_hz.zip(p.fluctuation_hz).is_some_and(|(b, p)| p >= FASTER * b));
    let hz = |b: &BearingFacts| {
        let one = |r: &RunFacts| r.fluctuation_hz.map_or_else(|| "none".into(), |f| format!("{f:.1}"));
        b.clearance.iter().map(one).collect::<Vec<_>>().join(", ")
    };
    let exponent = |p: Option<f64>| p.map_or_else(|| "not measurable".into(), |p| format!("{p:+.2}"));
    Claim {
        id: 6,
        claim: "Plastic bearing: the fluctuation frequency is higher, perhaps because of its modulus.",
        verdict: Verdict::from_each(each),
        threshold: "dominant frequency of the force in claim 1's first stretch at least 5 % higher at every \
                    clearance; partly: at some",
        why: format!(
            "plastic {} Hz, Babbitt {} Hz. The fluctuation is the journal swinging in the clearance circle: \
             measured, its frequency goes as clearance^{} for Babbitt and as swing radius (clearance plus \
             deformation)^{} and ^{} for Babbitt and plastic, and as modulus^{} with everything else fixed; \
             a softer bearing only widens the circle",
            hz(plastic),
            hz(babbitt),
            exponent(swing_exponent(babbitt, |r| r.clearance_mm)),
            exponent(swing_exponent(babbitt, |r| r.swing_radius_mm)),
            exponent(swing_exponent(plastic, |r| r.swing_radius_mm)),
            exponent(power_law(&facts.modulus).map(|(p, _)| p)),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::super::facts::tests::motion_facts;
    use super::*;

    #[test]
    fn claim_6_compares_frequencies_at_every_clearance_and_names_the_cause() {
        let verdict = |factors: [f64; 4]| {
            let mut facts = motion_facts();
            for (i, r) in facts.babbitt.clearance.iter_mut().enumerate() {
                let hz = 20.0 * r.clearance_mm.powf(-0.5);
                (r.swing_hz, r.fluctuation_hz) = (Some(hz), Some(hz));
                facts.plastic.clearance[i].fluctuation_hz = Some(hz * factors[i]);
            }
            facts.modulus = vec![(1e9, 20.0), (1e11, 20.0)];
            evaluate(&facts)
        };
        assert_eq!(verdict([1.2; 4]).verdict, Verdict::Holds);
        assert_eq!(verdict([1.2, 1.0, 1.0, 1.0]).verdict, Verdict::Partly);
        let slower = verdict([0.8; 4]);
        assert_eq!(slower.verdict, Verdict::DoesNotHold);
        assert!(
            slower.why.contains("clearance^-0.50") && slower.why.contains("modulus^+0.00"),
            "{}",
            slower.why
        );
    }
}
