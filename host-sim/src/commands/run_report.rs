//! The report of a run: the figures as a table, the forces over the cycle, the journal's orbit.

use super::run::Finished;
use super::{limits, run_tilt};
use crate::figure::{Chart, Series, Style, lines, map};
use crate::page::Page;
use crate::summary::{Differences, EstimatorSummary, PeakRow, Summary};
use bench::integrate::Impact;
use bench::transmission::Snapshot;

const WIDE: (u32, u32) = (1040, 360);
const SQUARE: (u32, u32) = (500, 500);

/// The figures in words: name, value with unit.
pub(super) fn rows(summary: &Summary) -> Vec<[String; 2]> {
    let row = |name: &str, value: String| [name.to_owned(), value];
    let figures = &summary.figures;
    let mut rows = vec![
        row(
            "bearing",
            format!("{}, {:.2} mm, {:+.1} kN", figures.bearing.name(), figures.clearance_mm, figures.load_kn),
        ),
        row("bearing force from", figures.force.name().into()),
        row("peak contact force", format!("{:.0} N", figures.peak_contact_force_n)),
        row("peak force along Y", format!("{:.0} N", figures.peak_force_y_n)),
        row("peak force along Z", format!("{:.0} N", figures.peak_force_z_n)),
        row("peak friction torque", format!("{:.1} N m", figures.peak_friction_torque_nm)),
        row("largest deformation", format!("{:.1} um", figures.max_deformation_m * 1e6)),
        row("oscillation, rms", format!("{:.0} N", figures.oscillation_rms_n)),
        row("periods in contact", figures.contacts.to_string()),
        row("energy residual", format!("{:.1e}", figures.energy_residual_rel)),
        row("outside the training range", format!("{:.2} %", 100.0 * figures.outside_training_share)),
        row("wall time per simulated second", format!("{:.3} s", summary.wall_s_per_simulated_s)),
    ];
    if let Some(tilt) = &summary.tilt {
        rows.push(row("largest tilt of the shaft", format!("{:.2} mrad", 1e3 * tilt.largest_tilt_rad)));
        rows.push(row("largest edge load over the mean", format!("{:.2}", tilt.largest_edge_ratio)));
    }
    if let Some(law) = &summary.against_law {
        rows.push(row(
            "peak contact force of the analytic law",
            format!("{:.0} N", law.peak_contact_force_n),
        ));
        rows.push(row("rms difference from the law, force", format!("{:.0} N", law.force_rms_difference_n)));
        rows.push(row(
            "rms difference from the law, journal",
            format!("{:.2} um", law.journal_rms_difference_m * 1e6),
        ));
    }
    if let Some(e) = &summary.estimator {
        rows.push(row("estimator", e.controller.into()));
        rows.push(row("estimator, rms error of the force", format!("{:.0} N", e.force_rms_error_n)));
        rows.push(row(
            "estimator, rms error of full scale",
            format!("{:.2} %", 100.0 * e.force_rms_error_n / e.force_full_scale_n.max(1e-9)),
        ));
        rows.push(row(
            "estimator, outside the training range",
            format!("{:.2} %", 100.0 * e.outside_training_share),
        ));
        rows.push(row("estimator, suspect sensors or timing", format!("{:.2} %", 100.0 * e.suspect_share)));
        rows.push(row("estimator, ticks", e.ticks.to_string()));
        rows.push(row("estimator, deadline misses", e.deadline_misses.to_string()));
        if let (Some(least), Some(mean), Some(most)) =
            (e.instructions_per_tick_min, e.instructions_per_tick_mean, e.instructions_per_tick_max)
        {
            rows.push(row("estimator, instructions a tick", format!("{least} / {mean:.0} / {most}")));
        }
        rows.push(row("exchanges per second", format!("{:.0}", e.exchanges_per_s)));
        if let Some(differences) = e.native_emulated_bit_differences {
            rows.push(row("estimates that differ, native and emulated", differences.to_string()));
        }
        if let Some(differences) = e.native_attached_bit_differences {
            rows.push(row("estimates that differ, native and attached", differences.to_string()));
        }
        if e.restarts > 0 {
            rows.push(row("restarts of the controller", e.restarts.to_string()));
        }
    }
    rows
}

const EQUIVALENCE_HEADER: [&str; 5] =
    ["estimates against", "force, rms, N", "force, most, N", "torque, rms, N m", "torque, most, N m"];

/// The estimates against everything that they can be held against.
fn equivalence_rows(e: &EstimatorSummary) -> Vec<Vec<String>> {
    let row = |name: &str, d: &Differences| {
        let figures = [d.force_rms_n, d.force_max_n, d.torque_rms_nm, d.torque_max_nm];
        std::iter::once(name.to_owned()).chain(figures.map(number)).collect()
    };
    vec![
        row("the bench", &e.against_truth),
        row("the analytic law, same signals", &e.against_law),
        row("the float networks, same signals", &e.against_float),
    ]
}

/// What controller and line counted, without what never happened.
fn counted_rows(e: &EstimatorSummary) -> Vec<Vec<String>> {
    let of = |counts: serde_json::Result<serde_json::Value>, prefix: &str| -> Vec<Vec<String>> {
        let mut rows = Vec::new();
        flatten(prefix, &counts.unwrap_or_default(), &mut rows);
        rows
    };
    [of(serde_json::to_value(e.counters), "controller"), of(serde_json::to_value(e.losses), "line")].concat()
}

fn flatten(name: &str, value: &serde_json::Value, rows: &mut Vec<Vec<String>>) {
    match value {
        serde_json::Value::Object(fields) => {
            fields.iter().for_each(|(field, value)| {
                flatten(&format!("{name}, {}", field.replace('_', " ")), value, rows)
            });
        }
        value if value.as_u64() != Some(0) => rows.push(vec![name.into(), value.to_string()]),
        _ => {}
    }
}

/// Contacts that are listed one by one.
const LISTED: usize = 30;

/// A number in five figures, whatever its size.
fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-2..1e6).contains(&size) {
        let digits = (4.0 - size.max(1e-9).log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.3e}")
    }
}

const IMPACT_HEADER: [&str; 7] = [
    "onset, s",
    "crank angle, deg",
    "approach speed, mm/s",
    "peak force, N",
    "deformation, um",
    "duration, ms",
    "energy lost, J",
];

/// The slice of a contact is worth a column only where there are several.
fn impact_header(finished: &Finished) -> Vec<&'static str> {
    let slice = (!finished.forced.tilting.is_empty()).then_some("slice");
    slice.into_iter().chain(IMPACT_HEADER).collect()
}

fn impact_rows(finished: &Finished) -> Vec<Vec<String>> {
    let slices = !finished.forced.tilting.is_empty();
    let row = |i: &Impact| {
        let slice = slices.then(|| (i.contact + 1).to_string());
        let cells = [
            format!("{:.6}", i.onset_s),
            format!("{:.3}", i.angles.crank_rad.to_degrees()),
            format!("{:.3}", 1e3 * i.approach_speed_m_s),
            format!("{:.1}", i.peak_force_n),
            format!("{:.2}", 1e6 * i.max_deformation_m),
            i.duration_s().map_or_else(|| "to the end".into(), |d| format!("{:.3}", 1e3 * d)),
            number(i.energy_lost_j),
        ];
        slice.into_iter().chain(cells).collect()
    };
    finished.forced.run.impacts.iter().take(LISTED).map(row).collect()
}

fn energy_rows(finished: &Finished) -> Vec<Vec<String>> {
    finished
        .forced
        .run
        .energy
        .terms()
        .iter()
        .map(|(name, value)| vec![(*name).to_owned(), number(*value)])
        .collect()
}

fn peak_rows(summary: &Summary) -> Vec<Vec<String>> {
    let row = |source: &str, p: &PeakRow| {
        let bar = p.error_bar.map_or_else(|| "unknown".into(), |bar| format!("{bar:.1e}"));
        vec![source.into(), p.name.to_owned(), number(p.value), bar, format!("{:.4}", p.time_s)]
    };
    let own = summary.peaks.iter().map(|p| row(summary.figures.force.name(), p));
    own.chain(summary.law_peaks.iter().map(|p| row("law", p))).collect()
}

/// Energy balance, contacts and peaks with their bars on the terminal.
pub(super) fn print_audit(finished: &Finished) {
    let table = |title: &str, header: &[&str], rows: Vec<Vec<String>>| {
        let line = |cells: &[String]| cells.iter().map(|c| format!("{c:>21}")).collect::<Vec<_>>().join(" ");
        say!("\n{title}");
        say!("{}", line(&header.iter().map(|h| (*h).to_owned()).collect::<Vec<_>>()));
        rows.iter().for_each(|row| say!("{}", line(row)));
    };
    if let Some(estimator) = &finished.summary.estimator {
        table("estimates", &EQUIVALENCE_HEADER, equivalence_rows(estimator));
        table("counted", &["what", "count"], counted_rows(estimator));
    }
    table("energy", &["term", "value"], energy_rows(finished));
    table("contacts (all in impacts.csv)", &impact_header(finished), impact_rows(finished));
    table("peaks", &PEAK_HEADER, peak_rows(&finished.summary));
}

const PEAK_HEADER: [&str; 5] = ["force from", "peak", "value", "error bar", "at, s"];

/// The page. An error is a drawing failure, in words.
pub(super) fn page(finished: &Finished) -> Result<Page, String> {
    let summary = &finished.summary;
    let figures = &summary.figures;
    let mut page = Page::new("Transmission bench: one run");
    page.lead(&format!(
        "{}, radial clearance {:.2} mm, load {:+.1} kN, bearing force from {}: peak contact force {:.0} N, \
         oscillation {:.0} N rms.",
        figures.bearing.name(),
        figures.clearance_mm,
        figures.load_kn,
        figures.force.name(),
        figures.peak_contact_force_n,
        figures.oscillation_rms_n,
    ));
    page.note(
        "Peaks and errors leave out the start: they count from the end of the load's ramp. Forces are those of the \
         bearing on the journal, normal and friction together.",
    );
    let table: Vec<Vec<String>> = rows(summary).into_iter().map(Vec::from).collect();
    page.section("Figures").table(&["quantity", "value"], &table);
    page.section("Forces over the cycle");
    let samples = &finished.forced.run.samples;
    let over_time = |name: &str, samples: &[Snapshot], read: fn(&Snapshot) -> f64| {
        Series::new(name, samples.iter().map(|s| s.time_s), samples.iter().map(read))
    };
    let law = finished.law.as_ref().map(|l| l.run.samples.as_slice());
    // The law below, so that a difference of the networks shows.
    let against_law = |read: fn(&Snapshot) -> f64| -> Vec<Series> {
        let law = law.map(|law| over_time("analytic law", law, read).styled(Style::Wide));
        law.into_iter().chain([over_time(figures.force.name(), samples, read)]).collect()
    };
    page.figure(
        &lines(
            &Chart { title: "Contact force", x: "time, s", y: "N", size: WIDE },
            &against_law(|s| s.forces.normal_n),
        )?,
        "Normal force of the contact.",
    );
    if let Some(tracked) = &finished.tracked {
        let estimate = Series::new(
            "estimator",
            tracked.estimates.iter().map(|e| f64::from(e.time_us) * 1e-6),
            tracked.estimates.iter().map(|e| f64::from(e.normal_force_n)),
        );
        let truth = over_time("bench", samples, |s| s.forces.normal_n);
        page.figure(
            &lines(
                &Chart { title: "Estimated contact force", x: "time, s", y: "N", size: WIDE },
                &[estimate, truth],
            )?,
            "What the controller made of noisy position and angle sensors at 10 kHz.",
        );
    }
    let components = [over_time("Y", samples, |s| s.force_y_n), over_time("Z", samples, |s| s.force_z_n)];
    page.figure(
        &lines(&Chart { title: "Force on the journal", x: "time, s", y: "N", size: WIDE }, &components)?,
        "Components along Y (transverse, towards the drive) and Z (upwards).",
    );
    page.figure(
        &lines(
            &Chart { title: "Friction torque", x: "time, s", y: "N m", size: WIDE },
            &against_law(|s| s.friction_torque_nm),
        )?,
        "Torque of the bearing on the shaft, negative while it turns forward.",
    );
    page.section("The journal in its clearance");
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
            "Negative is a gap.",
        ),
    ]);
    if !finished.forced.tilting.is_empty() {
        run_tilt::section(&mut page, &finished.bench, &finished.forced.tilting)?;
    }
    if let Some(estimator) = &summary.estimator {
        page.section("The controller").table(&EQUIVALENCE_HEADER, &equivalence_rows(estimator));
        page.note(
            "Against the bench: sensors, conditioning and networks together. Against the law and the float networks on the very \
             signals that the controller had: what the networks and their quantisation cost. From the end of the load's ramp on.",
        );
        page.table(&["counted", "times"], &counted_rows(estimator));
        page.note("What never happened is left out: deadline overruns, refused frames, losses on either side of the line.");
    }
    page.section("Peaks").table(&PEAK_HEADER, &peak_rows(summary));
    page.note(
        "The error bar is the numerical one: the distance between runs at two tolerances, with networks from one at twice \
         the communication step, which holds the step's error but not the networks' own: that is their difference from the law.",
    );
    page.section("Energy").table(&["term", "value"], &energy_rows(finished));
    page.note(
        "Work of drive, load and gravity less friction heat, damping loss and change of the stored energy is the residual.",
    );
    page.section("Contacts").table(&impact_header(finished), &impact_rows(finished));
    page.note("The first 30; impacts.csv has all, with angles, latched speeds and restitution.");
    limits::section(&mut page, limits::plant_of(&finished.bench));
    Ok(page)
}
