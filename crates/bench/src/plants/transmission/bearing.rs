//! Forces of the clearance bearing: the described laws, the effects on them, and the resulting
//! action on the shaft.

use super::geometry::Geometry;
use super::{BREAKAWAY, BRISTLE, BearingForces, ContactView, RISE, State, Transmission};
use crate::description::Memory;
use crate::integrate::Touch;

/// Action of the bearing on the shaft.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct OnShaft {
    /// Component along Y, N.
    pub(crate) force_y_n: f64,
    /// Component along Z, N.
    pub(crate) force_z_n: f64,
    /// Torque in N m.
    pub(crate) torque_nm: f64,
    /// Normal force in N.
    pub(crate) normal_n: f64,
    /// Friction along the sliding direction in N.
    pub(crate) friction_n: f64,
    /// Loss of the film in W.
    pub(crate) film_loss_w: f64,
}

impl Transmission {
    /// Evaluates the analytic laws of the description for a contact without history and without the
    /// effects on friction. A friction law with bristles is taken in its steady state.
    pub fn law(&self, view: &ContactView) -> BearingForces {
        self.forces_of(view, self.friction_law.steady_deflection_m(view.sliding_speed_m_s))
    }

    /// Evaluates the analytic laws at a state, with the effects on friction.
    pub fn forces(&self, time_s: f64, s: &State, touch: Touch) -> BearingForces {
        self.forces_at(time_s, s, &self.geometry(time_s, s), touch)
    }

    pub(super) fn forces_of(&self, view: &ContactView, deflection_m: f64) -> BearingForces {
        if view.deformation_m <= 0.0 {
            return BearingForces::default();
        }
        let normal_n = self.joint_law.law.force_n(view.deformation_m, view.rate_m_s, view.latched_m_s);
        let v = view.sliding_speed_m_s;
        let friction_n = self.friction_law.force_n(normal_n, v, deflection_m) * self.friction_level;
        BearingForces { normal_n, friction_n }
    }

    /// Applies the effects on friction to the forces of the described laws or of a network.
    pub(crate) fn with_effects(
        &self,
        time_s: f64,
        s: &State,
        view: &ContactView,
        forces: BearingForces,
    ) -> BearingForces {
        // A viscous term would act through the gap.
        if view.deformation_m <= 0.0 {
            return forces;
        }
        let v = view.sliding_speed_m_s;
        let sign = if self.plain_friction { 0.0 } else { (v / self.sign_width_m_s).tanh() };
        BearingForces { friction_n: self.effective_friction_n(time_s, s, &forces, (v, sign)), ..forces }
    }

    /// Friction in N with the effects on it, at a sliding speed in m/s and its sign.
    pub(super) fn effective_friction_n(
        &self,
        time_s: f64,
        s: &State,
        forces: &BearingForces,
        (sliding_m_s, sign): (f64, f64),
    ) -> f64 {
        if self.plain_friction {
            return forces.friction_n;
        }
        let memory = Memory { bristle: s[BRISTLE], breakaway: s[BREAKAWAY], rise_k: s[RISE] };
        let (normal, dry) = (forces.normal_n, forces.friction_n);
        self.extension.friction_n(time_s, normal, dry, sliding_m_s, sign, &memory)
    }

    /// Action of given forces and of the film on the shaft.
    pub(crate) fn on_shaft_at(&self, g: &Geometry, forces: &BearingForces) -> OnShaft {
        let (normal, friction) = (forces.normal_n, forces.friction_n);
        let mut force_y_n = -normal * g.ny + friction * g.nz;
        let mut force_z_n = -normal * g.nz - friction * g.ny;
        let mut torque_nm = friction * self.journal_radius_m;
        let mut film_loss_w = 0.0;
        if g.oval_m != 0.0 {
            // The normal force acts along the gradient of the deformation over y, z and the angle.
            force_y_n += normal * g.across * g.nz;
            force_z_n -= normal * g.across * g.ny;
            torque_nm += normal * g.oval_m;
        }
        if let Some(film) = &self.extension.film {
            let distance = g.depth_m + self.radial_clearance_m;
            let share = 1.0 - (distance / self.radial_clearance_m).powi(2);
            let share = share.max(2.0 * film.min_thickness_m / self.radial_clearance_m);
            let slender = (self.journal_radius_m / self.radial_clearance_m).powi(3) * self.bearing_length_m;
            let damping =
                12.0 * core::f64::consts::PI * film.viscosity_pa_s * slender / (share * share.sqrt());
            force_y_n -= damping * g.radial_m_s * g.ny;
            force_z_n -= damping * g.radial_m_s * g.nz;
            film_loss_w = damping * g.radial_m_s * g.radial_m_s;
        }
        OnShaft { force_y_n, force_z_n, torque_nm, normal_n: normal, friction_n: friction, film_loss_w }
    }
}
