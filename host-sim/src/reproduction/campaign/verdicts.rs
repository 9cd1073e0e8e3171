//! Verdicts of a draw: the paper's eighteen runs, each judged from rest and settled.

use super::parameter_box::Draw;
use crate::cli::error::CliError;
use crate::reproduction::claims::cycles::{self, CycleFacts, Detail, with_cycles};
use crate::reproduction::claims::{Claim, Verdict, evaluate_motion};
use crate::reproduction::runs::cases;
use crate::run::conditions::variant;
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use model_quant::report::claims::{friction, torque};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Number of claims.
pub(crate) const CLAIMS: usize = 15;

/// Verdicts on all claims in one operation; none where the operation has none.
pub type Row = [Option<Verdict>; CLAIMS];

/// Verdicts of a draw, from rest and settled, each claim a letter: `h` holds, `a` assumed, `p`
/// partly, `n` does not hold, `-` none.
#[derive(Clone, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
pub struct Letters {
    /// One cycle from rest.
    pub from_rest: String,
    /// Settled operation.
    pub settled: String,
}

const LETTERS: [(char, Option<Verdict>); 5] = [
    ('h', Some(Verdict::Holds)),
    ('a', Some(Verdict::Assumed)),
    ('p', Some(Verdict::Partly)),
    ('n', Some(Verdict::DoesNotHold)),
    ('-', None),
];

/// Formats verdicts as letters.
pub fn letters(row: &Row) -> String {
    let letter = |verdict: &Option<Verdict>| LETTERS.iter().find(|(_, v)| v == verdict).map_or('-', |l| l.0);
    row.iter().map(letter).collect()
}

/// Reads verdicts from letters; unknown ones count as none.
pub fn row(letters: &str) -> Row {
    let mut row = [None; CLAIMS];
    for (slot, letter) in row.iter_mut().zip(letters.chars()) {
        *slot = LETTERS.iter().find(|(l, _)| *l == letter).and_then(|(_, verdict)| *verdict);
    }
    row
}

/// Judges a bench that a draw changes, or the bench itself without one.
///
/// # Errors
///
/// A run cannot be integrated, or leaves the range of its stiffness law.
pub fn evaluate_draw(
    base: &TransmissionBench,
    draw: Option<&Draw>,
    slider_crank_ratios: [f64; 2],
) -> Result<Letters, CliError> {
    let runs: Vec<CycleFacts> = cases()
        .into_iter()
        .map(|(bearing, clearance_mm, load_kn)| {
            let bench = vary(variant(base, bearing, clearance_mm, load_kn), draw)?.resolved();
            cycles::measure(&bench, Detail::Verdicts).map_err(|e| {
                CliError::Work(format!("{}, {clearance_mm} mm, {load_kn} kN: {e}", bearing.name()))
            })
        })
        .collect::<Result<_, _>>()?;
    let [from_rest, settled] = cycles::assemble(&runs, slider_crank_ratios);
    let mut rows = [from_rest, settled].map(|facts| filled(evaluate_motion(&facts)));
    let law = evaluate_law(base, draw)?;
    let [from_rest, settled] = &mut rows;
    from_rest.iter_mut().zip(law).for_each(|(slot, verdict)| *slot = slot.or(verdict));
    Ok(Letters { from_rest: letters(from_rest), settled: letters(settled) })
}

/// Applies a draw to a bench and sets the number of cycles.
fn vary(mut bench: TransmissionBench, draw: Option<&Draw>) -> Result<TransmissionBench, CliError> {
    if let Some(draw) = draw {
        draw.apply(&mut bench)?;
    }
    Ok(with_cycles(bench))
}

/// Claims 12 to 14 of the bench's own friction law, at the rig's speeds and the bench's loads.
pub(crate) fn evaluate_law(base: &TransmissionBench, draw: Option<&Draw>) -> Result<Row, CliError> {
    let bench = |material| {
        let mut bench = base.clone();
        bench.set_material(material);
        vary(bench, draw)
    };
    let (babbitt, plastic) = (bench(BearingMaterial::Babbitt)?, bench(BearingMaterial::Plastic)?);
    let law = torque::from_law(|material, load_n, speed_m_s| {
        let bench = if material == BearingMaterial::Babbitt { &babbitt } else { &plastic };
        // The force opposes the sliding.
        let force_n = bench.friction.level * bench.friction_law().force_n(load_n, speed_m_s);
        force_n.abs() * bench.bearing.bearing_radius_m
    });
    Ok(filled(friction::assess_curves(&law, "")))
}

fn filled(claims: Vec<Claim>) -> Row {
    let mut row = [None; CLAIMS];
    for claim in claims {
        if let Some(slot) = row.get_mut(usize::from(claim.id).saturating_sub(1)) {
            *slot = Some(claim.verdict);
        }
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_and_verdicts_are_the_same_thing() {
        let text = "hapn-hapn-hapn-";
        assert_eq!(letters(&row(text)), text);
        assert_eq!(row("h")[0], Some(Verdict::Holds));
        assert_eq!(row("h")[1], None);
    }

    #[test]
    fn the_bench_law_of_the_default_rises_at_first_and_orders_the_bearings() {
        let base = TransmissionBench::open("bench-b").unwrap();
        let law = evaluate_law(&base, None).unwrap();
        assert_eq!(letters(&law), "-----------nnh-");
        // A sharper sign lets Babbitt's torque fall, and leaves plastic level up to 16 deg/s.
        let mut sharp = Draw::new(1, 0);
        sharp.values[8] = 2e-4;
        assert_eq!(letters(&evaluate_law(&base, Some(&sharp)).unwrap()), "-----------hnh-");
    }
}
