//! Commands of the workspace: setup, tests, instruction counts, sizes, campaigns. CI calls nothing
//! else.

mod accuracy;
mod archive;
mod board_tables;
mod book;
mod budget;
mod c_check;
mod c_library;
mod campaigns;
mod compile;
mod cores;
mod counts;
mod cycles;
mod document;
mod environment;
mod firmware;
mod flash;
mod fmu;
mod golden;
mod insn;
mod kernels;
mod language;
mod memory_map;
mod miri;
mod on_target;
mod published_faults;
mod python;
mod readme;
mod run;
mod seal;
mod sensitivity;
mod setup;
mod size;
mod stack;
mod table;
mod tally;
mod test;
mod test_programs;
mod verify;
mod workspace;

use clap::{Parser, Subcommand};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// Commands of the Pintle workspace.
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
    /// Install missing tools: the controller's target and the emulator.
    Setup,
    /// Set up, build the firmware and run all tests, including those on the emulator.
    Test {
        /// Also run the ignored tests: some 20 minutes more on two cores.
        #[arg(long)]
        long: bool,
    },
    /// Build the firmware's image for a board.
    Firmware {
        /// Name of the board, as in `docs/firmware.md`; `stm32f405` serves every board with that
        /// microcontroller.
        #[arg(long, default_value = "stm32f405", value_parser = firmware::parse_board)]
        board: firmware::Firmware,
        /// Include faults on demand for the emulator's tests; never for a bench.
        #[arg(long)]
        provoke: bool,
        /// Build for delivery: refuse a firmware that trusts the published development key.
        #[arg(long, conflicts_with = "provoke")]
        release: bool,
    },
    /// Compare the kernels of every emulated core with those of the host, bit for bit.
    Kernels,
    /// Check the language rules: words, line widths, functions; see `xtask/README.md`.
    Language {
        /// Files or folders to check; default: the complete workspace.
        paths: Vec<PathBuf>,
        /// Print one count for each file instead of one line for each departure.
        #[arg(long)]
        by_file: bool,
    },
    /// Run the tests of the crate `inference` under Miri (nightly toolchain).
    Miri,
    /// Build the static library for C, for the default controller and for this machine.
    CLibrary {
        /// Compile programs in C against the package of `model-quant generate c`, run them here and
        /// on the emulated controller, and compare their bits with Rust.
        #[arg(long)]
        check: bool,
    },
    /// Build the library of exported units (FMI) for every platform whose target is installed.
    FmuLibrary {
        /// Export units, validate them with FMPy, and run them in FMPy and libcosim.
        #[arg(long)]
        check: bool,
    },
    /// Build the wheel of the Python package with maturin, and print its path.
    Wheel {
        /// Check the package instead: install a wheel in a fresh virtual environment, and run its
        /// tests, types and notebooks.
        #[arg(long)]
        check: bool,
    },
    /// Verify the shipped model images against laws, float networks and other runtimes.
    Verify,
    /// Write the tables of boards and constants; measure and write the golden figures, their tables
    /// and the README's run.
    Bless,
    /// Count instructions of the reference network, its layers and a controller tick.
    Insn {
        /// Print as JSON.
        #[arg(long)]
        json: bool,
    },
    /// Price traces of ticks, the timer's handler and the networks in cycles of Cortex-M4 and M7.
    Cycles {
        /// Print as JSON.
        #[arg(long)]
        json: bool,
        /// Price another image instead, linked to the flash of an STM32F405: the instructions
        /// between its first two reads of SysTick's counter.
        #[arg(long, value_name = "ELF", conflicts_with = "json")]
        image: Option<PathBuf>,
    },
    /// Halve and double the tuned constants of the diagnosis, and record the tests that fail.
    ///
    /// Takes about a minute for each constant. A stopped run continues.
    Sensitivity {
        /// Modules of the diagnosis; default: all
        #[arg(value_name = "MODULE")]
        #[arg(value_parser = sensitivity::MODULES, default_values = sensitivity::MODULES)]
        modules: Vec<String>,
    },
    /// Measure the accuracy in 160 drawn worlds and compare it with the golden figures; minutes.
    Accuracy {
        /// Write golden figures and documents instead.
        #[arg(long)]
        bless: bool,
    },
    /// Build the documentation site in `target/book` with mdBook, and check its links.
    Book,
    /// Build the release archive: programs, firmware, completions, manual pages, documents. Needs
    /// `PINTLE_MODEL_KEY`.
    Archive,
    /// Campaigns and programs of the tests.
    #[command(flatten)]
    Board(BoardCommand),
    #[command(flatten)]
    Campaign(Campaign),
}

/// Campaigns and programs of the tests, with options of their own.
#[derive(Subcommand)]
enum Campaign {
    /// Hide effects in generated logs and report how well the diagnosis finds them.
    #[command(disable_help_flag = true)]
    HiddenEffects {
        /// See `cargo xtask hidden-effects --help`.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Write a log with a hidden effect for you to find, and show its label later.
    #[command(disable_help_flag = true)]
    Mystery {
        /// See `cargo xtask mystery --help`.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Inject seeded faults into the emulated controller and classify the reactions.
    #[command(disable_help_flag = true)]
    Faults {
        /// See `cargo xtask faults --help`.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Compare the emulated controller with the host's over many samples, bit for bit.
    #[command(disable_help_flag = true)]
    Soak {
        /// See `cargo xtask soak --help`.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
}

/// Commands about one board.
#[derive(Subcommand)]
enum BoardCommand {
    /// Build the firmware image and write it to a board, or check what would be written.
    Flash(flash::FlashArgs),
    /// Run the tests that need a board, through a probe; without one, only build them.
    OnTarget(on_target::OnTargetArgs),
    /// Report the static bound and the emulated high-water mark of the stack.
    Stack {
        /// Name of the board; only the image of the default one is run.
        #[arg(long, default_value = "stm32f405", value_parser = firmware::parse_board)]
        board: firmware::Firmware,
        /// Print as JSON.
        #[arg(long)]
        json: bool,
    },
    /// Report flash, RAM and stack of the image, and whether it contains a reachable panic.
    Size {
        /// Name of the board.
        #[arg(long, default_value = "stm32f405", value_parser = firmware::parse_board)]
        board: firmware::Firmware,
        /// Print as JSON.
        #[arg(long)]
        json: bool,
    },
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Setup => setup::setup().map(|_| ()),
        Command::Test { long } => test::test(long),
        Command::Firmware { board, provoke, release } => {
            firmware::image(board, provoke, release).map(|elf| print_path(&elf))
        }
        Command::Language { paths, by_file } => language::language(&paths, by_file),
        Command::Miri => miri::miri(),
        Command::CLibrary { check } => c_check::build_or_check(check),
        Command::FmuLibrary { check } => fmu::build_or_check(check),
        Command::Accuracy { bless } => accuracy::measure(bless),
        Command::Wheel { check } => python::build_or_check(check),
        Command::Verify => verify::verify(),
        Command::Kernels => kernels::kernels(),
        Command::Bless => bless(),
        Command::Insn { json } => insn::insn(json),
        Command::Cycles { json, image } => {
            image.map_or_else(|| cycles::cycles(json), |image| cycles::image(&image))
        }
        Command::Sensitivity { modules } => sensitivity::sensitivity(&modules),
        Command::Book => book::book().map(|page| print_path(&page)),
        Command::Archive => archive::archive().map(|path| print_path(&path)),
        Command::Board(command) => run_board(&command),
        Command::Campaign(campaign) => return exit(run_campaign(&campaign)),
    };
    exit(result.map(|()| ExitCode::SUCCESS))
}

/// Runs a command about a board.
fn run_board(command: &BoardCommand) -> Result<(), run::ChoreError> {
    match command {
        BoardCommand::Flash(args) => flash::flash(args),
        BoardCommand::OnTarget(args) => on_target::on_target(args),
        BoardCommand::Stack { board, json } => stack::stack(*board, *json),
        BoardCommand::Size { board, json } => size::size(*board, *json),
    }
}

/// Runs a campaign and returns the exit code of its program.
fn run_campaign(campaign: &Campaign) -> Result<ExitCode, run::ChoreError> {
    match campaign {
        Campaign::Faults { arguments } => campaigns::emulated("faults", arguments),
        Campaign::Soak { arguments } => campaigns::emulated("soak", arguments),
        Campaign::HiddenEffects { arguments } => campaigns::computed("hidden_effects", arguments),
        Campaign::Mystery { arguments } => campaigns::computed("mystery", arguments),
    }
}

fn print_path(path: &std::path::Path) {
    println!("{}", path.display());
}

/// Writes all golden figures and the blocks of documents.
fn bless() -> Result<(), run::ChoreError> {
    board_tables::bless()?;
    sensitivity::bless()?;
    golden::bless()?;
    cycles::bless()?;
    budget::bless()?;
    accuracy::write_documents()?;
    published_faults::bless()?;
    readme::bless()
}

/// Returns the exit code of a command and prints the error, if any.
fn exit(result: Result<ExitCode, run::ChoreError>) -> ExitCode {
    match result {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Cli;
    use clap::Parser;

    #[test]
    fn the_commands_in_the_documents_are_accepted() {
        let path = |name: &str| crate::run::root().join(name);
        let pages = std::fs::read_dir(path("docs")).unwrap().map(|entry| entry.unwrap().path());
        let readmes =
            ["README.md", "CONTRIBUTING.md", "firmware/README.md", "tests/README.md", "xtask/README.md"];
        let documents =
            pages.filter(|path| path.extension().is_some_and(|e| e == "md")).chain(readmes.map(path));
        let texts: Vec<String> = documents.map(|path| std::fs::read_to_string(path).unwrap()).collect();
        // Lines of code blocks: every other part between fences.
        let blocks = texts.iter().flat_map(|text| text.split("```").skip(1).step_by(2));
        let commands: Vec<&str> = blocks
            .flat_map(str::lines)
            .filter_map(|line| line.trim().trim_start_matches("$ ").strip_prefix("cargo xtask "))
            .filter_map(|line| line.split(" #").next())
            .collect();
        assert!(commands.len() >= 20, "{commands:?}");
        for command in commands {
            let words = std::iter::once("xtask").chain(command.split_whitespace());
            let parsed = Cli::try_parse_from(words);
            assert!(parsed.is_ok(), "{command}: {:?}", parsed.err());
        }
    }
}
