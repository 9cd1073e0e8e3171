//! The report of a diagnosis: what a bench engineer needs first comes first; everything that was done to the data comes last.

use super::diagnose_pictures::{measured_and_simulated, places, ranking, residuals, shares};
use super::diagnose_tables::{Table, calibrated, causes, checks, gains, noise, nuisances, separation};
use super::diagnose_words::{channelled, left_words, refused_words, sentence};
use crate::page::Page;
use diagnosis::{Diagnosis, Verdict};

/// The page. An error is a drawing failure, in words.
pub(super) fn page(diagnosis: &Diagnosis) -> Result<Page, String> {
    let mut page = Page::new(&format!("Diagnosis: {}", diagnosis.verdict.name()));
    page.lead(&sentence(diagnosis));
    let wrong = diagnosis.checks.iter().filter(|f| f.done.is_some()).count();
    if wrong > 0 {
        page.text(&format!(
            "Something was done to the data before: {wrong} finding{} below, under \"What was done to the data\".",
            if wrong == 1 { "" } else { "s" }
        ));
    }
    page.section("Measured and simulated");
    measured_and_simulated(&mut page, diagnosis)?;
    section(&mut page, "Causes", &causes(diagnosis));
    if diagnosis.verdict == Verdict::Ambiguous {
        for other in &diagnosis.ambiguous_with {
            page.text(&format!(
                "As well: {}, with a share of {:.1} %; its signature and that of the cause have a correlation of {:.3}.",
                channelled(&other.effect, other.channel),
                100.0 * other.probability,
                other.correlation
            ));
        }
    }
    page.figure(
        &shares(diagnosis),
        "What is likely: posterior shares of all that was fitted, of nothing being wrong, and of a cause that no effect explains.",
    );
    section(&mut page, "Gain", &gains(diagnosis));
    page.note(
        "Root mean squares of measured less simulated, in the channel's unit, on samples that were not fitted: before with \
         the calibrated nominal bench, after with the extended bench. Explained is the share of the power above the noise.",
    );
    if !diagnosis.places.is_empty() {
        page.section("Where the error sits");
        places(&mut page, diagnosis)?;
    }
    if !diagnosis.ranking.is_empty() {
        page.section("Ranking").figure(
            &ranking(diagnosis),
            "Fall of chi-square when an effect alone joins the calibrated nominal bench, refitted with everything that is uncertain, on a \
             logarithmic scale. The line is what a cause has to pass. Pale: out of the race on the first cycle already, figure from there.",
        );
    }
    page.section("What remains");
    match &diagnosis.signature {
        Some(left) => page.text(&left_words(left)),
        None => page.text("Nothing that repeats is left in the error."),
    };
    if let Some(refused) = &diagnosis.refused {
        page.text(&refused_words(refused));
    }
    residuals(&mut page, diagnosis)?;
    if !diagnosis.identifiability.is_empty() {
        page.section("What these logs do not tell");
        let words: Vec<&str> = diagnosis.identifiability.iter().map(|i| i.words.as_str()).collect();
        page.list(&words);
    }
    if let Some(next) = &diagnosis.next_experiment {
        page.section("Next experiment").text(next);
        if let Some(experiment) = &diagnosis.experiment {
            for recording in experiment.recordings.iter().filter(|r| !r.changes.is_empty()) {
                page.text(&format!("Change in the description: {}", recording.changes.join("; ")));
            }
        }
        let apart = separation(diagnosis);
        page.table(apart.header, &apart.rows);
    }
    page.section("What was done to the data");
    let found = checks(diagnosis);
    if found.rows.is_empty() {
        page.text("The logs were taken as they are.");
    } else {
        page.table(found.header, &found.rows);
    }
    page.text(&samples(diagnosis));
    section(&mut page, "Calibrated parameters", &calibrated(diagnosis));
    section(&mut page, "What is each session's own", &nuisances(diagnosis));
    if !diagnosis.nuisances.is_empty() {
        page.note(
            "Declared under [nuisances] and estimated for each log alone, together with everything else: no effect. Of a log that is \
             held out they come from its first cycle, which is then not compared.",
        );
    }
    section(&mut page, "Noise", &noise(diagnosis));
    for finding in diagnosis.noise.iter().filter_map(|n| n.finding.as_deref()) {
        page.text(finding);
    }
    Ok(page)
}

fn section(page: &mut Page, title: &str, table: &Table) {
    if !table.rows.is_empty() {
        page.section(title).table(table.header, &table.rows);
    }
}

/// What the samples were used for.
fn samples(diagnosis: &Diagnosis) -> String {
    let mut logs: Vec<&str> = diagnosis.series.iter().map(|s| s.source.as_str()).collect();
    logs.dedup();
    let (mut fitted, mut held_out) = (0, 0);
    for log in &logs {
        if let Some(series) = diagnosis.series.iter().find(|s| s.source == *log) {
            held_out += series.held_out.iter().filter(|held| **held).count();
            fitted += series.held_out.iter().filter(|held| !**held).count();
        }
    }
    format!(
        "{} log{}: {fitted} samples were fitted, {held_out} held out; the start transient is left out.",
        logs.len(),
        if logs.len() == 1 { "" } else { "s" }
    )
}
