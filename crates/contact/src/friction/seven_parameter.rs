//! Seven-parameter model (Armstrong-Helouvry 1991; Armstrong-Helouvry, Dupont and Canudas de Wit
//! 1994): a spring while it sticks, a delayed Stribeck curve while it slides, a break-away force
//! that rises with the time at standstill.
//!
//! * Sticking: `F = -N s_0 x`, `x` the pre-sliding displacement.
//! * Sliding: `F = -N (mu_c + k |v| + mu_st/(1 + (v_L/v_s)^2)) sgn v`.
//! * Break-away when `s_0 |x|` reaches `mu_c + mu_st(t_2)`, `mu_st(t_2) = mu_a + (mu_inf - mu_a)
//!   t_2/(t_2 + gamma)`, with `t_2` the time at standstill and `mu_a` the Stribeck part at the end
//!   of the last slide.
//!
//! The seven: `s_0, mu_c, k, mu_inf, v_s, tau, gamma`. Quoted from memory: neither the articles'
//! text nor an implementation was found, only summaries that list the parts (two regimes, delay,
//! rising static friction). One deliberate difference: the articles delay the speed of the Stribeck
//! part by a dead time `tau`, which needs a history of the speed. Here `v_L` follows the speed by
//! `v_L' = (v - v_L)/tau`, which agrees to first order in `tau` and keeps the state finite. Slides
//! end where the speed changes its sign.
//!
//! The state has two regimes, so there is a step, [`SevenParameter::advanced`], and no rate
//! function over all of it. Within a regime the step is exact for a constant speed. Regimes change
//! at the end of a step, so the step bounds the error of the time of break-away.

use crate::error::{LawError, above_zero, at_least_zero};
use crate::real::Real;

/// The seven-parameter law. Coefficients per normal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SevenParameter<T = f64> {
    /// `s_0` in 1/m, above 0.
    pub stiffness_per_m: T,
    /// `mu_c`, 0 or more.
    pub coulomb_coefficient: T,
    /// `k` in s/m, 0 or more.
    pub viscous_slope_s_m: T,
    /// `mu_inf`: static excess after a long standstill, 0 or more.
    pub long_rest_excess: T,
    /// `v_s` in m/s, above 0.
    pub stribeck_speed_m_s: T,
    /// `tau` in s, above 0.
    pub memory_s: T,
    /// `gamma` in s, above 0.
    pub rise_s: T,
}

/// State of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SevenParameterState<T = f64> {
    /// Standstill except for the spring.
    Sticking {
        /// `x` in m.
        displacement_m: T,
        /// `t_2` in s.
        rest_s: T,
        /// `mu_a`.
        initial_excess: T,
    },
    /// Sliding.
    Sliding {
        /// -1 or 1.
        direction: T,
        /// `|v_L|` in m/s.
        lagging_speed_m_s: T,
        /// `mu_st` of the break-away.
        excess: T,
    },
}

impl<T: Real> SevenParameter<T> {
    /// Checks every parameter.
    pub fn check(&self) -> Result<(), LawError> {
        above_zero("stiffness (1/m)", self.stiffness_per_m)?;
        at_least_zero("Coulomb coefficient", self.coulomb_coefficient)?;
        at_least_zero("viscous slope (s/m)", self.viscous_slope_s_m)?;
        at_least_zero("static excess", self.long_rest_excess)?;
        above_zero("Stribeck speed (m/s)", self.stribeck_speed_m_s)?;
        above_zero("memory (s)", self.memory_s)?;
        above_zero("rise time (s)", self.rise_s)?;
        Ok(())
    }

    /// State of a joint after a long standstill, its spring slack.
    pub fn rested(&self) -> SevenParameterState<T> {
        SevenParameterState::Sticking {
            displacement_m: T::ZERO,
            rest_s: T::ZERO,
            initial_excess: self.long_rest_excess,
        }
    }

    fn excess_after(&self, rest_s: T, initial: T) -> T {
        initial + (self.long_rest_excess - initial) * rest_s / (rest_s + self.rise_s)
    }

    fn stribeck(&self, excess: T, lagging_speed_m_s: T) -> T {
        let ratio = lagging_speed_m_s / self.stribeck_speed_m_s;
        excess / (T::ONE + ratio * ratio)
    }

    /// Coefficient at which a sticking joint breaks away; for a sliding one, that at which it would
    /// stick again.
    pub fn break_away_coefficient(&self, state: &SevenParameterState<T>) -> T {
        self.coulomb_coefficient
            + match *state {
                SevenParameterState::Sticking { rest_s, initial_excess, .. } => {
                    self.excess_after(rest_s, initial_excess)
                }
                SevenParameterState::Sliding { lagging_speed_m_s, excess, .. } => {
                    self.stribeck(excess, lagging_speed_m_s)
                }
            }
    }

    /// Returns the state after `duration_s` at a constant sliding speed in m/s.
    pub fn advanced(
        &self,
        state: SevenParameterState<T>,
        sliding_speed_m_s: T,
        duration_s: T,
    ) -> SevenParameterState<T> {
        let v = sliding_speed_m_s;
        match state {
            SevenParameterState::Sticking { displacement_m, rest_s, initial_excess } => {
                let displacement_m = displacement_m + v * duration_s;
                let rest_s = rest_s + duration_s;
                let excess = self.excess_after(rest_s, initial_excess);
                let broken = self.stiffness_per_m * displacement_m.abs() >= self.coulomb_coefficient + excess;
                if broken && displacement_m * v > T::ZERO {
                    SevenParameterState::Sliding { direction: v.sign(), lagging_speed_m_s: T::ZERO, excess }
                } else {
                    SevenParameterState::Sticking { displacement_m, rest_s, initial_excess }
                }
            }
            SevenParameterState::Sliding { direction, lagging_speed_m_s, excess } => {
                if v * direction <= T::ZERO {
                    // The spring starts with the force at which the slide ends, so that the force
                    // does not jump.
                    let initial_excess = self.stribeck(excess, lagging_speed_m_s);
                    let stretch = (self.coulomb_coefficient + initial_excess) / self.stiffness_per_m;
                    return SevenParameterState::Sticking {
                        displacement_m: direction * stretch + v * duration_s,
                        rest_s: duration_s,
                        initial_excess,
                    };
                }
                let decay = (-duration_s / self.memory_s).exp();
                SevenParameterState::Sliding {
                    direction,
                    lagging_speed_m_s: v.abs() + (lagging_speed_m_s - v.abs()) * decay,
                    excess,
                }
            }
        }
    }

    /// Friction force in N along the sliding direction.
    pub fn force_n(&self, normal_force_n: T, state: &SevenParameterState<T>, sliding_speed_m_s: T) -> T {
        let coefficient = match *state {
            SevenParameterState::Sticking { displacement_m, .. } => self.stiffness_per_m * displacement_m,
            SevenParameterState::Sliding { direction, lagging_speed_m_s, excess } => {
                (self.coulomb_coefficient + self.stribeck(excess, lagging_speed_m_s)) * direction
                    + self.viscous_slope_s_m * sliding_speed_m_s
            }
        };
        -normal_force_n * coefficient
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LAW: SevenParameter = SevenParameter {
        stiffness_per_m: 1e5,
        coulomb_coefficient: 0.15,
        viscous_slope_s_m: 0.1,
        long_rest_excess: 0.1,
        stribeck_speed_m_s: 1e-3,
        memory_s: 0.01,
        rise_s: 0.5,
    };

    /// Slides for `slide_s` at 10 mm/s, reverses for one step, is at standstill for `rest_s`, and
    /// returns the break-away coefficient.
    fn break_away_after(rest_s: f64) -> f64 {
        let mut state = LAW.rested();
        for _ in 0..10_000 {
            state = LAW.advanced(state, 0.01, 1e-5);
        }
        state = LAW.advanced(state, -1e-9, 1e-6);
        assert!(matches!(state, SevenParameterState::Sticking { .. }));
        LAW.break_away_coefficient(&LAW.advanced(state, 0.0, rest_s))
    }

    #[test]
    fn break_away_rises_with_the_time_at_rest() {
        let after = [1e-3, 0.1, 0.5, 5.0, 5000.0].map(break_away_after);
        assert!(after.is_sorted_by(|a, b| a < b), "{after:?}");
        let end_of_slide = 0.1 / (1.0 + 100.0);
        assert!((after[0] - 0.15 - end_of_slide).abs() < 5e-4, "{after:?}");
        assert!(
            (after[2] - 0.15 - 0.5 * (end_of_slide + 0.1)).abs() < 1e-6,
            "half-way after gamma: {after:?}"
        );
        assert!((after[4] - 0.25).abs() < 1e-4);
    }

    #[test]
    fn friction_follows_a_change_of_speed_with_its_memory() {
        let mut state = LAW.rested();
        for _ in 0..10_000 {
            state = LAW.advanced(state, 1e-3, 1e-5);
        }
        assert!((LAW.force_n(100.0, &state, 1e-3) + 100.0 * (0.15 + 0.05 + 1e-4)).abs() < 1e-3);
        let stribeck = |state: &_| -LAW.force_n(100.0, state, 0.0) / 100.0 - 0.15;
        let after = LAW.advanced(state, 2e-3, 0.01);
        // After one memory time the lagging speed has covered 1 - 1/e of the step from 1 to 2 mm/s.
        let lagging = 2.0 - (-1.0_f64).exp();
        assert!((stribeck(&after) - 0.1 / (1.0 + lagging * lagging)).abs() < 1e-5);
    }

    #[test]
    fn the_force_does_not_jump_when_a_slide_ends() {
        let mut state = LAW.rested();
        for _ in 0..10_000 {
            state = LAW.advanced(state, 1e-3, 1e-5);
        }
        let sliding = LAW.force_n(100.0, &state, 0.0);
        let sticking = LAW.force_n(100.0, &LAW.advanced(state, -1e-9, 1e-6), -1e-9);
        assert!((sliding / sticking - 1.0).abs() < 1e-9);
    }

    #[test]
    fn bad_figures_are_refused() {
        assert!(LAW.check().is_ok());
        assert!(SevenParameter { memory_s: 0.0, ..LAW }.check().is_err());
        assert!(SevenParameter { coulomb_coefficient: -0.1, ..LAW }.check().is_err());
    }

    proptest! {
        #[test]
        fn without_excess_and_viscosity_sliding_is_coulombs(v in 1e-4..1.0_f64) {
            let law = SevenParameter { long_rest_excess: 0.0, viscous_slope_s_m: 0.0, ..LAW };
            let state = law.advanced(law.rested(), v, 1.0);
            prop_assert!((law.force_n(100.0, &state, v) + 15.0).abs() < 1e-9);
        }

        #[test]
        fn it_is_odd_and_sliding_dissipates(
            v in 1e-5..0.1_f64, step in 1e-5..1e-2_f64, count in 1..50_usize,
        ) {
            let (mut forward, mut backward) = (LAW.rested(), LAW.rested());
            for _ in 0..count {
                forward = LAW.advanced(forward, v, step);
                backward = LAW.advanced(backward, -v, step);
                let force = LAW.force_n(100.0, &forward, v);
                prop_assert_eq!(force, -LAW.force_n(100.0, &backward, -v));
                prop_assert!(force * v <= 0.0);
            }
            let back = -0.1 * v;
            forward = LAW.advanced(forward, back, 1e-6);
            backward = LAW.advanced(backward, -back, 1e-6);
            prop_assert_eq!(LAW.force_n(100.0, &forward, back), -LAW.force_n(100.0, &backward, -back));
        }
    }
}
