//! Published known answers of the models.
//!
//! The plants' known answers come from the bench. This file adds the restitution that every
//! dissipation factor produces, and bench B's tables of peaks and oscillations by clearance and
//! load.

use crate::cli::error::CliError;
use crate::run::conditions::{CLEARANCE_LOAD_KN, CLEARANCES_MM, LOAD_CLEARANCE_MM, LOADS_KN, variant};
use crate::run::force::{self, DEFAULT_STEP_S, ForceSource, SAMPLE_RATE_HZ};
use crate::run::summary::Figures;
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use bench::known_answers::{KnownAnswer, known_answers};
use contact::{Dissipation, produced_restitution};
use schemars::JsonSchema;
use serde::Serialize;

/// Relative tolerance of bench B's figures, in addition to the tables' rounding.
const BENCH_TOLERANCE: f64 = 5e-4;

/// One known answer.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub(crate) struct Case {
    /// Name of the quantity.
    pub(crate) name: String,
    /// Computed value.
    pub(crate) value: f64,
    /// Published value.
    pub(crate) reference: f64,
    /// Error in the unit of the tolerance: relative, or in the value's unit.
    pub(crate) error: f64,
    /// Largest accepted error.
    pub(crate) tolerance: f64,
    /// True if the error is within the tolerance.
    pub(crate) ok: bool,
}

impl From<KnownAnswer> for Case {
    fn from(answer: KnownAnswer) -> Self {
        let (error, ok) = (answer.error(), answer.holds());
        let KnownAnswer { name, value, reference, tolerance, .. } = answer;
        Self { name, value, reference, error, tolerance, ok }
    }
}

fn relative(name: String, value: f64, reference: f64, tolerance: f64) -> Case {
    KnownAnswer { name, value, reference, tolerance, relative: true }.into()
}

/// All cases.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Cases {
    pub(crate) cases: Vec<Case>,
}

impl Cases {
    /// Computes every case; `finished` is called after each of three groups.
    pub(crate) fn compute(finished: impl Fn()) -> Result<Self, CliError> {
        let mut cases = restitution();
        finished();
        let plants = known_answers().map_err(|e| CliError::Work(e.to_string()))?;
        cases.extend(plants.into_iter().map(Case::from));
        finished();
        cases.extend(bench_b()?);
        finished();
        Ok(Self { cases })
    }
}

/// Restitution that each factor produces at a nominal .4 and .8.
fn restitution() -> Vec<Case> {
    let table = [
        ("Hunt-Crossley", Dissipation::HuntCrossley, 0.619736, 0.832870),
        ("Lankarani-Nikravesh", Dissipation::LankaraniNikravesh, 0.701635, 0.847102),
        ("Lee-Wang", Dissipation::LeeWang, 0.768000, 0.909016),
        ("Herbert-McWhannell", Dissipation::HerbertMcWhannell, 0.550309, 0.806980),
        ("Zhiying-Qishao", Dissipation::ZhiyingQishao, 0.398837, 0.787365),
        ("Gonthier", Dissipation::Gonthier, 0.397787, 0.768000),
        ("Flores", Dissipation::Flores, 0.362872, 0.788539),
        ("Hu-Guo", Dissipation::HuGuo, 0.379646, 0.799199),
        ("Carvalho-Martins", Dissipation::CarvalhoMartins, 0.401093, 0.799989),
    ];
    let case = |name: &str, law: Dissipation, e: f64, known: f64| {
        let name = format!("produced restitution, {name}, e = {e}");
        relative(name, produced_restitution(law.factor(e)), known, 2e-6)
    };
    table
        .iter()
        .flat_map(|&(name, law, at_04, at_08)| [case(name, law, 0.4, at_04), case(name, law, 0.8, at_08)])
        .collect()
}

/// Peaks of bench B by clearance (contact force, Y and Z in N, torque in N m, deformation in um)
/// and oscillation in N rms.
type ClearanceRow = ([f64; 5], f64);
/// Peak contact force by load, N.
type LoadRow = [f64; 6];

const TABLES: [(BearingMaterial, [ClearanceRow; 4], LoadRow); 2] = [
    (
        BearingMaterial::Babbitt,
        [
            ([8067.0, 7998.0, 2178.0, 96.0, 31.0], 94.0),
            ([10137.0, 10223.0, 2200.0, 120.0, 37.0], 743.0),
            ([11755.0, 11855.0, 2404.0, 137.0, 46.0], 1034.0),
            ([13924.0, 14050.0, 2654.0, 140.0, 56.0], 1152.0),
        ],
        [13924.0, 7068.0, 5481.0, 4917.0, 4838.0, 6601.0],
    ),
    (
        BearingMaterial::Plastic,
        [
            ([6004.0, 5909.0, 1745.0, 34.0, 150.0], 189.0),
            ([5952.0, 5854.0, 1779.0, 37.0, 165.0], 378.0),
            ([6244.0, 6201.0, 1942.0, 48.0, 184.0], 523.0),
            ([7173.0, 7180.0, 2014.0, 54.0, 218.0], 526.0),
        ],
        [7173.0, 5962.0, 5070.0, 4776.0, 5664.0, 6780.0],
    ),
];

fn bench_b() -> Result<Vec<Case>, CliError> {
    let base = TransmissionBench::open("bench-b")?;
    let mut cases = Vec::new();
    // The tables are rounded to integers.
    let rounding = |reference: f64| 0.5 / reference + BENCH_TOLERANCE;
    for (bearing, by_clearance, by_load) in TABLES {
        for (clearance_mm, (peaks, oscillation_n)) in CLEARANCES_MM.into_iter().zip(by_clearance) {
            let bench = variant(&base, bearing, clearance_mm, CLEARANCE_LOAD_KN);
            let name = |what: &str| format!("bench B, {}, {clearance_mm} mm, {what}", bearing.name());
            let whats = ["peak force, N", "peak Y, N", "peak Z, N", "peak torque, N m", "deformation, um"];
            for ((what, value), reference) in whats.into_iter().zip(peaks_of(&bench)?).zip(peaks) {
                cases.push(relative(name(what), value, reference, rounding(reference)));
            }
            let run = force::run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {})?;
            let value = Figures::from_run(&bench, ForceSource::Law, &run, SAMPLE_RATE_HZ).oscillation_rms_n;
            cases.push(relative(name("oscillation, N rms"), value, oscillation_n, rounding(oscillation_n)));
        }
        for (load_kn, reference) in LOADS_KN.into_iter().zip(by_load) {
            let bench = variant(&base, bearing, LOAD_CLEARANCE_MM, load_kn);
            let [value, ..] = peaks_of(&bench)?;
            let name = format!("bench B, {}, 1 mm, {load_kn:+} kN, peak force, N", bearing.name());
            cases.push(relative(name, value, reference, rounding(reference)));
        }
    }
    Ok(cases)
}

/// Peaks in the tables' order and units.
fn peaks_of(bench: &TransmissionBench) -> Result<[f64; 5], CliError> {
    let peaks = force::law_peaks(bench)?;
    let value = |name: &str| peaks.iter().find(|p| p.name == name).map_or(f64::NAN, |p| p.value);
    Ok([
        value("peak_contact_force_n"),
        value("peak_force_y_n"),
        value("peak_force_z_n"),
        value("peak_friction_torque_nm"),
        1e6 * value("max_deformation_m"),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_outside_its_tolerance_is_not_ok() {
        assert!(relative("x".into(), 1.001, 1.0, 2e-3).ok);
        assert!(!relative("x".into(), 1.003, 1.0, 2e-3).ok);
        assert!(!relative("x".into(), f64::NAN, 1.0, 2e-3).ok);
    }
}
