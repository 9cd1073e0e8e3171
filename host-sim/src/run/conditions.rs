//! Bearings, clearances and loads of the paper, and bench B under other conditions.

use bench::BearingMaterial;
use bench::description::TransmissionBench;

/// Clearances of Figs. 17 and 18, mm.
pub(crate) const CLEARANCES_MM: [f64; 4] = [0.1, 0.25, 0.5, 1.0];
/// Load of Figs. 17 and 18, kN.
pub(crate) const CLEARANCE_LOAD_KN: f64 = 10.0;
/// Loads of Figs. 19 and 20, and -1 kN, which the paper's list leaves out.
pub(crate) const LOADS_KN: [f64; 6] = [10.0, 5.0, 1.0, -1.0, -5.0, -10.0];
/// Clearance of Figs. 19 and 20, mm.
pub(crate) const LOAD_CLEARANCE_MM: f64 = 1.0;
/// Both bearings, in the order of the paper.
pub const BEARINGS: [BearingMaterial; 2] = [BearingMaterial::Babbitt, BearingMaterial::Plastic];

/// Returns the base bench with another bearing, clearance and load.
pub fn variant(
    base: &TransmissionBench,
    bearing: BearingMaterial,
    clearance_mm: f64,
    load_kn: f64,
) -> TransmissionBench {
    let mut bench = base.clone();
    bench.set_material(bearing);
    bench.set_radial_clearance(clearance_mm * 1e-3);
    bench.load.force_n = load_kn * 1e3;
    bench
}
