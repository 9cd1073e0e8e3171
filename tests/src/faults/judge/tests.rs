//! Every class, from what was said.

use super::*;
use crate::faults::Random;
use crate::faults::plan::Action;
use firmware::configuration::BENCH_B;
use firmware::flags::{HELD, JUMP};
use link::{Fault as Refusal, FrameError, Hello, NumberedEstimate};

const SAMPLES: u32 = 10;

fn stage() -> Stage {
    let sound = |sequence| EstimateFrame {
        sequence,
        time_us: 100 * sequence,
        normal_force_n: 1_000.0,
        deformation_m: 1e-5,
        ..EstimateFrame::default()
    };
    Stage {
        configuration: BENCH_B,
        frames: vec![],
        sound: (0..SAMPLES).map(sound).collect(),
        track: Default::default(),
        force_full_scale_n: 1_000.0,
        torque_full_scale_nm: 10.0,
        deformation_full_scale_m: 1e-5,
    }
}

fn fault() -> Fault {
    let (kind, action) = (Kind::State, Action::Flip { address: 0, bit: 0, during: None });
    Fault { number: 1, kind, sample: 2, action, random: Random::new(1, 1) }
}

/// What is said when everything is sound, changed.
fn said(change: impl Fn(&mut EstimateFrame)) -> Vec<Said> {
    let estimates = stage().sound.into_iter().map(|mut estimate| {
        change(&mut estimate);
        Ok(ToHost::Estimate(NumberedEstimate { number: estimate.sequence, dropped: 0, estimate }))
    });
    estimates.collect()
}

fn classed(said: &[Said], pumped: Pumped) -> (Class, Option<String>, Option<u32>, u32) {
    let outcome = judge(&fault(), &stage(), said, pumped);
    (outcome.class, outcome.told, outcome.late, outcome.wrong)
}

fn off_from(place: u32, share: f32) -> impl Fn(&mut EstimateFrame) {
    move |estimate| {
        if estimate.sequence >= place {
            estimate.normal_force_n += 1_000.0 * share;
        }
    }
}

#[test]
fn what_is_not_told_is_harmless_within_the_bound_and_silent_beyond_it() {
    assert_eq!(classed(&said(|_| {}), Pumped::Come), (Class::Harmless, None, None, 0));
    assert_eq!(classed(&said(off_from(4, 0.049)), Pumped::Come).0, Class::Harmless);
    assert_eq!(classed(&said(off_from(4, 0.051)), Pumped::Come), (Class::Silent, None, None, 6));
    assert_eq!(classed(&said(off_from(9, f32::NAN)), Pumped::Come).0, Class::Silent);
    let nowhere = |estimate: &mut EstimateFrame| {
        estimate.deformation_m = 0.0;
        estimate.contact_angle_rad = f32::NAN;
    };
    let mut apart = stage();
    apart.sound.iter_mut().for_each(|sound| sound.deformation_m = 0.0);
    assert_eq!(judge(&fault(), &apart, &said(nowhere), Pumped::Come).class, Class::Silent);
    let turned = |estimate: &mut EstimateFrame| estimate.contact_angle_rad = 0.2;
    assert_eq!(classed(&said(turned), Pumped::Come).0, Class::Silent);
}

#[test]
fn a_mark_in_time_detects_and_a_later_one_is_late() {
    let marked = |from: u32, flags: u32| {
        said(move |estimate| {
            off_from(4, 0.5)(estimate);
            estimate.flags = if estimate.sequence >= from { flags } else { 0 };
        })
    };
    let (jump, held) = (JUMP.bits(), (JUMP | HELD).bits());
    assert_eq!(classed(&marked(4, jump), Pumped::Come), (Class::Detected, Some("jump".into()), None, 0));
    assert_eq!(
        classed(&marked(7, held), Pumped::Come),
        (Class::DetectedLate, Some("jump".into()), Some(3), 3)
    );
    assert_eq!(classed(&marked(4, OVER_FORCE.bits()), Pumped::Come).0, Class::Silent, "no mark");
    // Marked once and wrong again: not silent, but counted.
    let once = said(|estimate| {
        off_from(4, 0.5)(estimate);
        estimate.flags = if estimate.sequence == 4 { jump } else { 0 };
    });
    assert_eq!(classed(&once, Pumped::Come), (Class::Detected, Some("jump".into()), None, 5));
}

#[test]
fn whatever_the_host_would_stumble_over_is_told() {
    let hello = || {
        let native = host_sim::controller::NativeController::open().unwrap();
        let hello = *host_sim::controller::Controller::hello(&native);
        Ok(ToHost::Hello(Hello { token: 0, ..hello }))
    };
    let with = |place: usize, message: Said| {
        let mut said = said(|_| {});
        said.insert(place, message);
        classed(&said, Pumped::Come)
    };
    assert_eq!(with(0, hello()).0, Class::Harmless, "its own greeting");
    let mut restarted = said(|_| {});
    restarted.insert(0, hello());
    restarted.insert(6, hello());
    assert_eq!(classed(&restarted, Pumped::Come).0, Class::Detected);
    assert_eq!(with(5, Err(FrameError::Crc)).1, Some("damaged frame".into()));
    let refused = Ok(ToHost::Fault(Refusal::NotConfigured { sequence: 5 }));
    assert_eq!(with(5, refused).1, Some("fault answer".into()));
    let mut missing = said(|_| {});
    let _ = missing.remove(5);
    assert_eq!(classed(&missing, Pumped::Come).1, Some("missing estimate".into()));
    let mut cut = said(|_| {});
    cut.truncate(7);
    assert_eq!(classed(&cut, Pumped::Come), (Class::Detected, Some("missing estimate".into()), None, 0));
    // An old estimate behind wrong ones tells nothing of the time before them.
    let mut old = said(off_from(4, 0.5));
    let first = old[0];
    old.push(first);
    assert_eq!(classed(&old, Pumped::Come).0, Class::DetectedLate);
    assert_eq!(classed(&said(|_| {}), Pumped::Silent).1, Some("time-out".into()));
    assert_eq!(classed(&said(|_| {}), Pumped::Ended).1, Some("end".into()));
}
