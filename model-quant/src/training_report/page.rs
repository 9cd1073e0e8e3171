//! The page of a training report.

use super::ReportError;
use super::facts::BearingFacts;
use super::pictures::{self, Picture};
use crate::claims::Claim;
use crate::goals::Goal;
use crate::layers::LAYER_ROWS;
use crate::recipe::TrainingSet;
use crate::verify::{TEST_ROWS, Verdict};
use report::page::Page;

/// The page and its pictures.
#[derive(Clone, Debug)]
pub struct Report {
    /// The page.
    pub page: Page,
    /// The pictures on it.
    pub pictures: Vec<Picture>,
}

/// A number in three figures.
fn figures(value: f64) -> String {
    let digits = if value == 0.0 { 0 } else { (2 - value.abs().log10().floor() as i32).clamp(0, 6) };
    format!("{value:.*}", digits as usize)
}

/// Every goal of every network: cells.
pub fn goal_rows(all: &[BearingFacts]) -> Vec<Vec<String>> {
    let verdicts = all.iter().flat_map(|facts| &facts.verdicts);
    let row = |verdict: &Verdict, goal: &Goal| {
        let digits = if goal.figure.starts_with("R^2") { 6 } else { 4 };
        vec![
            verdict.bearing.to_owned(),
            verdict.network.to_owned(),
            goal.figure.to_owned(),
            format!("{:.digits$}", goal.value),
            format!("{} {}", goal.relation, goal.limit),
            if goal.met { "met" } else { "not met" }.to_owned(),
        ]
    };
    verdicts.flat_map(|v| v.goals.iter().map(move |goal| row(v, goal))).collect()
}

/// What people read first.
pub fn lead(all: &[BearingFacts], claims: &[Claim]) -> String {
    let goals = || all.iter().flat_map(|facts| &facts.verdicts).flat_map(|v| &v.goals);
    let of = |name: &str| claims.iter().filter(|c| c.verdict.name() == name).count();
    format!(
        "{} of {} goals met. Of the paper's claims {}: {} borne out, {} in part, {} not.",
        goals().filter(|g| g.met).count(),
        goals().count(),
        claims.iter().map(|c| c.id.to_string()).collect::<Vec<_>>().join(", "),
        of("holds"),
        of("partly"),
        of("does not hold")
    )
}

fn error_rows(all: &[BearingFacts]) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for verdict in all.iter().flat_map(|facts| &facts.verdicts) {
        let torque = |force_n: f64| {
            if verdict.network == "friction" {
                figures(force_n * crate::errors::FRICTION_RADIUS_M)
            } else {
                "-".into()
            }
        };
        rows.push(vec![
            verdict.bearing.to_owned(),
            verdict.network.to_owned(),
            format!("test rows, {}", verdict.rows),
            format!("{:.6}", verdict.r2_quantised),
            format!("{:.6}", verdict.r2_float),
            figures(verdict.mae_n),
            torque(verdict.mae_n),
            format!("{:.3}", 100.0 * verdict.mae_share_of_p99),
            figures(verdict.largest_n),
        ]);
        if let Some(held_out) = &verdict.held_out {
            let (image, float) = (&held_out.image, &held_out.float);
            rows.push(vec![
                verdict.bearing.to_owned(),
                verdict.network.to_owned(),
                format!("held-out bench runs, {}", held_out.runs),
                format!("{:.6}", image.r2),
                format!("{:.6}", float.r2),
                figures(image.mae_n),
                torque(image.mae_n),
                format!("{:.3}", 100.0 * image.mae_share_of_p99),
                figures(image.largest_n),
            ]);
        }
    }
    rows
}

fn mode_rows(all: &[BearingFacts]) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for facts in all {
        for mode in &facts.modes {
            let [normal, friction] = mode.mae_quantisation_n;
            let [largest_normal, largest_friction] = mode.largest_quantisation_n;
            let [r2, _] = mode.r2_quantised;
            rows.push(vec![
                facts.bearing.to_owned(),
                mode.mode.name().to_owned(),
                mode.bytes.to_string(),
                figures(normal),
                figures(largest_normal),
                figures(friction),
                figures(largest_friction),
                format!("{r2:.6}"),
            ]);
        }
    }
    rows
}

fn recipe_rows(all: &[BearingFacts]) -> Vec<Vec<String>> {
    all.iter()
        .map(|facts| {
            let recipe = &facts.recipe;
            vec![
                facts.bearing.to_owned(),
                format!("{:?}", recipe.range).to_lowercase(),
                recipe.seed.to_string(),
                match recipe.set {
                    TrainingSet::Drawn => recipe.rows.to_string(),
                    TrainingSet::Full => "full set".to_owned(),
                },
                recipe.validation_rows.to_string(),
                recipe.epochs.to_string(),
                recipe.grid_epochs.to_string(),
                recipe.batch.to_string(),
                recipe.instruction_set.name().to_owned(),
                facts.training_id.clone(),
            ]
        })
        .collect()
}

/// Draws the pictures and writes the page.
///
/// # Errors
///
/// A drawing failure.
pub fn report(all: &[BearingFacts], claims: &[Claim]) -> Result<Report, ReportError> {
    let mut page = Page::new("Training report");
    let mut drawn = Vec::new();
    page.lead(&lead(all, claims));
    page.table(&["bearing", "network", "figure", "found", "goal", "verdict"], &goal_rows(all));
    page.note(
        "Truth is the analytic law: of the test rows, which no training saw, and of bench runs with clearances, loads and \
         periods that nothing was chosen on. The networks run as the controller runs them, in whole numbers.",
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
    page.section("Prediction (in the place of Fig. 11)");
    page.text(
        "Forces of the quantised networks over those of the law; friction is that of the whole chain. The paper's Fig. 11 is \
         against experiment: these networks know the bench's law, not the friction rig's records.",
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
