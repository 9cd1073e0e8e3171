//! Command line of the fault campaign; `cargo xtask faults` builds the image and runs it.

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::PathBuf;
use std::process::ExitCode;
use system_tests::faults::campaign::Campaign;
use system_tests::faults::classify::{Class, Outcome};
use system_tests::faults::publication::{begin, build_of, end};
use system_tests::faults::table::{Counts, Table};
use system_tests::faults::{CampaignError, exit};

/// Seed of a campaign that is not published.
const SEED: u64 = 1;

/// Inject seeded faults into the emulated controller and classify each by what the host receives.
#[derive(Parser)]
#[command(after_help = "Examples:\n  cargo xtask faults\n  \
    cargo xtask faults --publish --count 10000 --record out/faults.jsonl\n  \
    cargo xtask faults --only 4711 --json\n\n\
    Exit codes: 0 no fault was silent, 1 some were or the work failed, 2 the arguments are wrong.")]
struct Cli {
    /// Number of faults.
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    count: u64,
    /// Number of the first fault.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Inject only the fault of this number.
    #[arg(long, conflicts_with_all = ["count", "first", "record"])]
    only: Option<u64>,
    /// Seed of the campaign; by default 1, or a random one with --publish.
    #[arg(long)]
    seed: Option<u64>,
    /// Journal of the outcomes. It holds one image and seed; recorded faults are not repeated.
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Firmware image.
    #[arg(long, value_name = "FILE")]
    elf: Option<PathBuf>,
    /// Faults at the same time; 0: one on each core.
    #[arg(long, default_value_t = 0, value_name = "N")]
    threads: usize,
    /// Write the counts of the default count and seed to tests/golden/faults.json.
    #[arg(long, conflicts_with_all = ["count", "first", "only", "seed", "record", "elf"])]
    bless: bool,
    /// Draw a fresh seed and record the campaign in tests/golden/faults-published.json, for
    /// docs/figures.md (`cargo xtask bless`). To continue an interrupted one give its --seed and
    /// --record.
    #[arg(long, conflicts_with_all = ["first", "only", "bless"])]
    publish: bool,
    /// Print the table as JSON; with --only, the outcome.
    #[arg(long)]
    json: bool,
}

fn main() -> ExitCode {
    exit(run(&Cli::parse()))
}

/// Runs the campaign; returns whether no fault was silent.
fn run(cli: &Cli) -> Result<bool, CampaignError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(cli.threads).build_global();
    pool.map_err(|error| CampaignError::Unexpected { found: error.to_string(), expected: "threads" })?;
    let elf = cli.elf.clone().unwrap_or_else(host_sim::controller::EmulatedController::default_elf);
    let seed = if cli.publish {
        let seed = begin(cli.seed, build_of(&elf)?, cli.count)?;
        eprintln!("seed {seed}");
        seed
    } else {
        cli.seed.unwrap_or(SEED)
    };
    let campaign = Campaign::prepare(&elf, seed)?;
    if let Some(number) = cli.only {
        let outcome = campaign.fault(number)?;
        let text = serde_json::to_string_pretty(&outcome).unwrap_or_default();
        if cli.json {
            println!("{text}")
        } else {
            print!("{}{}", line(&outcome), Table::from_outcomes(std::slice::from_ref(&outcome)).render())
        }
        return Ok(outcome.class != Class::Silent);
    }
    let bar = if cli.json { ProgressBar::hidden() } else { ProgressBar::new(cli.count) };
    if let Ok(style) = ProgressStyle::with_template("{pos}/{len} {bar:40} {elapsed} eta {eta} {msg}") {
        bar.set_style(style);
    }
    let silent = std::sync::atomic::AtomicU64::new(0);
    let outcomes =
        campaign.run(cli.first..cli.first.saturating_add(cli.count), cli.record.as_deref(), |outcome| {
            bar.inc(1);
            if outcome.class == Class::Silent {
                let count = silent.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
                bar.set_message(format!("{count} silent"));
            }
        })?;
    bar.finish_and_clear();
    let table = Table::from_outcomes(&outcomes);
    if cli.bless {
        bless(&Counts::from_table(&table))?;
    }
    if cli.publish {
        end(seed, table.clone())?;
    }
    if cli.json {
        println!("{}", serde_json::to_string_pretty(&table).unwrap_or_default());
    } else {
        let (instructions, addresses) = campaign.traced();
        println!(
            "one sample executes {instructions} instructions at {addresses} addresses\n\n{}",
            table.render()
        );
        for outcome in outcomes.iter().filter(|outcome| outcome.class == Class::Silent) {
            print!("{}", line(outcome));
        }
    }
    Ok(table.all.silent == 0)
}

/// Writes the golden counts of the short campaign.
fn bless(counts: &Counts) -> Result<(), CampaignError> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden/faults.json");
    let text = serde_json::to_string_pretty(counts).unwrap_or_default() + "\n";
    bench::atomic::write(&path, text.as_bytes())
        .map_err(|source| CampaignError::System { what: "writing tests/golden/faults.json", source })
}

/// Formats an outcome as a line.
fn line(outcome: &Outcome) -> String {
    format!(
        "{} {}: {}; {:?}, {} unmarked estimates wrong, {} of them after the first report, \
         error up to {:.1} % of full scale\n",
        outcome.number,
        outcome.kind.name(),
        outcome.what,
        outcome.class,
        outcome.wrong,
        outcome.wrong_after_report,
        100.0 * outcome.error_share
    )
}
