//! Hertz' impact and the bouncing ball.

use super::{KnownAnswer, KnownAnswerError};
use crate::integrate::integrate;
use crate::known_answers::falling_ball::FallingBall;
use contact::{Dissipation, GRAVITY_M_S2, NormalLaw, Stiffness, produced_restitution};

/// Stiffness of a floor on which contacts last nanoseconds, N/m^1.5. The duration of a contact
/// limits how small bounces can be before the ball stays on the floor.
const HARD: f64 = 1e20;

pub(super) fn cases() -> Result<Vec<KnownAnswer>, KnownAnswerError> {
    let mut cases = hertz()?;
    for (restitution, known) in [(0.9, 8.578949), (0.4, 1.053555)] {
        let name = format!("bouncing ball, time to rest, e = {restitution}, s");
        cases.push(KnownAnswer::relative(name, time_to_rest_s(restitution, 1.0005 * known)?, known, 1e-5));
    }
    Ok(cases)
}

fn hertz() -> Result<Vec<KnownAnswer>, KnownAnswerError> {
    let stiffness = Stiffness::Hertz { coefficient: 1e9 };
    let normal_law =
        NormalLaw { stiffness, dissipation: Dissipation::None, restitution: 1.0, latch_floor_m_s: 1e-3 };
    let plant = FallingBall { mass_kg: 1.0, gravity_m_s2: 0.0, normal_law };
    let run =
        integrate(&plant, (0.0, 0.01), [1e-3, -1.0], false, &[], &plant.tolerances(1e-10), |_, _, _| {})?;
    let impact = run.impacts.first().ok_or(KnownAnswerError::Missing("the ball missed the floor"))?;
    let duration = impact.duration_s().ok_or(KnownAnswerError::Missing("the ball stuck to the floor"))?;
    Ok(vec![
        KnownAnswer::relative("Hertz impact, deformation, m", impact.max_deformation_m, 2.746401e-4, 4e-7),
        KnownAnswer::relative("Hertz impact, peak force, N", impact.peak_force_n, 4551.4105, 4e-8),
        KnownAnswer::relative("Hertz impact, duration, s", duration, 8.083415e-4, 4e-7),
        KnownAnswer::absolute("Hertz impact, energy lost, J", impact.energy_lost_j, 0.0, 1e-8),
    ])
}

/// Time until a ball dropped from 1 m comes to rest, without the time in contact, which the closed
/// form neglects. The floor is stiff for a ball at rest, so `end_s` should follow soon.
fn time_to_rest_s(restitution: f64, end_s: f64) -> Result<f64, KnownAnswerError> {
    // Nominal restitution whose dissipation factor produces the required one.
    let dissipation = Dissipation::ZhiyingQishao;
    let (mut low, mut high) = (0.01, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if produced_restitution(dissipation.factor(middle)) < restitution {
            low = middle
        } else {
            high = middle
        }
    }
    let stiffness = Stiffness::Hertz { coefficient: HARD };
    let normal_law = NormalLaw { stiffness, dissipation, restitution: low, latch_floor_m_s: 1e-12 };
    let plant = FallingBall { mass_kg: 1.0, gravity_m_s2: GRAVITY_M_S2, normal_law };
    let run = integrate(&plant, (0.0, end_s), [1.0, 0.0], false, &[], &plant.tolerances(1e-9), |_, _, _| {})?;
    let last = run.impacts.last().ok_or(KnownAnswerError::Missing("the ball missed the floor"))?;
    if last.separation_s.is_some() {
        return Err(KnownAnswerError::Missing("the ball did not come to rest"));
    }
    let in_contact: f64 = run.impacts.iter().filter_map(|i| i.duration_s()).sum();
    Ok(last.onset_s - in_contact)
}
