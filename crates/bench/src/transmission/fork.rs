//! What lies between the drive cylinder and the crank: a hydraulic column, play in the fork, or nothing.
//!
//! With a column alone `P = k g + c g'` over the gap `g = x_d - x_f`, pulling as well as pushing: the column is under
//! pressure on both sides. With play `b` the fork only pushes, and only beyond half the play on either side:
//! `P = k e (1 + h e')`, `e = |g| - b/2`, never pulling back; `k` is then fork and column in series, and the column's own
//! damping is left out. Play beyond that of a `[fork]` section comes from the effect `fork-backlash`; without the section it
//! is a fork of [`STIFF_N_M`].

use crate::description::{Fork, TransmissionBench};

/// Damping ratio of the hydraulic column against the shaft's inertia (oil columns: .05 to .15).
const COLUMN_DAMPING_RATIO: f64 = 0.1;
/// Compliance below which the column counts as rigid, m/N: a hundredth of a micrometre under 10 kN.
const LEAST_COMPLIANCE_M_N: f64 = 1e-12;

/// Stiffness of a fork that is described as rigid, N/m: a micrometre under 10 kN.
const STIFF_N_M: f64 = 1e10;
/// Relative gain of its force per closing speed, s/m.
const STIFF_DAMPING_S_M: f64 = 1.0;

/// A compliant drive.
#[derive(Clone, Copy, Debug)]
pub(super) enum Drive {
    /// Hydraulic column.
    Column {
        /// N/m.
        stiffness: f64,
        /// N s/m.
        damping: f64,
    },
    /// Fork with play.
    Play {
        /// N/m.
        stiffness: f64,
        /// Half the play, m.
        half: f64,
        /// Force gained per closing speed, relative, s/m.
        damping: f64,
    },
}

impl Drive {
    /// The drive of a resolved description; `None` if it is rigid.
    pub(super) fn of(bench: &TransmissionBench) -> Option<Self> {
        let compliance = bench.extension.hydraulic_compliance_m_n;
        let column = compliance > LEAST_COMPLIANCE_M_N;
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
    fn play_leaves_the_fork_free_and_pushes_beyond_it_on_either_side() {
        let fork = Drive::Play { stiffness: 1e8, half: 1e-4, damping: 1.0 };
        assert_eq!(fork.force_n(0.9e-4, 1.0), 0.0);
        assert!((fork.force_n(2e-4, 0.0) - 1e4).abs() < 1e-6);
        assert!((fork.force_n(-2e-4, 0.0) + 1e4).abs() < 1e-6);
        assert!((fork.force_n(-2e-4, -0.1) + 1.1e4).abs() < 1e-6);
        // It lets go rather than pull.
        assert_eq!(fork.force_n(2e-4, -5.0), 0.0);
    }
}
