//! The report section about the limits of the model.

use bench::description::{PlantDescription, TransmissionBench};
use report::page::Page;

/// Assumptions of every run of the transmission bench with the shipped materials.
const ASSUMED: [&str; 2] = [
    "The moment of inertia and the steel of the shaft are assumptions: the paper states neither.",
    "Friction was measured at 100 to 240 kN and at most 6 deg/s; the bench works at 1 to 14 kN and about 100 \
     deg/s.",
];

/// Adds the section for a plant.
pub(crate) fn section(page: &mut Page, plant: &dyn PlantDescription) {
    page.section("What the model leaves out");
    let assumed: &[&str] = if plant.plant_name() == TransmissionBench::PLANT { &ASSUMED } else { &[] };
    page.list(&[plant.limits(), assumed].concat());
    page.text("Not a safety function.");
}
