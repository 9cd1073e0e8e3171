//! Every class, from given messages.

use super::*;
use crate::faults::plan::Action;
use crate::faults::stream;
use crate::faults::table::Table;
use controller::configuration::BENCH_B;
use controller::flags::{HELD, JUMP};
use link::{Fault as Refusal, FrameError, Hello, NumberedEstimate};

const SAMPLES: u32 = 10;

fn scenario() -> Scenario {
    let reference = |sequence| EstimateFrame {
        sequence,
        time_us: 100 * sequence,
        normal_force_n: 1_000.0,
        deformation_m: 1e-5,
        ..EstimateFrame::default()
    };
    Scenario {
        configuration: BENCH_B,
        frames: vec![],
        reference: (0..SAMPLES).map(reference).collect(),
        track: Default::default(),
        force_full_scale_n: 1_000.0,
        torque_full_scale_nm: 10.0,
        deformation_full_scale_m: 1e-5,
    }
}

fn fault() -> Fault {
    let (kind, action) = (Kind::State, Action::Flip { address: 0, bit: 0, during: None });
    Fault { number: 1, kind, sample: 2, action, random: stream(1, 1) }
}

/// Messages of a run without fault, each estimate changed by a function.
fn received(change: impl Fn(&mut EstimateFrame)) -> Vec<Received> {
    let estimates = scenario().reference.into_iter().map(|mut estimate| {
        change(&mut estimate);
        Ok(ToHost::Estimate(NumberedEstimate { number: estimate.sequence, dropped: 0, estimate }))
    });
    estimates.collect()
}

fn classified(received: &[Received], end: PumpEnd) -> (Class, Option<String>, Option<u32>, u32) {
    let outcome = classify(&fault(), &scenario(), received, end);
    (outcome.class, outcome.first_report, outcome.late, outcome.wrong)
}

/// Estimates that are wrong from sample 4 on, with a mark in sample 7 only.
fn marked_in_the_middle(mark: u32) -> Vec<Received> {
    received(move |estimate| {
        off_from(4, 0.5)(estimate);
        estimate.flags = if estimate.sequence == 7 { mark } else { 0 };
    })
}

fn off_from(place: u32, share: f32) -> impl Fn(&mut EstimateFrame) {
    move |estimate| {
        if estimate.sequence >= place {
            estimate.normal_force_n += 1_000.0 * share;
        }
    }
}

#[test]
fn without_a_report_a_fault_is_harmless_within_the_bound_and_silent_beyond_it() {
    assert_eq!(classified(&received(|_| {}), PumpEnd::Arrived), (Class::Harmless, None, None, 0));
    assert_eq!(classified(&received(off_from(4, 0.049)), PumpEnd::Arrived).0, Class::Harmless);
    assert_eq!(classified(&received(off_from(4, 0.051)), PumpEnd::Arrived), (Class::Silent, None, None, 6));
    assert_eq!(classified(&received(off_from(9, f32::NAN)), PumpEnd::Arrived).0, Class::Silent);
    let nowhere = |estimate: &mut EstimateFrame| {
        estimate.deformation_m = 0.0;
        estimate.contact_angle_rad = f32::NAN;
    };
    let mut apart = scenario();
    apart.reference.iter_mut().for_each(|reference| reference.deformation_m = 0.0);
    assert_eq!(classify(&fault(), &apart, &received(nowhere), PumpEnd::Arrived).class, Class::Silent);
    let turned = |estimate: &mut EstimateFrame| estimate.contact_angle_rad = 0.2;
    assert_eq!(classified(&received(turned), PumpEnd::Arrived).0, Class::Silent);
}

#[test]
fn a_mark_in_time_detects_and_a_later_one_is_late() {
    let marked = |from: u32, flags: u32| {
        received(move |estimate| {
            off_from(4, 0.5)(estimate);
            estimate.flags = if estimate.sequence >= from { flags } else { 0 };
        })
    };
    let (jump, held) = (JUMP.bits(), (JUMP | HELD).bits());
    assert_eq!(
        classified(&marked(4, jump), PumpEnd::Arrived),
        (Class::Detected, Some("jump".into()), None, 0)
    );
    assert_eq!(
        classified(&marked(7, held), PumpEnd::Arrived),
        (Class::DetectedLate, Some("jump".into()), Some(3), 3)
    );
    assert_eq!(
        classified(&marked(4, OVER_FORCE.bits()), PumpEnd::Arrived).0,
        Class::Silent,
        "over-force is no mark"
    );
    // Marked once and wrong again.
    let once = received(|estimate| {
        off_from(4, 0.5)(estimate);
        estimate.flags = if estimate.sequence == 4 { jump } else { 0 };
    });
    assert_eq!(classified(&once, PumpEnd::Arrived), (Class::WrongAgain, Some("jump".into()), None, 5));
    let outcome = classify(&fault(), &scenario(), &once, PumpEnd::Arrived);
    assert_eq!((outcome.wrong, outcome.wrong_after_report), (5, 5));
    let table = Table::from_outcomes(&[outcome]);
    assert_eq!((table.all.faults, table.all.detected, table.all.wrong_again), (1, 0, 1));
    // Late, then marked, then wrong again: the count begins with the report.
    let late = marked_in_the_middle(jump);
    assert_eq!(classify(&fault(), &scenario(), &late, PumpEnd::Arrived).wrong_after_report, 2);
}

#[test]
fn every_message_that_the_host_does_not_expect_is_a_report() {
    let hello = || {
        let native = host_sim::controller::NativeController::open().unwrap();
        let hello = *host_sim::controller::Controller::hello(&native);
        Ok(ToHost::Hello(Hello { token: 0, ..hello }))
    };
    let with = |place: usize, message: Received| {
        let mut received = received(|_| {});
        received.insert(place, message);
        classified(&received, PumpEnd::Arrived)
    };
    assert_eq!(with(0, hello()).0, Class::Harmless, "the first hello frame is expected");
    let mut restarted = received(|_| {});
    restarted.insert(0, hello());
    restarted.insert(6, hello());
    assert_eq!(classified(&restarted, PumpEnd::Arrived).0, Class::Detected);
    assert_eq!(with(5, Err(FrameError::Crc)).1, Some("damaged frame".into()));
    let refused = Ok(ToHost::Fault(Refusal::NotConfigured { sequence: 5 }));
    assert_eq!(with(5, refused).1, Some("fault answer".into()));
    let mut missing = received(|_| {});
    let _ = missing.remove(5);
    assert_eq!(classified(&missing, PumpEnd::Arrived).1, Some("missing estimate".into()));
    let mut cut = received(|_| {});
    cut.truncate(7);
    assert_eq!(
        classified(&cut, PumpEnd::Arrived),
        (Class::Detected, Some("missing estimate".into()), None, 0)
    );
    // An old estimate after wrong ones does not report the wrong ones before it.
    let mut old = received(off_from(4, 0.5));
    let first = old[0];
    old.push(first);
    assert_eq!(classified(&old, PumpEnd::Arrived).0, Class::DetectedLate);
    assert_eq!(classified(&received(|_| {}), PumpEnd::TimedOut).1, Some("time-out".into()));
    assert_eq!(classified(&received(|_| {}), PumpEnd::Exited).1, Some("end".into()));
}
