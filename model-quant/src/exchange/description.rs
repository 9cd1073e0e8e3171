//! What a trained network takes and gives, in words and numbers, for the metadata of exported files.

use crate::checkpoint::Checkpoint;
use inference::Header;
use serde_json::{Value, json};

/// One of the two networks of a bearing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// State of the contact to normal force.
    Collision,
    /// Normal force and sliding speed to friction.
    Friction,
}

impl Which {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Collision, Self::Friction];

    /// Lower-case name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Collision => "collision",
            Self::Friction => "friction",
        }
    }

    /// Values of a column, in order; all are -1 to 1 inside the training range.
    pub const fn inputs(self) -> &'static [&'static str] {
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

    /// What the output is.
    pub fn output(self, header: &Header) -> String {
        match self {
            Self::Collision => {
                let power = f64::from(header.deformation_half_powers) / 2.0;
                format!("y; normal force in N = (max(y, 0) (d / d_high)^{power})^2, 0 in a gap")
            }
            Self::Friction => "mu; friction force in N = -sign(v) max(mu, 0) F".to_owned(),
        }
    }
}

/// Where the networks of a checkpoint come from and on which range they were trained.
pub fn origin(checkpoint: &Checkpoint, training_id: u64) -> Value {
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

/// What one network takes and gives.
pub fn network(checkpoint: &Checkpoint, which: Which) -> Value {
    json!({
        "network": which.name(),
        "window": "columns oldest first; the output belongs to the newest",
        "inputs": which.inputs(),
        "output": which.output(&checkpoint.header()),
    })
}
