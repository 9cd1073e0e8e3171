//! Live view of a run in browsers: real processes, real sockets, and the page in Chromium.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

#[cfg(target_os = "linux")]
mod twin;

use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Timeout of every wait.
const TIMEOUT: Duration = Duration::from_secs(120);
const TOKEN: &str = "a-token-of-some-length";

fn command(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_host-sim"));
    command.current_dir(folder).args(arguments.split_whitespace()).env_remove("HOST_SIM_SERVE_TOKEN");
    command
}

fn refusal(folder: &Path, arguments: &str) -> (Option<i32>, String) {
    let Output { status, stderr, .. } = command(folder, arguments).output().unwrap();
    (status.code(), String::from_utf8_lossy(&stderr).into_owned())
}

/// Run with a server; ended with the test.
struct Serving {
    child: Child,
    address: String,
    messages: BufReader<std::process::ChildStderr>,
}

impl Serving {
    /// Starts `host-sim run --serve` at a free port and waits for its address.
    fn start(folder: &Path, arguments: &str) -> Self {
        let mut command = command(folder, &format!("run --serve 127.0.0.1:0 {arguments}"));
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut messages = BufReader::new(child.stderr.take().unwrap());
        let mut line = String::new();
        messages.read_line(&mut line).unwrap();
        let url = line.trim().strip_prefix("live view: http://").unwrap_or_else(|| panic!("{line}"));
        Self { child, address: url.split('/').next().unwrap().into(), messages }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(TIMEOUT)).unwrap();
        stream
    }

    /// Sends a request and returns the response.
    fn response(&self, request: &str) -> String {
        let mut stream = self.connect();
        stream.write_all(request.as_bytes()).unwrap();
        let mut text = Vec::new();
        stream.read_to_end(&mut text).unwrap();
        String::from_utf8_lossy(&text).into_owned()
    }

    /// Status and headers of the response to a GET.
    fn get(&self, target: &str, headers: &str) -> String {
        self.response(&format!("GET {target} HTTP/1.1\r\nHost: localhost\r\n{headers}\r\n"))
    }

    fn events(&self, last: Option<&str>) -> Events {
        let mut stream = self.connect();
        let last = last.map(|id| format!("Last-Event-ID: {id}\r\n")).unwrap_or_default();
        write!(stream, "GET /events HTTP/1.1\r\nHost: {}\r\n{last}\r\n", self.address).unwrap();
        Events { lines: BufReader::new(stream), id: String::new() }
    }

    /// Waits for the end of the process and returns its exit code and messages.
    fn end(mut self) -> (Option<i32>, String) {
        let mut text = String::new();
        self.messages.read_to_string(&mut text).unwrap();
        (self.child.wait().unwrap().code(), text)
    }
}

impl Drop for Serving {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Events of a connection, with their ids, up to the end of the stream.
struct Events {
    lines: BufReader<TcpStream>,
    id: String,
}

impl Iterator for Events {
    type Item = (String, Value);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let mut line = String::new();
            if self.lines.read_line(&mut line).unwrap() == 0 {
                return None;
            }
            if let Some(id) = line.trim_end().strip_prefix("id: ") {
                self.id = id.into();
            }
            if let Some(data) = line.strip_prefix("data: ") {
                return Some((core::mem::take(&mut self.id), serde_json::from_str(data).unwrap()));
            }
        }
    }
}

/// Events of a kind.
fn of_kind<'a>(events: &'a [(String, Value)], kind: &str) -> Vec<&'a Value> {
    events.iter().map(|(_, data)| data).filter(|data| data["event"] == kind).collect()
}

/// Rows of a table of a run: the header's names, and the cells.
fn table(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut rows = text.lines().map(|line| line.split(',').map(str::to_owned).collect());
    (rows.next().unwrap(), rows.collect())
}

fn column((names, rows): &(Vec<String>, Vec<Vec<String>>), name: &str) -> Vec<String> {
    let at = names.iter().position(|found| found == name).unwrap();
    rows.iter().map(|row| row[at].clone()).collect()
}

fn floats(table: &(Vec<String>, Vec<Vec<String>>), name: &str) -> Vec<f32> {
    column(table, name).iter().map(|cell| cell.parse().unwrap()).collect()
}

/// Number as a 32-bit float; null is infinite.
fn float(value: &Value) -> f32 {
    value.as_f64().map_or(f32::INFINITY, |value| value as f32)
}

/// Bench whose journal falls from far above, so that it separates after its first impact.
fn falling_bench(folder: &Path) {
    let (_, bench_b) = bench::PRESETS[0];
    std::fs::write(folder.join("falling.toml"), format!("{bench_b}\n[start]\ngap_m = 4e-4\n")).unwrap();
}

#[test]
fn a_page_gets_every_extreme_every_flag_and_every_impact_of_the_result() {
    let folder = tempfile::tempdir().unwrap();
    falling_bench(folder.path());
    let arguments = "--bench falling.toml --force law --watch-speed 50 --serve-for 0";
    let serving = Serving::start(folder.path(), arguments);
    let events: Vec<_> = serving.events(None).collect();
    let (code, messages) = serving.end();
    assert_eq!(code, Some(0), "{messages}");

    let run = folder.path().join("out/run");
    let estimates = table(&run.join("estimates.csv"));
    let force = floats(&estimates, "normal_force_n");
    let deviation = floats(&estimates, "normal_force_sd_n");
    let flags: Vec<u32> = column(&estimates, "flags").iter().map(|cell| cell.parse().unwrap()).collect();
    let mut next = 0;
    for blocks in of_kind(&events, "blocks") {
        for i in 0..blocks["samples"].as_array().unwrap().len() {
            let count = blocks["samples"][i].as_u64().unwrap() as usize;
            assert_eq!(blocks["first_sequence"][i].as_u64(), Some(next as u64));
            let samples = next..next + count;
            let least = |values: &mut dyn Iterator<Item = f32>| values.reduce(f32::min).unwrap();
            let most = |values: &mut dyn Iterator<Item = f32>| values.reduce(f32::max).unwrap();
            let band = |sign: f32| samples.clone().map(move |s| (s, sign));
            let edge = |(s, sign): (usize, f32)| force[s] + sign * 2.0 * deviation[s];
            assert_eq!(float(&blocks["min_force_n"][i]), least(&mut force[samples.clone()].iter().copied()));
            assert_eq!(float(&blocks["max_force_n"][i]), most(&mut force[samples.clone()].iter().copied()));
            assert_eq!(float(&blocks["upper_n"][i]), most(&mut band(1.0).map(edge)));
            assert_eq!(float(&blocks["lower_n"][i]).abs(), least(&mut band(-1.0).map(edge)).abs());
            assert_eq!(blocks["flags"][i], flags[samples.clone()].iter().fold(0, |all, bits| all | bits));
            next += count;
        }
    }
    assert_eq!((next, force.len()), (10_000, 10_000));

    let impacts = table(&run.join("estimated_impacts.csv"));
    let shown = of_kind(&events, "impact");
    assert!(shown.len() > 1 && shown.len() == impacts.1.len(), "{shown:?}");
    for name in
        ["peak_force_n", "peak_force_sd_n", "approach_speed_m_s", "separation_speed_m_s", "energy_lost_j"]
    {
        let found: Vec<f32> = shown.iter().map(|impact| float(&impact[name])).collect();
        assert_eq!(found, floats(&impacts, name), "{name}");
    }
    for (impact, row) in shown.iter().zip(&impacts.1) {
        for (column, time) in [(2, "onset_us"), (3, "peak_us"), (4, "duration_us")] {
            assert_eq!(format!("{:.6}", impact[time].as_f64().unwrap() * 1e-6), row[column], "{time}");
        }
        assert_eq!(impact["number"].to_string(), row[0]);
        assert_eq!(impact["onset_sequence"].to_string(), row[1]);
        assert_eq!(impact["speed_ratio"].as_f64().map(|r| r as f32), row[10].parse().ok());
        assert_eq!((impact["flags"].to_string(), impact["end"].as_str()), (row[11].clone(), Some(&*row[12])));
    }
    assert_eq!(events.first().unwrap().1["event"], "start");
    assert_eq!(events.first().unwrap().1["block_samples"], 10);
    assert_eq!(events.last().unwrap().1, serde_json::json!({"event": "end", "error": null}));
    assert_satisfy_the_schema(events.iter().map(|(_, data)| data));
}

fn assert_satisfy_the_schema<'a>(events: impl Iterator<Item = &'a Value>) {
    let schema = command(Path::new("."), "schema serve").output().unwrap().stdout;
    let (mut schemas, mut compiler) = (boon::Schemas::new(), boon::Compiler::new());
    compiler.add_resource("schema.json", serde_json::from_slice(&schema).unwrap()).unwrap();
    let schema = compiler.compile("schema.json", &mut schemas).unwrap();
    for event in events {
        schemas.validate(event, schema).unwrap_or_else(|error| panic!("{error:#}"));
    }
    assert!(schemas.validate(&serde_json::json!({"event": "other"}), schema).is_err());
}

#[test]
fn a_page_that_reconnects_misses_nothing_and_gets_nothing_twice() {
    let folder = tempfile::tempdir().unwrap();
    // Two seconds, so that connections end while the run continues.
    let serving = Serving::start(folder.path(), "--force law --watch-speed 0.5 --serve-for 60");
    let started = Instant::now();
    let mut pieces: Vec<(String, Value)> = Vec::new();
    for length in 1.. {
        let last = pieces.last().map(|(id, _)| id.clone());
        pieces.extend(serving.events(last.as_deref()).take(length));
        if pieces.last().is_some_and(|(_, data)| data["event"] == "end") {
            break;
        }
    }
    assert!(started.elapsed() >= Duration::from_millis(1900), "the run is at the bench's own pace");
    let complete: Vec<_> = serving.events(None).collect();
    assert!(complete.len() > 10, "{}", complete.len());
    assert_eq!(pieces, complete);
    // After the last event nothing follows; an id of another run begins anew.
    assert_eq!(serving.events(Some(&complete.last().unwrap().0)).count(), 0);
    assert_eq!(serving.events(Some("0123456789abcdef-3")).count(), complete.len());
}

#[test]
#[cfg(target_os = "linux")]
fn an_attached_controller_is_shown_like_the_native_one() {
    let folder = tempfile::tempdir().unwrap();
    let twin = twin::Twin::start(vec![], 1);
    let blocks = |controller: &str| {
        let arguments = format!("--force law --watch-speed 1000 --serve-for 0 --controller {controller}");
        let events: Vec<_> = Serving::start(folder.path(), &arguments).events(None).collect();
        let start = events[0].1.clone();
        let forces: Vec<Value> = of_kind(&events, "blocks").into_iter().cloned().collect();
        (start["controller"].as_str().unwrap().to_owned(), forces)
    };
    let attached = blocks(&format!("attached --port {}", twin.port.display()));
    let native = blocks("native");
    assert_eq!((attached.0.as_str(), native.0.as_str()), ("attached", "native"));
    assert!(attached.1.len() >= 10 && attached.1 == native.1);
}

#[test]
fn a_live_view_changes_no_byte_of_the_results() {
    let folder = tempfile::tempdir().unwrap();
    let plain = command(folder.path(), "run --force law --out plain").output().unwrap();
    assert!(plain.status.success());
    let arguments =
        "--force law --serve-token a-secret-of-20-letters --watch-speed 1000 --serve-for 0 --out live";
    let serving = Serving::start(folder.path(), arguments);
    // A page that never reads.
    let silent = serving.connect();
    let (code, messages) = serving.end();
    assert_eq!(code, Some(0), "{messages}");
    drop(silent);
    let read = |out: &str, name: &str| std::fs::read_to_string(folder.path().join(out).join(name)).unwrap();
    for name in ["log.csv", "impacts.csv", "estimates.csv", "estimated_impacts.csv"] {
        assert!(read("plain", name) == read("live", name), "{name} differs");
    }
    let result = |out: &str| {
        let mut result: Value = serde_json::from_str(&read(out, "run.json")).unwrap();
        // Wall times differ from run to run.
        for name in ["wall_s", "wall_s_per_simulated_s"] {
            assert!(result.as_object_mut().unwrap().remove(name).is_some(), "{name}");
        }
        assert!(result["estimator"].as_object_mut().unwrap().remove("exchanges_per_s").is_some());
        result
    };
    assert_eq!(result("plain"), result("live"));
    for name in ["run.json", "report.html"] {
        assert!(!read("live", name).contains("a-secret"), "{name} has the token");
    }
}

#[test]
fn requests_other_than_those_of_a_page_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let serving = Serving::start(folder.path(), "--force law --watch-speed 1000 --serve-for 60");
    let page = serving.get("/", "");
    assert!(page.starts_with("HTTP/1.1 200 OK\r\n") && page.contains("<canvas id=\"orbit\""), "{page}");
    assert!(page.contains("connect-src 'self'") && page.contains("frame-ancestors 'none'"));
    let (_, html) = page.split_once("\r\n\r\n").unwrap();
    assert!(!html.contains("://"), "a page must not reach outside");
    let request = |line: &str, headers: &str| serving.response(&format!("{line}\r\n{headers}\r\n"));
    let padding = "x".repeat(9000);
    for (response, expected) in [
        (request("POST /events HTTP/1.1", "Host: localhost\r\n"), "405 Method Not Allowed"),
        (request("GET / HTTP/1.1", "Host: evil.example\r\n"), "403 Forbidden"),
        (request("GET /events HTTP/1.1", "Host: evil.example\r\n"), "403 Forbidden"),
        (request("GET / HTTP/1.1", ""), "400 Bad Request"),
        (request("GET / HTTP/1.1", "Host: localhost\r\nContent-Length: 5\r\n"), "413 Content Too Large"),
        (serving.get("/events", "Sec-Fetch-Site: cross-site\r\n"), "403 Forbidden"),
        (serving.get("/favicon.ico", ""), "404 Not Found"),
        (serving.get("/../Cargo.toml", ""), "404 Not Found"),
        (serving.get("/", &format!("X: {padding}\r\n")), "431 Request Header Fields Too Large"),
        (serving.get(&format!("/{padding}"), ""), "431 Request Header Fields Too Large"),
        // More than is read before the answer: the rest must not reset the connection.
        (serving.get("/", &format!("X: {}\r\n", "x".repeat(500_000))), "431 Request Header Fields Too Large"),
        (serving.response("nonsense\r\n\r\n"), "400 Bad Request"),
        (serving.response("GET / HTTP/1.1\r\n"), "408 Request Timeout"),
    ] {
        assert!(response.starts_with(&format!("HTTP/1.1 {expected}\r\n")), "{response}");
    }
}

#[test]
fn a_token_is_required_wherever_one_is_set() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = format!("--force law --watch-speed 1000 --serve-for 60 --serve-token {TOKEN}");
    let serving = Serving::start(folder.path(), &arguments);
    let status = |target: &str, headers: &str| serving.get(target, headers)[9..12].to_owned();
    for target in ["/", "/?token=", "/events", "/events?token=a-token-of-some-lengt", "/?token=wrong"] {
        assert_eq!(status(target, ""), "401", "{target}");
    }
    assert_eq!(status(&format!("/?token={TOKEN}"), ""), "200");
    assert_eq!(status(&format!("/events?token={TOKEN}"), ""), "200");
    assert_eq!(status("/", &format!("Authorization: Bearer {TOKEN}\r\n")), "200");
    assert_eq!(status(&format!("/?token={TOKEN}"), "Authorization: Bearer wrong\r\n"), "401");
}

#[test]
fn too_many_connections_are_refused_and_the_next_ones_served() {
    let folder = tempfile::tempdir().unwrap();
    let serving = Serving::start(folder.path(), "--force law --watch-speed 1000 --serve-for 60");
    let open: Vec<TcpStream> = (0..32).map(|_| serving.connect()).collect();
    assert_eq!(&serving.get("/", "")[9..12], "503");
    drop(open);
    // The server notices the ends at its own time.
    let mut found = String::new();
    for _ in 0..1000 {
        found = serving.get("/", "").chars().skip(9).take(3).collect();
        if found == "200" {
            break;
        }
    }
    assert_eq!(found, "200");
}

#[test]
fn wrong_options_are_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, expected) in [
        ("--serve 0.0.0.0:0", "found 0.0.0.0:0 without a token; expected --serve-token"),
        ("--serve [::]:0", "without a token"),
        ("--serve 0.0.0.0:0 --serve-token short", "found a token of 5 characters; expected 16 to 256"),
        ("--serve nowhere", "expected a port or IP:PORT"),
        ("--serve --serve-for -1", "--serve-for: found -1; expected 0 to 86400"),
        ("--serve 0 --watch-speed 0", "--watch-speed: found 0; expected 0.001 to 1000"),
        ("--serve-token a-token-of-some-length", "--serve"),
        ("--serve-for 1", "--serve"),
        ("--watch-speed 2", "--serve"),
        ("--serve --controller none", "--serve: found --controller none; expected a controller"),
        ("--serve --bench slider-crank", "--serve: found plant `slider-crank`"),
    ] {
        let (code, message) = refusal(folder.path(), &format!("run {arguments}"));
        assert_eq!(code, Some(2), "{arguments}: {message}");
        assert!(message.contains(expected), "{arguments}: {message}");
    }
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap();
    let (code, message) = refusal(folder.path(), &format!("run --serve {address}"));
    assert_eq!(code, Some(1), "{message}");
    assert!(
        message.contains(&format!("--serve: {address}: ")) && message.contains("expected a free port"),
        "{message}"
    );
    let (code, message) =
        refusal(folder.path(), "run --serve 192.0.2.1:0 --serve-token a-token-of-some-length");
    assert_eq!(code, Some(1), "{message}");
    assert!(message.contains("expected an address of this machine"), "{message}");
    assert!(!folder.path().join("out").exists());
}

#[test]
fn a_run_without_an_end_of_its_server_stays_after_its_results_are_there() {
    let folder = tempfile::tempdir().unwrap();
    let mut serving = Serving::start(folder.path(), "--force law --watch-speed 1000");
    let mut line = String::new();
    serving.messages.read_line(&mut line).unwrap();
    assert!(line.contains("control-C closes it") && line.contains(&serving.address), "{line}");
    assert!(folder.path().join("out/run/report.html").is_file());
    assert_eq!(serving.events(None).last().unwrap().1["event"], "end");
    assert!(serving.child.try_wait().unwrap().is_none());
}

#[test]
fn the_page_shows_a_run_in_a_browser() {
    let folder = tempfile::tempdir().unwrap();
    falling_bench(folder.path());
    let arguments =
        format!("--bench falling.toml --force law --watch-speed 10 --serve-for 100 --serve-token {TOKEN}");
    let serving = Serving::start(folder.path(), &arguments);
    let output = Command::new("chromium")
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--dump-dom"])
        .args(["--virtual-time-budget=10000", "--window-size=1400,2000"])
        .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
        .arg(format!("http://{}/?token={TOKEN}", serving.address))
        .output();
    let output = match output {
        Ok(output) => output,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            // The harness captures `eprintln!` of a test that passes, but not this.
            writeln!(std::io::stderr(), "skipped: pages in a browser; chromium is not installed").unwrap();
            return;
        }
        Err(error) => panic!("chromium: {error}"),
    };
    let dom = String::from_utf8_lossy(&output.stdout);
    let log = String::from_utf8_lossy(&output.stderr);
    let console: Vec<&str> = log.lines().filter(|line| line.contains("CONSOLE")).collect();
    let head = &dom[..dom.find("<head").unwrap_or(dom.len().min(300))];
    assert!(console.is_empty(), "{console:?}\n{head}");
    assert!(head.contains("data-state=\"complete\"") && !head.contains("data-error"), "{head}");
    let shown = |name: &str| {
        let text = head.split(&format!("data-{name}=\"")).nth(1).unwrap().split('"').next().unwrap();
        text.parse::<f64>().unwrap()
    };
    let run = folder.path().join("out/run");
    assert_eq!((shown("blocks"), shown("impacts")), (1000.0, 2.0));
    let force = floats(&table(&run.join("estimates.csv")), "normal_force_n");
    assert_eq!(shown("peak") as f32, force.into_iter().fold(0.0, f32::max));
    assert_eq!(dom.matches("class=\"u-over\"").count(), 1);
    for text in ["the run is complete", "2 so far, largest peak", "converging: ", "<td>separation</td>"] {
        assert!(dom.contains(text), "{text}");
    }
}
