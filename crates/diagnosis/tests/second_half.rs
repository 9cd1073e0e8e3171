//! A change late in a log is found as an early one is.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

mod rig;

use bench::Bench;
use bench::effects::{CATALOGUE, Effect};
use bench::simulate::record;
use diagnosis::{Diagnosis, Options, Verdict, diagnose};
use rig::rig;

const LENGTH_S: f64 = 4.0 * 4.013;

/// Diagnosis of a step of friction after a share of the log.
fn stepped(share: f64, change: f64, seed: u64) -> Diagnosis {
    let nominal = rig();
    let time_s = share * LENGTH_S;
    let parameters = [("coulomb_effort".to_owned(), change), ("time_s".to_owned(), time_s)];
    let step =
        Effect { name: "friction-step".into(), channel: None, of: None, parameters: parameters.into() };
    let mut bench = nominal.clone();
    bench.effects_mut().push(step);
    let log = record(&bench, seed).unwrap();
    diagnose(&nominal, &[log], &[], &Options::default()).unwrap()
}

fn assert_step_is_named(share: f64, change: f64, seed: u64) {
    let (d, time_s) = (stepped(share, change, seed), share * LENGTH_S);
    let summary = format!(
        "{share} of the log, seed {seed}: {:?} {:?} left {:?}; {:?}",
        d.verdict,
        d.causes,
        d.signature,
        d.ranking.iter().take(4).collect::<Vec<_>>()
    );
    assert_eq!(d.verdict, Verdict::Named, "{summary}");
    let [cause] = d.causes.as_slice() else { panic!("{summary}") };
    let found = |name: &str| cause.parameters.iter().find(|p| p.name == name).unwrap().value;
    assert_eq!(cause.effect, "friction-step", "{summary}");
    assert!((found("time_s") - time_s).abs() < 0.1, "{summary}");
    assert!((found("coulomb_effort") / change - 1.0).abs() < 0.1, "{summary}");
}

#[test]
fn a_friction_step_is_named_at_any_time_of_the_log() {
    for (i, share) in [0.2, 0.55, 0.7, 0.85].into_iter().enumerate() {
        assert_step_is_named(share, 20.0, 41 + i as u64);
    }
    for (i, share) in [0.55, 0.7, 0.85].into_iter().enumerate() {
        assert_step_is_named(share, 6.0, 52 + i as u64);
    }
}

#[test]
fn a_late_step_is_found_with_interleaved_hold_out_over_all_phases() {
    let held_out_shares = |share: f64| {
        let d = stepped(share, 20.0, 43);
        let series = &d.series[0];
        let (start, end) = (series.time_s[0], *series.time_s.last().unwrap());
        let phase = series.phase.as_ref().unwrap();
        let parts = |place: &dyn Fn(usize) -> f64| -> [f64; 8] {
            let part = |part: usize| {
                let in_part: Vec<bool> = (0..series.held_out.len())
                    .filter(|i| (8.0 * place(*i)) as usize == part)
                    .map(|i| series.held_out[i])
                    .collect();
                in_part.iter().filter(|held_out| **held_out).count() as f64 / in_part.len() as f64
            };
            std::array::from_fn(part)
        };
        let in_time = parts(&|i| (series.time_s[i] - start) / (end - start));
        (in_time, parts(&|i| phase[i].rem_euclid(1.0)))
    };
    let (in_time, in_phase) = held_out_shares(0.7);
    assert!(
        in_time.iter().chain(&in_phase).all(|share| (share - 0.5).abs() < 0.1),
        "{in_time:?} {in_phase:?}"
    );
    // An early step is found with the halves of the first pass.
    assert_eq!(held_out_shares(0.2).0.map(f64::round), [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
}

/// Two cycles of the transmission bench, the second of which is held out, with other friction from
/// 1.4 s on.
fn late_on_the_bench(exclude: &[&str]) -> Diagnosis {
    let mut nominal = Bench::open("bench-b").unwrap();
    nominal.set_cycles(2);
    let parameters = [("relative_change".to_owned(), 0.04), ("time_s".to_owned(), 1.4)];
    let mut bench = nominal.clone();
    bench.effects_mut().push(Effect {
        name: "friction-step".into(),
        channel: None,
        of: None,
        parameters: parameters.into(),
    });
    let log = record(&bench, 5).unwrap();
    let exclude: Vec<String> = exclude.iter().map(|name| (*name).to_owned()).collect();
    diagnose(&nominal, &[log], &[], &Options { exclude: &exclude, ..Options::default() }).unwrap()
}

#[test]
fn an_error_in_the_held_out_half_of_the_transmission_bench_is_found() {
    let all: Vec<&str> = CATALOGUE.iter().map(|k| k.name).collect();
    let d = late_on_the_bench(&all);
    assert_eq!(d.verdict, Verdict::Unknown);
    assert!(d.signature.as_ref().is_some_and(|left| left.rms_over_noise > 1.0), "{:?}", d.signature);

    let others: Vec<&str> = all.into_iter().filter(|name| *name != "friction-step").collect();
    let d = late_on_the_bench(&others);
    let [cause] = d.causes.as_slice() else { panic!("{:?} {:?}", d.verdict, d.causes) };
    // The time is known to a few blocks, because held-out samples between two of them do not
    // constrain it.
    for (name, truth) in [("time_s", 1.4), ("relative_change", 0.04)] {
        let found = cause.parameters.iter().find(|p| p.name == name).unwrap();
        assert!((found.value / truth - 1.0).abs() < 0.05, "{cause:?}");
    }
}
