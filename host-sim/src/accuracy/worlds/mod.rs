//! The estimate in worlds that differ from the described bench.
//!
//! The truth is the independent simulator `worlds`; the estimators know the described bench only.
//!
//! * [`cases`]: the worlds of an operating point: the described one, drawn ones, ones with a single
//!   parameter off, and ones with an effect that no description contains.
//! * [`estimators`]: the controller with the networks, with the law, and with a drive force.
//! * [`score`]: errors of one estimator in one world.
//! * [`goals`] evaluates the figures.
//!
//! Limits: the worlds share the model class of the bench: dry, rigid, planar. Shares refer to the
//! world's largest true force and torque after the start.

pub mod cases;
pub mod estimators;
pub mod goals;
mod outcome;
mod pictures;
mod recorded;
mod report;
pub mod score;

use crate::cli::error::CliError;
use crate::cli::output::{self, Files};
use crate::cli::{parallel, progress};
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use cases::{OperatingPoint, RealWorld};
use estimators::EstimatorKind;
pub(crate) use outcome::Outcome;
use recorded::Recorded;
use score::Case;
use std::path::Path;

/// Options of the measurement.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Drawn worlds of each operating point.
    pub draws: u32,
    /// Seed of the draws and of the sensors' noise.
    pub seed: u64,
    /// Threads; 0 uses one per core. The result does not depend on it.
    pub threads: usize,
}

/// Measures every estimator in every world of the operating points; `finished` is called after each
/// world.
pub fn measure(
    points: &[OperatingPoint],
    settings: Settings,
    finished: impl Fn() + Sync,
) -> Result<Vec<Case>, CliError> {
    let worlds = |point: &OperatingPoint| cases::worlds(point, settings.draws, settings.seed);
    let jobs: Vec<(OperatingPoint, RealWorld)> =
        points.iter().flat_map(|point| worlds(point).into_iter().map(|real| (*point, real))).collect();
    let measured = parallel::map(settings.threads, &jobs, |_, (point, real)| {
        let recorded = Recorded::new(point, real, settings.seed);
        let case = |kind| Ok(Case::new(point, real, kind, &recorded.rows, &recorded.estimates(point, kind)?));
        let cases = EstimatorKind::ALL.into_iter().map(case).collect::<Result<Vec<Case>, CliError>>()?;
        finished();
        Ok(cases)
    })?;
    Ok(measured.into_iter().flatten().collect())
}

/// Measures, stores and prints: the command.
pub(crate) fn run(
    bearing: Option<BearingMaterial>,
    settings: Settings,
    out: &Path,
    as_json: bool,
) -> Result<(), CliError> {
    output::check_folder(out)?;
    let points: Vec<OperatingPoint> =
        OperatingPoint::all().into_iter().filter(|p| bearing.is_none_or(|b| p.material() == b)).collect();
    if let (Some(bearing), true) = (bearing, points.is_empty()) {
        let expected = "a material whose worlds are described";
        return Err(CliError::Input(format!("--bearing: found {}; expected {expected}", bearing.name())));
    }
    let count: usize = points.iter().map(|p| cases::worlds(p, settings.draws, settings.seed).len()).sum();
    let bar = progress::bar(count as u64);
    bar.set_message("worlds");
    let cases = measure(&points, settings, || bar.inc(1))?;
    bar.finish_and_clear();
    let goals = goals::verdicts(&cases);
    let outcome = Outcome { worlds: settings.draws, seed: settings.seed, goals, cases };
    let pictures = pictures::draw(&outcome)?;
    let mut files = Files::new(out);
    let text = files.add_result("worlds.json", &outcome)?;
    pictures.add_to(&mut files)?;
    files.add_page("worlds.html", report::page(&outcome, &pictures, &TransmissionBench::open("bench-b")?))?;
    files.publish()?;
    if as_json {
        print_result!("{text}");
    } else {
        report::print(&outcome);
        print_line!("\nreport: {}", out.join("worlds.html").display());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::cases::Set;
    use super::*;
    use crate::run::force::{DEFAULT_STEP_S, ForceSource, SAMPLE_RATE_HZ, run_bench};
    use ::worlds::World;

    /// Both simulators integrate the same equations with different methods. The largest differences
    /// measured are 1.0 nm, 0.47 N and 0.033 N m; the tolerances are three times these.
    #[test]
    fn the_described_world_moves_as_the_engine_s_bench_does() {
        for point in OperatingPoint::all().into_iter().filter(|p| p.clearance_mm == 0.5) {
            let bench = point.described_bench().unwrap();
            let engine = run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {}).unwrap().run.samples;
            let rows = point.described_world().run(1.0, SAMPLE_RATE_HZ);
            let (mut journal_m, mut force_n, mut torque_nm) = (0.0_f64, 0.0_f64, 0.0_f64);
            for (row, sample) in rows.iter().zip(&engine) {
                assert!((row.time_s - sample.time_s).abs() < 1e-9);
                let off = (row.journal_y_m - sample.y_m).hypot(row.journal_z_m - sample.z_m);
                journal_m = journal_m.max(off);
                let off = (row.force_y_n - sample.force_y_n).hypot(row.force_z_n - sample.force_z_n);
                force_n = force_n.max(off.max((row.drive_force_n - sample.drive_force_n).abs()));
                torque_nm = torque_nm.max((row.friction_torque_nm - sample.friction_torque_nm).abs());
            }
            assert!(journal_m < 3e-9, "{}: {journal_m} m", point.name());
            assert!(force_n < 1.5, "{}: {force_n} N", point.name());
            assert!(torque_nm < 0.1, "{}: {torque_nm} N m", point.name());
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
        let points = [OperatingPoint::all()[0]];
        let text = |seed, threads| {
            let cases = measure(&points, Settings { draws: 2, seed, threads }, || {}).unwrap();
            serde_json::to_string(&cases).unwrap()
        };
        let one = text(1, 1);
        assert_eq!(one, text(1, 2));
        assert_ne!(one, text(2, 1));
    }

    #[test]
    fn a_draw_does_not_depend_on_the_number_of_worlds_or_on_the_other_operating_points() {
        let point = OperatingPoint::all()[3];
        let drawn = |draws, seed| {
            let worlds = cases::worlds(&point, draws, seed);
            worlds.into_iter().filter(|w| w.set == Set::Drawn).map(|w| w.world).collect::<Vec<World>>()
        };
        assert_eq!(drawn(2, 1), drawn(5, 1)[..2]);
        assert_ne!(drawn(2, 1), drawn(2, 2));
    }
}
