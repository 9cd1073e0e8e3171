//! The page of a training report.

use super::ReportError;
use super::companding::Comparison;
use super::facts::BearingFacts;
use super::pictures::{self, Picture};
use super::rig::{GOAL_R2, RigFacts};
use super::rig_pictures;
use super::tables::{error_rows, mode_rows, recipe_rows, rig_rows};
use crate::claims::Claim;
use crate::goals::Goal;
use crate::layers::LAYER_ROWS;
use crate::verify::{TEST_ROWS, Verdict};
use report::page::Page;
use serde::Serialize;

/// What a report shows.
#[derive(Clone, Debug, Serialize)]
pub struct Contents {
    /// Networks of the bearings.
    pub networks: Vec<BearingFacts>,
    /// Networks of the rigs.
    pub rigs: Vec<RigFacts>,
    /// Comparisons of the collision network's targets.
    pub companding: Vec<Comparison>,
    /// Claims 12 to 15.
    pub claims: Vec<Claim>,
}

/// The page and its pictures.
#[derive(Clone, Debug)]
pub struct Report {
    /// The page.
    pub page: Page,
    /// The pictures on it.
    pub pictures: Vec<Picture>,
}

fn word(met: bool) -> String {
    if met { "met" } else { "not met" }.to_owned()
}

/// Every goal of every network: cells.
pub fn goal_rows(contents: &Contents) -> Vec<Vec<String>> {
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
        let figure = "R^2 of the torque, rig's test groups against the truth without noise".to_owned();
        let start = [facts.bearing.to_owned(), "friction, rig".to_owned(), figure];
        start.into_iter().chain([format!("{r2:.6}"), format!(">= {GOAL_R2}"), word(facts.met)]).collect()
    };
    let goals = verdicts.flat_map(|v| v.goals.iter().map(move |goal| row(v, goal)));
    goals.chain(contents.rigs.iter().map(rig)).collect()
}

/// What people read first.
pub fn lead(contents: &Contents) -> String {
    let claims = &contents.claims;
    let verdicts = contents.networks.iter().flat_map(|facts| &facts.verdicts);
    let met = verdicts.flat_map(|v| &v.goals).map(|g| g.met).chain(contents.rigs.iter().map(|rig| rig.met));
    let met: Vec<bool> = met.collect();
    let of = |name: &str| claims.iter().filter(|c| c.verdict.name() == name).count();
    format!(
        "{} of {} goals met. Of the paper's claims {}: {} borne out, {} in part, {} not.",
        met.iter().filter(|met| **met).count(),
        met.len(),
        claims.iter().map(|c| c.id.to_string()).collect::<Vec<_>>().join(", "),
        of("holds"),
        of("partly"),
        of("does not hold")
    )
}

/// Draws the pictures and writes the page.
///
/// # Errors
///
/// A drawing failure.
pub fn report(contents: &Contents) -> Result<Report, ReportError> {
    let Contents { networks: all, rigs, companding, claims } = contents;
    let mut page = Page::new("Training report");
    let mut drawn = Vec::new();
    page.lead(&lead(contents));
    page.table(&["bearing", "network", "figure", "found", "goal", "verdict"], &goal_rows(contents));
    page.note(
        "Truth is the analytic law: of the test rows, which no training saw, and of bench runs with clearances, loads and \
         periods that nothing was chosen on. The rig's truth is its own. The networks of the bench run as the controller runs them, in whole numbers.",
    );
    let mut show = |page: &mut Page, pictures: Vec<Picture>| {
        let pairs: Vec<(String, &str)> =
            pictures.iter().map(|p| (p.svg.clone(), p.caption.as_str())).collect();
        page.figures(&pairs);
        drawn.extend(pictures);
    };
    page.section("Training (Fig. 10)");
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
    page.table(&header, &recipe_rows(all));
    if all.iter().all(|facts| facts.history.is_none()) {
        page.note(
            "No history of the epochs was given: `model-quant train` writes it beside the checkpoint, --history names it.",
        );
    }
    for history in all.iter().filter_map(|facts| facts.history.as_ref()) {
        show(&mut page, pictures::epochs(history)?);
    }
    page.section("What the collision network learns");
    page.text(
        "The same network, rows, seed and epochs for each target: mean absolute errors of the normal force in N by band of the \
         law's force, and the largest force without contact before any gate. The shipped networks learn the last target.",
    );
    for comparison in companding {
        page.text(&comparison.title);
        let header: Vec<&str> = comparison.header.iter().map(String::as_str).collect();
        page.table(&header, &comparison.rows);
    }
    if companding.is_empty() {
        page.note(
            "No comparison was given: `cargo run --release -p model-quant --example companding BEARING > FILE` makes one, \
             --companding FILE names it.",
        );
    }
    page.section("Prediction against experiment (Fig. 11)");
    page.text(
        "Friction networks trained on twelve groups of the simulated rig's noisy records, behind a collision network that \
         knows the rig's loads, on the four test groups that no training saw. Truth is what the rig's sensors would show \
         without noise, resolution and outliers.",
    );
    if rigs.is_empty() {
        page.note(
            "No networks of the rig were given: `model-quant train --friction rig --bearing BEARING --out DIR` makes them in \
             about a minute, --rig DIR/BEARING.rig.json names them.",
        );
    } else {
        let header = [
            "bearing",
            "test group",
            "samples",
            "R^2, truth",
            "MAE, N m",
            "largest, N m",
            "R^2, cleaned",
            "MAE, N m",
            "largest, N m",
        ];
        page.table(&header, &rig_rows(rigs));
        page.note("Without a load the torque is little but the sensor's drift: R^2 says nothing there.");
    }
    for rig in rigs {
        show(&mut page, rig_pictures::groups(rig)?);
    }
    page.section("Prediction of the law");
    page.text(
        "Forces of the quantised networks over those of the law; friction is that of the whole chain. These networks know \
         the bench's law, not the rig's records.",
    );
    for facts in all {
        show(&mut page, pictures::predictions(facts)?);
    }
    page.section("Friction torque over speed and load (Figs. 12 and 13)");
    page.text(
        "The chain of both networks at the bench's loads and speeds. The rig's 100 to 240 kN and 6 deg/s lie beyond what \
         these networks were trained on.",
    );
    for facts in all {
        show(&mut page, pictures::torque(facts)?);
    }
    page.section("Errors");
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
    page.table(&header, &error_rows(all));
    for facts in all {
        show(&mut page, pictures::bands(facts.bearing, &facts.verdicts)?);
    }
    page.section("What quantisation costs");
    page.text(&format!(
        "Mean and largest difference between image and float networks over {TEST_ROWS} test rows, by widths of weights and \
         activations. w8a16 is what ships."
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
        "One step at a time in whole numbers, everything else in floats, over {LAYER_ROWS} rows:"
    ));
    page.table(&["bearing", "network", "in whole numbers", "mean change, N"], &layers);
    page.section("The paper's claims");
    let claims: Vec<Vec<String>> = (claims.iter())
        .map(|c| {
            let cells = [c.id.to_string(), c.claim.to_owned(), c.verdict.name().to_owned()];
            cells.into_iter().chain([c.threshold.to_owned(), c.why.clone()]).collect()
        })
        .collect();
    page.table(&["claim", "the paper says", "verdict", "threshold", "why"], &claims);
    page.section("What this does not say");
    page.list(&[
        "How the networks do in the bench's loop and behind noisy sensors: `host-sim accuracy`.",
        "Anything about lubricated contact: laws and rig are dry.",
        "Anything about the real bearings: the paper's measurements are not published, the rig's friction stands in for \
         them.",
    ]);
    Ok(Report { page, pictures: drawn })
}
