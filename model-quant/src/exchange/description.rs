//! Description of a network's inputs and outputs, for the metadata of exported files.

use crate::network::NetworkKind;
use crate::network::checkpoint::Checkpoint;
use inference::Header;
use serde_json::{Value, json};

impl NetworkKind {
    /// Values of a column, in order; all are -1 to 1 inside the training range.
    pub(crate) const fn inputs(self) -> &'static [&'static str] {
        match self {
            Self::Collision => &[
                "D / D_high: radial clearance",
                "d / d_high: deformation, 0 in a gap",
                "sqrt(d / d_high)",
                "r / r_high: rate of the deformation over the latched approach speed",
                "d / (D + d): penetration",
                "r / (1 + |r|)",
                "sqrt(D_low / (D + d))",
                "sqrt((r - r_low) / (r_high - r_low))",
            ],
            Self::Friction => &[
                "sqrt(F / F_high): normal force, as the collision network gives it",
                "|v| / v_high: sliding speed",
                "|v| / (|v| + v_slow)",
                "|v| / (|v| + v_fast)",
            ],
        }
    }

    /// Meaning of the output.
    pub(crate) fn output(self, header: &Header) -> String {
        match self {
            Self::Collision => {
                let power = f64::from(header.deformation_half_powers) / 2.0;
                format!("y; normal force in N = (max(y, 0) (d / d_high)^{power})^2, 0 in a gap")
            }
            Self::Friction => "mu; friction force in N = -sign(v) max(mu, 0) F".to_owned(),
        }
    }
}

/// Origin and training range of the networks of a checkpoint.
pub(crate) fn describe_origin(checkpoint: &Checkpoint, training_id: u64) -> Value {
    let header = checkpoint.header();
    let [clearance, deformation, ratio, speed, force] = [
        header.radial_clearance_m(),
        header.deformation_m(),
        header.rate_ratio(),
        header.sliding_speed_m_s(),
        header.normal_force_n(),
    ]
    .map(|range| [range.low, range.high]);
    let [slow, fast] = header.speed_scales_m_s();
    json!({
        "written_by": concat!("model-quant ", env!("CARGO_PKG_VERSION")),
        "bearing": checkpoint.bearing.name(),
        "training_id": format!("{training_id:016x}"),
        "recipe": checkpoint.recipe,
        "training_range": {
            "D: radial clearance, m": clearance,
            "d: deformation, m": deformation,
            "r: rate over approach speed": ratio,
            "v: sliding speed, m/s": speed,
            "F: normal force, N": force,
        },
        "latch_floor_m_s": header.latch_floor_m_s(),
        "v_slow_m_s": slow,
        "v_fast_m_s": fast,
    })
}

/// Inputs and outputs of one network.
pub(crate) fn describe_network(checkpoint: &Checkpoint, which: NetworkKind) -> Value {
    json!({
        "network": which.name(),
        "window": "columns oldest first; the output belongs to the newest",
        "inputs": which.inputs(),
        "output": which.output(&checkpoint.header()),
    })
}
