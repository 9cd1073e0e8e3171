//! The soak from the command line; `cargo xtask soak` builds the image and runs it.

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::PathBuf;
use std::process::ExitCode;
use system_tests::faults::{CampaignError, exit};
use system_tests::soak::{Plan, Soaked, soak};

/// The emulated controller beside this process's for many samples: the same bits, in time, in flat memory.
#[derive(Parser)]
#[command(after_help = "Examples:\n  cargo xtask soak\n  cargo xtask soak --ticks 10000000 --json\n  \
    cargo xtask soak --sequence 4294960000 --time-us 4294000000\n\n\
    Exit codes: 0 sound, 1 not sound or the work failed, 2 the arguments are wrong.")]
struct Cli {
    /// How many samples.
    #[arg(long, default_value_t = 100_000, value_parser = clap::value_parser!(u64).range(10..=1_000_000_000_000))]
    ticks: u64,
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Sequence number of the first sample.
    #[arg(long, default_value_t = u32::MAX - 20_000)]
    sequence: u32,
    /// Time of the first sample, us.
    #[arg(long, default_value_t = u32::MAX - 3_000_000)]
    time_us: u32,
    /// The firmware's image.
    #[arg(long, value_name = "FILE")]
    elf: Option<PathBuf>,
    /// Print the outcome as JSON.
    #[arg(long)]
    json: bool,
}

fn main() -> ExitCode {
    exit(run(&Cli::parse()))
}

/// Runs the soak; whether it was sound.
fn run(cli: &Cli) -> Result<bool, CampaignError> {
    let elf = cli.elf.clone().unwrap_or_else(host_sim::controller::EmulatedController::default_elf);
    let expected = "the image that `cargo xtask firmware` builds";
    let elf = elf.canonicalize().map_err(|_| CampaignError::Image { path: elf, expected })?;
    let bar = if cli.json { ProgressBar::hidden() } else { ProgressBar::new(cli.ticks) };
    if let Ok(style) = ProgressStyle::with_template("{pos}/{len} {bar:40} {elapsed} eta {eta} {per_sec}") {
        bar.set_style(style);
    }
    let plan = Plan { ticks: cli.ticks, seed: cli.seed, sequence: cli.sequence, time_us: cli.time_us };
    let soaked = soak(&elf, &plan, |ticks| bar.inc(ticks))?;
    bar.finish_and_clear();
    if cli.json {
        println!("{}", serde_json::to_string_pretty(&soaked).unwrap_or_default());
    } else {
        print!("{}", table(&soaked));
    }
    Ok(soaked.is_sound())
}

fn table(soaked: &Soaked) -> String {
    let mebibytes = |bytes: u64| bytes as f64 / f64::from(1 << 20);
    format!(
        "samples                    {} ({:.0} a second)\n\
         numbers, times gone round  {}, {}\n\
         bit differences            {}\n\
         deadline misses            {}\n\
         instructions of a tick     {} to {}\n\
         marked estimates           {}\n\
         same reports at the end    {}\n\
         growth, host and emulator  {:.2} MiB, {:.2} MiB\n",
        soaked.ticks,
        soaked.ticks_per_s,
        soaked.sequence_wraps,
        soaked.time_wraps,
        soaked.bit_differences,
        soaked.deadline_misses,
        soaked.instructions_per_tick_min,
        soaked.instructions_per_tick_max,
        soaked.marked,
        soaked.same_reports,
        mebibytes(soaked.host_growth_bytes),
        mebibytes(soaked.emulator_growth_bytes),
    )
}
