//! Command line of the matrix of hidden effects: `cargo xtask hidden-effects`.
//!
//! Runs cells in parallel and keeps every outcome in a journal, so that an interrupted campaign can
//! continue. Prints the figures with their goals and writes the published pages on request.

use clap::Parser;
use host_sim::shard::{self, MergeError, Shard};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;
use system_tests::generator::plant::Plant;
use system_tests::hidden_effects::CampaignError;
use system_tests::hidden_effects::cell::{Arm, Campaign, Cell};
use system_tests::hidden_effects::compare::Outcome;
use system_tests::hidden_effects::page::{page, stem, summary};
use system_tests::hidden_effects::run::run;
use system_tests::hidden_effects::score::{Figures, figures};
use system_tests::journal::{self, JournalError};

/// Hide effects in logs of independent generators, let the diagnosis find them, and print the
/// figures.
#[derive(Parser)]
#[command(
    name = "hidden-effects",
    after_help = "Examples:\n  cargo xtask hidden-effects --seeds 100 --out out/hidden-effects\n  \
    cargo xtask hidden-effects --shard 2/4 --out out/shard-2\n  \
    cargo xtask hidden-effects --merge out/shard-1 out/shard-2 out/shard-3 out/shard-4\n\n\
    An interrupted campaign continues if it is started again with the same options.\n\
    Exit codes: 0 done, 1 the work failed, 2 the arguments are wrong."
)]
struct Cli {
    /// Seeds of every cell on the axes.
    #[arg(long, default_value_t = 100)]
    seeds: u64,
    /// Seeds of every cell on the transmission benches.
    #[arg(long, default_value_t = 5)]
    bench_seeds: u64,
    /// Seeds to skip: 10 with three seeds gives the seeds 11 to 13.
    #[arg(long, default_value_t = 0)]
    skip_seeds: u64,
    /// Plants.
    #[arg(long, value_delimiter = ',', default_value = "rotary,linear,bench,two-plane", value_parser = plant)]
    plant: Vec<Plant>,
    /// Sizes of single effects, rms over the noise.
    #[arg(long, value_delimiter = ',', default_value = "0.1,0.2,0.3,0.5,1,2,5")]
    sizes: Vec<f64>,
    /// Questions: clean, single, deleted, two, pair, changed, hard.
    #[arg(long, value_delimiter = ',', default_value = "clean,single,deleted,two,pair,changed,hard")]
    arms: Vec<Arm>,
    /// Run one of N parts of the campaign and write its journal, but no figures.
    #[arg(long, value_name = "I/N", conflicts_with = "bless")]
    shard: Option<Shard>,
    /// Merge the journals in the folders of all parts instead of running cells; the other options
    /// are those of the parts.
    #[arg(long, value_name = "DIR", num_args = 1.., conflicts_with = "shard")]
    merge: Vec<PathBuf>,
    /// Cells at the same time; 0: one on each core.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Print the figures as JSON.
    #[arg(long)]
    json: bool,
    /// Folder of the journal and the figures.
    #[arg(long, default_value = "out/hidden-effects")]
    out: PathBuf,
    /// Stop after this many minutes; finished cells count.
    #[arg(long)]
    minutes: Option<f64>,
    /// Date to print with the figures; default: today.
    #[arg(long)]
    date: Option<String>,
    /// Remark about the run for the page; may be given several times.
    #[arg(long)]
    note: Vec<String>,
    /// Run each effect once, and every question on the axes; other options are ignored.
    #[arg(long)]
    quick: bool,
    /// Run the part of --quick that is tested with every change.
    #[arg(long, conflicts_with = "quick")]
    sample: bool,
    /// Write the golden figures and the page: hidden-effects, hidden-effects-bench for `bench`
    /// alone, hidden-effects-two-plane for `two-plane` alone; with --quick or --sample
    /// only its golden figures.
    #[arg(long)]
    bless: bool,
    /// Write the pages from the golden figures, without running anything.
    #[arg(long, conflicts_with_all = ["bless", "quick", "sample"])]
    pages: bool,
}

fn plant(text: &str) -> Result<Plant, String> {
    Plant::ALL
        .into_iter()
        .find(|p| p.name() == text)
        .ok_or_else(|| format!("found `{text}`; expected rotary, linear, bench or two-plane"))
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    if let Some(size) = cli.sizes.iter().find(|s| !(0.0..=100.0).contains(*s)) {
        eprintln!("error: --sizes: found {size}; expected 0 to 100");
        return ExitCode::from(2);
    }
    match if cli.pages { write_pages() } else { campaign(&cli) } {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            let is_input = match &error {
                CampaignError::Journal(error) | CampaignError::Merge(MergeError::Journal(error)) => {
                    matches!(error, JournalError::Other { .. })
                }
                CampaignError::Merge(_) => true,
                _ => false,
            };
            ExitCode::from(if is_input { 2 } else { 1 })
        }
    }
}

/// Name of the journal in the folder of a campaign.
const JOURNAL: &str = "journal.jsonl";

fn campaign(cli: &Cli) -> Result<(), CampaignError> {
    let campaign = match (cli.quick, cli.sample) {
        (true, _) => Campaign::quick(),
        (_, true) => Campaign::sample(),
        _ => Campaign {
            seeds: cli.seeds,
            bench_seeds: cli.bench_seeds,
            skipped_seeds: cli.skip_seeds,
            bench_alone: false,
            is_sample: false,
            plants: cli.plant.clone(),
            sizes: cli.sizes.clone(),
            arms: cli.arms.clone(),
        },
    };
    let cells = campaign.cells();
    let (outcomes, mut failed) = if cli.merge.is_empty() {
        execute(cli, &campaign, &cells)?
    } else {
        let header = journal::header(campaign.clone())?;
        (shard::merge(&cli.merge, &cli.out, JOURNAL, &header, cells.len())?, Vec::new())
    };
    if let Some(shard) = cli.shard {
        println!("shard {shard}: {} of {} cells, {} failed", outcomes.len(), cells.len(), failed.len());
    } else {
        publish(cli, &campaign, &outcomes, failed.is_empty())?;
    }
    let Some(last) = failed.pop() else { return Ok(()) };
    failed.iter().for_each(|error| eprintln!("error: {error}"));
    Err(last)
}

/// Runs the cells that the journal lacks. Returns the outcomes in the order of the cells, and the
/// errors of cells that failed.
fn execute(
    cli: &Cli,
    campaign: &Campaign,
    cells: &[Cell],
) -> Result<(Vec<Outcome>, Vec<CampaignError>), CampaignError> {
    let (journal, finished) = journal::open(&cli.out.join(JOURNAL), campaign.clone())?;
    let mut finished: BTreeMap<usize, Outcome> =
        Vec::into_iter(finished).map(|outcome: Outcome| (outcome.cell.index, outcome)).collect();
    let shard = cli.shard.unwrap_or(Shard::ALL);
    let own: Vec<_> = cells.iter().filter(|cell| shard.contains(cell.index)).collect();
    let open: Vec<_> = own.iter().filter(|cell| !finished.contains_key(&cell.index)).collect();
    let bar = if cli.json { ProgressBar::hidden() } else { ProgressBar::new(own.len() as u64) };
    if let Ok(style) = ProgressStyle::with_template("hidden effects {bar:40} {pos}/{len} {elapsed} eta {eta}")
    {
        bar.set_style(style);
    }
    bar.set_position(finished.len() as u64);
    let start = std::time::Instant::now();
    let late = || cli.minutes.is_some_and(|m| start.elapsed().as_secs_f64() > 60.0 * m);
    let journal = Mutex::new(journal);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(cli.threads).build().map_err(|e| {
        CampaignError::File { file: "threads".into(), found: e.to_string(), expected: "a pool of threads" }
    })?;
    // A cell that fails is reported at the end, because the journal may hold hours of others. It is
    // asked again when the campaign continues. A journal that cannot be written ends the campaign:
    // results after half a line would be lost.
    let one = |cell: &&&Cell| -> Option<Result<Result<Outcome, CampaignError>, CampaignError>> {
        if late() {
            return None;
        }
        let outcome = run(&cli.out, cell);
        let line = |outcome: &Outcome| {
            journal.lock().unwrap_or_else(std::sync::PoisonError::into_inner).append(outcome)
        };
        let written = outcome.as_ref().map_or(Ok(()), line);
        bar.inc(1);
        Some(written.map(|()| outcome).map_err(CampaignError::from))
    };
    let new: Vec<Result<Outcome, CampaignError>> = pool
        .install(|| open.par_iter().with_max_len(1).filter_map(one).collect::<Result<_, CampaignError>>())?;
    bar.finish_and_clear();
    let mut failed = Vec::new();
    for outcome in new {
        match outcome {
            Ok(outcome) => drop(finished.insert(outcome.cell.index, outcome)),
            Err(error) => failed.push(error),
        }
    }
    Ok((finished.into_values().collect(), failed))
}

/// Writes and prints the figures; with `--bless` also the golden ones, if they are complete.
fn publish(
    cli: &Cli,
    campaign: &Campaign,
    outcomes: &[Outcome],
    is_complete: bool,
) -> Result<(), CampaignError> {
    let mut figures = figures(&cli.date.clone().unwrap_or_else(today), campaign, outcomes);
    figures.notes.clone_from(&cli.note);
    let json = serde_json::to_string_pretty(&figures).unwrap_or_default() + "\n";
    write(&cli.out.join("figures.json"), &json)?;
    write(&cli.out.join("hidden-effects.md"), &page(&figures))?;
    if cli.json {
        print!("{json}");
    } else {
        print!("{}", summary(&figures));
    }
    if cli.bless && is_complete { bless(&figures, &json) } else { Ok(()) }
}

/// Writes the pages from the golden figures.
fn write_pages() -> Result<(), CampaignError> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
    for name in ["hidden-effects", "hidden-effects-bench", "hidden-effects-two-plane"] {
        let file = root.join(format!("tests/golden/{name}.json"));
        let failed = |found: String| CampaignError::File {
            file: file.display().to_string(),
            found,
            expected: "golden figures",
        };
        let text = std::fs::read_to_string(&file).map_err(|error| failed(error.to_string()))?;
        let figures: Figures = serde_json::from_str(&text).map_err(|error| failed(error.to_string()))?;
        write(&root.join(format!("docs/{}.md", stem(&figures))), &page(&figures))?;
    }
    Ok(())
}

fn bless(figures: &Figures, json: &str) -> Result<(), CampaignError> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
    for (campaign, name) in [(Campaign::quick(), "quick"), (Campaign::sample(), "sample")] {
        if figures.campaign.as_ref() == Some(&campaign) {
            return write(&root.join(format!("tests/golden/hidden-effects-{name}.json")), json);
        }
    }
    write(&root.join(format!("tests/golden/{}.json", stem(figures))), json)?;
    write(&root.join(format!("docs/{}.md", stem(figures))), &page(figures))
}

fn write(file: &std::path::Path, text: &str) -> Result<(), CampaignError> {
    bench::atomic::write(file, text.as_bytes()).map_err(|e| CampaignError::File {
        file: file.display().to_string(),
        found: e.to_string(),
        expected: "a file that can be written",
    })
}

/// Returns the current date in UTC: days since 1970 as a date of the Gregorian calendar.
fn today() -> String {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    let days = (since.as_secs() / 86_400) as i64 + 719_468;
    let era = days.div_euclid(146_097);
    let day = days.rem_euclid(146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let remainder = day - (365 * year + year / 4 - year / 100);
    let month = (5 * remainder + 2) / 153;
    let (d, m) = (remainder - (153 * month + 2) / 5 + 1, if month < 10 { month + 3 } else { month - 9 });
    format!("{:04}-{m:02}-{d:02}", year + era * 400 + i64::from(m <= 2))
}
