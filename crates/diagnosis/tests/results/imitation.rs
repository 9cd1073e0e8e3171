//! An effect of the catalogue that imitates a cause outside it is not named, however much it
//! explains.

use super::{axis, diagnosed, effect, logged, with};
use bench::Channel;
use diagnosis::Verdict;

#[test]
fn an_offset_that_shrinks_at_the_reversals_is_not_named() {
    let mut bench = axis(12);
    if let Some(rig) = bench.axis_mut() {
        // Friction reverses slowly, so that the two differ.
        rig.axis.regularisation_m_s = 0.06;
    }
    let asymmetry = effect("coulomb-asymmetry", None, "asymmetry_effort", 1.6);
    let log = logged(&with(&bench, asymmetry), 5);
    let d = diagnosed(&bench, std::slice::from_ref(&log), &["sensor-offset"]);
    assert_eq!(d.verdict, Verdict::Unknown, "{:?} {:?}", d.ranking, d.explained_share);
    let d = diagnosed(&bench, &[log], &["sensor-offset", "coulomb-asymmetry"]);
    assert_eq!((d.verdict, d.causes[0].effect.as_str()), (Verdict::Named, "coulomb-asymmetry"));
    let offset = effect("sensor-offset", Some(Channel::DriveForce), "offset", 0.8);
    let d = diagnosed(&bench, &[logged(&with(&bench, offset), 5)], &["sensor-offset"]);
    assert_eq!((d.verdict, d.causes[0].effect.as_str()), (Verdict::Named, "sensor-offset"));
}
