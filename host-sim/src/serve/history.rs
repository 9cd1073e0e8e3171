//! Bounded history of a run's events, from which every page reads at its own pace.
//!
//! Events have consecutive numbers from 1. The oldest are dropped when the history is full, and a
//! page that has not read them receives an event that states how many are missing. Adding an event
//! never waits for a page.

use super::event::{Event, Gap};
use std::collections::VecDeque;
use std::fmt::Write as _;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Bytes after which the text for a page is sent.
const PART_BYTES: usize = 1 << 16;

/// Events of a run, shared with the threads of the pages.
#[derive(Debug)]
pub(super) struct History {
    /// Identifies the run, so that a page of an earlier one begins anew.
    run: String,
    /// Maximum number of bytes of the events.
    capacity: usize,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    start: Option<Box<str>>,
    events: VecDeque<Box<str>>,
    /// Number of events that were dropped.
    dropped: u64,
    bytes: usize,
    is_ended: bool,
}

/// Position of a page in the events of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Position {
    /// Nothing was received.
    Beginning,
    /// Everything up to this number was received; 0 is the description of the run.
    After(u64),
}

/// Text for a page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Part {
    /// Events as server-sent events; empty if there is nothing new.
    pub(super) text: String,
    /// Position after them.
    pub(super) position: Position,
    /// True if no event follows.
    pub(super) is_last: bool,
}

impl History {
    /// Creates an empty history.
    pub(super) fn new(run: String, capacity: usize) -> Self {
        Self { run, capacity, state: Mutex::default(), changed: Condvar::new() }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sets the description of the run, with which every page begins.
    pub(super) fn start(&self, event: &Event) {
        self.state().start = Some(text(event));
        self.changed.notify_all();
    }

    /// Appends an event.
    pub(super) fn push(&self, event: &Event) {
        self.state().push(text(event), self.capacity);
        self.changed.notify_all();
    }

    /// Appends the last event.
    pub(super) fn end(&self, event: &Event) {
        let mut state = self.state();
        state.push(text(event), self.capacity);
        state.is_ended = true;
        drop(state);
        self.changed.notify_all();
    }

    /// Returns the position for the id of the last event that a page has received.
    pub(super) fn position(&self, last_id: Option<&str>) -> Position {
        let number = last_id.and_then(|id| id.strip_prefix(&self.run)?.strip_prefix('-')?.parse().ok());
        match number {
            Some(number) if number <= self.state().last() => Position::After(number),
            _ => Position::Beginning,
        }
    }

    /// Returns the events after a position. If there are none, waits for them until the
    /// timeout.
    pub(super) fn read(&self, position: Position, timeout: Duration) -> Part {
        let deadline = Instant::now() + timeout;
        let mut state = self.state();
        loop {
            let part = self.part(&state, position);
            let left = deadline.saturating_duration_since(Instant::now());
            if !part.text.is_empty() || part.is_last || left.is_zero() {
                return part;
            }
            state = self.changed.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn part(&self, state: &State, position: Position) -> Part {
        let mut text = String::new();
        let mut after = match (position, &state.start) {
            (Position::After(after), _) => after,
            (Position::Beginning, Some(start)) => {
                self.write(&mut text, 0, start);
                0
            }
            (Position::Beginning, None) if state.is_ended => 0,
            (Position::Beginning, None) => return Part { text, position, is_last: false },
        };
        if after < state.dropped {
            let missing_events = state.dropped - after;
            after = state.dropped;
            self.write(&mut text, after, &self::text(&Event::Gap(Gap { missing_events })));
        }
        let skipped = usize::try_from(after - state.dropped).unwrap_or(usize::MAX);
        for event in state.events.iter().skip(skipped) {
            if text.len() >= PART_BYTES {
                break;
            }
            after += 1;
            self.write(&mut text, after, event);
        }
        let is_last = state.is_ended && after >= state.last();
        Part { text, position: Position::After(after), is_last }
    }

    /// Writes a server-sent event.
    fn write(&self, out: &mut String, number: u64, event: &str) {
        // Writing to text does not fail.
        let _ = write!(out, "id: {}-{number}\ndata: {event}\n\n", self.run);
    }
}

impl State {
    fn push(&mut self, event: Box<str>, capacity: usize) {
        self.bytes += event.len();
        self.events.push_back(event);
        while self.bytes > capacity && self.events.len() > 1 {
            if let Some(oldest) = self.events.pop_front() {
                self.bytes -= oldest.len();
                self.dropped += 1;
            }
        }
    }

    /// Number of the last event.
    fn last(&self) -> u64 {
        self.dropped + self.events.len() as u64
    }
}

/// Formats an event as JSON on one line.
fn text(event: &Event) -> Box<str> {
    // Events have no maps and no keys other than text, so this does not fail.
    serde_json::to_string(event).unwrap_or_default().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::serve::event::End;
    use proptest::prelude::*;

    /// Event that is recognised by its number.
    fn event(number: u64) -> Event {
        Event::Gap(Gap { missing_events: 1_000_000 + number })
    }

    fn end() -> Event {
        Event::End(End { error: None })
    }

    fn first() -> Event {
        Event::End(End { error: Some("start".into()) })
    }

    /// Ids and data of a part.
    fn parsed(part: &Part) -> Vec<(String, serde_json::Value)> {
        let events = part.text.split_terminator("\n\n").map(|event| {
            let (id, data) = event.split_once('\n').unwrap();
            (
                id.strip_prefix("id: ").unwrap().to_owned(),
                serde_json::from_str(data.strip_prefix("data: ").unwrap()).unwrap(),
            )
        });
        events.collect()
    }

    fn now(history: &History, position: Position) -> Part {
        history.read(position, Duration::ZERO)
    }

    #[test]
    fn a_page_gets_the_description_and_then_every_event_once() {
        let history = History::new("r".into(), 10_000);
        history.push(&event(1));
        let none = now(&history, Position::Beginning);
        assert_eq!((none.text.as_str(), none.position, none.is_last), ("", Position::Beginning, false));
        history.start(&first());
        let part = now(&history, Position::Beginning);
        let ids: Vec<String> = parsed(&part).into_iter().map(|(id, _)| id).collect();
        assert_eq!((ids, part.is_last), (vec!["r-0".into(), "r-1".into()], false));
        assert_eq!(now(&history, part.position), Part { text: String::new(), ..part.clone() });
        history.end(&end());
        let rest = now(&history, part.position);
        assert_eq!((parsed(&rest).len(), rest.position, rest.is_last), (1, Position::After(2), true));
        let nothing = now(&history, rest.position);
        assert!(nothing.text.is_empty() && nothing.is_last);
    }

    #[test]
    fn a_run_that_fails_before_it_starts_still_ends() {
        let history = History::new("r".into(), 10_000);
        history.end(&end());
        let part = now(&history, Position::Beginning);
        assert!(part.is_last && parsed(&part).len() == 1, "{part:?}");
    }

    #[test]
    fn only_the_id_of_this_run_and_of_an_event_that_exists_is_a_position() {
        let history = History::new("r".into(), 10_000);
        history.push(&event(1));
        assert_eq!(history.position(Some("r-0")), Position::After(0));
        assert_eq!(history.position(Some("r-1")), Position::After(1));
        for id in ["r-2", "r-", "s-1", "r1", "", "r--1", "r-99999999999999999999"] {
            assert_eq!(history.position(Some(id)), Position::Beginning, "{id}");
        }
        assert_eq!(history.position(None), Position::Beginning);
    }

    #[test]
    fn a_full_history_states_what_is_missing_and_a_page_that_knows_it_is_not_informed_again() {
        let history = History::new("r".into(), 3 * text(&event(1)).len());
        history.start(&first());
        (1..=10).for_each(|number| history.push(&event(number)));
        let part = now(&history, Position::After(4));
        let events = parsed(&part);
        assert_eq!((events[0].0.as_str(), &events[0].1["missing_events"]), ("r-7", &3.into()));
        assert_eq!(events.len(), 4);
        assert_eq!(events[3].0, "r-10");
        assert_eq!(parsed(&now(&history, Position::After(7))).len(), 3);
        assert_eq!(parsed(&now(&history, Position::Beginning))[1].1["missing_events"], 7);
        assert!(history.state().bytes <= history.capacity);
    }

    #[test]
    fn an_event_larger_than_the_history_is_kept_alone() {
        let history = History::new("r".into(), 1);
        history.push(&event(1));
        history.push(&event(2));
        assert_eq!(history.state().events.len(), 1);
    }

    #[test]
    fn a_part_is_bounded_and_a_reader_waits_for_the_next_event() {
        let history = History::new("r".into(), usize::MAX);
        history.start(&first());
        (1..=5_000).for_each(|number| history.push(&event(number)));
        let part = now(&history, Position::Beginning);
        assert!((PART_BYTES..PART_BYTES + 200).contains(&part.text.len()), "{}", part.text.len());
        std::thread::scope(|scope| {
            let reader = scope.spawn(|| history.read(Position::After(5_000), Duration::from_secs(60)));
            history.push(&event(5_001));
            assert_eq!(reader.join().unwrap().position, Position::After(5_001));
        });
    }

    proptest! {
        #[test]
        fn no_reader_gets_an_event_twice_or_misses_one_without_a_notice(
            steps in prop::collection::vec((0_u64..20, any::<bool>()), 1..60),
            events in 1_usize..40,
        ) {
            let history = History::new("r".into(), events * text(&event(1)).len());
            history.start(&first());
            let (mut pushed, mut known) = (0, 0);
            let mut position = Position::Beginning;
            for (count, is_reading) in steps {
                (0..count).for_each(|i| history.push(&event(pushed + i + 1)));
                pushed += count;
                if !is_reading {
                    continue;
                }
                // A page that reconnects states the last id.
                let part = now(&history, position);
                for (id, data) in parsed(&part) {
                    position = history.position(Some(&id));
                    let number = data["missing_events"].as_u64();
                    match number {
                        None => prop_assert_eq!(id, "r-0"),
                        Some(missing) if missing < 1_000_000 => known += missing,
                        Some(number) => {
                            known += 1;
                            prop_assert_eq!(number, 1_000_000 + known);
                        }
                    }
                }
                prop_assert_eq!(position, part.position);
                prop_assert_eq!(known, pushed);
            }
        }
    }
}
