//! Report of a diagnosis: first the verdict, last the data, parameters and noise.

use super::pictures::{measured_and_simulated, places, ranking, residuals, shares};
use super::sentences::{left_words, placed, rejection_words, sentence};
use super::tables::{Table, calibrated, causes, findings, gains, noise, nuisances, separation};
use diagnosis::{Diagnosis, Verdict};
use report::page::Page;

/// Builds the page. An error describes a failure of drawing.
pub(crate) fn page(diagnosis: &Diagnosis) -> Result<Page, String> {
    let mut page = Page::new(&format!("Diagnosis: {}", diagnosis.verdict.name()));
    page.lead(&sentence(diagnosis));
    add_corrections_note(&mut page, diagnosis);
    page.section("Measured and simulated");
    measured_and_simulated(&mut page, diagnosis)?;
    add_causes(&mut page, diagnosis);
    add_errors(&mut page, diagnosis)?;
    add_ranking(&mut page, diagnosis);
    add_remaining_error(&mut page, diagnosis)?;
    add_next_experiment(&mut page, diagnosis);
    add_data(&mut page, diagnosis);
    add_parameters(&mut page, diagnosis);
    add_noise(&mut page, diagnosis);
    Ok(page)
}

/// Refers to the findings that changed the data before the fit.
fn add_corrections_note(page: &mut Page, diagnosis: &Diagnosis) {
    let corrected = diagnosis.checks.iter().filter(|f| f.applied.is_some()).count();
    if corrected > 0 {
        page.text(&format!(
            "The data were changed before the fit because of {corrected} finding{}; see \"Checks of the \
             data\" below.",
            if corrected == 1 { "" } else { "s" }
        ));
    }
}

/// Causes, effects that fit equally well, and posterior probabilities.
fn add_causes(page: &mut Page, diagnosis: &Diagnosis) {
    section(page, "Causes", &causes(diagnosis));
    if diagnosis.verdict == Verdict::Ambiguous {
        for other in &diagnosis.ambiguous_with {
            page.text(&format!(
                "Equally possible: {}, with a probability of {:.1} %; its signature and that of the cause \
                 have a correlation of {:.3}.",
                placed(&other.effect, other.channel, &other.of),
                100.0 * other.probability,
                other.correlation
            ));
        }
    }
    page.figure(
        &shares(diagnosis).into(),
        "Posterior probabilities of all fitted combinations, of no fault, and of a cause outside the \
         catalogue of effects.",
    );
}

/// Errors before and after, and their distribution.
fn add_errors(page: &mut Page, diagnosis: &Diagnosis) -> Result<(), String> {
    section(page, "Gain", &gains(diagnosis));
    page.note(
        "Root mean square of measured minus simulated on held-out samples, in the channel's unit. Before: \
         with the calibrated nominal bench; a number out of tolerance has its described value. After: with \
         the extended bench. Explained: share of the power above the noise.",
    );
    if !diagnosis.places.is_empty() {
        page.section("Distribution of the error");
        places(page, diagnosis)?;
    }
    Ok(())
}

/// Evidence of every effect alone.
fn add_ranking(page: &mut Page, diagnosis: &Diagnosis) {
    if !diagnosis.ranking.is_empty() {
        page.section("Ranking").figure(
            &ranking(diagnosis).into(),
            "Decrease of chi-square if one effect alone is added to the calibrated nominal bench and \
             refitted together with all uncertain parameters; logarithmic scale. The line is the threshold \
             for a cause. Pale: excluded on the first cycle; the figure is that of the first cycle.",
        );
    }
}

/// Remaining error, findings that were not counted, and parameters that are not determined.
fn add_remaining_error(page: &mut Page, diagnosis: &Diagnosis) -> Result<(), String> {
    page.section("Remaining error");
    match &diagnosis.signature {
        Some(left) => page.text(&left_words(left)),
        None => page.text("The remaining error contains no repeatable part."),
    };
    if let Some(rejection) = &diagnosis.rejection {
        page.text(&rejection_words(rejection));
    }
    residuals(page, diagnosis)?;
    if !diagnosis.identifiability.is_empty() {
        page.section("Not determined by these logs");
        let words: Vec<&str> = diagnosis.identifiability.iter().map(|i| i.words.as_str()).collect();
        page.list(&words);
    }
    Ok(())
}

/// The proposed experiment, if there is one.
fn add_next_experiment(page: &mut Page, diagnosis: &Diagnosis) {
    let Some(next) = &diagnosis.next_experiment else { return };
    page.section("Next experiment").text(next);
    if let Some(experiment) = &diagnosis.experiment {
        for recording in experiment.recordings.iter().filter(|r| !r.changes.is_empty()) {
            page.text(&format!("Change in the description: {}", recording.changes.join("; ")));
        }
    }
    let separated = separation(diagnosis);
    page.table(separated.header, &separated.rows);
}

/// Findings about the logs, and the use of their samples.
fn add_data(page: &mut Page, diagnosis: &Diagnosis) {
    page.section("Checks of the data");
    let found = findings(&diagnosis.checks);
    if found.rows.is_empty() {
        page.text("No findings: the logs were used unchanged.");
    } else {
        page.table(found.header, &found.rows);
    }
    page.text(&samples(diagnosis));
}

/// Calibrated parameters, and nuisance parameters of each log.
fn add_parameters(page: &mut Page, diagnosis: &Diagnosis) {
    section(page, "Calibrated parameters", &calibrated(diagnosis));
    section(page, "Per-log nuisance parameters", &nuisances(diagnosis));
    if !diagnosis.nuisances.is_empty() {
        page.note(
            "Declared under [nuisances]. They are no effects: they are estimated for each log separately, \
             together with all other parameters. Those of a held-out log are estimated from its first \
             cycle, which is then excluded from the comparison.",
        );
    }
}

/// Noise that errors are compared with.
fn add_noise(page: &mut Page, diagnosis: &Diagnosis) {
    section(page, "Noise", &noise(diagnosis));
    for finding in diagnosis.noise.iter().filter_map(|n| n.finding.as_deref()) {
        page.text(finding);
    }
}

fn section(page: &mut Page, title: &str, table: &Table) {
    if !table.rows.is_empty() {
        page.section(title).table(table.header, &table.rows);
    }
}

/// Describes the use of the samples.
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
        "{} log{}: {fitted} samples were fitted, {held_out} held out; the start transient is excluded.",
        logs.len(),
        if logs.len() == 1 { "" } else { "s" }
    )
}
