//! Parameters of a world, in SI units.

use std::f64::consts::PI;

/// Young's modulus in Pa and Poisson ratio of the steel shaft.
const STEEL: (f64, f64) = (206e9, 0.3);

/// Bearing material of a described bench.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bearing {
    /// Babbitt alloy.
    Babbitt,
    /// Engineering plastic alloy.
    Plastic,
}

/// Dry friction: its coefficient is `mu_c + (mu_s - mu_c) exp(-|v|/v_s) + k max(|v| - v_k, 0)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Coefficient at high speed.
    pub coulomb_coefficient: f64,
    /// Coefficient at the onset of sliding.
    pub static_coefficient: f64,
    /// Decay speed of the difference.
    pub stribeck_speed_m_s: f64,
    /// Slope of the coefficient over the speed.
    pub viscous_slope_s_m: f64,
    /// Speed where the slope begins.
    pub viscous_onset_m_s: f64,
    /// Width of the regularised sign `tanh(v/v_r)`.
    pub regularisation_m_s: f64,
}

/// One transmission bench as it is in reality.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct World {
    /// Radius of the drive crank.
    pub drive_lever_m: f64,
    /// Radius of the load crank.
    pub load_lever_m: f64,
    /// Mass of the shaft.
    pub mass_kg: f64,
    /// Moment of inertia of the shaft.
    pub inertia_kg_m2: f64,
    /// Radius of the bearing; that of the journal is smaller by the clearance.
    pub bearing_radius_m: f64,
    /// Radial clearance.
    pub radial_clearance_m: f64,
    /// Young's modulus of the bearing.
    pub youngs_modulus_pa: f64,
    /// Poisson ratio of the bearing.
    pub poisson_ratio: f64,
    /// Coefficient of restitution, which determines the dissipation factor.
    pub restitution: f64,
    /// Lower limit of the approach speed in the damping term.
    pub latch_floor_m_s: f64,
    /// Friction of the bearing.
    pub friction: Friction,
    /// Load along +Y after its ramp.
    pub load_n: f64,
    /// Duration of the raised-cosine ramp of the load.
    pub load_ramp_s: f64,
    /// Amplitude of a sine that is added to the load. No described bench has it.
    pub load_swing_n: f64,
    /// Period of that sine.
    pub load_swing_period_s: f64,
    /// Stroke of the drive.
    pub stroke_m: f64,
    /// Period of the drive.
    pub period_s: f64,
    /// Further rise of the friction coefficient at standstill. No described bench has it.
    pub stribeck_rise: f64,
    /// Decay speed of that rise.
    pub stribeck_rise_speed_m_s: f64,
    /// Change of the exponent of the elastic force, about its value at 20 um. No described bench
    /// has it.
    pub exponent_change: f64,
    /// Lag of the drive's motion. No described bench has it.
    pub drive_lag_s: f64,
}

impl World {
    /// Bench B as described, with a radial clearance in m and a load in N.
    pub const fn bench_b(bearing: Bearing, radial_clearance_m: f64, load_n: f64) -> Self {
        let (elastic, restitution, coefficients, viscous) = match bearing {
            Bearing::Babbitt => ((50e9, 0.3), 0.4, (0.14, 0.22), (0.0, 0.0)),
            Bearing::Plastic => ((2.5e9, 0.4), 0.8, (0.08, 0.08), (0.25, 0.02)),
        };
        Self {
            drive_lever_m: 0.30,
            load_lever_m: 0.36,
            mass_kg: 150.0,
            inertia_kg_m2: 60.0,
            bearing_radius_m: 0.070,
            radial_clearance_m,
            youngs_modulus_pa: elastic.0,
            poisson_ratio: elastic.1,
            restitution,
            latch_floor_m_s: 1e-3,
            friction: Friction {
                coulomb_coefficient: coefficients.0,
                static_coefficient: coefficients.1,
                stribeck_speed_m_s: 0.02,
                viscous_slope_s_m: viscous.0,
                viscous_onset_m_s: viscous.1,
                regularisation_m_s: 1e-3,
            },
            load_n,
            load_ramp_s: 0.05,
            load_swing_n: 0.0,
            load_swing_period_s: 1.0,
            stroke_m: 0.172,
            period_s: 1.0,
            stribeck_rise: 0.0,
            stribeck_rise_speed_m_s: 0.01,
            exponent_change: 0.0,
            drive_lag_s: 0.0,
        }
    }

    /// Radius of the journal.
    pub const fn journal_radius_m(&self) -> f64 {
        self.bearing_radius_m - self.radial_clearance_m
    }

    /// Effective modulus of bearing and shaft: `1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2`.
    pub const fn effective_modulus_pa(&self) -> f64 {
        let bearing = (1.0 - self.poisson_ratio * self.poisson_ratio) / self.youngs_modulus_pa;
        1.0 / (bearing + (1.0 - STEEL.1 * STEEL.1) / STEEL.0)
    }

    /// Dissipation factor of Zhiying and Qishao (2006): `(3/4)(1 - e^2) exp(2(1 - e))`.
    pub fn dissipation_factor(&self) -> f64 {
        let restitution = self.restitution;
        0.75 * (1.0 - restitution * restitution) * (2.0 * (1.0 - restitution)).exp()
    }

    /// Returns the load along +Y in N.
    pub(crate) fn load_at(&self, time_s: f64) -> f64 {
        let share = time_s / self.load_ramp_s;
        let load_n = if share < 1.0 { 0.5 * self.load_n * (1.0 - (PI * share).cos()) } else { self.load_n };
        if self.load_swing_n == 0.0 {
            return load_n;
        }
        load_n + self.load_swing_n * (2.0 * PI * time_s / self.load_swing_period_s).sin()
    }

    /// Returns displacement, velocity and acceleration of the drive in m and s.
    pub(crate) fn drive_at(&self, time_s: f64) -> [f64; 3] {
        let t = time_s - self.drive_lag_s;
        if t < 0.0 {
            return [0.0; 3];
        }
        let (half, w) = (0.5 * self.stroke_m, 2.0 * PI / self.period_s);
        let (sine, cosine) = (w * t).sin_cos();
        [half * (1.0 - cosine), half * w * sine, half * w * w * cosine]
    }
}
