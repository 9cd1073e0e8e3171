//! A diagnosis on the terminal.

use super::diagnose_tables::{Table, causes, checks, gains, nuisances};
use super::diagnose_words::{left_words, refused_words, sentence};
use diagnosis::{Diagnosis, Severity, Verdict};
use std::fmt::Write as _;

/// All of it.
pub(super) fn text(diagnosis: &Diagnosis) -> String {
    let mut out = format!("verdict: {}\n{}\n", diagnosis.verdict.name(), sentence(diagnosis));
    let graver = |row: &Vec<String>| row.first().is_some_and(|word| word != Severity::Note.name());
    let mut findings = checks(diagnosis);
    findings.rows.retain(graver);
    for table in [findings, causes(diagnosis), gains(diagnosis), nuisances(diagnosis)] {
        push(&mut out, &table);
    }
    let is_told = diagnosis.verdict == Verdict::Unknown;
    if let (Some(left), false) = (&diagnosis.signature, is_told) {
        let _ = write!(out, "\nleft over: {}\n", left_words(left));
    }
    if let (Some(refused), false) = (&diagnosis.refused, is_told) {
        let _ = write!(out, "\nrefused: {}\n", refused_words(refused));
    }
    for remark in &diagnosis.identifiability {
        let _ = write!(out, "\nnot told by these logs: {}\n", remark.words);
    }
    if let Some(next) = &diagnosis.next_experiment {
        let _ = write!(out, "\nnext: {next}\n");
    }
    if let Some(path) = &diagnosis.extended_bench {
        let _ = write!(out, "\nextended bench: {path}\n");
    }
    out
}

fn push(out: &mut String, table: &Table) {
    if table.rows.is_empty() {
        return;
    }
    let width = |i: usize| {
        let cells = table.rows.iter().filter_map(|row| row.get(i)).map(|cell| cell.chars().count());
        cells.chain(table.header.get(i).map(|cell| cell.len())).max().unwrap_or_default()
    };
    out.push('\n');
    let header: Vec<String> = table.header.iter().map(|cell| (*cell).to_owned()).collect();
    for row in std::iter::once(&header).chain(&table.rows) {
        for (i, cell) in row.iter().enumerate() {
            let _ = write!(out, "{cell:<width$}  ", width = width(i));
        }
        out.truncate(out.trim_end().len());
        out.push('\n');
    }
}
