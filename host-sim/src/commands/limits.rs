//! What the model leaves out, for every report.

use crate::page::Page;

/// What is left out, a sentence each.
const LEFT_OUT: [&str; 5] = [
    "Planar: no tilt of the shaft, no edge loading.",
    "Dry: no lubrication, no wear during a run, no heat.",
    "The levers and the shaft are rigid; the load cylinder has no friction of its own unless the description says so.",
    "The moment of inertia and the steel of the shaft are assumptions: the paper states neither.",
    "Friction was measured at 100 to 240 kN and at most 6 deg/s; the bench works at 1 to 14 kN and about 100 deg/s.",
];

/// Adds the section.
pub(super) fn section(page: &mut Page) {
    page.section("What the model leaves out");
    page.list(&LEFT_OUT);
    page.text("Not a safety function.");
}
