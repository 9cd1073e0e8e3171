//! What the model leaves out, for every report.

use crate::page::Page;
use bench::description::TransmissionBench;
use bench::limits::limits;

/// What holds for every run of this program with the shipped materials, a sentence each.
const ASSUMED: [&str; 2] = [
    "The moment of inertia and the steel of the shaft are assumptions: the paper states neither.",
    "Friction was measured at 100 to 240 kN and at most 6 deg/s; the bench works at 1 to 14 kN and about 100 deg/s.",
];

/// The plant that a description runs as.
pub(super) fn plant_of(bench: &TransmissionBench) -> &'static str {
    if bench.two_plane.is_some() { "two-plane" } else { "transmission-bench" }
}

/// Adds the section for a plant.
pub(super) fn section(page: &mut Page, plant: &str) {
    page.section("What the model leaves out");
    let assumed: &[&str] = if plant == "slider-crank" { &[] } else { &ASSUMED };
    page.list(&[limits(plant), assumed].concat());
    page.text("Not a safety function.");
}
