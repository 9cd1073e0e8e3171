//! The axis that several tests hide effects in.

use bench::Bench;

/// The friction rig over four cycles of 4 s. Its friction reverses over a speed that a log can
/// resolve.
pub(crate) fn rig() -> Bench {
    let mut bench = Bench::open("friction-rig").unwrap();
    if let Some(rig) = bench.axis_mut() {
        rig.axis.period_s = 4.013;
        rig.axis.cycles = 4;
        rig.axis.regularisation_m_s = 3e-3;
    }
    bench
}
