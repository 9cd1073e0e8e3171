//! Text of a diagnosis for the terminal.

use super::sentences::{left_words, rejection_words, sentence};
use super::tables::{Table, causes, checks, gains, nuisances};
use diagnosis::{Diagnosis, Severity, Verdict};
use report::text_table;
use std::fmt::Write as _;

/// Formats the verdict, findings, causes, errors and remarks.
pub(crate) fn text(diagnosis: &Diagnosis) -> String {
    let mut out = format!("verdict: {}\n{}\n", diagnosis.verdict.name(), sentence(diagnosis));
    let is_graver_than_note =
        |row: &Vec<String>| row.first().is_some_and(|word| word != Severity::Note.name());
    let mut findings = checks(diagnosis);
    findings.rows.retain(is_graver_than_note);
    let corrections = without_corrections(&mut findings);
    push(&mut out, &findings);
    if !corrections.is_empty() {
        let _ = write!(out, "\nlines of the description that correct it:\n{}\n", corrections.join("\n"));
    }
    for table in [causes(diagnosis), gains(diagnosis), nuisances(diagnosis)] {
        push(&mut out, &table);
    }
    let is_in_verdict = diagnosis.verdict == Verdict::Unknown;
    if let (Some(left), false) = (&diagnosis.signature, is_in_verdict) {
        let _ = write!(out, "\nremaining error: {}\n", left_words(left));
    }
    if let (Some(rejection), false) = (&diagnosis.rejection, is_in_verdict) {
        let _ = write!(out, "\nrefused: {}\n", rejection_words(rejection));
    }
    for remark in &diagnosis.identifiability {
        let _ = write!(out, "\nnot determined by these logs: {}\n", remark.words);
    }
    if let Some(next) = &diagnosis.next_experiment {
        let _ = write!(out, "\nnext: {next}\n");
    }
    if let Some(path) = &diagnosis.extended_bench {
        let _ = write!(out, "\nextended bench: {path}\n");
    }
    out
}

/// Takes the last column, lines of a description, out of the findings: a line that is wrapped
/// cannot be copied.
fn without_corrections(findings: &mut Table) -> Vec<String> {
    findings.header = findings.header.split_last().map_or(&[], |(_, header)| header);
    let lines = findings.rows.iter_mut().filter_map(Vec::pop);
    lines.filter(|line| line != "-").collect()
}

fn push(out: &mut String, table: &Table) {
    if table.rows.is_empty() {
        return;
    }
    let _ = write!(out, "\n{}\n", text_table(table.header, &table.rows, table.header.len()));
}
