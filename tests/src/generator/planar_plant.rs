//! Equations of the planar transmission bench for [`super::planar`], with the terms of the effects.
//!
//! A fork drives a crank pin; the shaft has its journal in a clearance bearing, and the load acts
//! on a second crank. `bench::plants::transmission` has the drawing. The shaft may tilt
//! ([`super::tilt`]); otherwise the bearing is a single place. Effects have the meaning that
//! `docs/effects.md` documents.

use super::hidden::{HiddenEffect, total};
use super::planar_data::{Hidden, RealBench, Row, State};
use super::planar_effects::{Added, wave};
use super::tilt::{LENGTH_M, NODES, Tilt};
use std::f64::consts::{PI, TAU};

/// Gravity, m/s2. Not `contact::GRAVITY_M_S2`: the generator shares no code with the engine.
const GRAVITY: f64 = 9.81;
/// Stiffness of a fork with play, N/m, and damping of its force per closing speed, s/m.
const FORK: (f64, f64) = (1e10, 1.0);
/// Share of critical damping of a shaft that twists.
const TWIST_DAMPING: f64 = 0.02;

/// A bench with its effects.
pub(super) struct Plant {
    pub(super) drive_lever_m: f64,
    load_lever_m: f64,
    mass: f64,
    inertia: f64,
    pub(super) clearance_m: f64,
    journal_radius_m: f64,
    effective_modulus: f64,
    dissipation_factor: f64,
    friction: f64,
    viscous: f64,
    load_n: f64,
    third_harmonic_n: f64,
    drive: Drive,
    /// Stiffness and damping of a shaft that twists.
    shaft: Option<(f64, f64)>,
    pub(super) tilt: Tilt,
    added: Added,
}

/// Connection of cylinder and crank.
enum Drive {
    Rigid,
    /// Stiffness and damping.
    Column(f64, f64),
    /// Half the play, and the stiffness of the faces.
    Play(f64, f64),
}

/// Crank and cylinder at a state.
struct Crank {
    sine: f64,
    cosine: f64,
    speed: f64,
    /// Displacement, velocity and acceleration of the cylinder at the fork.
    cylinder: (f64, f64, f64),
}

/// Position of the journal at one place along the bearing.
pub(super) struct Place {
    normal: (f64, f64),
    distance: f64,
    /// Deformation and its rate.
    pub(super) depth: f64,
    pub(super) rate: f64,
    /// Radial speed of the journal's centre.
    radial: f64,
    /// Tangential speed of the journal's centre.
    around: f64,
    /// Derivative of the journal's radius with respect to its angle.
    slope: f64,
}

/// Reaction of the bearing on the shaft: forces, torque, moments about its middle.
#[derive(Default)]
struct Reaction {
    force_y: f64,
    force_z: f64,
    torque: f64,
    moment_y: f64,
    moment_z: f64,
}

impl Plant {
    pub(super) fn new(real: &RealBench, hidden: &Hidden, effects: &[HiddenEffect]) -> Self {
        let of = |effect: &str, parameter: &str| total(effects, effect, parameter);
        let factor = |effect: &str| 1.0 + of(effect, "relative_change");
        let clearance_m =
            real.clearance_m + hidden.clearance_m + of("clearance-wear", "clearance_increase_m");
        let inertia = real.inertia.1 * factor("inertia-mismatch");
        let modulus_pa = real.modulus_pa * factor("contact-stiffness");
        let compliance = |modulus: f64, poisson: f64| (1.0 - poisson * poisson) / modulus;
        let restitution = (0.4 + of("restitution", "restitution_change")).clamp(0.05, 1.0);
        let compliance_m_n = hidden.compliance_m_n + of("hydraulic-compliance", "compliance_m_n");
        let play = of("fork-backlash", "backlash_m");
        let drive = if play > 0.0 {
            // Fork and oil column are in series.
            Drive::Play(0.5 * play, 1.0 / (1.0 / FORK.0 + compliance_m_n))
        } else if compliance_m_n > 0.0 {
            let stiffness = 1.0 / compliance_m_n;
            let reduced = inertia / real.levers_m.0.powi(2);
            Drive::Column(stiffness, 0.2 * (stiffness * reduced).sqrt())
        } else {
            Drive::Rigid
        };
        let twist = of("shaft-flexibility", "compliance_rad_nm");
        let shaft =
            (twist > 0.0).then(|| (1.0 / twist, 2.0 * TWIST_DAMPING * (0.25 * inertia / twist).sqrt()));
        Self {
            drive_lever_m: real.levers_m.0,
            load_lever_m: real.levers_m.1 * factor("lever-ratio"),
            mass: real.inertia.0,
            inertia,
            clearance_m,
            journal_radius_m: 0.070 - clearance_m,
            effective_modulus: 1.0 / (compliance(modulus_pa, 0.3) + compliance(206e9, 0.3)),
            dissipation_factor: 0.75 * (1.0 - restitution * restitution) * (2.0 * (1.0 - restitution)).exp(),
            friction: real.friction * (1.0 + hidden.friction) * factor("coulomb-level"),
            viscous: hidden.viscous_n_s_m + of("viscous-friction", "viscous_n_s_m"),
            load_n: real.load_n,
            third_harmonic_n: hidden.third_harmonic_n,
            drive,
            shaft,
            tilt: if real.tilts { Tilt::described(effects) } else { Tilt::none() },
            added: Added::new(effects),
        }
    }

    /// Returns displacement, velocity and acceleration of the drive as logged.
    pub(super) fn drive(&self, t: f64) -> (f64, f64, f64) {
        let (half, w) = (0.086, TAU);
        (half * (1.0 - (w * t).cos()), half * w * (w * t).sin(), half * w * w * (w * t).cos())
    }

    fn load(&self, t: f64) -> f64 {
        if t < 0.05 { 0.5 * self.load_n * (1.0 - (PI * t / 0.05).cos()) } else { self.load_n }
    }

    fn crank(&self, t: f64, s: &State) -> Crank {
        let cylinder = self.drive((t - self.added.lag_s).max(0.0));
        let (sine, speed) = match self.drive {
            Drive::Rigid => {
                let plane = self.tilt.drive_plane_m;
                let sine = (cylinder.0 - s[0] - plane * s[8]) / self.drive_lever_m;
                let pin = cylinder.1 - s[2] - plane * s[10];
                (sine, pin / (self.drive_lever_m * (1.0 - sine * sine).sqrt()))
            }
            _ => (s[4].sin(), s[5]),
        };
        Crank { sine, cosine: (1.0 - sine * sine).sqrt(), speed, cylinder }
    }

    /// Returns the journal's position at every node of the bearing.
    pub(super) fn places(&self, t: f64, s: &State) -> impl Iterator<Item = Place> {
        let crank = self.crank(t, s);
        self.tilt.nodes.iter().map(move |(at, _)| self.journal(*at, s, &crank))
    }

    fn journal(&self, at: f64, s: &State, crank: &Crank) -> Place {
        let (slope_y, slope_z) = self.tilt.bearing;
        let (y, z) = (s[0] + (s[8] - slope_y) * at, s[1] + (s[9] - slope_z) * at);
        let speed = (s[2] + s[10] * at, s[3] + s[11] * at);
        let distance = y.hypot(z);
        let (ny, nz) = (y / distance, z / distance);
        let radial = ny * speed.0 + nz * speed.1;
        let (cosine, sine) = self.added.oval;
        // Direction of the contact in the journal's frame.
        let along = ny * crank.cosine + nz * crank.sine;
        let across = nz * crank.cosine - ny * crank.sine;
        let (even, odd) = (along * along - across * across, 2.0 * along * across);
        let slope = 2.0 * (sine * even - cosine * odd);
        let around = ny * speed.1 - nz * speed.0;
        Place {
            normal: (ny, nz),
            distance,
            depth: distance - self.clearance_m + cosine * even + sine * odd,
            rate: radial + slope * (around / distance - crank.speed),
            radial,
            around,
            slope,
        }
    }

    /// Returns the reaction of the bearing; each node has its own contact with its latched speed.
    fn bearing(&self, t: f64, s: &State, crank: &Crank, latched: &[f64; NODES]) -> Reaction {
        let mut sum = Reaction::default();
        for (&(at, share), latched) in self.tilt.nodes.iter().zip(latched) {
            let (force_y, force_z, torque) = self.contact(t, &self.journal(at, s, crank), crank, *latched);
            sum.force_y += share * force_y;
            sum.force_z += share * force_z;
            sum.torque += share * torque;
            sum.moment_y += share * force_y * at;
            sum.moment_z += share * force_z * at;
        }
        sum
    }

    /// Returns F_cy, F_cz and T_f of a bearing that is uniform along its length.
    fn contact(&self, t: f64, place: &Place, crank: &Crank, latched: f64) -> (f64, f64, f64) {
        let (ny, nz) = place.normal;
        let squeeze = self.film(place);
        let film = (-squeeze * ny, -squeeze * nz);
        let (depth, speed) = (place.depth, crank.speed);
        if depth <= 0.0 {
            return (film.0, film.1, 0.0);
        }
        let gap = self.clearance_m;
        let stiffness = PI / 8.0
            * self.effective_modulus
            * (2.0 * depth * (3.0 * gap + 2.0 * depth).powi(2) / (gap + depth).powi(3)).sqrt();
        let rate = place.rate;
        let normal = stiffness * depth.powf(1.5) * (1.0 + self.dissipation_factor * rate / latched.max(1e-3));
        let normal = normal.max(0.0);
        let slide = speed * self.journal_radius_m - place.around;
        let sign = 1.0 - 2.0 / (1.0 + (2.0 * slide / 1e-3).exp());
        let coefficient = self.friction * (0.14 + 0.08 * (-slide.abs() / 0.02).exp());
        let friction = self.added.friction_n((t, normal), (slide, sign), coefficient, self.viscous);
        let tilt = place.slope / place.distance;
        (
            film.0 - normal * (ny - tilt * nz) + friction * nz,
            film.1 - normal * (nz + tilt * ny) - friction * ny,
            friction * self.journal_radius_m + normal * place.slope,
        )
    }

    /// Returns the resistance of the film against radial motion, N.
    fn film(&self, place: &Place) -> f64 {
        let (viscosity, least) = self.added.film;
        if viscosity <= 0.0 {
            return 0.0;
        }
        let share = place.distance / self.clearance_m;
        let open = ((1.0 - share) * (1.0 + share)).max(2.0 * least / self.clearance_m);
        let slender = self.journal_radius_m / self.clearance_m;
        12.0 * PI * viscosity * LENGTH_M * slender * slender * slender * place.radial / open.powf(1.5)
    }

    /// Returns the force of the fork on the shaft, N.
    fn fork(&self, gap: f64, rate: f64) -> f64 {
        match self.drive {
            Drive::Rigid => 0.0,
            Drive::Column(stiffness, damping) => stiffness * gap + damping * rate,
            Drive::Play(half, stiffness) if gap > half => {
                (stiffness * (gap - half) * (1.0 + FORK.1 * rate)).max(0.0)
            }
            Drive::Play(half, stiffness) if gap < -half => {
                (stiffness * (gap + half) * (1.0 - FORK.1 * rate)).min(0.0)
            }
            Drive::Play(..) => 0.0,
        }
    }

    /// Returns the derivative of the state and the quantities of a row.
    pub(super) fn derivative(&self, t: f64, s: &State, latched: &[f64; NODES]) -> (State, Row) {
        let crank = self.crank(t, s);
        let (Crank { sine, cosine, speed, .. }, (x, v, a)) = (&crank, crank.cylinder);
        let measured = self.load(t);
        let lever = self.drive_lever_m * cosine;
        let bearing = self.bearing(t, s, &crank, latched);
        let torque = bearing.torque + wave(self.added.position_ripple, sine.asin());
        let (cosine_n, sine_n, frequency_hz) = self.added.load_ripple;
        // On a shaft that twists, the load crank has a separate angle.
        let (load_cosine, load_speed) =
            if self.shaft.is_some() { (s[6].cos(), s[7]) } else { (*cosine, *speed) };
        let pin = s[2] + self.tilt.load_plane_m * s[10] + self.load_lever_m * load_cosine * load_speed;
        let load = measured + wave((cosine_n, sine_n, 1.0 / frequency_hz), t)
            - self.added.seal_n * (pin / 1e-3).tanh();
        let at_load = load * self.load_lever_m * load_cosine;
        let (transmitted, inertia, load_angular) = match self.shaft {
            None => (at_load, self.inertia, 0.0),
            Some((stiffness, damping)) => {
                let transmitted = stiffness * (s[6] - sine.asin()) + damping * (s[7] - speed);
                (transmitted, 0.5 * self.inertia, 2.0 * (at_load - transmitted) / self.inertia)
            }
        };
        let extra = self.third_harmonic_n * (3.0 * TAU * t).sin();
        let vertical = (bearing.force_z + extra) / self.mass - GRAVITY;
        let (tilt, lateral) = (&self.tilt, load + bearing.force_y);
        let moment_y = load * tilt.load_plane_m + bearing.moment_y + tilt.upright(s[8], s[10]);
        let moment_z = bearing.moment_z + tilt.upright(s[9], s[11]);
        let plane = tilt.drive_plane_m;
        let fork = if matches!(self.drive, Drive::Rigid) {
            // Force that keeps the crank pin in the fork.
            let given = a + self.drive_lever_m * sine * speed * speed;
            let free = lateral / self.mass
                + plane * moment_y / tilt.inertia
                + lever * (transmitted + torque) / inertia;
            let yields = 1.0 / self.mass + plane * plane / tilt.inertia + lever * lever / inertia;
            (given - free) / yields
        } else {
            let gap = x - s[0] - plane * s[8] - self.drive_lever_m * sine;
            self.fork(gap, v - s[2] - plane * s[10] - lever * speed)
        };
        let (x, v, _) = self.drive(t);
        let outputs =
            [sine.asin(), *speed, s[0], s[1], bearing.force_y, bearing.force_z, bearing.torque, fork];
        let row = Row { drive: (x, v), load: measured, outputs };
        let derivative = [
            s[2],
            s[3],
            (fork + lateral) / self.mass,
            vertical,
            *speed,
            (fork * lever + transmitted + torque) / inertia,
            s[7],
            load_angular,
            s[10],
            s[11],
            (fork * plane + moment_y) / tilt.inertia,
            moment_z / tilt.inertia,
        ];
        (derivative, row)
    }

    /// Returns the quantities of a row.
    pub(super) fn row(&self, t: f64, s: &State, latched: &[f64; NODES]) -> Row {
        self.derivative(t, s, latched).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generator::noise::Noise;

    #[test]
    fn fork_play_and_oil_column_are_in_series() {
        let real = RealBench::near_description(&mut Noise::new(1), 0.0);
        let one = |effect: &str, parameter: &str, value: f64| HiddenEffect {
            effect: effect.into(),
            channel: None,
            parameters: [(parameter.to_owned(), value)].into(),
        };
        let play = one("fork-backlash", "backlash_m", 2e-4);
        let column = one("hydraulic-compliance", "compliance_m_n", 2e-8);
        let fork = |effects: &[HiddenEffect]| Plant::new(&real, &Hidden::default(), effects).fork(3e-4, 0.0);
        let (alone, both) = (fork(std::slice::from_ref(&play)), fork(&[play, column]));
        assert!((alone - FORK.0 * 2e-4).abs() < 1.0, "{alone}");
        assert!((2e-4 / both - 2e-4 / alone - 2e-8).abs() < 1e-12, "{alone} {both}");
    }
}
