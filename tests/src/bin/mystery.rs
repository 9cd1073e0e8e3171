//! Command line of `cargo xtask mystery`: writes a log with a hidden effect to diagnose, and shows
//! its label later.

use clap::{Parser, ValueEnum};
use std::path::PathBuf;
use std::process::ExitCode;
use system_tests::generator::plant::Plant;
use system_tests::hidden_effects::CampaignError;
use system_tests::hidden_effects::mystery::{BENCH, LOG, deal, reveal};

/// Plant of the log.
#[derive(Clone, Copy, ValueEnum)]
enum PlantChoice {
    /// Cylinder with its force.
    Linear,
    /// Friction rig with its torques.
    Rotary,
    /// Transmission bench.
    Bench,
    /// Transmission bench with a shaft that may tilt in its bearing.
    TwoPlane,
}

/// Write a log that hides an effect, or show the label of one that has been diagnosed.
#[derive(Parser)]
#[command(
    name = "mystery",
    after_help = "Examples:\n  cargo xtask mystery --seed 7 --out out/mystery\n  \
    cargo run --release -p host-sim -- diagnose out/mystery/log.csv \\\n    \
    --bench out/mystery/bench.toml --out out/mystery\n  \
    cargo xtask mystery --reveal out/mystery\n\n\
    Exit codes: 0 done, 1 the work failed, 2 the arguments are wrong."
)]
struct Cli {
    /// Plant of the log.
    #[arg(long, value_enum, default_value = "linear")]
    plant: PlantChoice,
    /// Seed of the log.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Size of the effect: rms of the part that calibration cannot absorb, over the rms of the
    /// noise.
    #[arg(long, default_value_t = 1.0)]
    size: f64,
    /// Folder of the log, the description and the label.
    #[arg(long, default_value = "out/mystery")]
    out: PathBuf,
    /// Show the label of a folder that has a diagnosis.
    #[arg(long, value_name = "DIR")]
    reveal: Option<PathBuf>,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    if !(0.01..=100.0).contains(&cli.size) {
        eprintln!("error: --size: found {}; expected 0.01 to 100", cli.size);
        return ExitCode::from(2);
    }
    match run(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error @ CampaignError::NoDiagnosis { .. }) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(cli: &Cli) -> Result<(), CampaignError> {
    if let Some(folder) = &cli.reveal {
        let label = reveal(folder)?;
        if label.effects.is_empty() {
            println!("the log hides no effect");
        }
        for (effect, size) in label.effects.iter().zip(&label.sizes) {
            let of = effect.channel.as_ref().map_or_else(String::new, |channel| format!(" of {channel}"));
            println!("the log hides {}{of}, size {size}:", effect.effect);
            effect.parameters.iter().for_each(|(name, value)| println!("  {name} = {value:.4e}"));
        }
        return Ok(());
    }
    let plant = match cli.plant {
        PlantChoice::Linear => Plant::Linear,
        PlantChoice::Rotary => Plant::Rotary,
        PlantChoice::Bench => Plant::Bench,
        PlantChoice::TwoPlane => Plant::TwoPlane,
    };
    deal(&cli.out, plant, cli.size, cli.seed)?;
    println!("{}", cli.out.join(LOG).display());
    println!("{}", cli.out.join(BENCH).display());
    Ok(())
}
