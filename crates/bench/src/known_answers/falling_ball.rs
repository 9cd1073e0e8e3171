//! Ball above a floor: the plant for the closed forms of the impact laws.
//!
//! States: height of the ball's lowest point above the floor in m, and its rate. The only contact
//! is the floor; the deformation is the depth below height 0. With gravity 0 it is a free impact.

use crate::integrate::{ContactAngles, ContactPlant, ContactReading, Tolerances, Touch};
use contact::NormalLaw;

/// Parameters, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FallingBall {
    /// Mass in kg.
    pub mass_kg: f64,
    /// Gravity in m/s2, downwards.
    pub gravity_m_s2: f64,
    /// Contact law of ball and floor.
    pub normal_law: NormalLaw,
}

impl FallingBall {
    /// Error control at a relative tolerance, for depths of micrometres.
    pub(super) fn tolerances(&self, relative: f64) -> Tolerances<2> {
        Tolerances { relative, absolute: [1e-6 * relative, 1e-3 * relative], largest_step_s: 0.05 }
    }
}

impl ContactPlant<2> for FallingBall {
    fn derivative(&self, time_s: f64, state: &[f64; 2], touch: Option<Touch>, derivative: &mut [f64; 2]) {
        let force = touch.map_or(0.0, |touch| self.contact(time_s, state, touch.latched_m_s).force_n);
        *derivative = [state[1], force / self.mass_kg - self.gravity_m_s2];
    }

    fn deformation(&self, _: f64, state: &[f64; 2]) -> (f64, f64) {
        (-state[0], -state[1])
    }

    fn contact(&self, _: f64, state: &[f64; 2], latched_m_s: f64) -> ContactReading {
        let (depth_m, rate_m_s) = (-state[0], -state[1]);
        ContactReading { depth_m, rate_m_s, force_n: self.normal_law.force_n(depth_m, rate_m_s, latched_m_s) }
    }

    fn angles(&self, _: f64, _: &[f64; 2]) -> ContactAngles {
        ContactAngles { crank_rad: 0.0, contact_rad: -core::f64::consts::FRAC_PI_2 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::{IntegrationError, integrate};
    use contact::{Dissipation, GRAVITY_M_S2, Stiffness, produced_restitution};

    fn ball(coefficient: f64, dissipation: Dissipation, restitution: f64, gravity_m_s2: f64) -> FallingBall {
        let stiffness = Stiffness::Hertz { coefficient };
        let normal_law = NormalLaw { stiffness, dissipation, restitution, latch_floor_m_s: 1e-9 };
        FallingBall { mass_kg: 1.0, gravity_m_s2, normal_law }
    }

    #[test]
    fn an_impact_loses_the_energy_of_its_restitution() {
        let plant = ball(1e9, Dissipation::ZhiyingQishao, 0.6, 0.0);
        let result =
            integrate(&plant, (0.0, 0.01), [1e-3, -1.0], false, &[], &plant.tolerances(1e-9), |_, _, _| {})
                .unwrap();
        let [impact] = result.impacts[..] else { panic!("{:?}", result.impacts) };
        let e = produced_restitution(Dissipation::ZhiyingQishao.factor(0.6));
        assert!((impact.onset_s - 1e-3).abs() < 1e-12);
        assert!((impact.speed_ratio().unwrap() - e).abs() < 1e-7, "{impact:?}");
        // Of a free body the energetic restitution is the ratio of the speeds.
        assert!((impact.restitution().unwrap() - e).abs() < 1e-6, "{impact:?}");
        // Work of the force and change of the kinetic energy, computed independently.
        assert!((impact.energy_lost_j - 0.5 * (1.0 - e * e)).abs() < 1e-6, "{impact:?}");
        assert!((result.state[1] - e).abs() < 1e-7);
    }

    #[test]
    fn a_ball_on_a_hard_floor_comes_to_rest_within_the_step_limit() {
        let plant = ball(1e14, Dissipation::ZhiyingQishao, 0.4, GRAVITY_M_S2);
        let result =
            integrate(&plant, (0.0, 3.0), [0.1, 0.0], false, &[], &plant.tolerances(1e-7), |_, _, _| {})
                .unwrap();
        let last = result.impacts.last().unwrap();
        assert!(result.impacts.len() < 40 && last.separation_s.is_none(), "{}", result.impacts.len());
        // The floor carries the ball's weight.
        let force = plant.contact(3.0, &result.state, last.approach_speed_m_s).force_n;
        assert!((force - GRAVITY_M_S2).abs() < 1e-3, "{force}");
    }

    /// Ball that a growing force pulls away from the floor.
    struct Pulled(FallingBall);

    impl ContactPlant<2> for Pulled {
        fn derivative(&self, t: f64, state: &[f64; 2], touch: Option<Touch>, out: &mut [f64; 2]) {
            self.0.derivative(t, state, touch, out);
            out[1] += 1e6 * t;
        }

        fn deformation(&self, t: f64, state: &[f64; 2]) -> (f64, f64) {
            self.0.deformation(t, state)
        }

        fn contact(&self, t: f64, state: &[f64; 2], latched_m_s: f64) -> ContactReading {
            self.0.contact(t, state, latched_m_s)
        }

        fn angles(&self, _: f64, _: &[f64; 2]) -> ContactAngles {
            ContactAngles::default()
        }
    }

    /// A driven body may separate faster than it approached. Its contact returns no more than it
    /// took up: all of it without damping.
    #[test]
    fn the_restitution_of_a_driven_body_is_that_of_its_contact() {
        let run = |dissipation| {
            let plant = Pulled(ball(1e9, dissipation, 0.8, 0.0));
            let tolerances = plant.0.tolerances(1e-10);
            let run = integrate(&plant, (0.0, 2e-3), [1e-6, -1.0], false, &[], &tolerances, |_, _, _| {});
            let impact = run.unwrap().impacts[0];
            (impact.speed_ratio().unwrap(), impact.restitution().unwrap())
        };
        let (elastic_ratio, elastic) = run(Dissipation::None);
        assert!(elastic_ratio > 1.1 && (elastic - 1.0).abs() < 1e-4, "{elastic_ratio} {elastic}");
        let (ratio, restitution) = run(Dissipation::ZhiyingQishao);
        assert!(ratio > restitution + 0.1 && (0.7..0.9).contains(&restitution), "{ratio} {restitution}");
    }

    /// Floor that vibrates too fast for separate impacts.
    struct Shaker;

    impl ContactPlant<2> for Shaker {
        fn derivative(&self, _: f64, _: &[f64; 2], _: Option<Touch>, derivative: &mut [f64; 2]) {
            *derivative = [1.0, 0.0];
        }
        fn deformation(&self, time_s: f64, _: &[f64; 2]) -> (f64, f64) {
            let (sin, cos) = (1e7 * time_s).sin_cos();
            (1e-6 * sin, 10.0 * cos)
        }
        fn contact(&self, time_s: f64, state: &[f64; 2], _: f64) -> ContactReading {
            let (depth_m, rate_m_s) = self.deformation(time_s, state);
            ContactReading { depth_m, rate_m_s, force_n: 0.0 }
        }
        fn angles(&self, _: f64, _: &[f64; 2]) -> ContactAngles {
            ContactAngles::default()
        }
    }

    #[test]
    fn chattering_ends_the_run_with_count_and_time() {
        let tolerances = Tolerances { relative: 1e-6, absolute: [1e-6; 2], largest_step_s: 1e-2 };
        let error = integrate(&Shaker, (0.0, 1.0), [0.0; 2], false, &[], &tolerances, |_, _, _| {});
        match error {
            Err(IntegrationError::Chattering { contact: 0, count, window_s, time_s }) => {
                assert!(count == 500 && window_s < 1e-2 && time_s < 0.1, "{count} {window_s} {time_s}");
            }
            other => panic!("{other:?}"),
        }
    }
}
