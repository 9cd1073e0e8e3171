//! Collects the facts: the paper's runs, and what the runs alone cannot tell.
//!
//! Beside the runs: a fine load grid and a modulus scan with the analytic law (they look for a cause, not for a
//! figure of the paper), the published slider-crank, the friction laws at the rig's loads, and the shipped networks.

use super::facts::{BearingFacts, Facts, FrictionFacts, JointFacts, RunFacts, TorqueCurve};
use super::training;
use crate::error::CliError;
use crate::force::{self, DEFAULT_STEP_S, ForceSource, SAMPLE_RATE_HZ};
use crate::paper::{LOAD_CLEARANCE_MM, PaperRuns, Series, resolved, variant};
use crate::summary::Figures;
use crate::{parallel, swing};
use bench::BearingMaterial::{self, Babbitt, Plastic};
use bench::description::TransmissionBench;
use bench::integrate::{ContactPlant, integrate};
use bench::slider_crank_description::reference_problem;

/// The rig's loads, N.
pub const RIG_LOADS_N: [f64; 4] = [100e3, 150e3, 200e3, 240e3];
/// The rig's largest speed, 6 deg/s, rad/s.
const RIG_SPEED_RAD_S: f64 = core::f64::consts::PI / 30.0;
/// Fine load grid: half kilonewtons to either side.
const LOAD_STEPS: i32 = 20;
const LOAD_STEP_KN: f64 = 0.5;
/// Moduli of the scan, Pa, at the bearing and clearance below.
const MODULI_PA: [f64; 8] = [2.5e9, 5e9, 10e9, 20e9, 50e9, 100e9, 200e9, 400e9];
const MODULUS_CLEARANCE_MM: f64 = 0.5;
const MODULUS_LOAD_KN: f64 = 10.0;
/// Points of a torque curve.
const CURVE_POINTS: u32 = 400;
/// Samples of the slider-crank: a contact of 50 us has some hundreds.
const SLIDER_CRANK_SAMPLES: u32 = 60_000;
const SLIDER_CRANK_TOLERANCE: f64 = 1e-10;

/// Collects everything for a base bench and its runs.
pub fn gather(base: &TransmissionBench, runs: &PaperRuns, threads: usize) -> Result<Facts, CliError> {
    let bench: Vec<(f64, f64)> = runs
        .series(Series::Clearance)
        .iter()
        .map(|r| (r.figures.clearance_mm, r.joint_acceleration_ratio))
        .collect();
    let bearing = |bearing: BearingMaterial| -> Result<BearingFacts, CliError> {
        let facts = |series| runs.of(series, bearing).into_iter().map(RunFacts::from).collect();
        Ok(BearingFacts {
            bearing,
            clearance: facts(Series::Clearance),
            load: facts(Series::Load),
            load_curve: load_curve(base, bearing, threads)?,
        })
    };
    Ok(Facts {
        babbitt: bearing(Babbitt)?,
        plastic: bearing(Plastic)?,
        modulus: modulus_scan(base, threads)?,
        joint: JointFacts { slider_crank: slider_crank_ratio()?, bench },
        friction: friction(base, runs)?,
        training: training::measure()?,
    })
}

fn load_curve(
    base: &TransmissionBench,
    bearing: BearingMaterial,
    threads: usize,
) -> Result<Vec<(f64, f64)>, CliError> {
    let loads: Vec<f64> = (-LOAD_STEPS..=LOAD_STEPS).map(|i| f64::from(i) * LOAD_STEP_KN).collect();
    parallel::map(threads, &loads, |_, &load_kn| {
        let bench = resolved(variant(base, bearing, LOAD_CLEARANCE_MM, load_kn))?;
        let run = force::run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {})?;
        let figures = Figures::of(&bench, ForceSource::Law, &run, SAMPLE_RATE_HZ);
        Ok((load_kn, figures.peak_contact_force_n))
    })
}

fn modulus_scan(base: &TransmissionBench, threads: usize) -> Result<Vec<(f64, f64)>, CliError> {
    let points = parallel::map(threads, &MODULI_PA, |_, &modulus_pa| {
        let mut bench = variant(base, Babbitt, MODULUS_CLEARANCE_MM, MODULUS_LOAD_KN);
        bench.bearing.youngs_modulus_pa = modulus_pa;
        let bench = resolved(bench)?;
        let run = force::run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {})?;
        let swing = swing::measure(&bench, &run.run.samples, SAMPLE_RATE_HZ);
        Ok(swing.swing_hz.map(|hz| (modulus_pa, hz)))
    })?;
    Ok(points.into_iter().flatten().collect())
}

/// Largest acceleration of the slider over that of the same mechanism without clearance.
pub fn slider_crank_ratio() -> Result<f64, CliError> {
    let bench = reference_problem()?;
    let plant = bench.plant();
    let end_s = bench.duration_s();
    let step = end_s / f64::from(SLIDER_CRANK_SAMPLES);
    let times: Vec<f64> = (0..SLIDER_CRANK_SAMPLES).map(|i| f64::from(i) * step).collect();
    let mut largest = 0.0_f64;
    integrate(
        &plant,
        (0.0, end_s),
        plant.initial_state(),
        false,
        &times,
        &plant.tolerances(SLIDER_CRANK_TOLERANCE),
        |t, state, latched| {
            let mut rates = [0.0; 4];
            let touching = plant.deformation(t, state).0 > 0.0;
            plant.derivative(t, state, touching.then_some(latched), &mut rates);
            largest = largest.max(rates[3].abs());
        },
    )?;
    let (r, l, w) = (plant.crank_length_m, plant.rod_length_m, plant.crank_speed_rad_s);
    let position = |t: f64| {
        let (sin, cos) = (w * t).sin_cos();
        r * cos + (l * l - r * r * sin * sin).sqrt()
    };
    // Second difference of the closed form over a step that rounding does not spoil.
    let h = 1e-3 / w;
    let ideal = times
        .iter()
        .step_by(20)
        .map(|&t| ((position(t + h) - 2.0 * position(t) + position(t - h)) / (h * h)).abs())
        .fold(0.0, f64::max);
    Ok(largest / ideal)
}

fn friction(base: &TransmissionBench, runs: &PaperRuns) -> Result<FrictionFacts, CliError> {
    let radius = base.bearing.bearing_radius_m;
    let sliding = runs.series(Series::Clearance).into_iter().flat_map(|r| &r.samples);
    let bench_speed = sliding.map(|s| s.contact.sliding_speed_m_s.abs()).fold(0.0, f64::max);
    let curves = |bearing: BearingMaterial| -> Result<Vec<TorqueCurve>, CliError> {
        let bench = resolved(variant(base, bearing, LOAD_CLEARANCE_MM, 1.0))?;
        let law = bench.friction_law();
        let curve = |load_n: f64| TorqueCurve {
            load_n,
            points: (0..=CURVE_POINTS)
                .map(|i| bench_speed * f64::from(i) / f64::from(CURVE_POINTS))
                .map(|v| (v, law.coefficient(v) * bench.friction.level * load_n * radius))
                .collect(),
        };
        Ok(RIG_LOADS_N.map(curve).to_vec())
    };
    Ok(FrictionFacts {
        babbitt: curves(Babbitt)?,
        plastic: curves(Plastic)?,
        rig_speed_m_s: RIG_SPEED_RAD_S * radius,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slider_cranks_clearance_multiplies_its_acceleration_as_published() {
        let ratio = slider_crank_ratio().unwrap();
        assert!((ratio / 16.8 - 1.0).abs() < 0.01, "{ratio}");
    }
}
