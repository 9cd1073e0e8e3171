//! Declared numbers that deviate beyond their tolerance are found, and deviations that change
//! nothing are notes.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bench::Bench;
use bench::effects::Effect;
use bench::simulate::record;
use diagnosis::{Diagnosis, Options, Severity, Verdict, diagnose};

/// A shaft of 0.8 kg m2 with dry friction of 6 +- 0.2 N m that swings for `cycles` cycles.
fn described(cycles: u32) -> Bench {
    let text = format!(
        "plant = \"friction-rig\"
[axis]
kind = \"rotary\"
inertia = 0.8
friction_radius_m = 0.05
load_gain = 0.05
coulomb_effort = 6.0
viscous_effort = 0.3
load_coefficient = 0.0
regularisation_m_s = 1e-3
period_s = 2.0
amplitude = 0.5
cycles = {cycles}
[load]
force_n = 100.0
ramp_s = 0.05
[logging]
sample_rate_hz = 200.0
[sensors]
drive_torque_nm = {{ noise = 0.05 }}
[uncertain]
\"axis.inertia\" = 0.04
\"axis.coulomb_effort\" = 0.2
\"axis.constant_effort\" = 0.05
"
    );
    Bench::parse("shaft.toml", &text).unwrap()
}

/// The diagnosis of a log in which a number of the description has another value.
fn with_number(name: &str, value: f64) -> Diagnosis {
    let bench = described(10);
    let mut truth = bench.clone();
    *truth.parameter_mut(name).unwrap() = value;
    diagnose(&bench, &[record(&truth, 3).unwrap()], &[], &Options::default()).unwrap()
}

/// The diagnosis of a log of 400 cycles with additional viscous friction whose torque has an rms of
/// a share of the sensor's noise.
fn with_viscous_friction(share: f64) -> Diagnosis {
    let bench = described(400);
    let mut truth = bench.clone();
    let rms_speed = 0.5 * std::f64::consts::PI / std::f64::consts::SQRT_2;
    let parameters = [("viscous_effort".to_owned(), share * 0.05 / rms_speed)].into();
    truth.effects_mut().push(Effect { name: "viscous-friction".into(), channel: None, of: None, parameters });
    diagnose(&bench, &[record(&truth, 3).unwrap()], &[], &Options::default()).unwrap()
}

fn sum_of_probabilities(d: &Diagnosis) -> f64 {
    d.probability_none + d.probability_unknown + d.hypotheses.iter().map(|h| h.probability).sum::<f64>()
}

#[test]
fn a_declared_number_beyond_three_deviations_is_the_effect_that_changes_it() {
    for (name, described, deviation, effect) in
        [("axis.coulomb_effort", 6.0, 0.2, "coulomb-level"), ("axis.inertia", 0.8, 0.04, "inertia-mismatch")]
    {
        for off in [-3.7, 3.4, 4.0, 4.6] {
            let d = with_number(name, described + off * deviation);
            assert_eq!(d.verdict, Verdict::Named, "{name} {off}: {:?}", d.ranking);
            assert_eq!((d.causes.len(), d.causes[0].effect.as_str()), (1, effect), "{name} {off}");
            let found = &d.causes[0].parameters[0];
            assert!((found.value / (off * deviation) - 1.0).abs() < 0.05, "{name} {off}: {found:?}");
            assert!(d.causes[0].probability > 0.95 && (sum_of_probabilities(&d) - 1.0).abs() < 1e-9);
            let gain = &d.causes[0].gain[0];
            assert!(gain.baseline_rms > gain.extended_rms, "{name} {off}: {gain:?}");
        }
    }
}

#[test]
fn a_declared_number_within_two_and_a_half_deviations_is_no_fault() {
    for off in [-2.5, 2.5] {
        let d = with_number("axis.coulomb_effort", 6.0 + off * 0.2);
        assert_eq!((d.verdict, d.causes.len()), (Verdict::None, 0), "{off}");
    }
}

#[test]
fn a_number_that_no_effect_changes_is_a_finding_and_the_verdict_is_not_none() {
    let d = with_number("axis.constant_effort", 3.8 * 0.05);
    assert_eq!(d.verdict, Verdict::Unknown, "{:?}", d.causes);
    let finding = d.checks.iter().find(|f| f.kind == "out-of-tolerance").unwrap();
    assert!(finding.severity == Severity::Doubtful && finding.channel == "axis.constant_effort");
    assert!((finding.evidence["value"] / 0.19 - 1.0).abs() < 0.01, "{finding:?}");
}

#[test]
fn a_significant_deviation_below_a_twentieth_of_the_noise_is_a_note() {
    let small = with_viscous_friction(0.04);
    assert_eq!((small.verdict, small.causes.len()), (Verdict::None, 0));
    let note = small.checks.iter().find(|f| f.kind == "immaterial").unwrap();
    assert!(note.severity == Severity::Note && note.found.contains("viscous-friction"), "{note:?}");
    assert!(small.probability_none > 0.9 && (sum_of_probabilities(&small) - 1.0).abs() < 1e-9);
    let large = with_viscous_friction(0.15);
    assert!(matches!(large.verdict, Verdict::Named | Verdict::Ambiguous), "{:?}", large.verdict);
    assert_eq!(large.causes[0].effect, "viscous-friction");
}
