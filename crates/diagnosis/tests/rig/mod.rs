//! The axis that several tests hide effects in.

use bench::Bench;

/// The friction rig over four cycles of 4 s. Its sign is as wide as the motion that a log gives back is sharp.
pub(crate) fn rig() -> Bench {
    let mut bench = Bench::open("friction-rig").unwrap();
    if let Bench::FrictionRig(rig) = &mut bench {
        rig.axis.period_s = 4.013;
        rig.axis.cycles = 4;
        rig.axis.regularisation_m_s = 3e-3;
    }
    bench
}
