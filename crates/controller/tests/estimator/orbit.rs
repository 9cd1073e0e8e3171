//! Journals with known motion: position, deformation, rate and sliding speed in closed form, and
//! the frames of noise-free sensors (1 nm, 1 nrad).
//!
//! The journal swings along the clearance circle, `phi = -pi/2 + A sin(2 pi f t)`. The deformation
//! is `d = m + h sin(2 pi g t + p)`, and the shaft turns at a constant speed. SI units.

use contact::{FrictionLaw, NormalLaw};
use controller::Estimator;
use core::f64::consts::{FRAC_PI_2, TAU};
use inference::{BearingMaterial, shipped};
use link::{BenchConfiguration, EstimateFrame, SensorFrame};

/// Sample period of every test.
pub(crate) const PERIOD_US: u32 = 100;
/// Radius of the bearing of the bench.
const BEARING_RADIUS_M: f64 = 0.07;

/// Motion of a journal, and the configuration of the controller for its bench.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Orbit {
    pub bearing: BearingMaterial,
    pub clearance_m: f64,
    pub swing_rad: f64,
    pub swing_hz: f64,
    pub mean_deformation_m: f64,
    pub deformation_swing_m: f64,
    pub deformation_hz: f64,
    pub deformation_phase_rad: f64,
    pub shaft_speed_rad_s: f64,
    pub unseen_approach_m_s: f64,
}

impl Orbit {
    /// Bench B: half a millimetre of clearance, swinging at 45 Hz with up to 150 mm/s, always in
    /// contact, the deformation moving by at most 0.4 mm/s around half of its training range.
    pub(crate) fn swinging(bearing: BearingMaterial) -> Self {
        Self {
            bearing,
            clearance_m: 0.5e-3,
            swing_rad: 1.06,
            swing_hz: 45.0,
            // A metal is stiffer than a plastic: the same force deforms it less.
            mean_deformation_m: if bearing.elastic().youngs_modulus_pa > 1e10 { 30e-6 } else { 100e-6 },
            deformation_swing_m: 2e-6,
            deformation_hz: 30.0,
            deformation_phase_rad: 0.7,
            shaft_speed_rad_s: 0.3,
            unseen_approach_m_s: 3e-3,
        }
    }

    /// Journal radius.
    pub(crate) fn journal_radius_m(&self) -> f64 {
        BEARING_RADIUS_M - self.clearance_m
    }

    /// Configuration of the controller.
    pub(crate) fn configuration(&self) -> BenchConfiguration {
        BenchConfiguration {
            bearing: self.bearing.code(),
            radial_clearance_nm: (self.clearance_m * 1e9).round() as u32,
            journal_radius_nm: (self.journal_radius_m() * 1e9).round() as u32,
            sample_period_us: PERIOD_US,
            latch_floor_um_s: 1_000,
            unseen_approach_um_s: (self.unseen_approach_m_s * 1e6).round() as u32,
        }
    }

    /// A fresh estimator for this bench.
    pub(crate) fn estimator(&self) -> Estimator {
        Estimator::new(shipped(self.bearing), self.configuration())
            .unwrap_or_else(|refusal| unreachable!("a bench within the limits: {refusal:?}"))
    }

    /// The truth at a sample.
    pub(crate) fn truth(&self, index: u32) -> Truth {
        let t = f64::from(index) * f64::from(PERIOD_US) * 1e-6;
        let swing = TAU * self.swing_hz;
        let angle_rad = self.swing_rad * (swing * t).sin() - FRAC_PI_2;
        let turning_rad_s = self.swing_rad * swing * (swing * t).cos();
        let breathing = TAU * self.deformation_hz;
        let phase = breathing * t + self.deformation_phase_rad;
        let deformation_m = self.mean_deformation_m + self.deformation_swing_m * phase.sin();
        let distance_m = self.clearance_m + deformation_m;
        // With `t = (n_z, -n_y)` a journal that turns from +y to +z slides backwards.
        let sliding_m_s = self.shaft_speed_rad_s * self.journal_radius_m() - distance_m * turning_rad_s;
        Truth {
            normal: (angle_rad.cos(), angle_rad.sin()),
            distance_m,
            deformation_m,
            rate_m_s: self.deformation_swing_m * breathing * phase.cos(),
            sliding_m_s,
            shaft_angle_rad: self.shaft_speed_rad_s * t,
        }
    }

    /// Sensor frame of a sample.
    pub(crate) fn frame(&self, index: u32) -> SensorFrame {
        let truth = self.truth(index);
        let nm = |value: f64| (value * 1e9).round() as i32;
        SensorFrame {
            sequence: index,
            time_us: index.wrapping_mul(PERIOD_US),
            journal_y_nm: nm(truth.distance_m * truth.normal.0),
            journal_z_nm: nm(truth.distance_m * truth.normal.1),
            shaft_angle_nrad: (truth.shaft_angle_rad * 1e9).round() as i64 as i32,
            load_force_mn: 0,
        }
    }

    /// Estimates of a run of `count` samples.
    pub(crate) fn run(&self, count: u32) -> Vec<EstimateFrame> {
        let mut estimator = self.estimator();
        (0..count).map(|index| estimator.step(&self.frame(index))).collect()
    }

    /// The law that the bearing's network has learnt, at this clearance.
    pub(crate) fn normal_law(&self) -> NormalLaw {
        self.bearing.normal_law(self.clearance_m, 1e-3)
    }

    /// The friction law that the bearing's network has learnt.
    pub(crate) fn friction_law(&self) -> FrictionLaw {
        self.bearing.friction_law()
    }
}

/// True values at a sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    pub normal: (f64, f64),
    pub distance_m: f64,
    pub deformation_m: f64,
    pub rate_m_s: f64,
    pub sliding_m_s: f64,
    pub shaft_angle_rad: f64,
}
