//! Claims of the paper through the complete chain: the verdicts follow from the model, not from the
//! networks or the number of threads.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use bench::description::TransmissionBench;
use host_sim::reproduction::claims::facts::Facts;
use host_sim::reproduction::claims::gather::gather;
use host_sim::reproduction::claims::{Claim, Verdict, evaluate};
use host_sim::reproduction::runs::PaperRuns;
use host_sim::reproduction::swing::power_law;
use host_sim::run::force::{DEFAULT_STEP_S, ForceSource};

fn base() -> TransmissionBench {
    TransmissionBench::open("bench-b").unwrap()
}

fn facts(source: ForceSource, threads: usize) -> Facts {
    let runs = PaperRuns::execute(&base(), source, DEFAULT_STEP_S, threads, || {}).unwrap();
    gather(&base(), &runs, threads).unwrap()
}

fn verdicts(claims: &[Claim]) -> Vec<(u8, Verdict)> {
    claims.iter().map(|c| (c.id, c.verdict)).collect()
}

#[test]
fn the_networks_and_the_law_lead_to_the_same_verdicts() {
    let (law, net) = (evaluate(&facts(ForceSource::Law, 1)), evaluate(&facts(ForceSource::QuantisedNet, 2)));
    assert_eq!(verdicts(&law), verdicts(&net));
    // Verdicts that the documents state. The reasons are measured, so a change here is a finding.
    let of = |id: u8| law.iter().find(|c| c.id == id).map(|c| c.verdict).unwrap();
    for (id, expected) in [
        (2, Verdict::Holds),
        (3, Verdict::Holds),
        (6, Verdict::DoesNotHold),
        (8, Verdict::Partly),
        (9, Verdict::Partly),
        (11, Verdict::Holds),
    ] {
        assert_eq!(of(id), expected, "claim {id}: {law:?}");
    }
}

#[test]
fn the_fluctuation_is_a_pendulum_of_the_clearance_and_hardly_feels_the_modulus() {
    let facts = facts(ForceSource::Law, 0);
    let swing: Vec<(f64, f64)> =
        facts.babbitt.clearance.iter().filter_map(|r| Some((r.clearance_mm, r.swing_hz?))).collect();
    assert_eq!(swing.len(), 4);
    let (over_clearance, _) = power_law(&swing).unwrap();
    assert!((over_clearance + 0.5).abs() < 0.05, "{over_clearance}");
    assert!(facts.modulus.len() >= 6);
    let (over_modulus, _) = power_law(&facts.modulus).unwrap();
    assert!(over_modulus.abs() < 0.05, "{over_modulus}");
}

#[test]
fn another_bench_gives_other_verdicts() {
    // At very low speed nothing oscillates: the verdicts follow the runs.
    let mut slow = base();
    slow.drive.period_s = 6.0;
    let runs = PaperRuns::execute(&slow, ForceSource::Law, DEFAULT_STEP_S, 0, || {}).unwrap();
    let slow = evaluate(&gather(&slow, &runs, 0).unwrap());
    let fast = evaluate(&facts(ForceSource::Law, 0));
    assert_ne!(verdicts(&slow), verdicts(&fast));
}
