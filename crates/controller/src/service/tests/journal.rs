//! Lines of the log.

use super::*;

/// Lines of the next 100 ms.
fn lines(fixture: &mut Fixture) -> Vec<LogEvent> {
    fixture.board.uptime_us += 100_000;
    fixture.run(&mut Script::default(), &mut Script::default(), 3).unwrap();
    fixture.board.lines.take()
}

fn state(state: State, period_us: u32) -> LogEvent {
    LogEvent::State(LoggedState { state, is_sampling: false, period_us })
}

#[test]
fn a_change_of_state_has_one_line() {
    let mut fixture = fixture(Pacing::Timer, blank());
    let idle_us = fixture.shared.sample_period_us();
    assert_eq!(lines(&mut fixture), [state(State::Waiting, idle_us)]);
    assert_eq!(lines(&mut fixture), []);
    fixture.order(Command::Configure(BENCH_B));
    assert_eq!(fixture.board.lines.take(), [], "not before it is time for a look");
    assert_eq!(lines(&mut fixture), [state(State::Running, BENCH_B.bench.sample_period_us)]);
    fixture.order(Command::Stop);
    assert_eq!(lines(&mut fixture), [state(State::Waiting, idle_us)]);
}

#[test]
fn losses_have_a_line_when_they_grow() {
    let mut fixture = fixture(Pacing::Timer, blank());
    fixture.order(Command::Configure(BENCH_B));
    lines(&mut fixture);
    let mut script = Script::default();
    script.write(&(0..12).map(sample).collect::<Vec<_>>());
    script.received.extend([1, 2, 3, 0]);
    fixture.run(&mut script, &mut Script::default(), 20).unwrap();
    let expected = Losses { samples: 4, received: 1, ..Losses::default() };
    assert_eq!(lines(&mut fixture), [LogEvent::Losses(expected)]);
    assert_eq!(lines(&mut fixture), []);
}
