//! Collects the facts: the paper's runs, and numbers that the runs alone do not contain.
//!
//! These are a fine grid of loads and a scan of the modulus with the analytic law (they show a
//! cause, not a figure of the paper), the published slider-crank, records of the friction rigs, and
//! the shipped networks.

use super::facts::{BearingFacts, Facts, JointFacts, MotionFacts, RunFacts};
use crate::cli::error::CliError;
use crate::cli::parallel;
use crate::reproduction::runs::{PaperRuns, Series};
use crate::reproduction::swing;
use crate::run::conditions::{LOAD_CLEARANCE_MM, variant};
use crate::run::force::{self, DEFAULT_STEP_S, ForceSource, SAMPLE_RATE_HZ};
use crate::run::summary::Figures;
use bench::BearingMaterial::{self, Babbitt, Plastic};
use bench::description::SliderCrankBench;
use bench::description::TransmissionBench;
use bench::integrate::{ContactPlant, integrate};
use bench::plants::slider_crank::SliderCrank;
use model_quant::report::claims::{torque, training};

/// Fine load grid: half kilonewtons to either side.
const LOAD_STEPS: i32 = 20;
const LOAD_STEP_KN: f64 = 0.5;
/// Moduli of the scan, Pa, at the bearing and clearance below.
const MODULI_PA: [f64; 8] = [2.5e9, 5e9, 10e9, 20e9, 50e9, 100e9, 200e9, 400e9];
const MODULUS_CLEARANCE_MM: f64 = 0.5;
const MODULUS_LOAD_KN: f64 = 10.0;
const SLIDER_CRANK_TOLERANCE: f64 = 1e-10;
const SLIDER_CRANK_SAMPLE_S: f64 = 1e-6;

/// Collects everything for a base bench and its runs.
pub fn gather(base: &TransmissionBench, runs: &PaperRuns, threads: usize) -> Result<Facts, CliError> {
    let bench: Vec<(f64, f64)> = runs
        .series(Series::Clearance)
        .iter()
        .map(|r| (r.figures.clearance_mm, r.joint_acceleration_ratio))
        .collect();
    let bearing = |bearing: BearingMaterial| -> Result<BearingFacts, CliError> {
        let facts = |series| runs.of_bearing(series, bearing).into_iter().map(RunFacts::from).collect();
        Ok(BearingFacts {
            bearing,
            clearance: facts(Series::Clearance),
            load: facts(Series::Load),
            load_curve: load_curve(base, bearing, threads)?,
        })
    };
    Ok(Facts {
        motion: MotionFacts {
            babbitt: bearing(Babbitt)?,
            plastic: bearing(Plastic)?,
            modulus: modulus_scan(base, threads)?,
            joint: JointFacts { slider_crank: slider_crank_ratio()?, bench },
        },
        friction: torque::measure_rigs().map_err(|e| CliError::Work(e.to_string()))?,
        networks: torque::measure_networks().map_err(|e| CliError::Work(e.to_string()))?,
        training: training::measure().map_err(|e| CliError::Work(e.to_string()))?,
    })
}

fn load_curve(
    base: &TransmissionBench,
    bearing: BearingMaterial,
    threads: usize,
) -> Result<Vec<(f64, f64)>, CliError> {
    let loads: Vec<f64> = (-LOAD_STEPS..=LOAD_STEPS).map(|i| f64::from(i) * LOAD_STEP_KN).collect();
    parallel::map(threads, &loads, |_, &load_kn| {
        let bench = variant(base, bearing, LOAD_CLEARANCE_MM, load_kn).resolved();
        let run = force::run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {})?;
        let figures = Figures::from_run(&bench, ForceSource::Law, &run, SAMPLE_RATE_HZ);
        Ok((load_kn, figures.peak_contact_force_n))
    })
}

fn modulus_scan(base: &TransmissionBench, threads: usize) -> Result<Vec<(f64, f64)>, CliError> {
    let points = parallel::map(threads, &MODULI_PA, |_, &modulus_pa| {
        let mut bench = variant(base, Babbitt, MODULUS_CLEARANCE_MM, MODULUS_LOAD_KN);
        bench.bearing.youngs_modulus_pa = modulus_pa;
        let bench = bench.resolved();
        let run = force::run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {})?;
        let swing = swing::measure(&bench, &run.run.samples, SAMPLE_RATE_HZ);
        Ok(swing.swing_hz.map(|hz| (modulus_pa, hz)))
    })?;
    Ok(points.into_iter().flatten().collect())
}

/// Largest acceleration of the slider over that of the same mechanism without clearance, which
/// decelerates hardest where crank and rod are in line. It counts from the published start over the
/// described time.
pub(crate) fn slider_crank_ratio() -> Result<f64, CliError> {
    let bench = SliderCrankBench::open("slider-crank")?;
    ratio_within(&bench.plant(), (0.0, bench.duration_s()))
}

/// The same over one revolution after `revolutions` of the crank. The joint may then stay in
/// contact.
pub(crate) fn settled_slider_crank_ratio(revolutions: u32) -> Result<f64, CliError> {
    let plant = SliderCrankBench::open("slider-crank")?.plant();
    let period_s = core::f64::consts::TAU / plant.crank_speed_rad_s;
    let from_s = f64::from(revolutions) * period_s;
    ratio_within(&plant, (from_s, from_s + period_s))
}

fn ratio_within(plant: &SliderCrank, (from_s, end_s): (f64, f64)) -> Result<f64, CliError> {
    let count = ((end_s - from_s) / SLIDER_CRANK_SAMPLE_S) as usize;
    let times: Vec<f64> = (0..count).map(|i| from_s + i as f64 * SLIDER_CRANK_SAMPLE_S).collect();
    let mut largest = 0.0_f64;
    let run = integrate(
        plant,
        (0.0, end_s),
        plant.initial_state(),
        false,
        &times,
        &plant.tolerances(SLIDER_CRANK_TOLERANCE),
        |time_s, state, touch| {
            let contact = plant.contact(time_s, state, touch.latched_m_s);
            if contact.depth_m > 0.0 {
                largest = largest.max(contact.force_n);
            }
        },
    )?;
    // Between samples a peak is higher; impacts have it exactly.
    let impacts = run.impacts.iter().filter(|i| i.onset_s >= from_s);
    let largest = impacts.map(|i| i.peak_force_n).fold(largest, f64::max) / plant.slider_mass_kg;
    let (crank, speed) = (plant.crank_length_m, plant.crank_speed_rad_s);
    Ok(largest / (crank * speed * speed * (1.0 + crank / plant.rod_length_m)))
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
