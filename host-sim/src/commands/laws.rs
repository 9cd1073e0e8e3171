//! `host-sim laws`: lists the contact and friction laws of a bench description, with range and
//! source.

use crate::cli::error::CliError;
use crate::cli::output;
use clap::Args;
use contact::catalogue::{self, Group};
use schemars::JsonSchema;
use serde::Serialize;

/// Arguments of `host-sim laws`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim laws\n  host-sim laws --json")]
pub struct LawsArgs {
    /// Print the laws as JSON.
    #[arg(long)]
    pub json: bool,
}

/// One law.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Law {
    /// Field of the description that takes the name.
    field: &'static str,
    name: &'static str,
    description: &'static str,
    range: &'static str,
    source: &'static str,
    /// True if a bench can be integrated with it.
    on_a_bench: bool,
    /// The only plants that integrate it; null if every plant with such a law does.
    only_on: Option<&'static str>,
}

#[derive(Serialize, JsonSchema)]
pub(crate) struct Laws {
    laws: Vec<Law>,
}

/// Runs the command.
pub fn run(args: &LawsArgs) -> Result<(), CliError> {
    let law = |entry: catalogue::Entry| Law {
        field: match entry.group {
            Group::Dissipation => "contact.dissipation",
            Group::Stiffness => "contact.stiffness",
            Group::Complete => "contact.law",
            Group::Friction => "friction.law",
        },
        name: entry.name,
        description: entry.description,
        range: entry.range,
        source: entry.source,
        on_a_bench: true,
        only_on: if entry.group == Group::Friction { bench::sticking_plants(entry.name) } else { None },
    };
    let laws = Laws { laws: catalogue::all().map(law).collect() };
    if args.json {
        print_result!("{}", output::json(&laws)?);
        return Ok(());
    }
    let mut field = "";
    for law in &laws.laws {
        if law.field != field {
            field = law.field;
            print_line!("{field}");
        }
        print_line!("  {:<34} {}", law.name, law.description);
        print_line!("  {:<34} holds: {}", "", law.range);
        print_line!("  {:<34} source: {}", "", law.source);
        if let Some(plants) = law.only_on {
            print_line!("  {:<34} sticks and slides, on {plants}", "");
        }
    }
    Ok(())
}
