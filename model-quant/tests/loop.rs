//! Tests of the networks as the force of a simulated bearing, with a zero-order hold of 5 us.
//!
//! A mass of 150 kg meets the surface at 1 mm/s under a load that rises to 10 kN and oscillates by
//! a tenth at 40 Hz. The contact damps with `chi d'/floor`, so a force with a delay of a few
//! samples would chatter or diverge.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::{BearingMaterial, ContactState, Flags, Model, Pair, shipped};
use model_quant::network::float_pair::FloatPair;

const STEP_S: f64 = 5e-6;
const MASS_KG: f64 = 150.0;
const CLEARANCE_M: f64 = 0.5e-3;
const APPROACH_M_S: f64 = 1e-3;

/// Returns the largest force, and force and deformation at every millisecond.
fn run(mut force: impl FnMut(f64, f64) -> f64) -> (f64, Vec<(f64, f64)>) {
    let (mut deformation, mut rate) = (-2e-6, APPROACH_M_S);
    let mut largest = 0.0_f64;
    let mut samples = Vec::new();
    for step in 0..40_000 {
        let time_s = f64::from(step) * STEP_S;
        let ramp = 0.5 - 0.5 * (core::f64::consts::PI * (time_s / 0.15).min(1.0)).cos();
        let load_n = ramp * (10_000.0 + 1000.0 * (2.0 * core::f64::consts::PI * 40.0 * time_s).sin());
        let contact_n = force(deformation, rate);
        rate += (load_n - contact_n) / MASS_KG * STEP_S;
        deformation += rate * STEP_S;
        largest = largest.max(contact_n);
        if step % 200 == 0 {
            samples.push((contact_n, deformation));
        }
    }
    (largest, samples)
}

fn state(deformation: f64, rate: f64) -> ContactState {
    ContactState {
        radial_clearance_m: CLEARANCE_M as f32,
        deformation_m: deformation as f32,
        deformation_rate_m_s: rate as f32,
        approach_speed_m_s: APPROACH_M_S as f32,
        sliding_speed_m_s: 0.05,
    }
}

#[test]
fn a_bearing_with_networks_moves_like_one_with_the_law() {
    for bearing in BearingMaterial::ALL {
        let law = bearing.normal_law(CLEARANCE_M, 1e-3);
        let (peak, expected) = run(|d, rate| law.force_n(d, rate, APPROACH_M_S));
        let mut image: Pair = Pair::new(Model::load(shipped(bearing)).expect("image"));
        let (mut flags, mut fastest) = (Flags::NONE, 0.0_f64);
        let quantised = run(|d, rate| {
            let estimate = image.push(&state(d, rate));
            flags |= estimate.flags;
            fastest = fastest.max(rate.abs());
            f64::from(estimate.normal_force_n())
        });
        assert!(!flags.intersects(Flags::OUTSIDE_TRAINING | Flags::SATURATED), "{flags:?} {fastest} m/s");
        let mut pair = FloatPair::new(bearing).expect("checkpoint");
        let float = run(|d, rate| f64::from(pair.push(&state(d, rate)).normal_force_n));
        for (name, (found_peak, found)) in [("image", quantised), ("float", float)] {
            let name = format!("{} {name}", bearing.name());
            assert!((found_peak / peak - 1.0).abs() < 0.01, "{name}: peak {found_peak} N for {peak} N");
            for (index, ((force, depth), (law_force, law_depth))) in found.iter().zip(&expected).enumerate() {
                assert!(
                    (force - law_force).abs() < 150.0,
                    "{name} at {index} ms: {force} N for {law_force} N"
                );
                assert!(
                    (depth - law_depth).abs() < 2e-6,
                    "{name} at {index} ms: {depth} m for {law_depth} m"
                );
            }
        }
    }
}
