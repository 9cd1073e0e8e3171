//! Windows: the input columns up to and including that of a row, with the target of the row.
//!
//! The laws depend on the newest state alone, and so must the networks. An influence of older
//! columns would be a delay, which makes a stiff contact in a closed loop unstable. Therefore the
//! history before a row contains no information about its force that the row does not contain, and
//! every column spacing is covered:
//!
//! * half of the windows: backward extrapolation `d(t - k dt) = d - d' k dt`. The column spacing
//!   `dt` is log-uniform in 2..200 us. The rate changes by a constant step from column to column,
//!   log-uniform in .001..3 approach speeds. Clearance and approach speed are constant. Sliding
//!   speed and root force of friction windows are extrapolated in the same way;
//! * half of the windows: every older column has an independent ratio, deformation, speed and
//!   force.

use crate::data::draw::Draw;
use crate::data::features::FloatFeatures;
use crate::data::rows::Row;
use inference::features::{COLLISION_INPUTS, FRICTION_INPUTS};
use inference::{ContactState, WINDOW};

/// Columns of a window, oldest first, and the network's target after the newest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window<const C: usize> {
    /// Features, oldest column first.
    pub columns: [[f32; C]; WINDOW],
    /// Target after the newest column.
    pub target: f32,
}

/// Draws a log-uniform magnitude of either sign.
fn draw_signed_step(draw: &mut Draw, low: f64, high: f64) -> f64 {
    draw.sign() * draw.log_uniform(low, high)
}

/// Draws the states of all columns of a window, oldest first; the newest is that of the row.
pub fn draw_history(features: &FloatFeatures, row: &Row, draw: &mut Draw) -> [ContactState; WINDOW] {
    let mut states = [row.state; WINDOW];
    let approach = f64::from(row.state.approach_speed_m_s.max(features.latch_floor_m_s));
    let ratio_high = f64::from(features.rate_ratio.high);
    let speed_high = f64::from(features.sliding_speed_m_s.high);
    if draw.unit() < 0.5 {
        let spacing_s = draw.log_uniform(2e-6, 200e-6);
        let rate_step = approach * draw_signed_step(draw, 1e-3, 3.0);
        let speed_step = draw_signed_step(draw, 1e-6, 5e-2);
        let mut deformation = f64::from(row.state.deformation_m);
        let mut rate = f64::from(row.state.deformation_rate_m_s);
        let mut speed = f64::from(row.state.sliding_speed_m_s);
        for state in states.iter_mut().rev().skip(1) {
            deformation -= rate * spacing_s;
            rate -= rate_step;
            speed -= speed_step;
            state.deformation_m = deformation as f32;
            state.deformation_rate_m_s = rate as f32;
            state.sliding_speed_m_s = speed as f32;
        }
    } else {
        for state in states.iter_mut().rev().skip(1) {
            state.deformation_m = (f64::from(features.deformation_m.high) * draw.uniform(-0.2, 1.0)) as f32;
            state.deformation_rate_m_s = (approach * draw.uniform(-ratio_high, ratio_high)) as f32;
            state.sliding_speed_m_s = draw.uniform(-speed_high, speed_high) as f32;
        }
    }
    states
}

/// Draws a window of the collision network; the target is [`collision_target`].
pub(crate) fn draw_collision_window(
    features: &FloatFeatures,
    row: &Row,
    draw: &mut Draw,
) -> Window<COLLISION_INPUTS> {
    let columns = draw_history(features, row, draw).map(|state| features.collision(&state).inputs);
    Window { columns, target: collision_target(features, row) }
}

/// Target of the collision network: square root of the normal force divided by the column's
/// `root_force_factor`; 0 without contact.
pub(crate) fn collision_target(features: &FloatFeatures, row: &Row) -> f32 {
    let factor = f64::from(features.collision(&row.state).root_force_factor);
    if factor > 0.0 { (libm::sqrt(row.normal_force_n) / factor) as f32 } else { 0.0 }
}

/// Draws a window of the friction network. The newest root force is that of the law, the older ones
/// are drawn. The target is the coefficient of friction.
pub(crate) fn draw_friction_window(
    features: &FloatFeatures,
    row: &Row,
    draw: &mut Draw,
) -> Window<FRICTION_INPUTS> {
    let states = draw_history(features, row, draw);
    let high = libm::sqrt(f64::from(features.normal_force_n.high));
    let newest = libm::sqrt(row.normal_force_n);
    let mut roots = [newest as f32; WINDOW];
    let step = high * draw_signed_step(draw, 1e-5, 1e-1);
    let independent = draw.unit() < 0.5;
    for (age, root) in roots.iter_mut().rev().enumerate().skip(1) {
        let value = if independent { high * draw.unit() } else { newest - step * age as f64 };
        *root = value.clamp(0.0, high) as f32;
    }
    let coefficient = features.bearing.friction_law().force_n(1.0, f64::from(row.state.sliding_speed_m_s));
    let columns = core::array::from_fn(|k| features.friction(roots[k], states[k].sliding_speed_m_s));
    Window { columns, target: coefficient.abs() as f32 }
}
