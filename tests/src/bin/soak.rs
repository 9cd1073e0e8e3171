//! Command line of the soak; `cargo xtask soak` builds the image and runs it.

use clap::Parser;
use clap::builder::TypedValueParser;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::PathBuf;
use std::process::ExitCode;
use system_tests::faults::{CampaignError, exit};
use system_tests::soak::{Plan, SoakResult, soak};

/// Compare the emulated controller with the host's over many samples: equal bits, no late tick,
/// constant memory.
#[derive(Parser)]
#[command(after_help = "Examples:\n  cargo xtask soak\n  cargo xtask soak --ticks 10000000 --json\n  \
    cargo xtask soak --sequence 4294960000 --time-us 4294000000\n\n\
    Exit codes: 0 passed, 1 failed or the work failed, 2 the arguments are wrong.")]
struct Cli {
    /// Number of samples.
    #[arg(long, default_value_t = 100_000, value_parser = ticks())]
    ticks: u64,
    /// Seed of the sensor noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Sequence number of the first sample.
    #[arg(long, default_value_t = u32::MAX - 20_000)]
    sequence: u32,
    /// Time of the first sample, us.
    #[arg(long, default_value_t = u32::MAX - 3_000_000)]
    time_us: u32,
    /// Firmware image.
    #[arg(long, value_name = "FILE")]
    elf: Option<PathBuf>,
    /// Print the result as JSON.
    #[arg(long)]
    json: bool,
}

/// Returns the parser of the number of samples.
fn ticks() -> impl TypedValueParser<Value = u64> {
    clap::value_parser!(u64).range(10..=1_000_000_000_000)
}

fn main() -> ExitCode {
    exit(run(&Cli::parse()))
}

/// Runs the soak; returns whether it passed.
fn run(cli: &Cli) -> Result<bool, CampaignError> {
    let elf = cli.elf.clone().unwrap_or_else(host_sim::controller::EmulatedController::default_elf);
    let expected = "the image that `cargo xtask firmware` builds";
    let elf = elf.canonicalize().map_err(|_| CampaignError::Image { path: elf, expected })?;
    let bar = if cli.json { ProgressBar::hidden() } else { ProgressBar::new(cli.ticks) };
    if let Ok(style) = ProgressStyle::with_template("{pos}/{len} {bar:40} {elapsed} eta {eta} {per_sec}") {
        bar.set_style(style);
    }
    let plan = Plan { ticks: cli.ticks, seed: cli.seed, sequence: cli.sequence, time_us: cli.time_us };
    let result = soak(&elf, &plan, |ticks| bar.inc(ticks))?;
    bar.finish_and_clear();
    if cli.json {
        println!("{}", serde_json::to_string_pretty(&result).unwrap_or_default());
    } else {
        print!("{}", table(&result));
    }
    Ok(result.has_passed())
}

fn table(result: &SoakResult) -> String {
    let mebibytes = |bytes: u64| bytes as f64 / f64::from(1 << 20);
    format!(
        "samples                    {} ({:.0} a second)\n\
         wraps of number and time   {}, {}\n\
         bit differences            {}\n\
         deadline misses            {}\n\
         instructions of a tick     {} to {}\n\
         marked estimates           {}\n\
         same reports at the end    {}\n\
         growth, host and emulator  {:.2} MiB, {:.2} MiB\n",
        result.ticks,
        result.ticks_per_s,
        result.sequence_wraps,
        result.time_wraps,
        result.bit_differences,
        result.deadline_misses,
        result.instructions_per_tick_min,
        result.instructions_per_tick_max,
        result.marked,
        result.same_reports,
        mebibytes(result.host_growth_bytes),
        mebibytes(result.emulator_growth_bytes),
    )
}
