//! Integration of a world: fixed-step Runge-Kutta of fourth order, contact onset interpolated.

use crate::equations::{Equations, State};
use crate::row::Row;
use crate::world::World;

/// Largest step of the integrator, s. Babbitt's damping limits it to some 20 us.
const STEP_S: f64 = 2e-6;
/// Distance of the journal from the bearing's centre at the start, as a share of the clearance.
const START_SHARE: f64 = 0.999;

impl World {
    /// Runs the world from rest and returns a row per sample. The journal starts at the bottom of
    /// the clearance.
    pub fn run(&self, duration_s: f64, rate_hz: f64) -> Vec<Row> {
        let mut motion = Motion::new(self, [0.0, -START_SHARE * self.radial_clearance_m, 0.0, 0.0]);
        let samples = (duration_s * rate_hz).round() as usize;
        let steps = (1.0 / rate_hz / STEP_S).ceil().max(1.0) as usize;
        let step_s = 1.0 / rate_hz / steps as f64;
        let sample = |index: usize| {
            let time_s = index as f64 / rate_hz;
            let row = motion.row(time_s);
            (0..steps).for_each(|step| motion.step(time_s + step as f64 * step_s, step_s));
            row
        };
        (0..samples).map(sample).collect()
    }
}

/// A world in motion.
struct Motion<'a> {
    equations: Equations<'a>,
    state: State,
    /// Approach speed at the onset of the present contact; none in a gap.
    latched_m_s: Option<f64>,
}

impl<'a> Motion<'a> {
    fn new(world: &'a World, state: State) -> Self {
        Self { equations: Equations::new(world), state, latched_m_s: None }
    }

    fn row(&self, time_s: f64) -> Row {
        self.equations.at(time_s, &self.state, self.latched_m_s).1
    }

    fn integrated(&self, t: f64, state: &State, h: f64) -> State {
        let rates = |t: f64, s: &State| self.equations.at(t, s, self.latched_m_s).0;
        let moved = |k: &State, h: f64| std::array::from_fn(|i| state[i] + h * k[i]);
        let k1 = rates(t, state);
        let k2 = rates(t + 0.5 * h, &moved(&k1, 0.5 * h));
        let k3 = rates(t + 0.5 * h, &moved(&k2, 0.5 * h));
        let k4 = rates(t + h, &moved(&k3, h));
        std::array::from_fn(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }

    /// Integrates one step; a step with a contact onset is divided there.
    fn step(&mut self, t: f64, h: f64) {
        let mut next = self.integrated(t, &self.state, h);
        let (after, _) = self.equations.deformation(&next);
        if self.latched_m_s.is_none() && after > 0.0 {
            let (before, _) = self.equations.deformation(&self.state);
            let free = h * (before / (before - after)).clamp(0.0, 1.0);
            let onset = self.integrated(t, &self.state, free);
            self.latched_m_s = Some(self.equations.deformation(&onset).1.max(0.0));
            next = self.integrated(t + free, &onset, h - free);
        } else if after <= 0.0 {
            self.latched_m_s = None;
        }
        self.state = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equations::GRAVITY_M_S2;
    use crate::{Bearing, Deviations};

    fn drawn() -> World {
        World::bench_b(Bearing::Babbitt, 0.5e-3, 10e3).draw(3, &Deviations::BENCH_B)
    }

    /// Integrates a quantity over the rows with the trapezoidal rule.
    fn integral(rows: &[Row], read: impl Fn(&Row) -> f64) -> f64 {
        let area = |pair: &[Row]| 0.5 * (read(&pair[0]) + read(&pair[1])) * (pair[1].time_s - pair[0].time_s);
        rows.windows(2).map(area).sum()
    }

    #[test]
    fn energy_changes_by_the_work_of_every_force() {
        let world = drawn();
        let rows = world.run(0.6, 100e3);
        let kinetic = |r: &Row| {
            0.5 * world.mass_kg * (r.velocity_y_m_s.powi(2) + r.velocity_z_m_s.powi(2))
                + 0.5 * world.inertia_kg_m2 * r.shaft_speed_rad_s.powi(2)
        };
        let pin =
            |r: &Row| r.velocity_y_m_s + world.load_lever_m * r.shaft_angle_rad.cos() * r.shaft_speed_rad_s;
        let powers: [&dyn Fn(&Row) -> f64; 5] = [
            &|r| r.drive_force_n * r.drive_velocity_m_s,
            &|r| r.load_force_n * pin(r),
            &|r| -world.mass_kg * GRAVITY_M_S2 * r.velocity_z_m_s,
            &|r| -r.normal_force_n * r.deformation_rate_m_s,
            &|r| r.friction_force_n * r.sliding_speed_m_s,
        ];
        let works = powers.map(|power| integral(&rows, power));
        let change = kinetic(&rows[rows.len() - 1]) - kinetic(&rows[0]);
        let residual = change - works.iter().sum::<f64>();
        assert!(works.iter().all(|work| work.abs() > 0.01), "{works:?}");
        assert!(residual.abs() < 1e-5, "{residual} of {works:?}");
    }

    #[test]
    fn momentum_changes_by_the_impulse_of_every_force() {
        let world = drawn();
        let rows = world.run(0.6, 100e3);
        let (first, last) = (rows[0], rows[rows.len() - 1]);
        let vertical = integral(&rows, |r| r.force_z_n - world.mass_kg * GRAVITY_M_S2);
        let lateral = integral(&rows, |r| r.force_y_n + r.load_force_n + r.drive_force_n);
        let angular = integral(&rows, |r| {
            let cranks = r.drive_force_n * world.drive_lever_m + r.load_force_n * world.load_lever_m;
            cranks * r.shaft_angle_rad.cos() + r.friction_torque_nm
        });
        let off = [
            world.mass_kg * (last.velocity_z_m_s - first.velocity_z_m_s) - vertical,
            world.mass_kg * (last.velocity_y_m_s - first.velocity_y_m_s) - lateral,
            world.inertia_kg_m2 * (last.shaft_speed_rad_s - first.shaft_speed_rad_s) - angular,
        ];
        assert!(off.iter().all(|off| off.abs() < 1e-5), "{off:?}");
    }

    /// The law's exact restitution solves `chi (1 + e) = ln((1 + chi)/(1 - chi e))`.
    #[test]
    fn an_impact_has_the_exact_restitution_of_the_law() {
        // Fast, so that gravity does not count.
        const SPEED_M_S: f64 = 10.0;
        for (bearing, restitution) in [(Bearing::Babbitt, 0.398_837), (Bearing::Plastic, 0.787_365)] {
            let world = World { stroke_m: 0.0, ..World::bench_b(bearing, 0.5e-3, 0.0) };
            let mut motion = Motion::new(&world, [0.0, -world.radial_clearance_m + 1e-6, 0.0, -SPEED_M_S]);
            let mut step = 0;
            while motion.state[3] < 0.0 || motion.latched_m_s.is_some() {
                motion.step(f64::from(step) * STEP_S, STEP_S);
                step += 1;
            }
            let found = motion.state[3] / SPEED_M_S;
            assert!((found - restitution).abs() < 5e-4, "{bearing:?}: {found}");
        }
    }

    #[test]
    fn a_run_repeats_and_does_not_depend_on_the_sample_rate() {
        let world = drawn();
        let (fast, slow) = (world.run(0.1, 20e3), world.run(0.1, 1e3));
        assert_eq!(fast, world.run(0.1, 20e3));
        assert_eq!((fast.len(), slow.len()), (2000, 100));
        for (fast, slow) in fast.iter().step_by(20).zip(&slow) {
            assert!((fast.normal_force_n - slow.normal_force_n).abs() < 0.05, "{fast:?} {slow:?}");
        }
    }
}
