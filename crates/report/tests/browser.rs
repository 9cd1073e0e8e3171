//! Pages in a real browser: every chart is drawn, nothing is fetched and no error is reported.

use report::figure::{Chart, Series, Style, lines, lines_log_log, map};
use report::heat::{self, Heat, Scale};
use report::page::Page;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};

/// Samples of a usual and of a long record.
const SAMPLES: [usize; 2] = [10_000, 200_000];

fn chart<'a>(title: &'a str, x: &'a str, y: &'a str) -> Chart<'a> {
    Chart { title, x, y, size: (900, 320) }
}

/// Page with every kind of chart, and the number of its charts.
fn page(samples: usize) -> (Page, usize) {
    let times = || (0..samples).map(|i| i as f64 * 1e-4);
    let wave = |scale: f64| times().map(move |t| scale * (6.0 * t).sin());
    let mut page = Page::new("Every kind of chart");
    let gaps = times().map(|t| if (0.2..0.3).contains(&t) { f64::NAN } else { 4900.0 * (6.0 * t).sin() });
    let law = Series::new("law", times(), wave(5000.0)).styled(Style::Wide);
    let mut force = vec![law, Series::new("network", times(), gaps)];
    force.push(Series::shade("start", (0.0, 0.1), &force));
    page.figure(&lines(&chart("Force", "time, s", "N"), &force).unwrap(), "With a gap.");
    let edge = |sign: f64| times().map(move |t| (t, sign * (1.0 + t)));
    let band = edge(1.0).chain(edge(-1.0).collect::<Vec<_>>().into_iter().rev()).collect();
    let error = [
        Series::through("band", band).styled(Style::Area),
        Series::new("error", times(), wave(0.5)),
        Series::through("peaks", vec![(0.25, 0.4), (0.5, -0.3)]).styled(Style::Points),
    ];
    page.figure(&lines(&chart("Error", "time, s", "N"), &error).unwrap(), "With a band.");
    let powers = Series::new("error", [1e-3, 1e-2, 1e-1], [1e-6, 1e-4, 1e-2]).styled(Style::Both);
    page.figure(&lines_log_log(&chart("Order", "step, s", "m"), &[powers]).unwrap(), "Two decades.");
    let angles = (0..=360).map(|i| f64::from(i).to_radians());
    let circle = Series::through("circle", angles.map(|a| (100.0 * a.cos(), 100.0 * a.sin())).collect());
    let size = (480, 480);
    page.figures(&[(map(&Chart { size, ..chart("Orbit", "y, um", "z, um") }, &[circle]).unwrap(), "Equal.")]);
    let heat = Heat {
        title: "Cells",
        x: "x",
        y: "y",
        columns: vec!["a".into()],
        rows: vec!["b".into()],
        values: vec![vec![Some(1.0)]],
        scale: Scale::Limit(2.0),
        decimals: 1,
        size: (300, 200),
    };
    page.figure(&heat::draw(&heat).unwrap(), "A picture that stays one.");
    (page, 4)
}

/// Opens a page and prints its elements after its scripts; `None` without a browser.
fn open(page: &Page, folder: &Path) -> Option<Output> {
    let path = folder.join("page.html");
    std::fs::write(&path, page.render()).unwrap();
    let output = Command::new("chromium")
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--dump-dom"])
        .args(["--virtual-time-budget=5000", "--window-size=1400,4000"])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg(format!("file://{}", path.display()))
        .output();
    match output {
        Ok(output) => Some(output),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            // The harness captures `eprintln!` of a test that passes, but not this.
            writeln!(std::io::stderr(), "skipped: pages in a browser; chromium is not installed").unwrap();
            None
        }
        Err(error) => panic!("chromium: {error}"),
    }
}

fn console(output: &Output) -> Vec<String> {
    let text = String::from_utf8_lossy(&output.stderr);
    text.lines().filter(|line| line.contains("CONSOLE")).map(str::to_owned).collect()
}

#[test]
fn every_chart_is_drawn_and_the_console_stays_empty() {
    for samples in SAMPLES {
        let folder = tempfile::tempdir().unwrap();
        let (page, charts) = page(samples);
        let Some(output) = open(&page, folder.path()) else { return };
        let dom = String::from_utf8_lossy(&output.stdout);
        let head = &dom[..dom.find("<head").unwrap_or(dom.len().min(300))];
        assert!(head.contains(&format!("data-drawn=\"{charts}\"")), "{head}\n{:?}", console(&output));
        assert!(console(&output).is_empty(), "{:?}", console(&output));
        assert_eq!(dom.matches("class=\"u-over\"").count(), charts);
        let button = dom.split("id=\"save-all\"").nth(1);
        assert!(button.is_some_and(|rest| rest.starts_with('>')), "the button for all pictures appears");
    }
}
