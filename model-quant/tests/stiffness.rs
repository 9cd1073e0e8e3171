//! Tests of the stiffness and damping of the image's force, which decide the stability of a contact
//! in a loop.

use inference::{BearingMaterial, ContactState, Model, Pair, shipped};

const FLOOR_M_S: f64 = 1e-3;
const STEPS: [f64; 2] = [0.02, 0.1];

/// Force of a warm stream with seven columns at `before` and the newest at `now`.
fn force(model: &Model<'_>, before: &ContactState, now: &ContactState) -> f64 {
    let mut pair: Pair = Pair::new(*model);
    for _ in 0..7 {
        pair.push(before);
    }
    f64::from(pair.push(now).normal_force_n())
}

#[test]
fn stiffness_and_damping_follow_the_law_and_act_at_once() {
    let [depth_step, ratio_step] = STEPS;
    for bearing in BearingMaterial::ALL {
        let model: Model = Model::load(shipped(bearing)).expect("image");
        let deepest = f64::from(model.header().deformation_m().high);
        let (mut worst, mut sum, mut count) = ([0.0_f64; 2], [0.0_f64; 2], 0);
        for clearance_mm in [0.1, 0.25, 0.5, 1.0] {
            let clearance = clearance_mm * 1e-3;
            let law = bearing.normal_law(clearance, FLOOR_M_S);
            for depth in 4..16 {
                for ratio in 0..20 {
                    let (d, r) = (deepest * f64::from(depth) / 20.0, 0.1 * f64::from(ratio));
                    let state = |d: f64, r: f64| ContactState {
                        radial_clearance_m: clearance as f32,
                        deformation_m: d as f32,
                        deformation_rate_m_s: (r * FLOOR_M_S) as f32,
                        approach_speed_m_s: 0.0,
                        sliding_speed_m_s: 0.1,
                    };
                    let here = state(d, r);
                    for (which, (d1, r1)) in
                        [(d * (1.0 + depth_step), r), (d, r + ratio_step)].into_iter().enumerate()
                    {
                        let found = force(&model, &here, &state(d1, r1)) - force(&model, &here, &here);
                        let expected = law.force_n(d1, r1 * FLOOR_M_S, FLOOR_M_S)
                            - law.force_n(d, r * FLOOR_M_S, FLOOR_M_S);
                        let error = (found / expected - 1.0).abs();
                        worst[which] = worst[which].max(error);
                        sum[which] += error;
                    }
                    count += 1;
                }
            }
        }
        let mean = sum.map(|sum| sum / f64::from(count));
        let name = bearing.name();
        assert!(
            mean[0] < 0.01 && worst[0] < 0.06,
            "{name}: stiffness off by {} at worst {}",
            mean[0],
            worst[0]
        );
        assert!(
            mean[1] < 0.03 && worst[1] < 0.15,
            "{name}: damping off by {} at worst {}",
            mean[1],
            worst[1]
        );
    }
}

#[test]
fn older_columns_hardly_affect_the_force() {
    for bearing in BearingMaterial::ALL {
        let model: Model = Model::load(shipped(bearing)).expect("image");
        let deepest = model.header().deformation_m().high;
        let state = |depth: f32, ratio: f32| ContactState {
            radial_clearance_m: 0.5e-3,
            deformation_m: depth * deepest,
            deformation_rate_m_s: ratio * FLOOR_M_S as f32,
            approach_speed_m_s: 0.0,
            sliding_speed_m_s: 0.1,
        };
        for (depth, ratio) in [(0.2, 0.0), (0.5, 0.5), (0.8, 1.5), (0.5, -0.2)] {
            let now = state(depth, ratio);
            let steady = force(&model, &now, &now);
            for before in
                [state(-0.1, 0.0), state(0.1, 5.0), state(1.0, -5.0), state(0.9, 2.0), state(0.3, 0.1)]
            {
                let after = force(&model, &before, &now);
                assert!(
                    (after / steady - 1.0).abs() < 0.03,
                    "{}: {after} N for {steady} N after {before:?}",
                    bearing.name()
                );
            }
        }
    }
}
