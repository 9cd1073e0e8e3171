//! Equations of the two-plane bench at one state.

use super::{STATES, State, TwoPlane};
use crate::description::Memory;
use crate::description::ripples;
use crate::integrate::{ContactAngles, ContactReading, SlicedPlant};
use crate::plants::transmission::MAX_SINE;
use crate::signals::Motion;
use contact::GRAVITY_M_S2;

/// The crank under the rigid fork.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crank {
    pub(super) sin: f64,
    pub(super) cos: f64,
    pub(super) speed_rad_s: f64,
    drive: Motion,
}

/// One slice at one state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slice {
    pub(super) ny: f64,
    pub(super) nz: f64,
    pub(super) depth_m: f64,
    pub(super) rate_m_s: f64,
    pub(super) sliding_m_s: f64,
}

/// Sums over the slices: forces, moments about the bearing's middle, torque, heat, damping loss.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    pub(super) force_y: f64,
    pub(super) force_z: f64,
    pub(super) moment_y: f64,
    pub(super) moment_z: f64,
    pub(super) torque: f64,
    heat: f64,
    damping_loss: f64,
}

impl TwoPlane {
    pub(super) fn crank(&self, time_s: f64, s: &State) -> Crank {
        let drive = self.drive.at(time_s - self.extension.drive_lag_s);
        let offset = self.section.drive_offset_m;
        let sin = ((drive.value - s[0] - s[4] * offset) / self.drive_lever_m).clamp(-MAX_SINE, MAX_SINE);
        let cos = (1.0 - sin * sin).sqrt();
        let speed_rad_s = (drive.rate - s[2] - s[6] * offset) / (self.drive_lever_m * cos);
        Crank { sin, cos, speed_rad_s, drive }
    }

    pub(super) fn slice(&self, position_m: f64, crank: &Crank, s: &State) -> Slice {
        let y = s[0] + (s[4] - self.section.misalignment_y_rad) * position_m;
        let z = s[1] + (s[5] - self.section.misalignment_z_rad) * position_m;
        let (vy, vz) = (s[2] + s[6] * position_m, s[3] + s[7] * position_m);
        let distance = (y * y + z * z).sqrt();
        let (ny, nz) = if distance > 0.0 { (y / distance, z / distance) } else { (0.0, 0.0) };
        Slice {
            ny,
            nz,
            depth_m: distance - self.radial_clearance_m,
            rate_m_s: ny * vy + nz * vz,
            sliding_m_s: crank.speed_rad_s * self.journal_radius_m + nz * vy - ny * vz,
        }
    }

    /// Normal and friction force of a slice in contact.
    pub(super) fn slice_forces_n(&self, time_s: f64, slice: &Slice, latched_m_s: f64) -> (f64, f64) {
        let normal = self.share() * self.joint_law.law.force_n(slice.depth_m, slice.rate_m_s, latched_m_s);
        let v = slice.sliding_m_s;
        let steady = self.friction_law.steady_deflection_m(v);
        let dry = self.friction_law.force_n(normal, v, steady) * self.friction_level;
        if self.plain_friction {
            return (normal, dry);
        }
        // The terms apply to the complete bearing.
        let (share, sign) = (self.share(), (v / self.sign_width_m_s).tanh());
        let friction =
            self.extension.friction_n(time_s, normal / share, dry / share, v, sign, &Memory::default());
        (normal, share * friction)
    }

    pub(super) fn sums(&self, time_s: f64, crank: &Crank, s: &State, latched_m_s: &[Option<f64>]) -> Sums {
        let mut sums = Sums::default();
        for (&position, latched) in self.positions_m.iter().zip(latched_m_s) {
            let Some(latched) = latched else { continue };
            let slice = self.slice(position, crank, s);
            let (normal, friction) = self.slice_forces_n(time_s, &slice, *latched);
            let force_y = -normal * slice.ny + friction * slice.nz;
            let force_z = -normal * slice.nz - friction * slice.ny;
            sums.force_y += force_y;
            sums.force_z += force_z;
            sums.moment_y += force_y * position;
            sums.moment_z += force_z * position;
            sums.torque += friction * self.journal_radius_m;
            sums.heat -= friction * slice.sliding_m_s;
            let elastic = self.share() * self.joint_law.elastic.force_n(slice.depth_m);
            sums.damping_loss += (normal - elastic) * slice.rate_m_s;
        }
        sums
    }

    /// Computes the state derivative and returns the fork force.
    pub(super) fn motion(&self, time_s: f64, s: &State, crank: &Crank, f: &Sums, out: &mut State) -> f64 {
        let section = &self.section;
        let load_rate =
            s[2] + s[6] * section.load_offset_m + self.load_lever_m * crank.cos * crank.speed_rad_s;
        let cylinder = self.load.at(time_s).value + ripples(&self.extension.load_ripples, time_s);
        let load_friction = self.load_friction.as_ref().map_or(0.0, |f| f.force_n(load_rate));
        let load = cylinder + load_friction;
        let lever = self.drive_lever_m * crank.cos;
        let (stiffness, damping) = (section.support_stiffness_nm_rad, section.support_damping_nm_s_rad);
        let (inertia, offset) = (section.transverse_inertia_kg_m2, section.drive_offset_m);
        // All forces except the fork's, which then follows from the constraint.
        let force_y = load + f.force_y;
        let moment_y = load * section.load_offset_m + f.moment_y - stiffness * s[4] - damping * s[6];
        let moment_z = f.moment_z - stiffness * s[5] - damping * s[7];
        let torque = load * self.load_lever_m * crank.cos + f.torque;
        let wanted =
            crank.drive.acceleration + self.drive_lever_m * crank.sin * crank.speed_rad_s * crank.speed_rad_s;
        let free = force_y / self.mass_kg + offset * moment_y / inertia + lever * torque / self.inertia_kg_m2;
        let yielding = 1.0 / self.mass_kg + offset * offset / inertia + lever * lever / self.inertia_kg_m2;
        let fork = (wanted - free) / yielding;
        let drive_power = fork * crank.drive.rate;
        // Each loss follows from its own law, none from the others. The misalignment of the bearing
        // is constant, so the slices' rates are those of the shaft, without a further term.
        *out = [
            s[2],
            s[3],
            (fork + force_y) / self.mass_kg,
            f.force_z / self.mass_kg - GRAVITY_M_S2,
            s[6],
            s[7],
            (fork * offset + moment_y) / inertia,
            moment_z / inertia,
            drive_power,
            drive_power.abs(),
            cylinder * load_rate,
            f.heat,
            f.damping_loss + damping * (s[6] * s[6] + s[7] * s[7]),
            -load_friction * load_rate,
        ];
        fork
    }

    /// Load in N.
    pub(super) fn load_n(&self, time_s: f64) -> f64 {
        self.load.at(time_s).value
    }

    /// Motion of the drive cylinder.
    pub(super) fn drive(&self, time_s: f64) -> Motion {
        self.drive.at(time_s)
    }
}

impl SlicedPlant<STATES> for TwoPlane {
    fn slices(&self) -> usize {
        self.positions_m.len()
    }

    fn sliced_derivative(
        &self,
        time_s: f64,
        state: &State,
        latched_m_s: &[Option<f64>],
        derivative: &mut State,
    ) {
        let crank = self.crank(time_s, state);
        let sums = self.sums(time_s, &crank, state, latched_m_s);
        self.motion(time_s, state, &crank, &sums, derivative);
    }

    fn slice_deformation(&self, slice: usize, time_s: f64, state: &State) -> (f64, f64) {
        let position = self.positions_m.get(slice).copied().unwrap_or_default();
        let slice = self.slice(position, &self.crank(time_s, state), state);
        (slice.depth_m, slice.rate_m_s)
    }

    fn slice_contact(&self, slice: usize, time_s: f64, state: &State, latched_m_s: f64) -> ContactReading {
        let (depth_m, rate_m_s) = self.slice_deformation(slice, time_s, state);
        let force_n = self.share() * self.joint_law.law.force_n(depth_m, rate_m_s, latched_m_s);
        ContactReading { depth_m, rate_m_s, force_n }
    }

    fn slice_angles(&self, slice: usize, time_s: f64, state: &State) -> ContactAngles {
        let position = self.positions_m.get(slice).copied().unwrap_or_default();
        let crank = self.crank(time_s, state);
        let slice = self.slice(position, &crank, state);
        ContactAngles { crank_rad: crank.sin.asin(), contact_rad: slice.nz.atan2(slice.ny) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::{TransmissionBench, TwoPlaneSection};
    use crate::integrate::integrate_slices;

    /// The bench with a change of the bearing's forces and one of the state's rates.
    struct Changed<'a>(&'a TwoPlane, fn(&mut Sums), fn(&mut State));

    impl SlicedPlant<STATES> for Changed<'_> {
        fn slices(&self) -> usize {
            self.0.slices()
        }

        fn sliced_derivative(&self, t: f64, s: &State, latched_m_s: &[Option<f64>], out: &mut State) {
            let crank = self.0.crank(t, s);
            let mut sums = self.0.sums(t, &crank, s, latched_m_s);
            self.1(&mut sums);
            self.0.motion(t, s, &crank, &sums, out);
            self.2(out);
        }

        fn slice_deformation(&self, slice: usize, t: f64, s: &State) -> (f64, f64) {
            self.0.slice_deformation(slice, t, s)
        }

        fn slice_contact(&self, slice: usize, t: f64, s: &State, latched_m_s: f64) -> ContactReading {
            self.0.slice_contact(slice, t, s, latched_m_s)
        }

        fn slice_angles(&self, slice: usize, t: f64, s: &State) -> ContactAngles {
            self.0.slice_angles(slice, t, s)
        }
    }

    type Change = (&'static str, fn(&mut Sums), fn(&mut State));

    #[test]
    fn every_equation_of_the_tilting_shaft_that_is_changed_alone_leaves_a_residual() {
        let mut bench = TransmissionBench::open("bench-b").unwrap();
        bench.two_plane = Some(TwoPlaneSection {
            slices: 3,
            misalignment_y_rad: 1e-3,
            support_stiffness_nm_rad: 5e5,
            support_damping_nm_s_rad: 500.0,
            ..TwoPlaneSection::default()
        });
        let plant = TwoPlane::new(&bench, bench.drive_profile(), bench.load_profile());
        let residual = |action, rates| {
            let (changed, initial) = (Changed(&plant, action, rates), plant.initial_state());
            let tolerances = plant.tolerances(1e-7);
            let run = integrate_slices(&changed, (0.0, 0.5), initial, &[], &[], &tolerances, |_, _, _| {});
            plant.audit((0.0, &initial), (0.5, &run.unwrap().state)).residual_rel
        };
        let right = residual(|_| {}, |_| {});
        assert!(right < 1e-8, "{right}");
        let changes: [Change; 8] = [
            ("force along Y", |f| f.force_y *= 1.01, |_| {}),
            ("force along Z", |f| f.force_z *= 1.01, |_| {}),
            ("moment of the Y forces", |f| f.moment_y *= 1.01, |_| {}),
            ("torque", |f| f.torque *= 0.5, |_| {}),
            ("friction heat", |f| f.heat *= 0.5, |_| {}),
            ("damping loss", |f| f.damping_loss *= 0.9, |_| {}),
            ("tilt", |_| {}, |out| out[6] *= 2.0),
            ("work of the load", |_| {}, |out| out[10] *= 1.01),
        ];
        for (name, action, rates) in changes {
            let found = residual(action, rates);
            assert!(found > 1e-7, "{name}: {found}");
        }
    }
}
