//! Windows: the columns that lead up to a row.
//!
//! The laws depend on the newest state alone, so the networks must, too: whatever they took from older columns would
//! be a delay, which a stiff contact in a loop does not forgive. So the history behind a row says nothing about its
//! force that the row itself does not say better, and every column spacing is covered:
//!
//! * half of the windows: extrapolation backwards, `d(t - k dt) = d - d' k dt` with the column spacing `dt` log-uniform
//!   in 2..200 us and the rate changing by a constant step a column, log-uniform in .001..3 approach speeds; the
//!   clearance and the latched speed are constant; in the friction set likewise speed and root force;
//! * half of the windows: every older column has a ratio, a deformation, a speed and a force of its own.

use crate::draw::Draw;
use crate::features::FloatFeatures;
use crate::rows::Row;
use inference::features::{COLLISION_INPUTS, FRICTION_INPUTS};
use inference::{ContactState, WINDOW};

/// Columns of a window, oldest first, and what the network should give after the newest.
#[derive(Clone, Copy, Debug)]
pub struct Window<const C: usize> {
    /// Features, oldest column first.
    pub columns: [[f32; C]; WINDOW],
    /// Target after the newest column.
    pub target: f32,
}

fn log_step(draw: &mut Draw, low: f64, high: f64) -> f64 {
    draw.sign() * draw.log_uniform(low, high)
}

/// The state of every column of a window, oldest first; the newest is the row's.
pub fn history(features: &FloatFeatures, row: &Row, draw: &mut Draw) -> [ContactState; WINDOW] {
    let mut states = [row.state; WINDOW];
    let approach = f64::from(row.state.approach_speed_m_s.max(features.latch_floor_m_s));
    let ratio_high = f64::from(features.rate_ratio.high);
    let speed_high = f64::from(features.sliding_speed_m_s.high);
    if draw.unit() < 0.5 {
        let spacing_s = draw.log_uniform(2e-6, 200e-6);
        let rate_step = approach * log_step(draw, 1e-3, 3.0);
        let speed_step = log_step(draw, 1e-6, 5e-2);
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

/// Window of the collision network; the target is the root of the force over the column's factor.
pub fn collision(features: &FloatFeatures, row: &Row, draw: &mut Draw) -> Window<COLLISION_INPUTS> {
    let columns = history(features, row, draw).map(|state| features.collision(&state).inputs);
    Window { columns, target: collision_target(features, row) }
}

/// What the collision network should give at a row.
pub fn collision_target(features: &FloatFeatures, row: &Row) -> f32 {
    let factor = f64::from(features.collision(&row.state).root_force_factor);
    if factor > 0.0 { (libm::sqrt(row.normal_force_n) / factor) as f32 } else { 0.0 }
}

/// Window of the friction network over given root forces, oldest first; the target is the coefficient of friction.
pub fn friction_over(
    features: &FloatFeatures,
    states: &[ContactState; WINDOW],
    roots: &[f32; WINDOW],
    coefficient: f64,
) -> Window<FRICTION_INPUTS> {
    let columns = core::array::from_fn(|k| features.friction(roots[k], states[k].sliding_speed_m_s));
    Window { columns, target: coefficient as f32 }
}

/// Window of the friction network with the roots of the law's forces.
pub fn friction(features: &FloatFeatures, row: &Row, draw: &mut Draw) -> Window<FRICTION_INPUTS> {
    let states = history(features, row, draw);
    let high = libm::sqrt(f64::from(features.normal_force_n.high));
    let newest = libm::sqrt(row.normal_force_n);
    let mut roots = [newest as f32; WINDOW];
    let step = high * log_step(draw, 1e-5, 1e-1);
    let independent = draw.unit() < 0.5;
    for (age, root) in roots.iter_mut().rev().enumerate().skip(1) {
        let value = if independent { high * draw.unit() } else { newest - step * age as f64 };
        *root = value.clamp(0.0, high) as f32;
    }
    let coefficient =
        crate::law::friction_law(features.bearing).force_n(1.0, f64::from(row.state.sliding_speed_m_s));
    friction_over(features, &states, &roots, coefficient.abs())
}
