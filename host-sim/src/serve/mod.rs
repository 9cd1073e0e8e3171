//! Live view of `host-sim run --serve`: a server that shows a run in browsers. `docs/serve.md`
//! describes use, stream and limits.
//!
//! The run puts its events into a bounded [`history`] and never waits for a page. Every connection
//! has a thread that reads from there at its own pace.
//!
//! The server is `std::net` with the parser `httparse`. It answers GET for two paths, one request
//! for a connection. Small libraries without an asynchronous runtime (`tiny_http`, `rouille`) have
//! no timeouts of reads and writes and no limit of a request's head; those with such limits bring a
//! runtime into a program that has no other use for it.

mod access;
mod blocks;
mod connection;
pub(crate) mod event;
pub(crate) mod feed;
mod history;
pub mod options;
mod page;
mod request;
mod response;

use crate::cli::console;
use crate::cli::error::CliError;
use access::Access;
use connection::{OpenConnections, Shared};
use event::{End, Event, Start};
use feed::Feed;
use history::History;
use options::ServeOptions;
use std::hash::{BuildHasher, RandomState};
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::time::Duration;

/// Maximum number of bytes of the history. The blocks of the longest run take about half of it.
const HISTORY_BYTES: usize = 64 << 20;
/// Maximum time for which the end of the process waits for connected pages.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(30);

/// Open server.
pub(crate) struct Server {
    shared: Arc<Shared>,
    stay: Option<Duration>,
}

impl Server {
    /// Opens a server if the options require one, and prints its address.
    ///
    /// # Errors
    ///
    /// An option is wrong, or the address cannot be used.
    pub(crate) fn open(options: &ServeOptions) -> Result<Option<Self>, CliError> {
        let Some(options) = options.check()? else { return Ok(None) };
        let failed = |error| unusable(options.address, &error);
        let listener = TcpListener::bind(options.address).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let shared = Arc::new(Shared {
            history: Arc::new(History::new(run_id(), HISTORY_BYTES)),
            page: page::page(),
            access: Access::new(address.ip(), options.token.as_deref()),
            open: OpenConnections::default(),
        });
        let accepting = Arc::clone(&shared);
        let thread = std::thread::Builder::new().name("live view".into());
        thread.spawn(move || connection::accept(&listener, &accepting)).map_err(failed)?;
        let query = if options.token.is_some() { "?token=TOKEN" } else { "" };
        print(&format!("live view: http://{address}/{query}"));
        Ok(Some(Self { shared, stay: options.stay }))
    }

    /// Begins a run of so many samples, shown at `speed` simulated seconds per second.
    pub(crate) fn feed(&self, start: Start, samples: u64, speed: f64) -> Feed {
        Feed::begin(Arc::clone(&self.shared.history), start, samples, speed)
    }

    /// Ends the run for all pages, and stays as the options require. After a failed run it stays
    /// only until the connected pages have received everything.
    pub(crate) fn finish(self, error: Option<&CliError>) {
        let end = End { error: error.map(ToString::to_string) };
        let stay = if end.error.is_some() { Some(Duration::ZERO) } else { self.stay };
        self.shared.history.end(&Event::End(end));
        match stay {
            Some(stay) => std::thread::sleep(stay),
            None => {
                print("live view: the run has ended; control-C closes the view");
                loop {
                    std::thread::park();
                }
            }
        }
        self.shared.open.close(DRAIN_TIMEOUT);
    }
}

/// Creates the error of an address that cannot be used.
fn unusable(address: SocketAddr, error: &std::io::Error) -> CliError {
    let expected = match error.kind() {
        std::io::ErrorKind::AddrInUse => "; expected a free port, or port 0 for any free one",
        std::io::ErrorKind::AddrNotAvailable => "; expected an address of this machine",
        _ => "",
    };
    CliError::Work(format!("--serve: {address}: {error}{expected}"))
}

/// Returns an id that differs from those of other runs. It is no part of a result.
fn run_id() -> String {
    format!("{:016x}", RandomState::new().hash_one(std::process::id()))
}

/// Prints a message unless the command is quiet.
fn print(message: &str) {
    if !console::is_quiet() {
        anstream::eprintln!("{message}");
    }
}
