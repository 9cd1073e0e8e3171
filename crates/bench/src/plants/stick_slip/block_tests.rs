//! Sticking laws on a block on a belt, against closed forms.
//!
//! A block of mass `m` on a spring to the wall is carried by a belt under a constant normal force,
//! and a force that grows with time pushes it. States: position and speed of the block, friction
//! heat, memory of the law.

use super::{Balance, StickingLaw};
use crate::integrate::{
    ContactAngles, ContactPlant, ContactReading, Integration, IntegrationError, Slip, Tolerances, Touch,
    integrate,
};
use contact::{FrictionKind, Karnopp, SevenParameter, SlidingLaw, SlidingParameters};
use core::f64::consts::PI;

struct Block {
    law: StickingLaw,
    mass_kg: f64,
    stiffness_n_m: f64,
    normal_n: f64,
    belt_m_s: f64,
    /// Force at a time in N.
    push_n: fn(f64) -> f64,
}

impl Block {
    /// Friction that keeps the block at the belt's speed.
    fn needed_n(&self, time_s: f64, [x, ..]: &[f64; 4]) -> f64 {
        self.stiffness_n_m * x - (self.push_n)(time_s)
    }

    fn balance(&self, time_s: f64, state: &[f64; 4]) -> Balance {
        Balance { needed_n: self.needed_n(time_s, state), limit_n: self.law.break_away_n(self.normal_n) }
    }

    fn run(
        &self,
        initial: [f64; 4],
        end_s: f64,
        samples_s: &[f64],
        observe: impl FnMut(f64, &[f64; 4], Touch),
    ) -> Result<Integration<4>, IntegrationError> {
        let tolerances = Tolerances { relative: 1e-11, absolute: [1e-13; 4], largest_step_s: 1e-2 };
        integrate(self, (0.0, end_s), initial, true, samples_s, &tolerances, observe)
    }
}

impl ContactPlant<4> for Block {
    fn derivative(&self, t: f64, state: &[f64; 4], touch: Option<Touch>, out: &mut [f64; 4]) {
        let [_, v, _, memory] = *state;
        let (slip, sliding_m_s) = (touch.unwrap_or_default().slip, v - self.belt_m_s);
        let friction_n = if slip.is_sticking() && self.law.is_rigid() {
            self.needed_n(t, state)
        } else {
            self.law.force_n(slip, t, self.normal_n, sliding_m_s, memory)
        };
        let rate = self.law.memory_rate(slip, sliding_m_s, memory);
        let acceleration = (friction_n - self.needed_n(t, state)) / self.mass_kg;
        *out = [v, acceleration, -friction_n * sliding_m_s, rate];
    }

    fn deformation(&self, _: f64, _: &[f64; 4]) -> (f64, f64) {
        (1e-3, 0.0)
    }

    fn contact(&self, _: f64, _: &[f64; 4], _: f64) -> ContactReading {
        ContactReading { depth_m: 1e-3, rate_m_s: 0.0, force_n: self.normal_n }
    }

    fn angles(&self, _: f64, _: &[f64; 4]) -> ContactAngles {
        ContactAngles::default()
    }

    fn has_slip_ended(&self, t: f64, state: &[f64; 4], touch: Touch) -> bool {
        let sliding_m_s = state[1] - self.belt_m_s;
        self.law.has_ended(touch.slip, t, sliding_m_s, state[3], || self.balance(t, state))
    }

    fn next_slip(&self, t: f64, state: &mut [f64; 4], touch: Touch) -> Slip {
        let (sliding_m_s, mut memory) = (state[1] - self.belt_m_s, state[3]);
        let next = self.law.next(touch.slip, t, sliding_m_s, &mut memory, || self.balance(t, state));
        state[3] = memory;
        if next.is_stopped {
            state[1] = self.belt_m_s;
            state[2] += 0.5 * self.mass_kg * sliding_m_s * sliding_m_s;
        }
        next.slip
    }
}

/// Coulomb's law with a static coefficient.
fn coulomb(coulomb_coefficient: f64, static_coefficient: f64) -> StickingLaw {
    let parameters = SlidingParameters {
        coulomb_coefficient,
        static_coefficient,
        still_speed_m_s: 0.0,
        full_speed_m_s: 1e-3,
        stribeck_speed_m_s: 1e-3,
        viscous_slope_s_m: 0.0,
        viscous_damping_n_s_m: 0.0,
        transition_force_n: 1.0,
    };
    let Ok(SlidingLaw::Coulomb(parameters)) = SlidingLaw::new(FrictionKind::Coulomb, parameters) else {
        panic!("Coulomb's law")
    };
    StickingLaw::Coulomb(parameters)
}

/// 2 kg on 800 N/m: 20 rad/s. Under 10 N a coefficient of 1 is worth 12.5 mm.
fn block(law: StickingLaw, belt_m_s: f64) -> Block {
    Block { law, mass_kg: 2.0, stiffness_n_m: 800.0, normal_n: 10.0, belt_m_s, push_n: |_| 0.0 }
}

fn assert_near(found: f64, expected: f64, relative: f64, name: &str) {
    assert!((found / expected - 1.0).abs() < relative, "{name}: {found} for {expected}");
}

/// Popp and Stelter 1990 (Phil. Trans. R. Soc. A 332), Leine et al. 1998 (Nonlinear Dynamics 16):
/// the limit cycle sticks for `2 A/v` and slips for `(2/w)(pi - atan(A w/v))`, with `A` the
/// difference of the friction forces over the stiffness.
#[test]
fn a_block_on_a_belt_has_the_limit_cycle_of_the_closed_form() {
    for belt_m_s in [0.01, 0.05, 0.3] {
        let plant = block(coulomb(0.2, 0.5), belt_m_s);
        let (w, amplitude_m) = (20.0, 0.3 * 0.0125);
        let stick_s = 2.0 * amplitude_m / belt_m_s;
        let slip_s = 2.0 / w * (PI - (amplitude_m * w / belt_m_s).atan());
        let start_m = 0.2 * 0.0125 - amplitude_m;
        let end_s = 7.0 * (stick_s + slip_s) + 0.5 * stick_s;
        let times: Vec<f64> = (0..20_000).map(|i| end_s * f64::from(i) / 20_000.0).collect();
        let mut highest_m = 0.0_f64;
        let run = plant.run([start_m, belt_m_s, 0.0, 0.0], end_s, &times, |_, s, _| {
            highest_m = highest_m.max(s[0]);
        });
        let run = run.unwrap();
        let [impact] = run.impacts[..] else { panic!("{:?}", run.impacts) };
        assert_eq!(impact.sticks, 8, "{belt_m_s}");
        assert_near(impact.stuck_s, 7.5 * stick_s, 1e-8, "time of sticking");
        assert!((run.state[0] - start_m - amplitude_m).abs() < 1e-10, "{:?}", run.state);
        // Heat: the force of sliding times the distance on the belt.
        let heat_j = 7.0 * 0.2 * 10.0 * (belt_m_s * slip_s + 2.0 * amplitude_m);
        assert_near(run.state[2], heat_j, 1e-8, "heat");
        let reach_m = 0.2 * 0.0125 + amplitude_m.hypot(belt_m_s / w);
        assert_near(highest_m, reach_m, 1e-5, "amplitude");
    }
}

/// Every half cycle of `pi/w` takes `2 mu N/k` off the amplitude. The block stops at the first
/// turning point where the spring does not exceed the static friction, and stays there.
#[test]
fn a_vibration_decays_linearly_and_stops() {
    // In units of `mu N/k`: 9.7, -7.7, 5.7, -3.7, 1.7, 0.3.
    for (static_coefficient, half_cycles, stop) in [(0.2, 5.0, 0.3), (0.4, 4.0, 1.7), (0.8, 3.0, -3.7)] {
        let plant = block(coulomb(0.2, static_coefficient), 0.0);
        let unit_m = 0.2 * 0.0125;
        let run = plant.run([9.7 * unit_m, 0.0, 0.0, 0.0], 2.0, &[], |_, _, _| {}).unwrap();
        let impact = run.impacts[0];
        assert_eq!(impact.sticks, 1, "{static_coefficient}");
        assert_near(2.0 - impact.stuck_s, half_cycles * PI / 20.0, 1e-9, "time of the stop");
        assert_near(run.state[0], stop * unit_m, 1e-7, "place of the stop");
        assert_eq!(run.state[1], 0.0);
        let stored = |units: f64| 0.5 * 800.0 * (units * unit_m).powi(2);
        assert_near(run.state[2], stored(9.7) - stored(stop), 1e-9, "heat");
    }
}

/// The block slides into the band and is stopped there; then a growing push breaks it away.
#[test]
fn a_band_of_speeds_counts_as_standstill() {
    let (band_m_s, normal_n, mass_kg) = (0.01, 10.0, 2.0);
    let law = StickingLaw::Karnopp(Karnopp::new(0.2, 0.5, 0.0, band_m_s).unwrap());
    let push_n = |t: f64| 4.0 * (t - 0.5).max(0.0);
    let plant = Block { law, mass_kg, stiffness_n_m: 0.0, normal_n, belt_m_s: 0.0, push_n };
    let stopped = plant.run([0.0, 0.1, 0.0, 0.0], 0.4, &[], |_, _, _| {}).unwrap();
    // 1 m/s2 down to the band.
    assert_near(stopped.state[0], 0.5 * (0.1 * 0.1 - band_m_s * band_m_s), 1e-9, "distance");
    assert_eq!(stopped.state[1], 0.0);
    assert_near(stopped.impacts[0].stuck_s, 0.4 - 0.09, 1e-9, "stop at the band");
    assert_near(stopped.state[2], 0.5 * mass_kg * 0.01, 1e-9, "heat");
    // 5 N are reached 1.25 s after the push begins. In the band friction stays at 5 N.
    let away_s: f64 = (2.0 * mass_kg * band_m_s / 4.0_f64).sqrt();
    let end_s = 2.2;
    let run = plant.run([0.0, 0.1, 0.0, 0.0], end_s, &[], |_, _, _| {}).unwrap();
    assert_near(run.impacts[0].stuck_s, 1.75 - 0.09, 1e-9, "break-away");
    let (from_s, to_s) = (1.25 + away_s, end_s - 0.5);
    let push_ns = 2.0 * (to_s * to_s - from_s * from_s);
    let speed_m_s = band_m_s + (push_ns - 0.2 * normal_n * (to_s - from_s)) / mass_kg;
    assert_near(run.state[1], speed_m_s, 1e-9, "speed after the band");
}

#[test]
fn karnopps_law_sticks_again_within_the_band_and_has_a_viscous_part_outside() {
    let law = StickingLaw::Karnopp(Karnopp::new(0.2, 0.5, 0.1, 0.01).unwrap());
    let has_ended = |sliding_m_s, needed_n| {
        let balance = || Balance { needed_n, limit_n: 5.0 };
        law.has_ended(Slip::BreakingAway { direction: 1.0 }, 0.0, sliding_m_s, 0.0, balance)
    };
    assert!(!has_ended(0.005, -5.1) && has_ended(0.005, -4.9) && has_ended(0.011, -5.1));
    let sliding = Slip::Sliding { direction: -1.0, excess: 0.0 };
    assert_near(law.force_n(sliding, 0.0, 10.0, -0.5, 0.0), 10.0 * (0.2 + 0.1 * 0.5), 1e-12, "force");
}

fn seven_parameter() -> SevenParameter {
    SevenParameter {
        stiffness_per_m: 1e4,
        coulomb_coefficient: 0.2,
        viscous_slope_s_m: 0.0,
        long_rest_excess: 0.3,
        stribeck_speed_m_s: 1e-3,
        memory_s: 0.01,
        rise_s: 0.2,
    }
}

/// The spring breaks at the force of this dwell time, so a slow belt pulls the block farther.
#[test]
fn the_break_away_of_a_spring_rises_with_its_dwell() {
    let law = seven_parameter();
    let mut reached = Vec::new();
    for belt_m_s in [0.005, 0.02, 0.08] {
        let plant = block(StickingLaw::SevenParameter(law), belt_m_s);
        let times: Vec<f64> = (0..60_000).map(|i| 1e-4 * f64::from(i)).collect();
        let (mut last, mut breaks) = (Touch::default(), Vec::new());
        let mut before = [0.0_f64; 4];
        let observe = |t: f64, s: &[f64; 4], touch: Touch| {
            if let (Slip::Sticking { since_s, excess }, Slip::Sliding { excess: risen, .. }) =
                (last.slip, touch.slip)
            {
                breaks.push((t - since_s, excess, risen, 10.0 * law.stiffness_per_m * before[3].abs()));
            }
            (last, before) = (touch, *s);
        };
        plant.run([0.0, belt_m_s, 0.0, 0.0], 6.0, &times, observe).unwrap();
        assert!(breaks.len() > 2, "{breaks:?}");
        // The first standstill is a long one.
        for (dwell_s, excess, risen, force_n) in breaks.iter().skip(1) {
            let expected = excess + (law.long_rest_excess - excess) * dwell_s / (dwell_s + law.rise_s);
            assert_near(*risen, expected, 2e-2, "excess");
            // The spring is read at the last sample before.
            assert_near(*force_n, 10.0 * (law.coulomb_coefficient + risen), 5e-2, "break-away force");
        }
        reached.push(breaks[2].2);
    }
    assert!(reached.is_sorted_by(|a, b| *a > 1.05 * b), "{reached:?}");
}

#[test]
fn sliding_of_the_seven_parameter_law_continues_through_break_away() {
    let law = StickingLaw::SevenParameter(seven_parameter());
    let balance = || Balance { needed_n: 0.0, limit_n: 0.0 };
    let stuck = Slip::Sticking { since_s: 1.0, excess: 0.1 };
    // After 0.2 s half of the excess has recovered: 0.2 + 0.2 over 1e4/m.
    let limit_m = 0.4 / 1e4;
    assert!(!law.has_ended(stuck, 1.2, 1e-3, 0.999 * limit_m, balance));
    assert!(law.has_ended(stuck, 1.2, 1e-3, 1.001 * limit_m, balance));
    let mut memory = -1.001 * limit_m;
    let before = law.force_n(stuck, 1.2, 10.0, -1e-3, memory);
    let next = law.next(stuck, 1.2, -1e-3, &mut memory, balance);
    let Slip::Sliding { direction, excess } = next.slip else { panic!("{next:?}") };
    assert!(direction == -1.0 && (excess - 0.2).abs() < 1e-12 && memory == 0.0, "{next:?} {memory}");
    let after = law.force_n(next.slip, 1.2, 10.0, -1e-3, memory);
    assert_near(before, after, 2e-3, "force");
    // The lagging speed approaches 3 mm/s within 10 ms.
    assert_near(law.memory_rate(next.slip, -3e-3, 1e-3), 0.2, 1e-12, "lag");
}

/// A push that vibrates across the limit at 1.6 MHz.
#[test]
fn a_slip_that_changes_too_often_ends_the_run() {
    let push_n = |t: f64| 1.9 + (1e7 * t).sin();
    let plant = Block { push_n, stiffness_n_m: 0.0, ..block(coulomb(0.2, 0.2), 0.0) };
    match plant.run([0.0; 4], 1.0, &[], |_, _, _| {}) {
        Err(error @ IntegrationError::SlipChattering { contact: 0, count: 500, window_s, .. }) => {
            assert!(window_s < 1e-2, "{error}");
            assert!(
                error.to_string().starts_with("contact 0 changes between sticking and sliding 500 times")
            );
        }
        other => panic!("{other:?}"),
    }
}
