//! The result of a campaign: one row a claim.

use super::parameter_box::Draw;
use super::shares::{Effect, Share, deciding, effects};
use super::verdicts::{CLAIMS, row};
use super::work::Record;
use crate::reproduction::claims::Verdict;
use schemars::JsonSchema;
use serde::Serialize;

/// Short names of the claims for maps and charts.
pub(crate) const SHORT: [&str; CLAIMS] = [
    "reversal",
    "clearance",
    "Y over Z",
    "friction",
    "plastic",
    "frequency",
    "torque",
    "load +Y",
    "load -Y",
    "sign",
    "joint",
    "Babbitt law",
    "plastic law",
    "law order",
    "training",
];

/// Result of a claim in one operation over all draws.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize)]
pub struct Mapped {
    /// Draws in which it holds.
    pub holds: Share,
    /// Draws in which it holds in part.
    pub partly: usize,
    /// Effects of the parameters on the share, in the order of the box.
    pub effects: Vec<Effect>,
}

impl Mapped {
    /// The parameter with the largest effect, as text.
    pub(crate) fn decided_by(&self) -> String {
        let Some(effect) = deciding(&self.effects) else {
            return "none".into();
        };
        let points = 100.0 * effect.difference;
        let [first, second] = &effect.groups;
        if second == "upper half" {
            return format!("{} {points:+.0}", effect.parameter);
        }
        let (best, worst) = if points >= 0.0 { (second, first) } else { (first, second) };
        format!("{}: {best} over {worst} {:+.0}", effect.parameter, points.abs())
    }
}

/// A claim over all draws: from rest and settled. None where the operation has no verdict.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize)]
pub struct MappedClaim {
    /// Number, from 1.
    pub id: u8,
    /// From rest and settled.
    pub operations: [Option<Mapped>; 2],
}

/// Pairs of draw and hit for a claim (from 0) in an operation (0 from rest, 1 settled).
pub fn hits(seed: u64, records: &[Record], claim: usize, operation: usize) -> Vec<(Draw, bool)> {
    let hits = verdicts(records, claim, operation);
    hits.map(|(index, verdict)| (Draw::new(seed, index), verdict.is_affirmed())).collect()
}

fn verdicts(
    records: &[Record],
    claim: usize,
    operation: usize,
) -> impl Iterator<Item = (usize, Verdict)> + '_ {
    records.iter().filter_map(move |record| {
        let letters = record.outcome.as_ref().ok()?;
        let text = if operation == 0 { &letters.from_rest } else { &letters.settled };
        Some((record.index, row(text).get(claim).copied().flatten()?))
    })
}

/// Computes the rows of claims 1 to 14; claim 15 is about a training.
pub fn mapped(seed: u64, records: &[Record]) -> Vec<MappedClaim> {
    let one = |claim: usize, operation: usize| {
        let draws = hits(seed, records, claim, operation);
        let partly = verdicts(records, claim, operation).filter(|(_, v)| *v == Verdict::Partly).count();
        let holds = Share::new(draws.iter().filter(|(_, holds)| *holds).count(), draws.len());
        (!draws.is_empty()).then(|| Mapped { holds, partly, effects: effects(&draws) })
    };
    (0..CLAIMS - 1)
        .map(|claim| MappedClaim {
            id: u8::try_from(claim + 1).unwrap_or(u8::MAX),
            operations: [0, 1].map(|operation| one(claim, operation)),
        })
        .collect()
}

/// Heading of the cells of [`cells`].
pub const HEADER: [&str; 9] = [
    "",
    "claim",
    "as run",
    "settled",
    "networks",
    "from rest, %",
    "settled, %",
    "decides from rest",
    "decides settled",
];

/// Verdicts on a claim at the bench's own parameters.
#[derive(Clone, Copy, Debug, JsonSchema, Serialize)]
pub struct Nominal {
    /// One cycle from rest.
    pub as_run: Option<Verdict>,
    /// Settled.
    pub settled: Option<Verdict>,
    /// Outputs of the shipped networks.
    pub networks: Option<Verdict>,
}

/// Cells of a claim's row.
pub fn cells(row: &MappedClaim, nominal: &Nominal) -> Vec<String> {
    let name = |verdict: Option<Verdict>| verdict.map_or("-", Verdict::name).to_owned();
    let share = |mapped: &Option<Mapped>| {
        mapped.as_ref().map_or_else(
            || "-".into(),
            |m| {
                let percent = 100.0 * m.holds.value();
                let (low, high) = (100.0 * m.holds.low, 100.0 * m.holds.high);
                format!("{percent:.1} ({low:.1} to {high:.1})")
            },
        )
    };
    let decided = |mapped: &Option<Mapped>| mapped.as_ref().map_or_else(|| "-".into(), Mapped::decided_by);
    let [from_rest, settled] = &row.operations;
    let short = SHORT.get(usize::from(row.id).saturating_sub(1)).copied().unwrap_or_default();
    vec![
        row.id.to_string(),
        short.into(),
        name(nominal.as_run),
        name(nominal.settled),
        name(nominal.networks),
        share(from_rest),
        share(settled),
        decided(from_rest),
        decided(settled),
    ]
}

/// Formats rows of cells as a Markdown table.
pub(crate) fn markdown(rows: &[Vec<String>]) -> String {
    let line = |cells: &[&str]| format!("| {} |\n", cells.join(" | "));
    let mut text = line(&HEADER);
    text.push_str(&line(&HEADER.map(|_| "---")));
    for row in rows {
        text.push_str(&line(&row.iter().map(String::as_str).collect::<Vec<_>>()));
    }
    text
}
