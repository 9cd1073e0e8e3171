//! Connection between the drive cylinder and the crank: rigid, a hydraulic column, or a fork with
//! play.
//!
//! With a column alone the force is `P = k g + c g'` over the gap `g = x_d - x_f`. It pulls as well
//! as pushes, as the column is under pressure on both sides. With play `b` the fork only pushes,
//! and only beyond half the play on either side: `P = k e (1 + h e')`, `e = |g| - b/2`, never
//! negative. `k` is then fork and column in series, and the column's own damping is left out. The
//! effect `fork-backlash` adds play to that of a `[fork]` section; without the section the fork has
//! the stiffness [`STIFF_N_M`].

use crate::description::{Fork, TransmissionBench};

/// Damping ratio of the hydraulic column against the shaft's inertia (oil columns: 0.05 to 0.15).
const COLUMN_DAMPING_RATIO: f64 = 0.1;
/// Compliance below which the column counts as rigid, m/N: 0.01 um under 10 kN.
const MIN_COMPLIANCE_M_N: f64 = 1e-12;

/// Stiffness of a fork that is described as rigid, N/m: 1 um under 10 kN.
const STIFF_N_M: f64 = 1e10;
/// Relative gain of its force per closing speed, s/m.
const STIFF_DAMPING_S_M: f64 = 1.0;

/// A compliant drive.
#[derive(Clone, Copy, Debug)]
pub(super) enum Drive {
    /// Hydraulic column.
    Column {
        /// Stiffness in N/m.
        stiffness: f64,
        /// Damping in N s/m.
        damping: f64,
    },
    /// Fork with play.
    Play {
        /// Stiffness in N/m.
        stiffness: f64,
        /// Half the play, m.
        half: f64,
        /// Relative increase of the force per closing speed, s/m.
        damping: f64,
    },
}

impl Drive {
    /// Drive of a resolved description; `None` if it is rigid.
    pub(super) fn from_bench(bench: &TransmissionBench) -> Option<Self> {
        let servo = bench.servo.as_ref().map_or(0.0, |servo| servo.compliance_m_n);
        let compliance = bench.extension.hydraulic_compliance_m_n + servo;
        let column = compliance > MIN_COMPLIANCE_M_N;
        let backlash_m = bench.extension.backlash_m;
        let rigid = Fork { backlash_m: 0.0, stiffness_n_m: STIFF_N_M, damping_s_m: STIFF_DAMPING_S_M };
        match bench.fork.as_ref().or((backlash_m > 0.0).then_some(&rigid)) {
            Some(fork) => Some(Self::Play {
                stiffness: 1.0 / (1.0 / fork.stiffness_n_m + if column { compliance } else { 0.0 }),
                half: 0.5 * (fork.backlash_m + backlash_m),
                damping: fork.damping_s_m,
            }),
            None => column.then(|| {
                let stiffness = 1.0 / compliance;
                let reduced_mass = bench.shaft.inertia_kg_m2 / bench.geometry.drive_lever_radius_m.powi(2);
                let damping = 2.0 * COLUMN_DAMPING_RATIO * (stiffness * reduced_mass).sqrt();
                Self::Column { stiffness, damping }
            }),
        }
    }

    /// Force of the fork on the shaft along +Y in N at a gap `x_d - x_f` in m and its rate.
    pub(super) fn force_n(&self, gap: f64, rate: f64) -> f64 {
        match *self {
            Self::Column { stiffness, damping } => stiffness * gap + damping * rate,
            Self::Play { stiffness, half, damping } => {
                let depth = gap.abs() - half;
                if depth <= 0.0 {
                    return 0.0;
                }
                let side = gap.signum();
                side * (stiffness * depth * (1.0 + damping * side * rate)).max(0.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fork_with_play_is_free_inside_it_and_pushes_on_either_side() {
        let fork = Drive::Play { stiffness: 1e8, half: 1e-4, damping: 1.0 };
        assert_eq!(fork.force_n(0.9e-4, 1.0), 0.0);
        assert!((fork.force_n(2e-4, 0.0) - 1e4).abs() < 1e-6);
        assert!((fork.force_n(-2e-4, 0.0) + 1e4).abs() < 1e-6);
        assert!((fork.force_n(-2e-4, -0.1) + 1.1e4).abs() < 1e-6);
        // The force is cut off at 0: the fork does not pull.
        assert_eq!(fork.force_n(2e-4, -5.0), 0.0);
    }
}
