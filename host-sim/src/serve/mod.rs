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
use options::{Checked, ServeOptions};
use std::hash::{BuildHasher, RandomState};
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::time::Duration;

/// Maximum number of bytes of the history. The blocks of the longest run take about half of it.
const HISTORY_BYTES: usize = 64 << 20;
/// Timeout of the wait for connected pages at the end of the process.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(30);

/// Open server.
pub(crate) struct Server {
    /// Address of the page.
    url: String,
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
        let server = Self::open_with(&options, HISTORY_BYTES)?;
        print(&format!("live view: {}", server.url));
        Ok(Some(server))
    }

    fn open_with(options: &Checked, history_bytes: usize) -> Result<Self, CliError> {
        let failed = |error| unusable(options.address, &error);
        let listener = TcpListener::bind(options.address).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let shared = Arc::new(Shared {
            history: Arc::new(History::new(run_id(), history_bytes)),
            page: page::page(),
            access: Access::new(address.ip(), options.token.as_deref()),
            open: OpenConnections::default(),
        });
        let accepting = Arc::clone(&shared);
        let thread = std::thread::Builder::new().name("live view".into());
        thread.spawn(move || connection::accept(&listener, &accepting)).map_err(failed)?;
        let query = if options.token.is_some() { "?token=TOKEN" } else { "" };
        Ok(Self { url: format!("http://{address}/{query}"), shared, stay: options.stay })
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
                print(&format!("live view: stays at {}; control-C closes it", self.url));
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

#[cfg(test)]
mod tests {
    use super::*;
    use link::{EstimateFrame, SensorFrame};
    use std::io::{Read, Write};
    use std::net::TcpStream;

    fn server(history_bytes: usize) -> (Server, TcpStream) {
        let address = "127.0.0.1:0".parse().unwrap();
        let options = Checked { address, token: None, stay: Some(Duration::ZERO) };
        let server = Server::open_with(&options, history_bytes).unwrap();
        let address = server.url.trim_start_matches("http://").trim_end_matches('/');
        let mut page = TcpStream::connect(address).unwrap();
        page.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        page.write_all(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
        // The connection counts from its first byte.
        page.read_exact(&mut [0; 9]).unwrap();
        (server, page)
    }

    fn start() -> Start {
        Start {
            title: "t".into(),
            controller: "native".into(),
            duration_s: 1.0,
            clearance_nm: 5e5,
            sample_rate_hz: 1e4,
            block_samples: 0,
            flags: Vec::new(),
        }
    }

    /// Shows samples, without a wait for the page.
    fn show(server: &Server, samples: u32) {
        let mut feed = server.feed(start(), samples.into(), 1e3);
        for sequence in 0..samples {
            let sample = SensorFrame { sequence, time_us: 100 * sequence, ..SensorFrame::default() };
            feed.observe(&sample, &EstimateFrame { normal_force_n: sequence as f32, ..Default::default() });
        }
    }

    /// Events of a stream up to its end.
    fn events(page: &mut TcpStream) -> Vec<serde_json::Value> {
        let mut text = String::new();
        page.read_to_string(&mut text).unwrap();
        let lines = text.lines().filter_map(|line| line.strip_prefix("data: "));
        lines.map(|data| serde_json::from_str(data).unwrap()).collect()
    }

    #[test]
    fn a_page_that_reads_nothing_until_the_end_holds_nothing_up_and_learns_what_it_missed() {
        let samples = 2_000_000;
        let (server, mut page) = server(1 << 20);
        // Some 20 MB: more than the history and the buffers of the system.
        show(&server, samples);
        let end = std::thread::spawn(move || server.finish(None));
        let events = events(&mut page);
        end.join().unwrap();
        assert_eq!((&events[0]["event"], &events.last().unwrap()["event"]), (&"start".into(), &"end".into()));
        let (mut next, mut missing) = (0, 0);
        for event in &events[1..events.len() - 1] {
            // An event has 100 blocks of 10 samples here.
            match event["missing_events"].as_u64() {
                Some(count) => (next, missing) = (next + 1000 * count, missing + count),
                None => {
                    assert_eq!(event["first_sequence"][0].as_u64(), Some(next));
                    next += 1000;
                }
            }
        }
        assert_eq!(next, u64::from(samples));
        assert!(missing > 0, "the history was large enough: the test shows nothing");
    }

    #[test]
    fn the_history_has_room_for_the_longest_run() {
        // 20,000,000 samples in 200,000 blocks, with numbers of full length.
        let blocks = {
            let mut sampler = blocks::DownSampler::new(blocks::Sizes { block_samples: 1, event_blocks: 100 });
            (0..100).find_map(|i| {
                let sample = SensorFrame {
                    sequence: 19_999_000 + i,
                    time_us: 1_999_999_900 + i,
                    journal_y_nm: -519_718,
                    journal_z_nm: -519_718,
                    ..SensorFrame::default()
                };
                let estimate = EstimateFrame {
                    normal_force_n: 10_001.234,
                    normal_force_sd_n: 123.456_79,
                    friction_torque_nm: -10.001_234,
                    flags: u32::MAX,
                    ..EstimateFrame::default()
                };
                sampler.push(&sample, &estimate)
            })
        };
        let event = serde_json::to_string(&Event::Blocks(blocks.unwrap())).unwrap();
        assert!(event.len() * 2000 < HISTORY_BYTES * 2 / 3, "{}", event.len());
    }

    #[test]
    fn a_run_that_fails_states_its_error_and_does_not_stay() {
        let (mut server, mut page) = server(1 << 20);
        server.stay = None;
        show(&server, 15);
        server.finish(Some(&CliError::Work("the controller restarted".into())));
        let events = events(&mut page);
        assert_eq!(events[1]["samples"], serde_json::json!([10, 5]));
        assert_eq!(events[2]["error"], "the controller restarted");
    }

    #[test]
    fn ids_of_runs_differ() {
        assert_ne!(run_id(), run_id());
    }
}
