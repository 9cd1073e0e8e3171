//! The incremental encoder over a counter that wraps and an index that comes where it should, or
//! not.

use controller::sensors::{Incremental, QuadratureCounter, SensorFault};
use proptest::prelude::*;

const PER_REVOLUTION: u32 = 20_000;

/// Readings of a 16-bit counter, each with the index captured since the last.
struct Counter(std::vec::IntoIter<(u16, Option<u16>)>, Option<u16>);

impl QuadratureCounter for Counter {
    const BITS: u32 = 16;

    fn count(&mut self) -> u32 {
        let (count, index) = self.0.next().unwrap();
        self.1 = index;
        u32::from(count)
    }

    fn index(&mut self) -> Option<u32> {
        self.1.take().map(u32::from)
    }
}

fn encoder(readings: Vec<(u16, Option<u16>)>) -> Incremental<Counter> {
    Incremental::new(Counter(readings.into_iter(), None), PER_REVOLUTION, 4).unwrap()
}

proptest! {
    #[test]
    fn any_motion_below_half_the_counter_is_followed(
        start in any::<u16>(), steps in proptest::collection::vec(-32_000..32_000_i32, 1..50),
    ) {
        let mut readings = vec![(start, None)];
        let mut positions = vec![0];
        let mut position = 0;
        for step in steps {
            position += step;
            positions.push(position);
            readings.push((start.wrapping_add(position as u16), None));
        }
        let mut encoder = encoder(readings);
        for expected in positions {
            prop_assert_eq!(encoder.read(), Ok(expected));
        }
    }
}

#[test]
fn complete_revolutions_between_indices_are_accepted_and_others_are_lost_counts() {
    // The index at 5,000, a revolution later, back over it, and then three counts and thirty short
    // of another one.
    let cases = [
        (25_000_u32, None),
        (25_000, None),
        (24_998, None),
        (44_999, None),
        (44_969, Some(SensorFault::CountsLost)),
        (64_969, None),
    ];
    let mut readings = vec![(0, None), (6_000, Some(5_000))];
    readings.extend(cases.iter().map(|(index, _)| ((*index + 900) as u16, Some(*index as u16))));
    let mut encoder = encoder(readings);
    assert_eq!((encoder.read(), encoder.read()), (Ok(0), Ok(6_000)));
    for (index, fault) in cases {
        let expected = fault.map_or(Ok(index as i32 + 900), Err);
        assert_eq!(encoder.read(), expected, "index at {index}");
    }
}

#[test]
fn an_encoder_without_counts_is_refused() {
    let counter = || Counter(vec![].into_iter(), None);
    assert!(Incremental::new(counter(), 0, 0).is_none());
    assert!(Incremental::new(counter(), 100, 50).is_none());
}
