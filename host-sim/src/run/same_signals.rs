//! Alternatives to the controller's networks on the same signals: the float networks and the
//! analytic law.
//!
//! The estimator runs in this process on the same frames and gives the same bits as on a
//! controller. Float networks and law are evaluated at its estimated contact.

use crate::cli::error::CliError;
use bench::description::TransmissionBench;
use bench::plants::transmission::{ContactView, Transmission};
use controller::Estimator;
use inference::{ContactState, shipped};
use link::{ControllerConfiguration, EstimateFrame, SensorFrame};
use model_quant::network::float_pair::FloatPair;

/// Normal force in N and friction torque in N m.
pub type Forces = [f64; 2];

/// One sample.
#[derive(Clone, Copy, Debug)]
pub struct OnSignals {
    /// The estimator's own estimate.
    pub estimate: EstimateFrame,
    /// The float networks.
    pub float_network: Forces,
    /// The analytic law.
    pub law: Forces,
}

/// Follows a bench through its sensor frames. Fails if the estimator refuses the configuration.
pub fn follow(
    bench: &TransmissionBench,
    configuration: &ControllerConfiguration,
    frames: impl Iterator<Item = SensorFrame>,
) -> Result<Vec<OnSignals>, CliError> {
    let refused = |e: &dyn std::fmt::Debug| CliError::Work(format!("estimator: {e:?}"));
    let plant = Transmission::new(bench, bench.drive_profile(), bench.load_profile());
    let bearing = bench.bearing.material;
    let mut estimator = Estimator::new(shipped(bearing), &configuration.bench, &configuration.monitor)
        .map_err(|e| refused(&e))?;
    let mut float = FloatPair::new(bearing).map_err(|e| refused(&e))?;
    let radius_m = plant.journal_radius_m();
    let sample = |frame: SensorFrame| {
        let estimate = estimator.step(&frame);
        let state = estimator.contact();
        let float = float.push(&state);
        let law = plant.law(&view(&state));
        OnSignals {
            estimate,
            float_network: [f64::from(float.normal_force_n), f64::from(float.friction_force_n) * radius_m],
            law: [law.normal_n, law.friction_n * radius_m],
        }
    };
    Ok(frames.map(sample).collect())
}

fn view(state: &ContactState) -> ContactView {
    ContactView {
        radial_clearance_m: f64::from(state.radial_clearance_m),
        deformation_m: f64::from(state.deformation_m),
        rate_m_s: f64::from(state.deformation_rate_m_s),
        latched_m_s: f64::from(state.approach_speed_m_s),
        sliding_speed_m_s: f64::from(state.sliding_speed_m_s),
    }
}
