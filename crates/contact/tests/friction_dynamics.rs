//! Friction laws with memory in motion: break-away, pre-sliding, stick-slip on a belt.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use contact::{Karnopp, KarnoppState, LuGre, SevenParameter, SevenParameterState};

const LUGRE: LuGre = LuGre {
    coulomb_coefficient: 0.15,
    static_coefficient: 0.25,
    stribeck_speed_m_s: 0.01,
    stiffness_per_m: 1e5,
    damping_s_m: 30.0,
    viscous_slope_s_m: 0.5,
};
const NORMAL_N: f64 = 10.0;
const STATIC_N: f64 = 2.5;
const COULOMB_N: f64 = 1.5;
const SPRING_N_M: f64 = 1000.0;
const STEP_S: f64 = 1e-5;

fn karnopp() -> Karnopp {
    Karnopp::new(0.15, 0.25, 0.5, 1e-5).unwrap()
}

/// Simulates a mass of 1 kg on a spring on a belt for 8 s. Returns its swing in m over the last
/// quarter and the share of that time in which it moves with the belt to within a hundredth of the
/// belt's speed.
fn on_a_belt(belt_m_s: f64, mut friction_n: impl FnMut(f64, f64) -> f64) -> (f64, f64) {
    let count = 800_000;
    let (mut x, mut v) = (0.0_f64, belt_m_s);
    let (mut low, mut high, mut stuck) = (f64::INFINITY, f64::NEG_INFINITY, 0);
    for index in 0..count {
        let spring = -SPRING_N_M * x;
        v += STEP_S * (spring + friction_n(v - belt_m_s, spring));
        x += STEP_S * v;
        if index >= count / 4 * 3 {
            low = low.min(x);
            high = high.max(x);
            stuck += i32::from((v - belt_m_s).abs() < 0.01 * belt_m_s);
        }
    }
    (high - low, f64::from(stuck) / f64::from(count / 4))
}

fn lugre_on_a_belt(belt_m_s: f64) -> (f64, f64) {
    let mut z = 0.0;
    on_a_belt(belt_m_s, |sliding, _| {
        z = LUGRE.advanced_m(z, sliding, STEP_S);
        LUGRE.force_n(NORMAL_N, z, sliding)
    })
}

fn karnopp_on_a_belt(belt_m_s: f64) -> (f64, f64) {
    let law = karnopp();
    on_a_belt(belt_m_s, |sliding, applied| law.force_n(NORMAL_N, sliding, applied))
}

#[test]
fn lugre_sticks_and_slips_on_a_slow_belt_and_slides_on_a_fast_one() {
    let (swing, stuck) = lugre_on_a_belt(0.002);
    // The spring swings from break-away at F_s to about as far below F_c: 2 (F_s - F_c)/k = 2 mm.
    assert!((1e-3..2.2e-3).contains(&swing) && stuck > 0.5, "slow: {swing} m, {stuck}");
    let (swing, stuck) = lugre_on_a_belt(0.3);
    assert!(swing < 1e-5 && stuck == 0.0, "fast: {swing} m, {stuck}");
}

#[test]
fn karnopp_sticks_and_slips_on_a_slow_belt_and_slides_on_a_fast_one() {
    let (swing, stuck) = karnopp_on_a_belt(0.002);
    assert!((1e-3..2.2e-3).contains(&swing) && stuck > 0.5, "slow: {swing} m, {stuck}");
    let (swing, stuck) = karnopp_on_a_belt(0.3);
    assert!(swing < 1e-5 && stuck == 0.0, "fast: {swing} m, {stuck}");
}

/// Returns the largest friction in N on a mass of 1 kg under a ramp of the applied force, until it
/// slides at 50 mm/s.
fn lugre_break_away_n(rate_n_s: f64) -> f64 {
    let (mut z, mut v, mut t, mut largest) = (0.0, 0.0_f64, 0.0, 0.0_f64);
    while v < 0.05 {
        t += STEP_S;
        z = LUGRE.advanced_m(z, v, STEP_S);
        let friction = LUGRE.force_n(NORMAL_N, z, v);
        v += STEP_S * (rate_n_s * t + friction);
        largest = largest.max(-friction);
    }
    largest
}

#[test]
fn lugre_breaks_away_near_the_static_force_and_earlier_under_a_faster_ramp() {
    let slow = lugre_break_away_n(0.5);
    assert!((slow / STATIC_N - 1.0).abs() < 0.02, "{slow}");
    let fast = lugre_break_away_n(500.0);
    assert!(fast < slow && fast > COULOMB_N, "{fast}");
}

#[test]
fn karnopp_breaks_away_at_the_static_force() {
    let law = karnopp();
    let breaks = |applied| law.state(NORMAL_N, 0.0, applied) == KarnoppState::BreakingAway;
    assert!(!breaks(STATIC_N) && breaks(STATIC_N * (1.0 + 1e-12)));
}

#[test]
fn seven_parameters_break_away_within_one_step_of_the_static_force() {
    let law = SevenParameter {
        stiffness_per_m: 1e5,
        coulomb_coefficient: 0.15,
        viscous_slope_s_m: 0.5,
        long_rest_excess: 0.1,
        stribeck_speed_m_s: 0.01,
        memory_s: 0.01,
        rise_s: 0.5,
    };
    let mut state = law.rested();
    let (speed, mut largest) = (1e-6, 0.0_f64);
    while matches!(state, SevenParameterState::Sticking { .. }) {
        largest = largest.max(-law.force_n(NORMAL_N, &state, speed));
        state = law.advanced(state, speed, 1e-3);
    }
    // A step moves the spring by 1 nm, which is 1 mN.
    assert!(largest <= STATIC_N && largest > STATIC_N - 2e-3, "{largest}");
}

#[test]
fn lugre_before_sliding_closes_a_loop_that_encloses_work() {
    let steps = 20_000;
    let step = std::f64::consts::TAU / f64::from(steps);
    let amplitude = 5e-7;
    let mut z = 0.0;
    let mut loops = Vec::new();
    for _ in 0..4 {
        let mut work = 0.0;
        for index in 0..steps {
            let v = amplitude * (step * (f64::from(index) + 0.5)).cos();
            let next = LUGRE.advanced_m(z, v, step);
            work -= LUGRE.force_n(NORMAL_N, 0.5 * (z + next), v) * v * step;
            z = next;
        }
        loops.push((work, z));
    }
    assert!(loops[3].0 > 0.0, "{loops:?}");
    assert!(
        (loops[3].0 / loops[2].0 - 1.0).abs() < 0.05 && (loops[3].1 - loops[2].1).abs() < 0.05 * amplitude
    );
    assert!(loops[3].0 < 0.5 * 4.0 * STATIC_N * amplitude, "{loops:?}");
}
