//! Rows of a data set: contact states, drawn from a range and labelled with the forces of the laws.

use crate::data::draw::{Draw, Purpose};
use crate::data::features::FloatFeatures;
use crate::data::ranges::{RangeKind, header};
use inference::{BearingMaterial, ContactState};
use rayon::prelude::*;

/// Maximum number of repeated draws of a row; after them the last state is taken with a rate of 0.
const DRAWS: usize = 64;

/// A contact state with its labels, the forces of the laws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Input state of the networks.
    pub state: ContactState,
    /// Normal force of the law in N.
    pub normal_force_n: f64,
    /// Friction force of the law in N, opposed to the sliding speed.
    pub friction_force_n: f64,
}

impl Row {
    /// Labels a state with the forces of the laws. The rate is first limited to the training range.
    pub(crate) fn label(features: &FloatFeatures, mut state: ContactState) -> Self {
        state.deformation_rate_m_s =
            limited_rate_m_s(features, state.deformation_rate_m_s, state.approach_speed_m_s);
        let law = features
            .bearing
            .normal_law(f64::from(state.radial_clearance_m), f64::from(features.latch_floor_m_s));
        let normal_force_n = law.force_n(
            f64::from(state.deformation_m),
            f64::from(state.deformation_rate_m_s),
            f64::from(state.approach_speed_m_s),
        );
        let friction_force_n =
            features.bearing.friction_law().force_n(normal_force_n, f64::from(state.sliding_speed_m_s));
        Self { state, normal_force_n, friction_force_n }
    }
}

/// Limits a rate in m/s to the training range of its ratio to the approach speed, which has a
/// floor.
pub(crate) fn limited_rate_m_s(features: &FloatFeatures, rate_m_s: f32, approach_m_s: f32) -> f32 {
    let floored = approach_m_s.max(features.latch_floor_m_s);
    let ratio = rate_m_s / floored;
    if features.rate_ratio.contains(ratio) { rate_m_s } else { features.rate_ratio.clamp(ratio) * floored }
}

/// Draws row `index` of a set. A state whose force exceeds the range is drawn again.
pub(crate) fn draw_row(
    bearing: BearingMaterial,
    kind: RangeKind,
    seed: u64,
    purpose: Purpose,
    index: u64,
) -> Row {
    let features = FloatFeatures::from_header(&header(bearing, kind));
    let mut draw = Draw::new(seed, purpose, index);
    let mut drawn = Row::label(&features, draw_state(&features, kind, &mut draw));
    for _ in 0..DRAWS {
        if drawn.normal_force_n <= f64::from(features.normal_force_n.high) {
            return drawn;
        }
        drawn = Row::label(&features, draw_state(&features, kind, &mut draw));
    }
    Row::label(&features, ContactState { deformation_rate_m_s: 0.0, ..drawn.state })
}

/// Draws `count` rows of a set in parallel; the result does not depend on the number of threads.
pub fn draw_rows(
    bearing: BearingMaterial,
    kind: RangeKind,
    seed: u64,
    purpose: Purpose,
    count: usize,
) -> Vec<Row> {
    (0..count as u64).into_par_iter().map(|index| draw_row(bearing, kind, seed, purpose, index)).collect()
}

fn draw_state(features: &FloatFeatures, kind: RangeKind, draw: &mut Draw) -> ContactState {
    let clearance = features.radial_clearance_m;
    let deformation_high = f64::from(features.deformation_m.high);
    let floor = f64::from(features.latch_floor_m_s);
    let (radial_clearance_m, deformation_m, rate, approach) = match kind {
        RangeKind::Paper => (
            draw.uniform(f64::from(clearance.low), f64::from(clearance.high)),
            draw.truncated_exponential(deformation_high),
            draw.truncated_exponential(1.0),
            draw.truncated_exponential(1.0),
        ),
        RangeKind::Bench | RangeKind::Rig => {
            let radial_clearance_m = draw.log_uniform(f64::from(clearance.low), f64::from(clearance.high));
            // Half of the rows are impacts, half a loaded bearing whose deformation changes slowly.
            let is_loaded = draw.unit() < 0.5;
            let deformation_m = deformation_high * if is_loaded { 0.75 } else { 1.0 } * draw.unit();
            let approach =
                if draw.unit() < 0.5 { floor } else { draw.log_uniform(0.1 * floor, 50.0 * floor) };
            let ratio_high = f64::from(features.rate_ratio.high);
            let (mean, leaving) = if is_loaded { (0.15, 0.5) } else { (0.8, 0.3) };
            let ratio = if !is_loaded && draw.unit() < 0.25 {
                draw.uniform(-ratio_high, ratio_high)
            } else {
                let magnitude = (mean * draw.exponential()).min(ratio_high);
                if draw.unit() < leaving { -magnitude } else { magnitude }
            };
            (radial_clearance_m, deformation_m, ratio * approach.max(floor), approach)
        }
    };
    let speed_high = f64::from(features.sliding_speed_m_s.high);
    let sliding =
        if draw.unit() < 0.5 { draw.uniform(0.0, speed_high) } else { draw.log_uniform(1e-5, speed_high) };
    let sliding = sliding * draw.sign();
    ContactState {
        radial_clearance_m: clearance.clamp(radial_clearance_m as f32),
        deformation_m: features.deformation_m.clamp(deformation_m as f32),
        deformation_rate_m_s: rate as f32,
        approach_speed_m_s: approach as f32,
        sliding_speed_m_s: features.sliding_speed_m_s.clamp(sliding as f32),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stay_in_their_ranges_and_reach_their_ends() {
        for bearing in BearingMaterial::ALL {
            for kind in [RangeKind::Paper, RangeKind::Bench] {
                let features = FloatFeatures::from_header(&header(bearing, kind));
                let set = draw_rows(bearing, kind, 3, Purpose::TestRows, 4000);
                let mut extreme = 0;
                for row in &set {
                    assert!(features.radial_clearance_m.contains(row.state.radial_clearance_m));
                    assert!(features.deformation_m.contains(row.state.deformation_m));
                    assert!(features.sliding_speed_m_s.contains(row.state.sliding_speed_m_s));
                    assert!(row.normal_force_n <= f64::from(features.normal_force_n.high), "{row:?}");
                    let ratio = features.unclamped_rate_ratio(&row.state);
                    assert!(ratio.abs() < 1.000_001 * features.rate_ratio.high, "{ratio}");
                    extreme += usize::from(ratio.abs() > 0.95 * features.rate_ratio.high);
                    assert!(row.friction_force_n * f64::from(row.state.sliding_speed_m_s) <= 0.0);
                }
                assert!(extreme > 0, "the ratio comes near its limit");
                let deepest = set.iter().map(|row| row.state.deformation_m).fold(0.0, f32::max);
                assert!(deepest > 0.9 * features.deformation_m.high, "{deepest}");
            }
        }
    }

    #[test]
    fn paper_rows_have_the_means_of_their_distributions() {
        let set = draw_rows(BearingMaterial::Babbitt, RangeKind::Paper, 4, Purpose::TestRows, 20_000);
        let mean = |pick: fn(&Row) -> f32| set.iter().map(|row| f64::from(pick(row))).sum::<f64>() / 20_000.0;
        // Uniform up to 1.5 mm; truncated exponential: high (1/5 - 1/(e^5 - 1)).
        let share = 0.2 - 1.0 / (5.0_f64.exp() - 1.0);
        assert!((mean(|row| row.state.radial_clearance_m) / 0.75e-3 - 1.0).abs() < 0.02);
        assert!((mean(|row| row.state.deformation_m) / (1e-4 * share) - 1.0).abs() < 0.03);
        assert!((mean(|row| row.state.approach_speed_m_s) / share - 1.0).abs() < 0.03);
    }
}
