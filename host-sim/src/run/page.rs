//! The report page of a run.

use super::estimator_summary::EstimatorSummary;
use super::exchange::ExchangeResult;
use super::impacts::TABLE_HEADER;
use super::report::{
    EQUIVALENCE_HEADER, PEAK_HEADER, counted_rows, energy_rows, equivalence_rows, impact_header, impact_rows,
    or_unknown, peak_rows, recorded_rows, rows,
};
use super::{Finished, servo, settled, tilt};
use crate::cli::limits;
use crate::run::magnitude::after_start;
use bench::plants::transmission::Snapshot;
use link::{EstimateFrame, ImpactRecord};
use report::figure::{Chart, Series, Style, lines, map};
use report::page::Page;

const WIDE: (u32, u32) = (1040, 360);
const SQUARE: (u32, u32) = (500, 500);

/// Builds the page. An error describes a failure of drawing.
pub(crate) fn page(finished: &Finished) -> Result<Page, String> {
    let summary = &finished.summary;
    let figures = &summary.figures;
    let mut page = Page::new("Transmission bench: one run");
    page.lead(&format!(
        "{}, radial clearance {:.2} mm, load {:+.1} kN, bearing force from {}: peak contact force {:.0} N, \
         oscillation {} rms.",
        figures.bearing.name(),
        figures.clearance_mm,
        figures.load_kn,
        figures.force.name(),
        figures.peak_contact_force_n,
        or_unknown(figures.oscillation_rms_n),
    ));
    page.note(
        "Peaks and errors count from the end of the load's ramp. Forces are those of the \
         bearing on the journal, normal and friction together.",
    );
    let table: Vec<Vec<String>> = rows(summary).into_iter().map(Vec::from).collect();
    page.section("Figures").table(&["quantity", "value"], &table);
    if summary.servo.is_some() || finished.bench.drive_profile.is_some() {
        servo::motion_section(&mut page, &finished.bench, &finished.forced.run.samples)?;
    }
    forces_section(&mut page, finished)?;
    journal_section(&mut page, finished)?;
    if !finished.forced.tilting.is_empty() {
        tilt::section(&mut page, &finished.bench, &finished.forced.tilting)?;
    }
    if let Some(found) = &summary.settled {
        settled::section(&mut page, found)?;
    }
    if let Some(estimator) = &summary.estimator {
        controller_section(&mut page, estimator);
        impacts_section(&mut page, finished);
    }
    audit_sections(&mut page, finished);
    match &summary.plant {
        Some(plant) => {
            page.note(&format!(
                "The plant is the unit {}; this program does not know its omissions.",
                plant.file
            ));
        }
        None => limits::section(&mut page, &finished.bench),
    }
    Ok(page)
}

fn over_time(name: &str, samples: &[Snapshot], read: Read) -> Series {
    Series::new(name, samples.iter().map(|s| s.time_s), samples.iter().map(read))
}

/// Quantity of a snapshot.
type Read = fn(&Snapshot) -> f64;

/// Contact force, estimate, force components and friction torque over time.
fn forces_section(page: &mut Page, finished: &Finished) -> Result<(), String> {
    page.section("Forces over the cycle");
    let force = Chart { title: "Contact force", x: "time, s", y: "N", size: WIDE };
    against_law(page, finished, &force, |s| s.forces.normal_n, "Normal force of the contact.")?;
    estimate_figures(page, finished)?;
    let samples = &finished.forced.run.samples;
    let components = [over_time("Y", samples, |s| s.force_y_n), over_time("Z", samples, |s| s.force_z_n)];
    page.figure(
        &lines(&Chart { title: "Force on the journal", x: "time, s", y: "N", size: WIDE }, &components)?,
        "Components along Y (transverse, towards the drive) and Z (upwards).",
    );
    against_law(
        page,
        finished,
        &Chart { title: "Friction torque", x: "time, s", y: "N m", size: WIDE },
        |s| s.friction_torque_nm,
        "Torque of the bearing on the shaft, negative during forward rotation.",
    )
}

/// Draws a quantity and, where the law was run too, its difference from that run.
fn against_law(
    page: &mut Page,
    finished: &Finished,
    chart: &Chart,
    read: Read,
    caption: &str,
) -> Result<(), String> {
    let samples = &finished.forced.run.samples;
    let name = finished.summary.figures.force.name();
    let Some(law) = finished.law.as_ref().map(|law| law.run.samples.as_slice()) else {
        page.figure(&lines(chart, &[over_time(name, samples, read)])?, caption);
        return Ok(());
    };
    // The law is drawn first, so that a difference of the networks remains visible.
    let both = [over_time("analytic law", law, read).styled(Style::Wide), over_time(name, samples, read)];
    page.figure(&lines(chart, &both)?, caption);
    let title = format!("{}: difference from the analytic law", chart.title);
    let pairs = samples.iter().zip(law).map(|(found, law)| (found.time_s, read(found) - read(law)));
    let difference = Series::through("difference", pairs.collect());
    let (width, height) = chart.size;
    let chart = Chart { title: &title, size: (width, height * 2 / 3), ..*chart };
    page.figure(&lines(&chart, &[difference])?, "Both runs have the same samples.");
    Ok(())
}

/// The estimated force, and its error within the band of two standard deviations, after the start.
/// Held estimates have no deviation and are left out of the band.
fn estimate_figures(page: &mut Page, finished: &Finished) -> Result<(), String> {
    let Some(exchange) = &finished.exchange else { return Ok(()) };
    let samples = &finished.forced.run.samples;
    let counted = after_start(&finished.bench, samples);
    let estimates = exchange.estimates.iter().skip(samples.len() - counted.len());
    let pairs: Vec<_> = counted.iter().zip(estimates).filter(|(_, e)| e.force_sd_n.is_finite()).collect();
    let over = |value: fn(&Snapshot, &EstimateFrame) -> f64| -> Vec<(f64, f64)> {
        pairs.iter().map(|(sample, estimate)| (sample.time_s, value(sample, estimate))).collect()
    };
    let mut band = over(|_, e| 2.0 * f64::from(e.normal_force_sd_n));
    band.extend(over(|_, e| -2.0 * f64::from(e.normal_force_sd_n)).into_iter().rev());
    let mut force = vec![
        Series::through("estimate", over(|_, e| e.normal_force_n.into())),
        Series::through("bench", over(|s, _| s.forces.normal_n)),
    ];
    let start_s = pairs.first().map_or(0.0, |(sample, _)| sample.time_s);
    let peaks = recorded_peaks(exchange, start_s);
    if !peaks.is_empty() {
        force.push(Series::through("recorded peaks", peaks).styled(Style::Points));
    }
    let error = [
        Series::through("two standard deviations", band).styled(Style::Area),
        Series::through("error", over(|s, e| f64::from(e.normal_force_n) - s.forces.normal_n)),
    ];
    page.figure(
        &lines(&Chart { title: "Estimated contact force", x: "time, s", y: "N", size: WIDE }, &force)?,
        "Estimated by the controller from noisy position, angle and load sensors at 10 kHz.",
    );
    page.figure(
        &lines(&Chart { title: "Error of the estimate", x: "time, s", y: "N", size: WIDE }, &error)?,
        "Estimated normal force less that of the bench. The band is reported with every estimate; it \
         also covers what is declared uncertain, such as the mass.",
    );
    Ok(())
}

/// Peaks of the recorded impacts from a time on, s and N.
fn recorded_peaks(exchange: &ExchangeResult, start_s: f64) -> Vec<(f64, f64)> {
    let peak = |record: &ImpactRecord| (f64::from(record.peak_us) * 1e-6, f64::from(record.peak_force_n));
    exchange.impacts.iter().map(peak).filter(|(time_s, _)| *time_s >= start_s).collect()
}

/// Orbit and deformation.
fn journal_section(page: &mut Page, finished: &Finished) -> Result<(), String> {
    page.section("The journal in its clearance");
    let samples = &finished.forced.run.samples;
    let clearance_um = finished.bench.bearing.radial_clearance_m * 1e6;
    let circle = Series::through(
        "clearance circle",
        (0..=180)
            .map(|i| f64::from(i) * core::f64::consts::TAU / 180.0)
            .map(|a| (clearance_um * a.cos(), clearance_um * a.sin()))
            .collect(),
    );
    let orbit = |name: &str, samples: &[Snapshot]| {
        let thinned = samples.iter().step_by((samples.len() / 2000).max(1));
        Series::through(name, thinned.map(|s| (s.y_m * 1e6, s.z_m * 1e6)).collect())
    };
    let deformation = over_time("deformation", samples, |s| s.contact.deformation_m * 1e6);
    page.figures(&[
        (
            map(
                &Chart { title: "Orbit", x: "y, um", y: "z, um", size: SQUARE },
                &[orbit("journal centre", samples), circle],
            )?,
            "Journal centre from the bearing's centre; outside the circle it deforms the bearing.",
        ),
        (
            lines(&Chart { title: "Deformation", x: "time, s", y: "um", size: SQUARE }, &[deformation])?,
            "Negative values are a gap.",
        ),
    ]);
    Ok(())
}

/// Differences of the estimates, and the counters.
fn controller_section(page: &mut Page, estimator: &EstimatorSummary) {
    page.section("The controller").table(&EQUIVALENCE_HEADER, &equivalence_rows(estimator));
    page.note(
        "Difference from the bench: error of sensors, filter and networks together. Differences \
         from the described law and from the float networks at the estimated contact: what the filter has \
         learnt, and the error of the networks and of their quantisation. All are evaluated after the load \
         ramp.",
    );
    page.table(&["counted", "times"], &counted_rows(estimator));
    page.note("Counters at zero are omitted.");
}

/// Impacts that the controller recorded, beside the true contacts.
fn impacts_section(page: &mut Page, finished: &Finished) {
    page.section("Impacts that the controller recorded");
    let rows = recorded_rows(finished);
    if rows.is_empty() {
        page.note("None: the journal did not separate from the bearing, or not after the start.");
        return;
    }
    page.table(&TABLE_HEADER, &rows);
    page.note(
        "The first 30; estimated_impacts.csv contains all. An impact is a contact that begins after a \
         separation. A record settles after 50 ms in contact; true peaks are those up to that time, true \
         losses those of the complete contact.",
    );
}

/// Peaks with error bars, energy balance and contacts.
fn audit_sections(page: &mut Page, finished: &Finished) {
    page.section("Peaks").table(&PEAK_HEADER, &peak_rows(&finished.summary));
    page.note(
        "The error bar is numerical. It follows from runs at three tolerances, with networks at one, two \
         and four communication steps, and their observed order of convergence. It does not contain the \
         error of the networks, which is their difference from the law.",
    );
    page.section("Energy").table(&["term", "value"], &energy_rows(finished));
    page.note(
        "Residual: work of drive, load and gravity minus friction heat, damping loss, hold loss and change \
         of the stored energy. Each term follows from its own law. Only the hold loss, of a force that \
         is held over a communication step, is a difference.",
    );
    page.section("Contacts").table(&impact_header(finished), &impact_rows(finished));
    page.note(
        "The first 30. impacts.csv contains all, with angles, latched speeds, speed ratio and restitution.",
    );
}
