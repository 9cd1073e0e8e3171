//! Text of a diagnosis for the terminal.

use super::sentences::{left_words, rejection_words, sentence};
use super::tables::{causes, gains, nuisances, push, push_findings};
use diagnosis::{Diagnosis, Verdict};
use std::fmt::Write as _;

/// Formats the verdict, findings, causes, errors and remarks.
pub(crate) fn text(diagnosis: &Diagnosis) -> String {
    let mut out = format!("verdict: {}\n{}\n", diagnosis.verdict.name(), sentence(diagnosis));
    push_findings(&mut out, &diagnosis.checks);
    for table in [causes(diagnosis), gains(diagnosis), nuisances(diagnosis)] {
        push(&mut out, &table);
    }
    let is_in_verdict = diagnosis.verdict == Verdict::Unknown;
    let is_place_in_verdict = is_in_verdict || diagnosis.verdict == Verdict::Partial;
    if let (Some(left), false) = (&diagnosis.signature, is_place_in_verdict) {
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
