//! Report of `host-sim sweep clearance`, `sweep load` and `figures`: the paper's pictures and its
//! claims, as run and settled.
//!
//! The claims require both series, so both are run even if only one is shown.

use super::pictures::motion::PaperFigure;
use super::pictures::{causes, diagram, friction, motion};
use super::runs::{PaperRun, PaperRuns, Series};
use crate::cli::error::CliError;
use crate::cli::limits;
use crate::cli::output::{self, Files, Picture};
use crate::cli::progress;
use crate::reproduction::claims::cycles::{self, SettledRun};
use crate::reproduction::claims::facts::Facts;
use crate::reproduction::claims::gather::gather;
use crate::reproduction::claims::judged::{Judged, evaluate_all};
use crate::run::conditions::BEARINGS;
use crate::run::force::ForceSource;
use crate::run::summary::PerPeak;
use crate::sweep::options::SweepOptions;
use crate::sweep::owner;
use crate::sweep::table;
use bench::description::TransmissionBench;
use model_quant::report::paper;
use report::page::Page;
use report::text_table;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// Extent of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    /// One series and what its figures depend on.
    Series(Series),
    /// Every picture of the paper.
    Paper,
}

impl Content {
    fn series(self) -> Vec<Series> {
        match self {
            Self::Series(series) => vec![series],
            Self::Paper => vec![Series::Clearance, Series::Load],
        }
    }
}

/// Printed and stored result.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Outcome<'a> {
    sweep: &'static str,
    runs: Vec<&'a PaperRun>,
    claims: Vec<Judged>,
}

/// Everything that the page shows.
struct Results {
    runs: PaperRuns,
    settled: Vec<SettledRun>,
    facts: Facts,
}

/// Page under construction and its pictures as files.
struct Draft {
    page: Page,
    pictures: Vec<Picture>,
}

impl Draft {
    fn show(&mut self, pictures: Vec<Picture>) {
        output::show(&mut self.page, &pictures);
        self.pictures.extend(pictures);
    }

    fn show_wide(&mut self, pictures: Vec<Picture>) {
        for picture in &pictures {
            self.page.figure(&picture.drawing, &picture.caption);
        }
        self.pictures.extend(pictures);
    }

    fn figure(&mut self, figure: PaperFigure) {
        self.page.section(&figure.heading).text(&figure.text);
        self.show(figure.pictures);
    }
}

/// Runs the series and writes runs.csv, sweep.json, the pictures and report.html.
pub(crate) fn run(
    options: &SweepOptions,
    content: Content,
    folder: &Path,
    json: bool,
) -> Result<(), CliError> {
    let source = options.force.unwrap_or(ForceSource::QuantisedNet);
    let (base, step_s) = (options.base()?, options.step_s()?);
    let sweep = match content {
        Content::Series(Series::Clearance) => "clearance",
        Content::Series(Series::Load) => "load",
        Content::Paper => "figures",
    };
    output::check_folder(folder)?;
    owner::check(folder, sweep)?;
    let bar = progress::bar(2 * PaperRuns::COUNT + 1);
    bar.set_message(format!("runs with {}", source.name()));
    let runs = PaperRuns::execute(&base, source, step_s, options.threads, || bar.inc(1))?;
    bar.set_message("settled runs");
    let (settled, [_, settled_facts]) = cycles::gather(&base, options.threads, || bar.inc(1))?;
    bar.set_message("claims");
    let facts = gather(&base, &runs, options.threads)?;
    let claims = evaluate_all(&facts, &settled_facts);
    bar.finish_and_clear();

    let mut draft = Draft { page: Page::new("The paper's figures, run again"), pictures: Vec::new() };
    lead(&mut draft.page, &claims, source);
    claims_section(&mut draft.page, &claims);
    let results = Results { runs, settled, facts };
    if content == Content::Paper {
        laws_and_experiment(&mut draft, &base)?;
        networks(&mut draft, base.bearing.bearing_radius_m)?;
    }
    for series in content.series() {
        show_series(&mut draft, &results, series)?;
    }
    limits::section(&mut draft.page, &base);

    let series = content.series();
    let runs = series.iter().flat_map(|s| results.runs.series(*s)).collect();
    let outcome = Outcome { sweep, runs, claims };
    let mut files = Files::new(folder);
    files.add("runs.csv", &table::csv(&outcome.runs)?)?;
    let text = files.add_result("sweep.json", &outcome)?;
    files.add_pictures(&draft.pictures)?;
    files.add_page("report.html", draft.page)?;
    files.publish()?;
    if json {
        print_result!("{text}");
    } else {
        print(&outcome);
        print_line!("\nreport: {}", folder.join("report.html").display());
    }
    Ok(())
}

/// Figs. 2, 3, 6, 7 and 8.
fn laws_and_experiment(draft: &mut Draft, base: &TransmissionBench) -> Result<(), CliError> {
    draft.page.section("Figs. 2 and 3: forces in the joint");
    draft.page.text(
        "These are definitions and have no start. The bench uses the Stribeck law with exponent 1 and a \
         regularised sign.",
    );
    draft.show(vec![diagram::forces()]);
    draft.show(friction::laws(base)?);
    for (bearing, number) in BEARINGS.into_iter().zip([6, 7]) {
        draft.page.section(&format!("Fig. {number}: friction experiment, {}", bearing.name()));
        draft.page.text(
            "Records of the simulated rig in place of the paper's measurements, which are not published. \
             The torque changes its sign with the velocity. A record has no start to forget: after each \
             standstill of 2 s the torque breaks away and falls within .2 mm of sliding, in every cycle \
             alike.",
        );
        draft.show(friction::records(bearing, number)?);
    }
    draft.page.section("Fig. 8: data before and after cleaning");
    draft.page.text(
        "Outliers are removed, then a Gaussian-weighted average is applied. Look at the break-away: \
         smoothing rounds the steepest place.",
    );
    for bearing in BEARINGS {
        draft.show_wide(vec![paper::cleaning(bearing).map(picture).map_err(CliError::Work)?]);
    }
    Ok(())
}

/// Figs. 10 to 13.
fn networks(draft: &mut Draft, radius_m: f64) -> Result<(), CliError> {
    draft.page.section("Fig. 10: training of the networks");
    draft.page.text(
        "Errors of the shipped trainings, (a) Babbitt and (b) plastic, relative to the target's rms. \
         Validation follows training to the end. A training has no settled operation.",
    );
    for bearing in BEARINGS {
        let pictures = paper::training(bearing).map_err(CliError::Work)?;
        draft.show(pictures.into_iter().map(picture).collect());
    }
    draft.page.section("Fig. 11: predicted and measured friction, not drawn");
    draft.page.text(
        "This figure compares networks that were trained on the rig's records with these records. No such \
         networks are shipped: the shipped ones are trained on the bench's law up to 14 kN, and the rig has \
         100 to 240 kN. `model-quant train --friction rig --bearing babbitt --out rig` trains them in about \
         a minute, and `model-quant report --rig rig/babbitt.rig.json` draws the figure.",
    );
    let [maps, curves] = friction::characteristics(radius_m)?;
    draft.page.section("Fig. 12: friction over load and angular velocity");
    draft.page.text(
        "The paper's range, 0 to 240 kN and 0 to 6 deg/s, from the simulated rig; its friction is an \
         assumption in the shape of the paper's measurement. Every value is a median over a whole cycle, so \
         there is no start.",
    );
    draft.show_wide(maps);
    draft.page.section("Fig. 13: friction over angular velocity by load");
    draft.page.text(
        "Left: the rig at the paper's loads. Right: outputs of the shipped networks at the bench's loads, as \
         the paper's Figs. 12 and 13 are outputs of its networks. They contradict claims 12 and 13.",
    );
    draft.show(curves);
    Ok(())
}

fn picture(paper::PaperPicture { name, caption, drawing }: paper::PaperPicture) -> Picture {
    Picture { name, caption, drawing }
}

/// Figs. 16 to 18, or 19 and 20, and what they depend on.
fn show_series(draft: &mut Draft, results: &Results, series: Series) -> Result<(), CliError> {
    let Results { runs, settled, facts } = results;
    let (heading, text) = match series {
        Series::Clearance => (
            "Clearances .1 to 1 mm at +10 kN (Figs. 16-18)",
            "Radial clearance, which the paper calls maximum clearance. Peaks count from the end of the load \
             ramp, which the pictures shade.",
        ),
        Series::Load => (
            "Loads +10 to -10 kN at 1 mm (Figs. 19 and 20)",
            "Positive loads point along +Y. The paper's list does not contain -1 kN. At negative load the \
             largest force from rest lies just after the ramp, within the start.",
        ),
    };
    draft.page.section(heading).text(text);
    draft.page.table(&HEADER, &runs.series(series).into_iter().map(cells).collect::<Vec<_>>());
    let bars = PerPeak::largest_bars(runs.series(series).into_iter().map(|r| &r.figures));
    draft.page.note(&format!("Here {bars}. runs.csv has each."));
    for figure in motion::figures(runs, settled, series)? {
        draft.figure(figure);
    }
    draft.page.section(match series {
        Series::Clearance => "Effect of the clearance, and causes",
        Series::Load => "Effect of the load",
    });
    draft.show(match series {
        Series::Clearance => causes::over_clearance(runs, facts)?,
        Series::Load => causes::over_load(runs, facts)?,
    });
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

/// Counts the verdicts for one cycle from rest, and those that are another when settled.
fn counts(claims: &[Judged]) -> String {
    let count = |name: &str| claims.iter().filter(|c| c.claim.verdict.name() == name).count();
    let others = claims.iter().filter(|c| c.settled.as_ref().is_some_and(|s| s.verdict != c.claim.verdict));
    let others: Vec<String> = others.map(|c| c.claim.id.to_string()).collect();
    format!(
        "Of the paper's {} claims, as it ran the bench: {} hold, {} are assumed, {} partly, {} do not; \
         settled, the verdict is another for {}",
        claims.len(),
        count("holds"),
        count("assumed"),
        count("partly"),
        count("does not hold"),
        if others.is_empty() { "none".to_owned() } else { others.join(", ") }
    )
}

fn lead(page: &mut Page, claims: &[Judged], source: ForceSource) {
    page.lead(&format!("{}, on this model with the bearing force from {}.", counts(claims), source.name()));
    page.note(
        "As run: one cycle from rest, as in the paper, peaks after the load ramp. Settled: the last two of \
         five cycles, with the analytic law. `assumed`: the project's own friction law stands in for the \
         paper's unpublished measurements. Every verdict compares numbers with the threshold in its row; \
         `host-sim claims` varies what the paper does not state.",
    );
}

fn claims_section(page: &mut Page, claims: &[Judged]) {
    page.section("The paper's claims");
    let rows: Vec<Vec<String>> = claims
        .iter()
        .map(|c| {
            let settled = c.settled.as_ref().map_or("-", |s| s.verdict.name());
            let networks = c.networks.as_ref().map_or("-", |n| n.verdict.name());
            let mut why = c.claim.why.clone();
            for (what, further) in [("Settled", &c.settled), ("Networks", &c.networks)] {
                if let Some(further) = further {
                    why.push_str(&format!(" | {what}: {}", further.why));
                }
            }
            let claim = &c.claim;
            let verdict = claim.verdict.name();
            [&claim.id.to_string(), claim.claim, verdict, settled, networks, &why, claim.threshold]
                .map(str::to_owned)
                .to_vec()
        })
        .collect();
    let header = ["", "claim", "as run", "settled", "networks", "numbers and cause", "holds if"];
    page.table(&header, &rows);
}

fn print(outcome: &Outcome) {
    print_line!("{}", text_table(HEADER, outcome.runs.iter().map(|run| cells(run)), 1));
    print_line!("{}", PerPeak::largest_bars(outcome.runs.iter().map(|r| &r.figures)));
    print_line!("\n{}:", counts(&outcome.claims));
    for Judged { claim, settled, networks } in &outcome.claims {
        print_line!("{:>3} {:<13} {}\n{:17} {}", claim.id, claim.verdict.name(), claim.claim, "", claim.why);
        for (what, further) in [("settled", settled), ("networks", networks)] {
            if let Some(further) = further {
                print_line!("{:17} {what}: {}; {}", "", further.verdict.name(), further.why);
            }
        }
        print_line!("{:17} holds if: {}", "", claim.threshold);
    }
}
