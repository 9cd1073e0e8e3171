//! Workspace chores: set-up, tests, instruction counts, sizes. CI calls nothing else.

mod boards;
mod budget;
mod campaigns;
mod compile;
mod firmware;
mod flash;
mod golden;
mod insn;
mod kernels;
mod miri;
mod run;
mod seal;
mod setup;
mod size;
mod stack;
mod table;
mod test;
mod verify;

use clap::{Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;

/// Chores of the Pintle workspace.
#[derive(Parser)]
#[command(
    after_help = "Examples:\n  cargo xtask test\n  cargo xtask firmware\n  cargo xtask insn --json\n\n\
    Exit codes: 0 done, 1 the work failed, 2 the arguments are wrong."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Install what is missing: the controller's target and the emulator.
    Setup,
    /// Set up, build the firmware, run every test, the emulated ones included.
    Test,
    /// Build the firmware's image for a board.
    Firmware {
        /// The board: stm32f405 (any of them), feather-stm32f405, olimex-stm32-h405, netduino-plus-2, mps2-an505.
        #[arg(long, default_value = "stm32f405", value_parser = firmware::board)]
        board: firmware::Board,
        /// With faults on demand, for the emulator's tests; never for a bench.
        #[arg(long)]
        provoke: bool,
    },
    /// Compare the kernels of every emulated core with the host's, bit for bit.
    Kernels,
    /// Run the inference crate's tests under Miri (nightly toolchain).
    Miri,
    /// Verify the shipped images against laws, float networks, other runtimes and the emulated core.
    Verify,
    /// Count anew and write the golden figures and the README's tables.
    Bless,
    /// Hide effects in logs of independent generators and tell how well the diagnosis finds them (its own `--help` tells more).
    #[command(disable_help_flag = true)]
    HiddenEffects {
        /// As `cargo xtask hidden-effects --help` says.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Deal a log that hides an effect, for you to find, and open its label afterwards (its own `--help` tells more).
    #[command(disable_help_flag = true)]
    Mystery {
        /// As `cargo xtask mystery --help` says.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Instructions of the reference network, the layers and a controller tick, from the emulator.
    Insn {
        /// Print as JSON.
        #[arg(long)]
        json: bool,
    },
    /// Build the firmware's image and write it to a board, or check what would be written.
    Flash(flash::FlashArgs),
    /// Static bound and emulated high-water mark of the stack.
    Stack {
        /// Print as JSON.
        #[arg(long)]
        json: bool,
    },
    /// Disturb the emulated controller with seeded faults and class what the host gets to hear (its own `--help` tells more).
    #[command(disable_help_flag = true)]
    Faults {
        /// As `cargo xtask faults --help` says.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Run the emulated controller beside the host's for many samples and compare every bit.
    #[command(disable_help_flag = true)]
    Soak {
        /// As `cargo xtask soak --help` says.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Flash, RAM and stack of the image, and whether it contains a reachable panic.
    Size {
        /// Print as JSON.
        #[arg(long)]
        json: bool,
    },
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Setup => setup::setup().map(|_| ()),
        Command::Test => test::test(),
        Command::Firmware { board, provoke } => if provoke { board.build_provoking() } else { board.build() }
            .map(|elf| println!("{}", elf.display())),
        Command::Miri => miri::miri(),
        Command::Verify => verify::verify(),
        Command::Kernels => kernels::kernels(),
        Command::Bless => golden::bless().and_then(|()| budget::bless()),
        Command::Insn { json } => insn::insn(json),
        Command::Flash(args) => flash::flash(&args),
        Command::Stack { json } => stack::stack(json),
        Command::Size { json } => size::size(json),
        Command::Faults { arguments } => return exit(campaigns::emulated("faults", &arguments)),
        Command::Soak { arguments } => return exit(campaigns::emulated("soak", &arguments)),
        Command::HiddenEffects { arguments } => {
            return exit(campaigns::computed("hidden_effects", &arguments));
        }
        Command::Mystery { arguments } => return exit(campaigns::computed("mystery", &arguments)),
    };
    exit(result.map(|()| ExitCode::SUCCESS))
}

/// The exit code of a chore; what failed is told.
fn exit(result: Result<ExitCode, run::ChoreError>) -> ExitCode {
    match result {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
