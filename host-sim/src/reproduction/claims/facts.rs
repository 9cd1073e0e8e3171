//! The numbers on which the verdicts depend.

use crate::reproduction::runs::PaperRun;
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use model_quant::report::claims::torque::FrictionFacts;
use model_quant::report::claims::training::TrainingFacts;

/// One run of the paper's series.
#[derive(Clone, Debug)]
pub struct RunFacts {
    /// Radial clearance.
    pub clearance_mm: f64,
    /// Load.
    pub load_kn: f64,
    /// Largest normal force.
    pub peak_n: f64,
    /// Largest force along Y.
    pub peak_y_n: f64,
    /// Largest force along Z.
    pub peak_z_n: f64,
    /// Largest friction torque.
    pub peak_torque_nm: f64,
    /// Oscillation after the first sign change of the angular acceleration.
    pub oscillation_n: f64,
    /// Oscillation around each sign change over that before it.
    pub growth: Vec<f64>,
    /// Frequency of the contact force, Hz.
    pub fluctuation_hz: Option<f64>,
    /// Frequency of the journal's swing, Hz.
    pub swing_hz: Option<f64>,
    /// Mean distance of the journal from the bearing's centre, mm.
    pub swing_radius_mm: f64,
    /// Mean coefficient of friction by sliding speed in m/s.
    pub coefficients: Vec<(f64, f64)>,
    /// Largest difference of those from the bench's friction law, relative.
    pub coefficient_error: f64,
}

/// The runs of a bearing.
#[derive(Clone, Debug)]
pub struct BearingFacts {
    /// The bearing.
    pub bearing: BearingMaterial,
    /// Facts by clearance, ascending.
    pub clearance: Vec<RunFacts>,
    /// Facts by load, descending.
    pub load: Vec<RunFacts>,
    /// Peak force by load in kN on a fine grid, ascending, with the analytic law.
    pub load_curve: Vec<(f64, f64)>,
}

/// Joint acceleration over the ideal one.
#[derive(Clone, Debug)]
pub struct JointFacts {
    /// The published slider-crank.
    pub slider_crank: f64,
    /// The bench by clearance in mm, both bearings.
    pub bench: Vec<(f64, f64)>,
}

/// Everything that claims 1 to 11 are judged by.
#[derive(Clone, Debug)]
pub struct MotionFacts {
    /// Babbitt's runs.
    pub babbitt: BearingFacts,
    /// Plastic's runs.
    pub plastic: BearingFacts,
    /// Swing frequency in Hz by modulus in Pa, everything else fixed, with the analytic law.
    pub modulus: Vec<(f64, f64)>,
    /// Joint acceleration.
    pub joint: JointFacts,
}

/// Everything the claims are judged by.
#[derive(Clone, Debug)]
pub struct Facts {
    /// The bench's motion.
    pub motion: MotionFacts,
    /// Friction on the rig.
    pub friction: FrictionFacts,
    /// Friction of the shipped networks at the rig's speeds and the bench's loads.
    pub networks: FrictionFacts,
    /// Shipped networks.
    pub training: Vec<TrainingFacts>,
}

impl RunFacts {
    /// Largest relative difference of mean coefficients from the bench's friction law.
    pub(super) fn coefficient_error(bench: &TransmissionBench, coefficients: &[(f64, f64)]) -> f64 {
        let law = bench.friction_law();
        let error = |&(speed, found): &(f64, f64)| {
            (found / (law.coefficient(speed) * bench.friction.level) - 1.0).abs()
        };
        coefficients.iter().map(error).fold(0.0, f64::max)
    }
}

impl From<&PaperRun> for RunFacts {
    fn from(run: &PaperRun) -> Self {
        let figures = &run.figures;
        Self {
            clearance_mm: figures.clearance_mm,
            load_kn: figures.load_kn,
            peak_n: figures.peak_contact_force_n,
            peak_y_n: figures.peak_force_y_n,
            peak_z_n: figures.peak_force_z_n,
            peak_torque_nm: figures.peak_friction_torque_nm,
            oscillation_n: figures.oscillation_rms_n,
            growth: run.oscillation_growth.clone(),
            fluctuation_hz: run.swing.fluctuation_hz,
            swing_hz: run.swing.swing_hz,
            swing_radius_mm: run.swing.swing_radius_mm,
            coefficients: run.coefficients.clone(),
            coefficient_error: Self::coefficient_error(&run.bench, &run.coefficients),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in super::super) fn run(clearance_mm: f64, load_kn: f64) -> RunFacts {
        RunFacts {
            clearance_mm,
            load_kn,
            peak_n: 1000.0,
            peak_y_n: 900.0,
            peak_z_n: 300.0,
            peak_torque_nm: 10.0,
            oscillation_n: 100.0,
            growth: vec![1.0, 1.0],
            fluctuation_hz: None,
            swing_hz: None,
            swing_radius_mm: clearance_mm,
            coefficients: Vec::new(),
            coefficient_error: 0.0,
        }
    }

    pub(in super::super) fn bearing_of(
        bearing: BearingMaterial,
        clearance: Vec<RunFacts>,
        load: Vec<RunFacts>,
    ) -> BearingFacts {
        BearingFacts { bearing, clearance, load, load_curve: Vec::new() }
    }

    pub(in super::super) fn motion_facts() -> MotionFacts {
        let bearing = |bearing| {
            let clearances = [0.1, 0.25, 0.5, 1.0].map(|c| run(c, 10.0)).to_vec();
            let loads = [10.0, 5.0, 1.0, -1.0, -5.0, -10.0].map(|l| run(1.0, l)).to_vec();
            bearing_of(bearing, clearances, loads)
        };
        MotionFacts {
            babbitt: bearing(BearingMaterial::Babbitt),
            plastic: bearing(BearingMaterial::Plastic),
            modulus: Vec::new(),
            joint: JointFacts { slider_crank: 1.0, bench: Vec::new() },
        }
    }

    #[test]
    fn every_claim_is_judged_once_even_without_evidence() {
        let none = || FrictionFacts { babbitt: Vec::new(), plastic: Vec::new() };
        let facts =
            Facts { motion: motion_facts(), friction: none(), networks: none(), training: Vec::new() };
        let ids: Vec<u8> = super::super::evaluate(&facts).iter().map(|c| c.id).collect();
        assert_eq!(ids, (1..=15).collect::<Vec<u8>>());
    }
}
