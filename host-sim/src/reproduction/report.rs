//! Report of `host-sim sweep clearance`, `sweep load` and `figures`: the paper's Figs. 16-20 and
//! its claims.
//!
//! The claims require both series, so both are run even if only one is shown.

use super::pictures;
use super::runs::{PaperRun, PaperRuns, Series};
use crate::cli::error::CliError;
use crate::cli::limits;
use crate::cli::output::{self, Files, Picture};
use crate::cli::progress;
use crate::reproduction::claims::{Claim, evaluate, gather::gather};
use crate::run::force::ForceSource;
use crate::run::summary::ErrorBars;
use crate::sweep::options::SweepOptions;
use crate::sweep::owner;
use crate::sweep::table;
use report::page::Page;
use report::text_table;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// Printed and stored result.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Outcome<'a> {
    sweep: &'static str,
    runs: Vec<&'a PaperRun>,
    claims: Vec<Claim>,
}

/// Runs the series and writes runs.csv, sweep.json, the pictures and report.html.
pub(crate) fn run(
    options: &SweepOptions,
    series: &[Series],
    folder: &Path,
    json: bool,
) -> Result<(), CliError> {
    let source = options.force.unwrap_or(ForceSource::QuantisedNet);
    let (base, step_s) = (options.base()?, options.step_s()?);
    let sweep = match series {
        [Series::Clearance] => "clearance",
        [Series::Load] => "load",
        _ => "figures",
    };
    output::check_folder(folder)?;
    owner::check(folder, sweep)?;
    let bar = progress::bar(PaperRuns::COUNT + 1);
    bar.set_message(format!("runs with {}", source.name()));
    let runs = PaperRuns::execute(&base, source, step_s, options.threads, || bar.inc(1))?;
    bar.set_message("claims");
    let facts = gather(&base, &runs, options.threads)?;
    let claims = evaluate(&facts);
    bar.finish_and_clear();

    let mut page = Page::new("The paper's figures, run again");
    lead(&mut page, &claims, source);
    claims_section(&mut page, &claims);
    let mut all: Vec<Picture> = Vec::new();
    for &one in series {
        let (heading, text) = match one {
            Series::Clearance => (
                "Clearances .1 to 1 mm at +10 kN (Figs. 16-18)",
                "Radial clearance, which the paper calls maximum clearance. The curves begin after the load \
                 ramp.",
            ),
            Series::Load => (
                "Loads +10 to -10 kN at 1 mm (Figs. 19 and 20)",
                "Positive loads point along +Y. The paper's list does not contain -1 kN.",
            ),
        };
        page.section(heading).text(text);
        page.table(&HEADER, &runs.series(one).into_iter().map(cells).collect::<Vec<_>>());
        let bars = ErrorBars::largest(runs.series(one).into_iter().map(|r| &r.figures));
        page.note(&format!("Here {bars}. runs.csv has each."));
        let drawn = pictures::over_time(&runs, one)?;
        output::show(&mut page, &drawn);
        all.extend(drawn);
        let drawn = match one {
            Series::Clearance => pictures::over_clearance(&runs, &facts)?,
            Series::Load => pictures::over_load(&runs, &facts)?,
        };
        output::show(&mut page, &drawn);
        all.extend(drawn);
    }
    limits::section(&mut page, &base);

    let outcome = Outcome { sweep, runs: series.iter().flat_map(|s| runs.series(*s)).collect(), claims };
    let text = output::json(&outcome)?;
    let mut files = Files::new(folder);
    files.add("runs.csv", &table::csv(&outcome.runs)?)?;
    files.add("sweep.json", &format!("{text}\n"))?;
    files.add_pictures(&all)?;
    files.add("report.html", &page.render())?;
    files.publish()?;
    if json {
        print_result!("{text}");
    } else {
        print(&outcome);
        print_line!("\nreport: {}", folder.join("report.html").display());
    }
    Ok(())
}

const HEADER: [&str; 10] = [
    "bearing",
    "clearance, mm",
    "load, kN",
    "peak force, N",
    "peak Y, N",
    "peak Z, N",
    "peak torque, N m",
    "largest deformation, um",
    "oscillation, N rms",
    "swing, Hz",
];

fn cells(run: &PaperRun) -> Vec<String> {
    let f = &run.figures;
    vec![
        f.bearing.name().into(),
        format!("{:.2}", f.clearance_mm),
        format!("{:+.0}", f.load_kn),
        format!("{:.0}", f.peak_contact_force_n),
        format!("{:.0}", f.peak_force_y_n),
        format!("{:.0}", f.peak_force_z_n),
        format!("{:.1}", f.peak_friction_torque_nm),
        format!("{:.1}", f.max_deformation_m * 1e6),
        format!("{:.0}", f.oscillation_rms_n),
        run.swing.swing_hz.map_or_else(|| "none".into(), |hz| format!("{hz:.1}")),
    ]
}

fn counts(claims: &[Claim]) -> String {
    let count = |name: &str| claims.iter().filter(|c| c.verdict.name() == name).count();
    format!(
        "Of the paper's {} claims: {} hold, {} partly, {} do not",
        claims.len(),
        count("holds"),
        count("partly"),
        count("does not hold")
    )
}

fn lead(page: &mut Page, claims: &[Claim], source: ForceSource) {
    page.lead(&format!("{}, on this model with the bearing force from {}.", counts(claims), source.name()));
    page.note(
        "Peaks are evaluated after the load ramp. Every verdict compares the numbers of these runs with the \
         threshold in its row; another bench description gives other verdicts.",
    );
}

fn claims_section(page: &mut Page, claims: &[Claim]) {
    page.section("The paper's claims");
    let rows: Vec<Vec<String>> = claims
        .iter()
        .map(|c| {
            vec![c.id.to_string(), c.claim.into(), c.verdict.name().into(), c.why.clone(), c.threshold.into()]
        })
        .collect();
    page.table(&["", "claim", "verdict", "numbers and cause", "holds if"], &rows);
}

fn print(outcome: &Outcome) {
    print_line!("{}", text_table(HEADER, outcome.runs.iter().map(|run| cells(run)), 1));
    print_line!("{}", ErrorBars::largest(outcome.runs.iter().map(|r| &r.figures)));
    print_line!("\n{}:", counts(&outcome.claims));
    for c in &outcome.claims {
        print_line!("{:>3} {:<13} {}\n{:17} {}", c.id, c.verdict.name(), c.claim, "", c.why);
        print_line!("{:17} holds if: {}", "", c.threshold);
    }
}
