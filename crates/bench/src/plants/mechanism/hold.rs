//! Reading of the held contact forces at the start of a communication step.

use super::contact::ContactKind;
use super::held::{Held, HeldForces};
use super::{Evaluation, Mechanism};
use crate::plants::transmission::ContactView;

impl Mechanism {
    /// Reads the forces of every held contact for the step that begins at a state.
    pub(super) fn hold<const N: usize>(
        &self,
        source: &mut HeldForces<'_>,
        (time_s, state): (f64, &[f64; N]),
        latched_m_s: &[Option<f64>],
        evaluation: &mut Evaluation,
    ) {
        let mut rates = [0.0; N];
        self.state_derivative((time_s, state), latched_m_s, evaluation, &mut rates);
        let half_s = 0.5 * source.step_s;
        let middle: [f64; N] = std::array::from_fn(|i| state[i] + half_s * rates[i]);
        for (i, contact) in self.contacts.iter().enumerate() {
            let ContactKind::Journal { bearing_radius_m, journal_radius_m, .. } = contact.kind else {
                continue;
            };
            if !source.contacts.get(i).copied().unwrap_or(false) {
                continue;
            }
            let [first, second] = self.pair(contact, time_s + half_s, &middle);
            let touch = contact.kind.at(time_s + half_s, [&first, &second]);
            let onset_m_s = if touch.depth_m > 0.0 { touch.rate_m_s.max(0.0) } else { 0.0 };
            let view = ContactView {
                radial_clearance_m: bearing_radius_m - journal_radius_m,
                deformation_m: touch.depth_m,
                rate_m_s: touch.rate_m_s,
                latched_m_s: latched_m_s[i].unwrap_or(onset_m_s),
                sliding_speed_m_s: touch.sliding_m_s,
            };
            evaluation.held[i] = Some(Held::new((source.force)(i, &view), &touch));
        }
    }
}
