//! Friction torque over speed and load: medians of a rig's records in speed bands.

use crate::data::friction_source::FrictionError;
use crate::data::statistics::median;
use bench::Channel;
use bench::description::FrictionRig;
use bench::simulate::{LOADS_N, rig_groups};

/// Number of bands of the sliding speed.
pub(crate) const RIG_BANDS: usize = 12;
/// Lower end of the lowest band in m/s; below it presliding after a standstill still affects the
/// torque.
pub(crate) const RIG_MIN_SPEED_M_S: f64 = 1.2e-3;
/// Seed of the rig's sensor noise.
const RIG_SEED: u64 = 1;

/// Friction torque in N m at one load over sliding speed in m/s, ascending; each point is the
/// median of a band.
#[derive(Clone, Debug)]
pub struct TorqueCurve {
    /// Load in N.
    pub load_n: f64,
    /// Pairs of speed and torque.
    pub points: Vec<(f64, f64)>,
}

/// Friction torque over load and speed on the rigs, ascending in load.
#[derive(Clone, Debug)]
pub struct FrictionFacts {
    /// Babbitt.
    pub babbitt: Vec<TorqueCurve>,
    /// Plastic.
    pub plastic: Vec<TorqueCurve>,
}

/// Measures the rigs of both presets.
pub fn measure_rigs() -> Result<FrictionFacts, FrictionError> {
    Ok(FrictionFacts {
        babbitt: measure_rig("friction-rig-babbitt")?,
        plastic: measure_rig("friction-rig-plastic")?,
    })
}

/// Computes the torque curves of a rig from its records, over both rotation and loading directions.
pub(crate) fn measure_rig(preset: &str) -> Result<Vec<TorqueCurve>, FrictionError> {
    let rig = FrictionRig::open(preset)?;
    let radius = rig.axis.friction_radius_m;
    let highest = radius * rig.axis.amplitude * core::f64::consts::TAU / rig.axis.period_s;
    let width = (highest - RIG_MIN_SPEED_M_S) / RIG_BANDS as f64;
    let groups = rig_groups(&rig, RIG_SEED)?;
    let mut curves = Vec::new();
    for load_n in LOADS_N.into_iter().filter(|n| *n > 0.0) {
        let mut bands: Vec<Vec<f64>> = vec![Vec::new(); RIG_BANDS];
        for group in groups.iter().filter(|g| g.load_n.abs() == load_n) {
            let Some(speeds) = group.log.channels.get(&Channel::SpindleSpeed) else { continue };
            for (speed, torque) in speeds.iter().zip(group.friction_torque_nm()) {
                let place = (speed.abs() * radius - RIG_MIN_SPEED_M_S) / width;
                if place >= 0.0
                    && let Some(band) = bands.get_mut(place as usize)
                {
                    // The torque opposes the motion, except in outliers.
                    band.push(-torque * speed.signum());
                }
            }
        }
        let points = bands.iter_mut().enumerate().filter_map(|(i, band)| {
            let speed = RIG_MIN_SPEED_M_S + (i as f64 + 0.5) * width;
            (!band.is_empty()).then(|| (speed, median(band)))
        });
        curves.push(TorqueCurve { load_n, points: points.collect() });
    }
    Ok(curves)
}
