//! Pictures of the paper, and the causes of what its claims describe.
//!
//! * `motion`: Figs. 16 to 20 from the bench's runs, from rest and settled.
//! * `friction`: Figs. 3, 6, 7, 12 and 13 from the friction laws and the rigs.
//! * `diagram`: Fig. 2.
//! * `causes`: figures of the runs over clearance, load, modulus and speed.
//!
//! Figs. 8 and 10 are drawn by [`model_quant::report::paper`].

pub(super) mod causes;
pub(super) mod diagram;
pub(super) mod friction;
pub(super) mod motion;

use super::runs::{PaperRun, Series};
use report::figure::Chart;

/// Size of a chart that is next to another.
const HALF: (u32, u32) = (512, 340);

/// Legend text of a run.
fn label(series: Series, run: &PaperRun) -> String {
    label_of(series, run.figures.clearance_mm, run.figures.load_kn)
}

fn label_of(series: Series, clearance_mm: f64, load_kn: f64) -> String {
    match series {
        Series::Clearance => format!("{clearance_mm} mm"),
        Series::Load => format!("{load_kn:+} kN"),
    }
}

fn chart<'a>(title: &'a str, x: &'a str, y: &'a str) -> Chart<'a> {
    Chart { title, x, y, size: HALF }
}
