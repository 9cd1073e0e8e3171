//! Every mode compared with a plain second implementation, on random networks and inputs.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

mod plain;

use inference::chain::{Chain, Sums, Then};
use inference::features::COLLISION_INPUTS;
use inference::image::{LayerShape, WeightForm};
use inference::kernel::{Engine, Native, Portable};
use inference::model::{CHANNELS, HEAD_COLUMNS, KERNEL};
use inference::{Causal, Convolution, Head, LayerInput, Pad, Padding, Same, Streaming, Valid, Windowed};
use plain::{Noise, Plain, plain};
use proptest::prelude::*;

const POSITIONS: usize = if cfg!(miri) { 9 } else { 40 };
const P: usize = 12;

/// Two convolutions and a head whose shapes leave partial blocks and groups everywhere.
type Odd<'a, A> =
    Then<Convolution<'a, i16, A, 3, 6, 5>, Then<Convolution<'a, A, A, 6, 7, 2>, Head<'a, A, 7, 4, 2>>>;
/// Family of the shipped networks.
type Family<'a, A> = inference::Network<'a, A, COLLISION_INPUTS>;

fn odd<A: LayerInput>(form: WeightForm) -> Vec<LayerShape> {
    let between = if A::BITS == 8 { WeightForm::Packed } else { form };
    vec![
        Convolution::<i16, A, 3, 6, 5>::shape(form),
        Convolution::<A, A, 6, 7, 2>::shape(between),
        Head::<A, 7, 4, 2>::shape(between),
    ]
}

fn family<A: LayerInput>(form: WeightForm) -> Vec<LayerShape> {
    let between = if A::BITS == 8 { WeightForm::Packed } else { form };
    let first = Convolution::<i16, A, COLLISION_INPUTS, CHANNELS, KERNEL>::shape(form);
    let hidden = Convolution::<A, A, CHANNELS, CHANNELS, KERNEL>::shape(between);
    vec![first, hidden, hidden, Head::<A, CHANNELS, HEAD_COLUMNS, 1>::shape(between)]
}

fn read<'a, N: Chain<'a, i16, IN>, const IN: usize>(words: &'a [u32]) -> N {
    inference::image::load_layers(bytemuck::cast_slice(words), "test").expect("network")
}

fn wide<const OUT: usize>(sums: Sums<OUT>) -> Vec<i64> {
    sums.0.map(i64::from).to_vec()
}

/// Checks the stream at every position; returns the number of clipped activations.
fn streams<'a, N, E, const IN: usize, const OUT: usize>(
    words: &'a [u32],
    network: &Plain,
    seed: u64,
) -> Result<u32, TestCaseError>
where
    N: Chain<'a, i16, IN, Output = Sums<OUT>> + Copy,
    E: Engine,
{
    let mut noise = Noise(seed ^ 0x5555);
    let columns: Vec<[i16; IN]> = (0..POSITIONS).map(|_| noise.column()).collect();
    let chain: N = read(words);
    let causal = network.stream(&plain(&columns));
    let mut stream = Streaming::<N, i16, IN, E>::new(chain);
    let mut clipped = 0;
    for (position, column) in columns.iter().enumerate() {
        let (sums, count) = stream.push(column);
        clipped += count;
        prop_assert_eq!(&(wide(sums), count), &causal[position], "stream, position {}", position);
        if position + 1 >= N::WINDOW {
            let newest = plain(&columns[position + 1 - N::WINDOW..=position]);
            prop_assert_eq!(
                wide(sums),
                network.evaluate(&newest, Padding::Valid).0,
                "window, position {}",
                position
            );
        }
    }
    Ok(clipped)
}

/// Checks a window, evaluated and moved, at every position.
fn windows<'a, N, D, E, const IN: usize, const OUT: usize>(
    words: &'a [u32],
    network: &Plain,
    seed: u64,
) -> Result<(), TestCaseError>
where
    N: Chain<'a, i16, IN, Output = Sums<OUT>> + Copy,
    D: Pad,
    E: Engine,
{
    let mut noise = Noise(seed ^ 0xaaaa);
    let columns: Vec<[i16; IN]> = (0..POSITIONS).map(|_| noise.column()).collect();
    let chain: N = read(words);
    let mut moved = Windowed::<N, i16, IN, P, D, E>::new(chain);
    for (position, newest) in columns.iter().enumerate() {
        let mut window = [[0; IN]; P];
        for (slot, column) in window.iter_mut().rev().zip(columns[..=position].iter().rev()) {
            *slot = *column;
        }
        let expected = network.evaluate(&plain(&window), D::PADDING);
        let mut fresh = Windowed::<N, i16, IN, P, D, E>::new(chain);
        let (sums, clipped) = fresh.evaluate(&window);
        prop_assert_eq!(&(wide(sums), clipped), &expected, "evaluated, position {}", position);
        prop_assert_eq!(&wide(moved.slide(newest).0), &expected.0, "moved, position {}", position);
    }
    Ok(())
}

/// Checks complete windows and moves in any order, in the smallest window that the head allows.
fn windows_of<'a, N, D, const IN: usize, const OUT: usize, const SIZE: usize>(
    words: &'a [u32],
    network: &Plain,
    seed: u64,
) -> Result<(), TestCaseError>
where
    N: Chain<'a, i16, IN, Output = Sums<OUT>> + Copy,
    D: Pad,
{
    let mut noise = Noise(seed ^ 0x3333);
    let mut moved = Windowed::<N, i16, IN, SIZE, D>::new(read(words));
    let mut window = [[0; IN]; SIZE];
    for step in 0..POSITIONS {
        let sums = if noise.bits().is_multiple_of(4) {
            window = core::array::from_fn(|_| noise.column());
            moved.evaluate(&window).0
        } else {
            window.rotate_left(1);
            window[SIZE - 1] = noise.column();
            moved.slide(&window[SIZE - 1]).0
        };
        prop_assert_eq!(wide(sums), network.evaluate(&plain(&window), D::PADDING).0, "step {}", step);
    }
    Ok(())
}

fn forms() -> impl Strategy<Value = WeightForm> {
    prop_oneof![Just(WeightForm::Wide), Just(WeightForm::Packed)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 1 } else { 24 }))]

    #[test]
    fn streams_equal_windows_at_every_position(seed in any::<u64>(), form in forms(), gain in 0.3f64..4.0) {
        let network = Plain::random(&family::<i16>(form), seed, gain);
        let words = network.bytes();
        streams::<Family<'_, i16>, Native, 8, 1>(&words, &network, seed)?;
        streams::<Family<'_, i16>, Portable, 8, 1>(&words, &network, seed)?;
        let network = Plain::random(&family::<i8>(form), seed, gain);
        let words = network.bytes();
        streams::<Family<'_, i8>, Native, 8, 1>(&words, &network, seed)?;
        let network = Plain::random(&odd::<i16>(form), seed, gain);
        let words = network.bytes();
        streams::<Odd<'_, i16>, Native, 3, 2>(&words, &network, seed)?;
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes minutes there, and the streams run the same code")]
    fn windows_evaluated_and_moved_are_right_with_every_padding(
        seed in any::<u64>(), form in forms(), gain in 0.3f64..4.0,
    ) {
        let network = Plain::random(&odd::<i16>(form), seed, gain);
        let words = network.bytes();
        windows::<Odd<'_, i16>, Same, Native, 3, 2>(&words, &network, seed)?;
        windows::<Odd<'_, i16>, Same, Portable, 3, 2>(&words, &network, seed)?;
        windows::<Odd<'_, i16>, Causal, Native, 3, 2>(&words, &network, seed)?;
        windows::<Odd<'_, i16>, Valid, Native, 3, 2>(&words, &network, seed)?;
        let network = Plain::random(&odd::<i8>(form), seed, gain);
        let words = network.bytes();
        windows::<Odd<'_, i8>, Same, Native, 3, 2>(&words, &network, seed)?;
        windows::<Odd<'_, i8>, Causal, Portable, 3, 2>(&words, &network, seed)?;
        let network = Plain::random(&family::<i16>(form), seed, gain);
        let words = network.bytes();
        windows::<Family<'_, i16>, Same, Native, 8, 1>(&words, &network, seed)?;
        windows::<Family<'_, i16>, Valid, Native, 8, 1>(&words, &network, seed)?;
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes minutes there, and the streams run the same code")]
    fn moves_agree_with_complete_windows_in_the_smallest_windows(seed in any::<u64>(), form in forms()) {
        let network = Plain::random(&odd::<i16>(form), seed, 1.0);
        let words = network.bytes();
        windows_of::<Odd<'_, i16>, Same, 3, 2, 4>(&words, &network, seed)?;
        windows_of::<Odd<'_, i16>, Same, 3, 2, 7>(&words, &network, seed)?;
        windows_of::<Odd<'_, i16>, Causal, 3, 2, 4>(&words, &network, seed)?;
        windows_of::<Odd<'_, i16>, Causal, 3, 2, 5>(&words, &network, seed)?;
        windows_of::<Odd<'_, i16>, Valid, 3, 2, 9>(&words, &network, seed)?;
    }

    #[test]
    fn weights_come_back_from_every_form_of_storage(seed in any::<u64>(), form in forms()) {
        let network = Plain::random(&odd::<i16>(form), seed, 1.0);
        let words = network.bytes();
        let chain: Odd<'_, i16> = read(&words);
        let [first, second, head] = &network.0[..] else { panic!("three layers") };
        for output in 0..6 {
            for tap in 0..15 {
                let expected = i32::from(first.weights[output * 15 + tap]);
                prop_assert_eq!(chain.layer.weight(output, tap), Some(expected));
            }
        }
        for output in 0..7 {
            for tap in 0..12 {
                let found = chain.tail.layer.weight(output, tap);
                prop_assert_eq!(found, Some(i32::from(second.weights[output * 12 + tap])));
            }
        }
        for output in 0..2 {
            for tap in 0..28 {
                let found = chain.tail.tail.weight(output, tap);
                prop_assert_eq!(found, Some(i32::from(head.weights[output * 28 + tap])));
            }
        }
        prop_assert_eq!(chain.layer.bias(5), Some(first.biases[5]));
        prop_assert_eq!(chain.layer.multiplier(5), Some(first.multipliers[5]));
        // The last output is followed by those of another block, the last tap by the multiplier.
        for output in 6..10 {
            prop_assert_eq!((chain.layer.bias(output), chain.layer.multiplier(output)), (None, None));
            prop_assert_eq!(chain.layer.weight(output, 0), None);
        }
        prop_assert_eq!(chain.layer.weight(5, 15), None);
        prop_assert_eq!(chain.tail.layer.weight(6, 12), None);
        prop_assert_eq!(chain.tail.tail.weight(1, 28), None);
    }
}

#[test]
fn large_factors_clip_and_the_clipping_is_counted() {
    let network = Plain::random(&family::<i16>(WeightForm::Wide), 7, 6.0);
    let words = network.bytes();
    let clipped = streams::<Family<'_, i16>, Native, 8, 1>(&words, &network, 7).expect("equal");
    assert!(clipped > 20, "{clipped}");
}
