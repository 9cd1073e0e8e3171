//! Maps of the claims over the parameters, and shares over the parameter that decides.

use super::parameter_box::{BOX, PARAMETERS, Values};
use super::shares::{deciding, over_range};
use super::table::{MappedClaim, SHORT, hits};
use super::work::Record;
use crate::cli::error::CliError;
use crate::cli::output::Picture;
use report::figure::{Chart, Series, Style, lines_log_x};
use report::heat::{self, Heat, Scale};

/// Difference of two shares, in points, at which a cell has the strongest colour.
const LARGE_POINTS: f64 = 40.0;
/// Bands of a parameter's range in a chart.
const BANDS: usize = 8;
const MAP: (u32, u32) = (760, 420);
const CHART: (u32, u32) = (512, 300);

/// Operations by the order of results: file name, title.
const OPERATIONS: [(&str, &str); 2] = [("from-rest", "one cycle from rest"), ("settled", "settled")];

fn short(id: u8) -> &'static str {
    SHORT.get(usize::from(id).saturating_sub(1)).copied().unwrap_or_default()
}

/// Draws one map for each operation: claims by parameters.
pub(super) fn maps(claims: &[MappedClaim]) -> Result<Vec<Picture>, CliError> {
    let mut pictures = Vec::new();
    for (operation, (file, what)) in OPERATIONS.into_iter().enumerate() {
        let rows: Vec<(String, Vec<Option<f64>>)> = claims
            .iter()
            .filter_map(|claim| {
                let mapped = claim.operations.get(operation)?.as_ref()?;
                let cell = |e: &super::shares::Effect| e.is_significant().then_some(100.0 * e.difference);
                let values = mapped.effects.iter().map(cell).collect();
                Some((format!("{} {}", claim.id, short(claim.id)), values))
            })
            .collect();
        let title = format!("Change of the share of draws in which a claim holds, points, {what}");
        let height = MAP.1 * (rows.len() as u32 + 3) / 16;
        let (names, values) = rows.into_iter().unzip();
        let heat = Heat {
            title: &title,
            x: "parameter: upper half of its range less lower half",
            y: "claim",
            columns: BOX.iter().map(|p| p.name.to_owned()).collect(),
            rows: names,
            values,
            scale: Scale::Sign(LARGE_POINTS),
            decimals: 0,
            size: (MAP.0, height),
        };
        let drawing = heat::draw(&heat).map_err(CliError::Work)?;
        let caption = "Orange: the claim holds more often with large values; blue: with small values. The \
                       stronger the colour, the larger the difference. Empty: the interval over all \
                       parameters contains 0. Damping: reference speed less latched speed. Stiffness: the \
                       law with the largest share less that with the smallest.";
        pictures.push(Picture { name: format!("claims-map-{file}"), caption: caption.into(), drawing });
    }
    Ok(pictures)
}

/// Draws the share of every claim over the range parameter that decides it, in both operations.
pub(super) fn over_deciding(
    (seed, records): (u64, &[Record]),
    claims: &[MappedClaim],
) -> Result<Vec<Picture>, CliError> {
    let mut pictures = Vec::new();
    for claim in claims {
        let Some(number) = deciding_range(claim) else { continue };
        let Some(parameter) = BOX.get(number) else { continue };
        let series: Vec<Series> = OPERATIONS
            .into_iter()
            .enumerate()
            .filter(|(operation, _)| claim.operations.get(*operation).is_some_and(Option::is_some))
            .map(|(operation, (_, what))| {
                let draws = hits(seed, records, usize::from(claim.id).saturating_sub(1), operation);
                let points = over_range(&draws, number, BANDS);
                let points = points.into_iter().map(|(at, share)| (at, 100.0 * share.value())).collect();
                Series::through(what, points).styled(Style::Both)
            })
            .collect();
        let title = format!("Claim {}, {}, over {}", claim.id, short(claim.id), parameter.name);
        let chart =
            Chart { title: &title, x: parameter.description, y: "draws in which it holds, %", size: CHART };
        let name = format!("claim-{}-over-{}", claim.id, parameter.name.replace(' ', "-"));
        let caption = "Eight bands of the range, all other parameters drawn at random.";
        pictures.push(Picture::draw(lines_log_x, &name, &chart, &series, caption)?);
    }
    Ok(pictures)
}

/// Number of the range parameter with the largest effect on a claim in any operation.
fn deciding_range(claim: &MappedClaim) -> Option<usize> {
    let effects = claim.operations.iter().flatten().filter_map(|mapped| {
        let ranges: Vec<_> = mapped
            .effects
            .iter()
            .zip(BOX)
            .filter(|(_, parameter)| matches!(parameter.values, Values::Between(..)))
            .map(|(effect, _)| effect.clone())
            .collect();
        deciding(&ranges).cloned()
    });
    let largest = effects.max_by(|a, b| a.difference.abs().total_cmp(&b.difference.abs()))?;
    (0..PARAMETERS).find(|number| BOX.get(*number).is_some_and(|p| p.name == largest.parameter))
}
