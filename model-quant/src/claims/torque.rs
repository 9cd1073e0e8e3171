//! Friction torque over speed and load: medians of a rig's records in bands of the speed.

use crate::dataset::friction_source::FrictionError;
use bench::rig_groups::{LOADS_N, rig_groups};
use bench::{Bench, Channel};

/// Bands of the sliding speed on the rig, and the slowest that counts: below, a rest is not yet forgotten.
pub const RIG_BANDS: usize = 12;
/// Slowest speed that counts, m/s.
pub const RIG_LEAST_SPEED_M_S: f64 = 1.2e-3;
/// Seed of the rig's noise.
const RIG_SEED: u64 = 1;

/// Friction torque in N m at a load in N by sliding speed in m/s, ascending: medians of a rig's records in bands.
#[derive(Clone, Debug)]
pub struct TorqueCurve {
    /// Load in N.
    pub load_n: f64,
    /// Speed and torque.
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

/// Both rigs of the presets.
pub fn of_rigs() -> Result<FrictionFacts, FrictionError> {
    Ok(FrictionFacts { babbitt: of_rig("friction-rig-babbitt")?, plastic: of_rig("friction-rig-plastic")? })
}

/// Torque curves of a rig from its records: both directions of turning and of loading.
pub fn of_rig(preset: &str) -> Result<Vec<TorqueCurve>, FrictionError> {
    let Bench::FrictionRig(rig) = Bench::open(preset)? else {
        return Err(FrictionError::Content {
            file: preset.into(),
            found: "another plant".into(),
            expected: "a friction rig".into(),
        });
    };
    let radius = rig.axis.friction_radius_m;
    let highest = radius * rig.axis.amplitude * core::f64::consts::TAU / rig.axis.period_s;
    let width = (highest - RIG_LEAST_SPEED_M_S) / RIG_BANDS as f64;
    let groups = rig_groups(&rig, RIG_SEED)?;
    let mut curves = Vec::new();
    for load_n in LOADS_N.into_iter().filter(|n| *n > 0.0) {
        let mut bands: Vec<Vec<f64>> = vec![Vec::new(); RIG_BANDS];
        for group in groups.iter().filter(|g| g.load_n.abs() == load_n) {
            let Some(speeds) = group.log.channels.get(&Channel::SpindleSpeed) else { continue };
            for (speed, torque) in speeds.iter().zip(group.friction_torque_nm()) {
                let place = (speed.abs() * radius - RIG_LEAST_SPEED_M_S) / width;
                if place >= 0.0
                    && let Some(band) = bands.get_mut(place as usize)
                {
                    // The torque opposes the motion; an outlier may not.
                    band.push(-torque * speed.signum());
                }
            }
        }
        let points = bands.iter_mut().enumerate().filter_map(|(i, band)| {
            band.sort_by(f64::total_cmp);
            let median = *band.get(band.len() / 2)?;
            Some((RIG_LEAST_SPEED_M_S + (i as f64 + 0.5) * width, median))
        });
        curves.push(TorqueCurve { load_n, points: points.collect() });
    }
    Ok(curves)
}
