//! Integrated free impacts: every factor on every stiffness rebounds with the restitution of the
//! closed relation.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use contact::{
    BearingMaterial, ContactLaw, Damping, Dissipation, FactorisedLaw, Joint, Material, NormalLaw,
    SpringDashpot, Stiffness, StiffnessKind, StiffnessParameters, produced_restitution,
};
use proptest::prelude::*;

/// Result of an impact: rebound speed over approach speed, depth in m, largest force in N, duration
/// in s.
struct Impact {
    restitution: f64,
    depth_m: f64,
    force_n: f64,
    duration_s: f64,
}

/// Integrates the impact of a mass by RK4, in steps of a fraction of `duration_s`, an estimate of
/// its duration.
fn impact(law: &ContactLaw, mass_kg: f64, speed_m_s: f64, duration_s: f64, steps: f64) -> Impact {
    let step = duration_s / steps;
    let acceleration = |d: f64, v: f64| -law.force_n(d, v, speed_m_s) / mass_kg;
    let (mut d, mut v, mut t) = (0.0, speed_m_s, 0.0);
    let (mut depth_m, mut force_n) = (0.0_f64, 0.0_f64);
    loop {
        let (k1d, k1v) = (v, acceleration(d, v));
        let (k2d, k2v) = (v + 0.5 * step * k1v, acceleration(d + 0.5 * step * k1d, v + 0.5 * step * k1v));
        let (k3d, k3v) = (v + 0.5 * step * k2v, acceleration(d + 0.5 * step * k2d, v + 0.5 * step * k2v));
        let (k4d, k4v) = (v + step * k3v, acceleration(d + step * k3d, v + step * k3v));
        let next_d = d + step / 6.0 * (k1d + 2.0 * k2d + 2.0 * k3d + k4d);
        let next_v = v + step / 6.0 * (k1v + 2.0 * k2v + 2.0 * k3v + k4v);
        if next_d <= 0.0 {
            let share = d / (d - next_d);
            let restitution = -(v + share * (next_v - v)) / speed_m_s;
            return Impact { restitution, depth_m, force_n, duration_s: t + step * share };
        }
        (d, v, t) = (next_d, next_v, t + step);
        depth_m = depth_m.max(d);
        force_n = force_n.max(law.force_n(d, v, speed_m_s));
    }
}

/// Duration in s of an elastic impact, roughly: three depths over the speed.
fn elastic_duration_s(stiffness: &Stiffness, mass_kg: f64, speed_m_s: f64) -> f64 {
    let (mut low, mut high) = (1e-12, 1.0);
    for _ in 0..60 {
        let depth = f64::sqrt(low * high);
        let work: f64 =
            (0..50).map(|i| stiffness.force_n((f64::from(i) + 0.5) / 50.0 * depth) * depth / 50.0).sum();
        if work < 0.5 * mass_kg * speed_m_s * speed_m_s { low = depth } else { high = depth }
    }
    3.0 * high / speed_m_s
}

fn latched(stiffness: Stiffness, dissipation: Dissipation, e: f64) -> ContactLaw {
    let damping = Damping::Latched { floor_m_s: 1e-9 };
    ContactLaw::Factorised(FactorisedLaw::new(stiffness, dissipation, e, damping).unwrap())
}

fn every_stiffness() -> Vec<(StiffnessKind, Stiffness)> {
    let joint = Joint {
        bearing_radius_m: 0.07,
        radial_clearance_m: 0.5e-3,
        length_m: 0.14,
        bearing: BearingMaterial::Babbitt.elastic(),
        journal: Material::STEEL,
    };
    let parameters = StiffnessParameters { joint, coefficient: Some(1e9), exponent: Some(1.2) };
    StiffnessKind::ALL.into_iter().map(|kind| (kind, kind.build(&parameters).unwrap())).collect()
}

#[test]
fn every_factor_on_every_stiffness_returns_with_the_exact_restitution() {
    let (mass, speed) = (10.0, 0.5);
    for (kind, stiffness) in every_stiffness() {
        let duration = elastic_duration_s(&stiffness, mass, speed);
        for dissipation in Dissipation::ALL {
            for e in [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95] {
                let expected = produced_restitution(dissipation.factor(e));
                let found =
                    impact(&latched(stiffness, dissipation, e), mass, speed, duration, 1000.0).restitution;
                assert!(
                    (found / expected - 1.0).abs() < 1e-4,
                    "{kind:?} {dissipation:?} e = {e}: {found} for {expected}"
                );
            }
        }
    }
}

#[test]
fn hertz_impact_matches_the_closed_form() {
    let law = latched(Stiffness::Hertz { coefficient: 1e9 }, Dissipation::None, 1.0);
    let found = impact(&law, 1.0, 1.0, 8e-4, 1e5);
    let closed = (5.0 / (4.0 * 1e9_f64)).powf(0.4);
    assert!((closed / 2.746401e-4 - 1.0).abs() < 1e-6);
    assert!((found.depth_m / 2.746401e-4 - 1.0).abs() < 1e-6, "{}", found.depth_m);
    assert!((found.force_n / 4551.4105 - 1.0).abs() < 1e-6, "{}", found.force_n);
    assert!((found.duration_s / 8.083415e-4 - 1.0).abs() < 1e-5, "{}", found.duration_s);
    assert!((found.restitution - 1.0).abs() < 1e-6, "{}", found.restitution);
}

#[test]
fn a_reference_speed_keeps_the_restitution_there_and_raises_it_below() {
    let stiffness = Stiffness::Hertz { coefficient: 1e9 };
    for dissipation in [Dissipation::HuntCrossley, Dissipation::Exact] {
        let damping = Damping::Reference { speed_m_s: 0.1 };
        let law = FactorisedLaw::new(stiffness, dissipation, 0.6, damping).unwrap();
        let at = |speed: f64| {
            let duration = elastic_duration_s(&stiffness, 2.0, speed);
            impact(&ContactLaw::Factorised(law), 2.0, speed, duration, 3000.0).restitution
        };
        let nominal = produced_restitution(dissipation.factor(0.6));
        assert!((at(0.1) / nominal - 1.0).abs() < 1e-5, "{dissipation:?}: {}", at(0.1));
        for speed in [0.001, 0.01, 0.05, 0.2, 0.5] {
            let expected = produced_restitution(dissipation.factor(0.6) * damping.rate_ratio(speed, speed));
            assert!((at(speed) / expected - 1.0).abs() < 1e-4, "{speed}: {} for {expected}", at(speed));
        }
        assert!(at(0.001) > 0.98);
    }
}

#[test]
fn bounded_and_latched_are_one_law_in_a_free_impact() {
    let stiffness = Stiffness::Hertz { coefficient: 1e9 };
    let law = |damping| {
        ContactLaw::Factorised(FactorisedLaw::new(stiffness, Dissipation::Flores, 0.4, damping).unwrap())
    };
    let restitution = |damping| impact(&law(damping), 1.0, 0.3, 1e-3, 2000.0).restitution;
    let (latched, bounded) = (
        restitution(Damping::Latched { floor_m_s: 1e-3 }),
        restitution(Damping::Bounded { floor_m_s: 1e-3 }),
    );
    assert!((latched / bounded - 1.0).abs() < 1e-12);
}

#[test]
fn below_the_latch_floor_the_rebound_grows_as_the_method_says() {
    let stiffness = Stiffness::Hertz { coefficient: 1e9 };
    let normal = NormalLaw::new(stiffness, Dissipation::ZhiyingQishao, 0.4, 0.1).unwrap();
    let speed = 0.02;
    let duration = elastic_duration_s(&stiffness, 1.0, speed);
    let found = impact(&normal.into(), 1.0, speed, duration, 2000.0).restitution;
    let ratio = FactorisedLaw::from(normal).damping().rate_ratio(speed, speed);
    let expected = produced_restitution(Dissipation::ZhiyingQishao.factor(0.4) * ratio);
    assert!((found / expected - 1.0).abs() < 1e-4, "{found} for {expected}");
    assert!(found > 2.0 * 0.39, "far more than the nominal .4");
}

#[test]
fn spring_and_dashpot_return_with_their_closed_form() {
    for e in [0.2, 0.4, 0.8] {
        let spring = SpringDashpot::anagnostopoulos(1e8, e, 2.0).unwrap();
        let law = ContactLaw::SpringDashpot(spring);
        let found = impact(&law, 2.0, 0.3, 4.5e-4, 20_000.0).restitution;
        let expected = spring.produced_restitution(2.0);
        assert!((found / expected - 1.0).abs() < 2e-4, "e = {e}: {found} for {expected}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_restitution_does_not_depend_on_stiffness_exponent_mass_or_speed(
        decades in 5.0..11.0_f64, exponent in 1.0..3.0_f64, mass in 0.01..1e3_f64, speed in 0.01..10.0_f64,
        e in 0.1..1.0_f64, factor in 0..11_usize,
    ) {
        let stiffness = Stiffness::Power { coefficient: 10_f64.powf(decades), exponent };
        let duration = elastic_duration_s(&stiffness, mass, speed);
        let dissipation = Dissipation::ALL[factor];
        let found = impact(&latched(stiffness, dissipation, e), mass, speed, duration, 1000.0).restitution;
        let expected = produced_restitution(dissipation.factor(e));
        prop_assert!((found / expected - 1.0).abs() < 2e-4, "{} for {}", found, expected);
    }
}
