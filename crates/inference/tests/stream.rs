//! The streaming kernels against the plain second implementation, on random networks and inputs.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::encode::{ConvolutionParts, HeadParts, NetworkParts, write};
use inference::layout::{
    COLLISION_INPUTS, COLLISION_TAPS, FRICTION_TAPS, HEAD_WEIGHTS, IMAGE_LENGTH, KERNEL, WINDOW,
};
use inference::reference::{whole_history, window};
use inference::{Bearing, ContactState, Estimate, Flags, Header, Model, Network, Pair, Stream, shipped};
use proptest::prelude::*;

/// A small generator: random enough for weights, and its seed is all that a failing case has to show.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        self.0 >> 33
    }

    fn within(&mut self, magnitude: i64) -> i64 {
        (self.next() as i64) % (2 * magnitude + 1) - magnitude
    }

    fn convolution<const TAPS: usize>(&mut self, typical: u32) -> ConvolutionParts<TAPS> {
        ConvolutionParts {
            biases: core::array::from_fn(|_| self.within(4_000_000) as i32),
            multipliers: core::array::from_fn(|_| (1 << typical) + self.within(1 << (typical - 1)) as i32),
            weights: core::array::from_fn(|_| core::array::from_fn(|_| self.within(127) as i8)),
        }
    }

    fn network<const TAPS: usize>(&mut self, typical: u32) -> NetworkParts<TAPS> {
        NetworkParts {
            first: self.convolution(typical),
            second: self.convolution(typical),
            third: self.convolution(typical),
            head: HeadParts {
                scale: 1e-6,
                bias: self.within(1 << 20) as i32,
                weights: core::array::from_fn::<_, HEAD_WEIGHTS, _>(|_| self.within(127) as i8),
            },
        }
    }

    fn column<const C: usize>(&mut self) -> [i16; C] {
        core::array::from_fn(|_| self.within(32767) as i16)
    }
}

fn image(seed: u64, typical: u32) -> Box<[u8; IMAGE_LENGTH]> {
    let mut noise = Noise(seed);
    let header = Model::load(shipped(Bearing::Babbitt)).expect("shipped image").header();
    let mut image = Box::new([0; IMAGE_LENGTH]);
    let collision = noise.network::<COLLISION_TAPS>(typical);
    let friction = noise.network::<FRICTION_TAPS>(typical);
    write(&header, &collision, &friction, &mut image);
    image
}

fn check<const C: usize, const TAPS: usize>(
    network: &Network<'_, TAPS>,
    noise: &mut Noise,
) -> Result<u32, TestCaseError> {
    const POSITIONS: usize = 40;
    let columns: [[i16; C]; POSITIONS] = core::array::from_fn(|_| noise.column());
    let causal = whole_history(network, &columns);
    let mut stream = Stream::default();
    let mut clipped = 0;
    for position in 0..POSITIONS {
        let (output, saturated) = stream.step(network, &columns[position]);
        clipped += u32::from(saturated);
        prop_assert_eq!(i64::from(output), causal[position], "position {}", position);
        if position + 1 >= WINDOW {
            let newest: &[[i16; C]; WINDOW] =
                columns[position + 1 - WINDOW..=position].try_into().expect("window");
            prop_assert_eq!(i64::from(output), window(network, newest), "position {}", position);
        }
    }
    Ok(clipped)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn stream_equals_window_and_whole_history_at_every_position(seed in any::<u64>(), typical in 20u32..30) {
        let image = image(seed, typical);
        let model = Model::load(image.as_slice()).expect("random image");
        let mut noise = Noise(seed ^ 0x5555);
        check::<COLLISION_INPUTS, COLLISION_TAPS>(model.collision(), &mut noise)?;
        check::<{ FRICTION_TAPS / KERNEL }, FRICTION_TAPS>(model.friction(), &mut noise)?;
    }

    #[test]
    fn an_image_runs_the_same_from_any_address(offset in 1usize..8, steps in 1usize..30) {
        let bytes = shipped(Bearing::Plastic);
        let mut moved = vec![0; offset];
        moved.extend_from_slice(bytes);
        let mut here = Pair::new(Model::load(bytes).expect("image"));
        let mut there = Pair::new(Model::load(&moved[offset..]).expect("moved image"));
        for step in 0..steps {
            let state = state(step);
            prop_assert_eq!(here.step(&state), there.step(&state));
        }
    }

    #[test]
    fn any_input_gives_finite_forces_and_no_panic(
        clearance in any::<f32>(), deformation in any::<f32>(), rate in any::<f32>(),
        approach in any::<f32>(), sliding in any::<f32>(),
    ) {
        let mut pair = Pair::new(Model::load(shipped(Bearing::Babbitt)).expect("image"));
        let state = ContactState {
            radial_clearance_m: clearance,
            deformation_m: deformation,
            deformation_rate_m_s: rate,
            approach_speed_m_s: approach,
            sliding_speed_m_s: sliding,
        };
        let estimate = pair.step(&state);
        prop_assert!(estimate.normal_force_n >= 0.0);
        prop_assert!(estimate.normal_force_n.is_finite() && estimate.friction_force_n.is_finite());
        prop_assert_eq!(estimate.flags.contains(Flags::NON_FINITE), !state.is_finite());
        if deformation.is_nan() || deformation <= 0.0 {
            prop_assert_eq!(estimate.normal_force_n, 0.0);
            prop_assert_eq!(estimate.friction_force_n, 0.0);
        }
    }
}

/// A press and release of the bearing, sliding to and fro.
fn state(step: usize) -> ContactState {
    let phase = step as f32 * 0.3;
    ContactState {
        radial_clearance_m: 0.5e-3,
        deformation_m: 4e-5 * phase.sin(),
        deformation_rate_m_s: 1e-3 * phase.cos(),
        approach_speed_m_s: 1e-3,
        sliding_speed_m_s: 0.1 * (0.37 * phase).cos(),
    }
}

#[test]
fn random_networks_do_saturate_and_the_clipping_is_counted() {
    let image = image(7, 29);
    let model = Model::load(image.as_slice()).expect("random image");
    let mut noise = Noise(7);
    let clipped = check::<COLLISION_INPUTS, COLLISION_TAPS>(model.collision(), &mut noise).expect("equal");
    assert!(clipped > 0, "large multipliers must clip");
    let mut pair = Pair::new(model);
    let estimate = pair.step(&state(3));
    assert_eq!(estimate.flags.contains(Flags::SATURATED), estimate.saturated > 0);
}

#[test]
fn reset_forgets_everything_and_the_start_is_flagged() {
    let mut pair = Pair::new(Model::load(shipped(Bearing::Babbitt)).expect("image"));
    let run =
        |pair: &mut Pair<'_>| -> Vec<Estimate> { (0..20).map(|step| pair.step(&state(step))).collect() };
    let first = run(&mut pair);
    let warm = run(&mut pair);
    assert_ne!(first, warm, "the history matters");
    pair.reset();
    assert_eq!(run(&mut pair), first);
    for (index, estimate) in first.iter().enumerate() {
        assert_eq!(estimate.flags.contains(Flags::WARMING_UP), index + 1 < WINDOW, "sample {index}");
    }
}

#[test]
fn a_bad_sample_starts_the_history_anew() {
    let mut pair = Pair::new(Model::load(shipped(Bearing::Babbitt)).expect("image"));
    let fresh: Vec<Estimate> = (0..12).map(|step| pair.step(&state(step))).collect();
    let bad = pair.step(&ContactState { deformation_m: f32::NAN, ..state(1) });
    assert_eq!(bad.normal_force_n, 0.0);
    assert!(bad.flags.contains(Flags::NON_FINITE | Flags::WARMING_UP));
    let again: Vec<Estimate> = (0..12).map(|step| pair.step(&state(step))).collect();
    assert_eq!(again, fresh);
}

#[test]
fn each_input_outside_the_training_range_has_its_flag() {
    let model = Model::load(shipped(Bearing::Plastic)).expect("image");
    let header: Header = model.header();
    let inside = ContactState {
        radial_clearance_m: 0.5e-3,
        deformation_m: 1e-4,
        deformation_rate_m_s: 1e-4,
        approach_speed_m_s: 0.0,
        sliding_speed_m_s: -0.1,
    };
    let flags = |state: ContactState| {
        let mut pair = Pair::new(model.clone());
        (0..WINDOW).map(|_| pair.step(&state).flags).last().unwrap_or_default()
    };
    assert!(!flags(inside).intersects(Flags::OUTSIDE_TRAINING));
    let beyond = |range: inference::Range| range.high * 1.01;
    for (state, flag) in [
        (
            ContactState { radial_clearance_m: beyond(header.radial_clearance_m), ..inside },
            Flags::OUTSIDE_CLEARANCE,
        ),
        (ContactState { radial_clearance_m: 0.0, ..inside }, Flags::OUTSIDE_CLEARANCE),
        (ContactState { deformation_m: beyond(header.deformation_m), ..inside }, Flags::OUTSIDE_DEFORMATION),
        (
            ContactState { deformation_rate_m_s: beyond(header.rate_ratio) * 1e-3, ..inside },
            Flags::OUTSIDE_RATE_RATIO,
        ),
        (
            ContactState { sliding_speed_m_s: -beyond(header.sliding_speed_m_s), ..inside },
            Flags::OUTSIDE_SLIDING_SPEED,
        ),
        (ContactState { deformation_m: 1e-2, ..inside }, Flags::OUTSIDE_FORCE | Flags::OUTSIDE_DEFORMATION),
    ] {
        assert!(flags(state).contains(flag), "{state:?} has {:?}", flags(state));
    }
    // A gap has no rate ratio: its force is 0 whatever the rate.
    let gap = ContactState { deformation_m: -1e-5, deformation_rate_m_s: 1.0, ..inside };
    assert!(!flags(gap).intersects(Flags::OUTSIDE_TRAINING));
}
