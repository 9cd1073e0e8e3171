//! Connections of browsers: one thread each, at most [`MAX_CONNECTIONS`]. Every wait has a timeout.

use super::access::Access;
use super::history::{History, Position};
use super::request;
use super::response::{self, Refusal};
use report::script_page::ScriptPage;
use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Maximum number of open connections.
const MAX_CONNECTIONS: usize = 32;
/// Timeout of a write: a page that takes nothing loses its connection.
const WRITE_TIMEOUT: Duration = Duration::from_secs(10);
/// Time between two signs of life of a stream without events.
const KEEP_ALIVE: Duration = Duration::from_secs(2);
/// Timeout of the other side at the end of a connection.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);
/// Maximum number of bytes that are read after a response.
const MAX_UNREAD_BYTES: usize = 1 << 20;
/// Timeout of a connection for which there is no room.
const BUSY_TIMEOUT: Duration = Duration::from_millis(50);
/// Stack of a connection's thread.
const STACK_BYTES: usize = 256 << 10;
/// Pause after a connection that cannot be accepted, as without free file handles.
const ACCEPT_PAUSE: Duration = Duration::from_millis(50);

/// Data that all connections share.
#[derive(Debug)]
pub(super) struct Shared {
    pub(super) history: Arc<History>,
    pub(super) page: ScriptPage,
    pub(super) access: Access,
    pub(super) open: OpenConnections,
}

/// Count of the open connections.
#[derive(Debug, Default)]
pub(super) struct OpenConnections {
    count: Mutex<Count>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Count {
    open: usize,
    is_closed: bool,
}

impl OpenConnections {
    fn count(&self) -> MutexGuard<'_, Count> {
        self.count.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Counts a new connection. Returns false if there is no room for it.
    fn enter(&self) -> bool {
        let mut count = self.count();
        let has_room = !count.is_closed && count.open < MAX_CONNECTIONS;
        count.open += usize::from(has_room);
        has_room
    }

    fn leave(&self) {
        let mut count = self.count();
        count.open = count.open.saturating_sub(1);
        drop(count);
        self.changed.notify_all();
    }

    /// Accepts no further connection, and waits until none is open or until the timeout.
    pub(super) fn close(&self, timeout: Duration) {
        let mut count = self.count();
        count.is_closed = true;
        let deadline = Instant::now() + timeout;
        while count.open > 0 {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return;
            }
            count = self.changed.wait_timeout(count, left).unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

/// Leaves the count when a connection ends, in whatever way.
struct Entered(Arc<Shared>);

impl Drop for Entered {
    fn drop(&mut self) {
        self.0.open.leave();
    }
}

/// Accepts connections until the process ends.
pub(super) fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    loop {
        let Ok((mut stream, _)) = listener.accept() else {
            std::thread::sleep(ACCEPT_PAUSE);
            continue;
        };
        if !shared.open.enter() {
            let _ = refuse_busy(&mut stream);
            continue;
        }
        let entered = Entered(Arc::clone(shared));
        let thread = std::thread::Builder::new().name("live view".into()).stack_size(STACK_BYTES);
        // Without a thread the connection is closed, and the page tries again.
        let _ = thread.spawn(move || {
            // A page that has gone is no error of the run.
            let _ = respond(&mut stream, &entered.0);
            let _ = close(&mut stream);
        });
    }
}

/// Refuses a connection without a thread for it. Its request is read, as far as it arrives soon: an
/// unread one would reset the connection before the answer is read.
fn refuse_busy(stream: &mut TcpStream) -> io::Result<()> {
    stream.set_read_timeout(Some(BUSY_TIMEOUT))?;
    stream.set_write_timeout(Some(BUSY_TIMEOUT))?;
    let _ = stream.read(&mut [0; 8192]);
    Refusal::Busy.write(stream)
}

/// Answers one request.
fn respond(stream: &mut TcpStream, shared: &Shared) -> io::Result<()> {
    stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
    stream.set_nodelay(true)?;
    let request = match request::read(stream) {
        Ok(request) => request,
        Err(Some(refusal)) => return refusal.write(stream),
        Err(None) => return Ok(()),
    };
    if let Err(refusal) = shared.access.check(&request) {
        return refusal.write(stream);
    }
    match request.path.as_str() {
        "/" => response::write_page(stream, &shared.page.html, &shared.page.policy),
        "/events" => {
            response::write_stream_head(stream)?;
            let position = shared.history.position(request.last_event_id.as_deref());
            write_events(stream, &shared.history, position)
        }
        _ => Refusal::Path.write(stream),
    }
}

/// Writes events until the last one.
fn write_events(out: &mut impl Write, history: &History, mut position: Position) -> io::Result<()> {
    loop {
        let part = history.read(position, KEEP_ALIVE);
        let text = if part.text.is_empty() && !part.is_last { ":\n\n" } else { &part.text };
        out.write_all(text.as_bytes())?;
        position = part.position;
        if part.is_last {
            return Ok(());
        }
    }
}

/// Ends a connection so that the other side receives everything: unread data would reset it.
fn close(stream: &mut TcpStream) -> io::Result<()> {
    stream.shutdown(Shutdown::Write)?;
    let deadline = Instant::now() + CLOSE_TIMEOUT;
    let (mut unread, mut part) = (0, [0; 4096]);
    while unread < MAX_UNREAD_BYTES {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            break;
        }
        stream.set_read_timeout(Some(left))?;
        match stream.read(&mut part)? {
            0 => break,
            count => unread += count,
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::serve::event::{End, Event};

    #[test]
    fn there_is_room_for_a_number_of_connections_and_none_after_the_end() {
        let open = OpenConnections::default();
        (0..MAX_CONNECTIONS).for_each(|_| assert!(open.enter()));
        assert!(!open.enter());
        open.leave();
        assert!(open.enter());
        open.close(Duration::from_millis(1));
        open.leave();
        assert!(!open.enter(), "closed");
    }

    /// Output that ends the run as soon as it has a sign of life.
    struct Alive<'a>(&'a History, Vec<u8>);

    impl Write for Alive<'_> {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.1.extend_from_slice(bytes);
            if self.1.ends_with(b":\n\n") {
                self.0.end(&Event::End(End { error: None }));
            }
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_stream_without_events_shows_signs_of_life() {
        let history = History::new("r".into(), 1000);
        let mut out = Alive(&history, Vec::new());
        write_events(&mut out, &history, Position::Beginning).unwrap();
        let text = String::from_utf8(out.1).unwrap();
        assert_eq!(text, ":\n\nid: r-1\ndata: {\"event\":\"end\",\"error\":null}\n\n");
    }

    #[test]
    fn the_end_waits_for_the_last_connection() {
        let open = OpenConnections::default();
        assert!(open.enter());
        std::thread::scope(|scope| {
            let end = scope.spawn(|| {
                open.close(Duration::from_secs(60));
                open.count().open
            });
            while !open.count().is_closed {
                std::thread::yield_now();
            }
            open.leave();
            assert_eq!(end.join().unwrap(), 0);
        });
    }
}
