//! Ticks whose bits every core must agree on.

use controller::Identity;
use link::{BuildId, ClockSource, Target};
use on_target::ticks::{DIGEST, TICKS, Ticks};

#[test]
fn ticks_have_the_bits_that_the_tests_on_a_board_expect() {
    let (target, clock) = (Target::Native, ClockSource::Host);
    let identity = Identity { build_id: BuildId::new("test"), target, clock, core_hz: 0 };
    let mut ticks = Ticks::new(identity).unwrap();
    for _ in 0..TICKS {
        let sample = ticks.sample();
        assert!(ticks.tick(&sample).is_some());
    }
    assert_eq!(ticks.digest(), DIGEST, "{:#018x}", ticks.digest());
}
