//! The paper's claims through the whole chain: the verdicts are those of the model, not of the networks or the threads.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use bench::Bench;
use bench::description::TransmissionBench;
use host_sim::claims::facts::Facts;
use host_sim::claims::gather::gather;
use host_sim::claims::{Claim, Verdict, judge};
use host_sim::force::{DEFAULT_STEP_S, ForceSource};
use host_sim::paper::PaperRuns;
use host_sim::swing::power_law;

fn base() -> TransmissionBench {
    match Bench::open("bench-b").unwrap() {
        Bench::Transmission(bench) => *bench,
        Bench::FrictionRig(_) => panic!("bench-b is a transmission bench"),
    }
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
    let (law, net) = (judge(&facts(ForceSource::Law, 1)), judge(&facts(ForceSource::QuantisedNet, 2)));
    assert_eq!(verdicts(&law), verdicts(&net));
    // What the documents say about this model; the reasons are measured, not assumed, so a change here is a finding.
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
    // At a crawl nothing swings: the verdicts follow the runs.
    let mut slow = base();
    slow.drive.period_s = 6.0;
    let runs = PaperRuns::execute(&slow, ForceSource::Law, DEFAULT_STEP_S, 0, || {}).unwrap();
    let slow = judge(&gather(&slow, &runs, 0).unwrap());
    let fast = judge(&facts(ForceSource::Law, 0));
    assert_ne!(verdicts(&slow), verdicts(&fast));
}
