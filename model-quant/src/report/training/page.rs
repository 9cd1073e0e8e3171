//! Page of the training report.

use super::ReportError;
use super::companding::Comparison;
use super::facts::BearingFacts;
use super::pictures::{self, Picture};
use super::rig::RigFacts;
use super::rig_pictures;
use super::tables::{error_rows, mode_rows, recipe_rows, rig_rows};
use crate::evaluate::goals::FRICTION_R2;
use crate::evaluate::goals::Goal;
use crate::evaluate::layers::LAYER_ROWS;
use crate::evaluate::test_set::TEST_ROWS;
use crate::evaluate::verdict::Verdict;
use crate::report::claims::Claim;
use report::figure::Drawing;
use report::page::Page;
use serde::Serialize;

/// Content of the report.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Contents {
    /// Figures of the bench's networks, by bearing.
    pub networks: Vec<BearingFacts>,
    /// Figures of the rig's networks.
    pub rigs: Vec<RigFacts>,
    /// Comparisons of the collision network's targets.
    pub companding: Vec<Comparison>,
    /// Claims 12 to 15.
    pub claims: Vec<Claim>,
}

/// Page with its pictures.
#[derive(Clone, Debug)]
pub(crate) struct Report {
    /// The page.
    pub page: Page,
    /// Pictures on the page.
    pub pictures: Vec<Picture>,
}

fn word(met: bool) -> String {
    if met { "met" } else { "not met" }.to_owned()
}

/// Table rows with every goal of every network.
pub(crate) fn goal_rows(contents: &Contents) -> Vec<Vec<String>> {
    let verdicts = contents.networks.iter().flat_map(|facts| &facts.verdicts);
    let row = |verdict: &Verdict, goal: &Goal| {
        let digits = if goal.figure.starts_with("R^2") { 6 } else { 4 };
        vec![
            verdict.bearing.to_owned(),
            verdict.network.to_owned(),
            goal.figure.to_owned(),
            format!("{:.digits$}", goal.value),
            format!("{} {}", goal.relation, goal.limit),
            word(goal.met),
        ]
    };
    let rig = |facts: &RigFacts| {
        let r2 = facts.errors.first().map_or(f64::NAN, |all| all.truth.r2);
        let figure = "R^2 of the torque, rig's test groups against the torque without noise".to_owned();
        let start = [facts.bearing.to_owned(), "friction, rig".to_owned(), figure];
        start.into_iter().chain([format!("{r2:.6}"), format!(">= {FRICTION_R2}"), word(facts.met)]).collect()
    };
    let goals = verdicts.flat_map(|v| v.goals.iter().map(move |goal| row(v, goal)));
    goals.chain(contents.rigs.iter().map(rig)).collect()
}

/// Summary sentence.
pub(crate) fn lead(contents: &Contents) -> String {
    let claims = &contents.claims;
    let verdicts = contents.networks.iter().flat_map(|facts| &facts.verdicts);
    let met = verdicts.flat_map(|v| &v.goals).map(|g| g.met).chain(contents.rigs.iter().map(|rig| rig.met));
    let met: Vec<bool> = met.collect();
    let count_of = |name: &str| claims.iter().filter(|c| c.verdict.name() == name).count();
    format!(
        "{} of {} goals met. Of the paper's claims {}: {} hold, {} are assumed, {} hold in part, {} do \
         not.",
        met.iter().filter(|met| **met).count(),
        met.len(),
        claims.iter().map(|c| c.id.to_string()).collect::<Vec<_>>().join(", "),
        count_of("holds"),
        count_of("assumed"),
        count_of("partly"),
        count_of("does not hold")
    )
}

/// Page under construction with the pictures drawn up to now.
struct Draft {
    page: Page,
    pictures: Vec<Picture>,
}

impl Draft {
    fn show(&mut self, pictures: Vec<Picture>) {
        let pairs: Vec<(Drawing, &str)> =
            pictures.iter().map(|p| (p.drawing.clone(), p.caption.as_str())).collect();
        self.page.figures(&pairs);
        self.pictures.extend(pictures);
    }
}

/// Draws the pictures and writes the page.
///
/// # Errors
///
/// The drawing library fails.
pub(crate) fn report(contents: &Contents) -> Result<Report, ReportError> {
    let mut draft = Draft { page: Page::new("Training report"), pictures: Vec::new() };
    write_goals(&mut draft, contents);
    write_training(&mut draft, &contents.networks)?;
    write_targets(&mut draft, &contents.companding);
    write_rigs(&mut draft, &contents.rigs)?;
    write_predictions(&mut draft, &contents.networks)?;
    write_errors(&mut draft, &contents.networks)?;
    write_quantisation(&mut draft, &contents.networks);
    write_claims(&mut draft, &contents.claims);
    write_limits(&mut draft);
    Ok(Report { page: draft.page, pictures: draft.pictures })
}

fn write_goals(draft: &mut Draft, contents: &Contents) {
    let page = &mut draft.page;
    page.lead(&lead(contents));
    page.table(&["bearing", "network", "figure", "found", "goal", "verdict"], &goal_rows(contents));
    page.note(
        "Reference is the analytic law, on test rows and on held-out bench runs. The rig's reference is its \
         simulated friction. The networks of the bench run in fixed point as on the controller.",
    );
}

fn write_training(draft: &mut Draft, all: &[BearingFacts]) -> Result<(), ReportError> {
    draft.page.section("Training (Fig. 10)");
    let header = [
        "bearing",
        "rows of",
        "seed",
        "rows",
        "validation",
        "epochs",
        "on the grid",
        "batch",
        "arithmetic",
        "training id",
    ];
    draft.page.table(&header, &recipe_rows(all));
    if all.iter().all(|facts| facts.history.is_none()) {
        draft.page.note(
            "No training history was given: `model-quant train` writes it next to the checkpoint, \
             and --history includes it.",
        );
    }
    for history in all.iter().filter_map(|facts| facts.history.as_ref()) {
        draft.show(pictures::epochs(history)?);
    }
    Ok(())
}

fn write_targets(draft: &mut Draft, companding: &[Comparison]) {
    let page = &mut draft.page;
    page.section("Targets of the collision network");
    page.text(
        "Network, rows, seed and epochs are the same for each target. The table has mean absolute errors of \
         the normal force in N by band of the law's force, and the largest force without contact before it \
         is set to 0. The shipped networks learn the last target.",
    );
    for comparison in companding {
        page.text(&comparison.title);
        let header: Vec<&str> = comparison.header.iter().map(String::as_str).collect();
        page.table(&header, &comparison.rows);
    }
    if companding.is_empty() {
        page.note(
            "No comparison was given: `cargo run --release -p model-quant --example companding \
             BEARING > FILE` makes one, and --companding FILE includes it.",
        );
    }
}

fn write_rigs(draft: &mut Draft, rigs: &[RigFacts]) -> Result<(), ReportError> {
    draft.page.section("Prediction against experiment (Fig. 11)");
    draft.page.text(
        "Friction networks were trained on twelve groups of the simulated rig's noisy records, with the \
         force of a collision network for the rig's loads, and evaluated on the four test groups. \
         Reference is the sensor value without noise, resolution and outliers.",
    );
    if rigs.is_empty() {
        draft.page.note(
            "No networks of the rig were given: `model-quant train --friction rig --bearing BEARING \
             --out DIR` makes them in about a minute, and --rig DIR/BEARING.rig.json includes them.",
        );
    } else {
        let header = [
            "bearing",
            "test group",
            "samples",
            "R^2, noise-free",
            "MAE, N m",
            "largest, N m",
            "R^2, cleaned",
            "MAE, N m",
            "largest, N m",
        ];
        draft.page.table(&header, &rig_rows(rigs));
        draft.page.note("Without load the torque is mostly sensor drift, so R^2 has no meaning there.");
    }
    for rig in rigs {
        draft.show(rig_pictures::groups(rig)?);
    }
    Ok(())
}

fn write_predictions(draft: &mut Draft, all: &[BearingFacts]) -> Result<(), ReportError> {
    draft.page.section("Prediction of the law");
    draft.page.text(
        "Forces of the quantised networks over those of the law; friction is that of both networks \
         together. These networks were trained on the bench's law, not on the rig's records.",
    );
    for facts in all {
        draft.show(pictures::predictions(facts)?);
    }
    draft.page.section("Friction torque over speed and load (Figs. 12 and 13)");
    draft.page.text(
        "Both networks together at the bench's loads and speeds. The rig's 100 to 240 kN and 6 deg/s lie \
         beyond the training range of these networks.",
    );
    for facts in all {
        draft.show(pictures::torque(facts)?);
    }
    Ok(())
}

fn write_errors(draft: &mut Draft, all: &[BearingFacts]) -> Result<(), ReportError> {
    draft.page.section("Errors");
    let header = [
        "bearing",
        "network",
        "rows",
        "R^2, image",
        "R^2, float",
        "mean abs. error, N",
        "N m",
        "% of 99th percentile",
        "largest, N",
    ];
    draft.page.table(&header, &error_rows(all));
    for facts in all {
        draft.show(pictures::bands(facts.bearing, &facts.verdicts)?);
    }
    Ok(())
}

fn write_quantisation(draft: &mut Draft, all: &[BearingFacts]) {
    let page = &mut draft.page;
    page.section("Quantisation error");
    page.text(&format!(
        "Mean and largest difference between image and float networks over {TEST_ROWS} test rows, \
         by widths of weights and activations. The shipped images have w8a16."
    ));
    let header = [
        "bearing",
        "mode",
        "bytes",
        "normal force, mean N",
        "largest N",
        "friction, mean N",
        "largest N",
        "R^2, normal force",
    ];
    page.table(&header, &mode_rows(all));
    let layers: Vec<Vec<String>> = (all.iter())
        .flat_map(|facts| facts.layers.iter().map(|l| (facts.bearing, l)))
        .map(|(bearing, l)| {
            vec![bearing.to_owned(), l.network.to_owned(), l.quantised.clone(), format!("{:.2}", l.mae_n)]
        })
        .collect();
    page.text(&format!(
        "One step at a time in fixed point, everything else in floats, over {LAYER_ROWS} rows:"
    ));
    page.table(&["bearing", "network", "in fixed point", "mean change, N"], &layers);
}

fn write_claims(draft: &mut Draft, claims: &[Claim]) {
    draft.page.section("The paper's claims");
    let rows: Vec<Vec<String>> = (claims.iter())
        .map(|c| {
            let cells = [c.id.to_string(), c.claim.to_owned(), c.verdict.name().to_owned()];
            cells.into_iter().chain([c.threshold.to_owned(), c.why.clone()]).collect()
        })
        .collect();
    draft.page.table(&["claim", "the paper says", "verdict", "threshold", "why"], &rows);
}

fn write_limits(draft: &mut Draft) {
    draft.page.section("Not in this report");
    draft.page.list(&[
        "Accuracy in the bench's closed loop and with noisy sensors: `host-sim accuracy`.",
        "Lubricated contact: laws and rig are dry.",
        "Real bearings: the paper's measurements are not published, and the rig's friction is an assumption.",
    ]);
}
