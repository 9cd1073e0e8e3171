//! Claims 1 to 5 and 7: clearance and bearing material. Claim 6 is in a separate file.

use super::facts::{BearingFacts, MotionFacts, RunFacts};
use super::{Claim, Verdict, frequency, list, list_to};

const GROWTH: f64 = 2.0;
const STRONGER: f64 = 2.0;
const LEVEL_SLACK: f64 = 0.01;
const Y_OVER_Z: f64 = 2.0;
const NONLINEAR: f64 = 0.10;
const LAW_ERROR: f64 = 0.05;
const TORQUE_FACTOR: f64 = 1.5;

pub(super) fn evaluate(facts: &MotionFacts) -> Vec<Claim> {
    let (babbitt, plastic) = (&facts.babbitt, &facts.plastic);
    vec![
        Claim {
            id: 1,
            claim: "The impact force oscillates where the shaft's angular acceleration changes sign.",
            verdict: oscillates(babbitt),
            threshold: "rms of the force less its 20 ms mean, from .02 T before to .13 T after each sign \
                        change, is 2 times that of as long a stretch before, at every clearance; partly: at \
                        one of them",
            why: oscillates_why(babbitt),
        },
        Claim {
            id: 2,
            claim: "The larger the clearance, the stronger the oscillation.",
            verdict: stronger(babbitt),
            threshold: "the rms doubles from .1 to 1 mm and no step falls by more than 1 %; partly: it \
                doubles",
            why: format!(
                "oscillation at {} mm: {} N rms",
                list_to(2, babbitt.clearance.iter().map(|r| r.clearance_mm)),
                list(babbitt.clearance.iter().map(|r| r.oscillation_n))
            ),
        },
        Claim {
            id: 3,
            claim: "The transverse (Y) force is much larger than the vertical (Z) force.",
            verdict: transverse(babbitt),
            threshold: "peak along Y at least 2 times that along Z at every clearance; partly: larger at \
                some",
            why: format!(
                "Y over Z: {}",
                list_to(1, babbitt.clearance.iter().map(|r| r.peak_y_n / r.peak_z_n))
            ),
        },
        nonlinear(babbitt),
        same_conclusions(babbitt, plastic),
        frequency::evaluate(facts),
        torque_differs(babbitt, plastic),
    ]
}

fn oscillates(bearing: &BearingFacts) -> Verdict {
    let all: Vec<bool> =
        bearing.clearance.iter().flat_map(|r| r.growth.iter().map(|g| *g >= GROWTH)).collect();
    let at_one = (0..2).any(|i| {
        !bearing.clearance.is_empty()
            && bearing.clearance.iter().all(|r| r.growth.get(i).is_some_and(|g| *g >= GROWTH))
    });
    Verdict::from_conditions(!all.is_empty() && all.iter().all(|ok| *ok), at_one)
}

fn oscillates_why(bearing: &BearingFacts) -> String {
    let at = |i: usize| list_to(1, bearing.clearance.iter().filter_map(|r| r.growth.get(i).copied()));
    format!(
        "growth over the stretch before, by clearance: {} at the first sign change, {} at the second; below \
         1 the swing that is under way decays through the sign change",
        at(0),
        at(1)
    )
}

fn stronger(bearing: &BearingFacts) -> Verdict {
    let values: Vec<f64> = bearing.clearance.iter().map(|r| r.oscillation_n).collect();
    let steps = values.windows(2).all(|w| matches!(w, [a, b] if *b >= a * (1.0 - LEVEL_SLACK)));
    let doubles = values.first().zip(values.last()).is_some_and(|(a, b)| *a > 0.0 && *b >= STRONGER * a);
    Verdict::from_conditions(doubles && steps, doubles)
}

fn transverse(bearing: &BearingFacts) -> Verdict {
    let ratios: Vec<f64> = bearing.clearance.iter().map(|r| r.peak_y_n / r.peak_z_n).collect();
    let all = !ratios.is_empty() && ratios.iter().all(|r| *r >= Y_OVER_Z);
    Verdict::from_conditions(all, ratios.iter().any(|r| *r > 1.0))
}

/// Relative change of the coefficient from the slowest to the fastest band.
fn change(run: &RunFacts) -> f64 {
    run.coefficients.first().zip(run.coefficients.last()).map_or(0.0, |(a, b)| b.1 / a.1 - 1.0)
}

fn nonlinear(bearing: &BearingFacts) -> Claim {
    let some =
        |ok: &dyn Fn(&RunFacts) -> bool| !bearing.clearance.is_empty() && bearing.clearance.iter().all(ok);
    let changes = some(&|r| change(r).abs() >= NONLINEAR);
    let follows = some(&|r| r.coefficient_error <= LAW_ERROR);
    let worst = bearing.clearance.iter().map(|r| r.coefficient_error).fold(0.0, f64::max);
    Claim {
        id: 4,
        claim: "The friction torque shows the measured non-linearity.",
        verdict: Verdict::from_conditions(changes && follows, changes || follows).of_own_law(),
        threshold: "torque over force and radius changes by 10 % over the sliding speeds of the run and \
                    stays within 5 % of the bench's friction law; partly: one of the two",
        why: format!(
            "change of the coefficient by clearance: {} %; at most {:.1} % from the law. The law stands in \
             for the paper's measurements, which are not published",
            list(bearing.clearance.iter().map(|r| 100.0 * change(r))),
            100.0 * worst
        ),
    }
}

fn same_conclusions(babbitt: &BearingFacts, plastic: &BearingFacts) -> Claim {
    let judged = |b: &BearingFacts| [oscillates(b), stronger(b), transverse(b)];
    let same = judged(babbitt) == judged(plastic);
    let pairs = || babbitt.clearance.iter().zip(&plastic.clearance);
    let smaller = pairs().count() > 0 && pairs().all(|(b, p)| p.peak_n < b.peak_n);
    let verdicts = judged(plastic).map(Verdict::name).join(", ");
    Claim {
        id: 5,
        claim: "Plastic bearing: the same conclusions, with a smaller impact force.",
        verdict: Verdict::from_conditions(same && smaller, same || smaller),
        threshold: "claims 1 to 3 come out as for Babbitt, and the peak force is smaller at every clearance; \
                    partly: one of the two",
        why: format!(
            "claims 1 to 3 for plastic: {verdicts}; peak force {} N against {} N",
            list(plastic.clearance.iter().map(|r| r.peak_n)),
            list(babbitt.clearance.iter().map(|r| r.peak_n))
        ),
    }
}

fn torque_differs(babbitt: &BearingFacts, plastic: &BearingFacts) -> Claim {
    let ratios: Vec<f64> = babbitt
        .clearance
        .iter()
        .zip(&plastic.clearance)
        .map(|(b, p)| b.peak_torque_nm / p.peak_torque_nm)
        .collect();
    Claim {
        id: 7,
        claim: "Plastic bearing: the friction torque is much different.",
        verdict: Verdict::from_each(ratios.iter().map(|r| r.max(1.0 / r) >= TORQUE_FACTOR)),
        threshold: "peak torques differ by a factor of 1.5 at every clearance; partly: at some",
        why: format!("Babbitt over plastic: {}", list_to(2, ratios)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::facts::tests::{bearing_of, run};
    use super::*;
    use bench::BearingMaterial::{Babbitt, Plastic};

    fn with(change: impl Fn(usize, &mut RunFacts)) -> BearingFacts {
        let mut runs: Vec<RunFacts> = [0.1, 0.25, 0.5, 1.0].iter().map(|&c| run(c, 10.0)).collect();
        runs.iter_mut().enumerate().for_each(|(i, r)| change(i, r));
        bearing_of(Babbitt, runs, Vec::new())
    }

    #[test]
    fn claim_1_needs_both_sign_changes() {
        assert_eq!(oscillates(&with(|_, r| r.growth = vec![3.0, 2.5])), Verdict::Holds);
        assert_eq!(oscillates(&with(|_, r| r.growth = vec![3.0, 0.4])), Verdict::Partly);
        assert_eq!(
            oscillates(&with(|i, r| r.growth = vec![if i == 0 { 1.0 } else { 3.0 }, 0.4])),
            Verdict::DoesNotHold
        );
        assert_eq!(oscillates(&with(|_, r| r.growth.clear())), Verdict::DoesNotHold);
    }

    #[test]
    fn claim_2_needs_a_rise_without_a_fall() {
        assert_eq!(stronger(&with(|i, r| r.oscillation_n = 100.0 * (i + 1) as f64)), Verdict::Holds);
        let dented = |i: usize, r: &mut RunFacts| r.oscillation_n = [100.0, 400.0, 300.0, 500.0][i];
        assert_eq!(stronger(&with(dented)), Verdict::Partly);
        assert_eq!(stronger(&with(|_, r| r.oscillation_n = 100.0)), Verdict::DoesNotHold);
    }

    #[test]
    fn claim_3_compares_the_components() {
        assert_eq!(transverse(&with(|_, r| r.peak_y_n = 3.0 * r.peak_z_n)), Verdict::Holds);
        assert_eq!(transverse(&with(|_, r| r.peak_y_n = 1.5 * r.peak_z_n)), Verdict::Partly);
        assert_eq!(transverse(&with(|_, r| r.peak_y_n = 0.5 * r.peak_z_n)), Verdict::DoesNotHold);
    }

    #[test]
    fn claim_4_needs_a_change_that_is_the_laws() {
        let curve = |slope: f64, error: f64| {
            nonlinear(&with(|_, r| {
                r.coefficients = vec![(0.01, 0.2), (0.1, 0.2 * (1.0 + slope))];
                r.coefficient_error = error;
            }))
            .verdict
        };
        assert_eq!(curve(-0.3, 0.01), Verdict::Assumed);
        assert_eq!(curve(-0.3, 0.2), Verdict::Partly);
        assert_eq!(curve(0.0, 0.01), Verdict::Partly);
        assert_eq!(curve(0.0, 0.2), Verdict::DoesNotHold);
    }

    #[test]
    fn claim_5_needs_the_same_verdicts_and_a_smaller_force() {
        let base = with(|_, r| r.growth = vec![3.0, 3.0]);
        let verdict = |plastic: &BearingFacts| same_conclusions(&base, plastic).verdict;
        assert_eq!(
            verdict(&with(|_, r| {
                r.growth = vec![3.0, 3.0];
                r.peak_n *= 0.5
            })),
            Verdict::Holds
        );
        assert_eq!(
            verdict(&with(|_, r| {
                r.growth = vec![1.0, 1.0];
                r.peak_n *= 0.5
            })),
            Verdict::Partly
        );
        assert_eq!(
            verdict(&with(|_, r| {
                r.growth = vec![1.0, 1.0];
                r.peak_n *= 1.5
            })),
            Verdict::DoesNotHold
        );
    }

    #[test]
    fn claim_7_counts_the_clearances() {
        let babbitt = with(|_, _| {});
        let verdict = |factors: [f64; 4]| {
            let mut plastic = with(|i, r| r.peak_torque_nm *= factors[i]);
            plastic.bearing = Plastic;
            torque_differs(&babbitt, &plastic).verdict
        };
        assert_eq!(verdict([0.4; 4]), Verdict::Holds);
        assert_eq!(verdict([0.4, 0.9, 0.9, 0.9]), Verdict::Partly);
        assert_eq!(verdict([0.9; 4]), Verdict::DoesNotHold);
    }
}
