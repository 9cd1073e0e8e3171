//! `host-sim schema`: JSON schemas of the results that the commands print and write.

use super::{describe, laws, record};
use crate::cli::error::CliError;
use crate::cli::output;
use crate::cli::provenance::Stamped;
use crate::compare::Comparison;
use crate::run::mechanism::MechanismSummary;
use crate::run::slider_crank::SliderCrankSummary;
use crate::run::summary::Summary;
use crate::serve::event::Event;
use crate::validation::Cases;
use crate::{accuracy, fmu, life, logs, reproduction, shard, sweep};
use clap::Args;
use clap::builder::PossibleValuesParser;
use diagnosis::{Diagnosis, Evaluation, Inspection};
use schemars::generate::{SchemaGenerator, SchemaSettings};
use schemars::transform::{Transform, transform_subschemas};
use schemars::{JsonSchema, Schema};
use serde_json::json;

/// Name of a schema, result that it describes, and the schema.
type Entry = (&'static str, &'static str, fn() -> Schema);

/// All schemas.
const ALL: [Entry; 24] = [
    ("accuracy", "accuracy: accuracy.json", stamped::<accuracy::Outcome>),
    ("accuracy-worlds", "accuracy --worlds: worlds.json", stamped::<accuracy::worlds::Outcome>),
    ("check", "check: check.json", stamped::<Inspection>),
    ("claims", "claims: claims.json", schema_of::<reproduction::campaign::report::Outcome>),
    ("compare", "compare: comparison.json", stamped::<Comparison>),
    ("describe", "describe --json", schema_of::<describe::Described>),
    ("diagnose", "diagnose: diagnosis.json", stamped::<Diagnosis>),
    ("evaluate", "evaluate: evaluation.json", stamped::<Evaluation>),
    ("export-fmu", "export-fmu --json", schema_of::<fmu::export::Exported>),
    (
        "figures",
        "figures, sweep clearance, sweep load: sweep.json",
        stamped::<reproduction::report::Outcome<'_>>,
    ),
    ("laws", "laws --json", schema_of::<laws::Laws>),
    ("life", "life: life.json", stamped::<life::Outcome>),
    ("log-convert", "log convert --json", schema_of::<logs::convert::Converted>),
    ("log-info", "log info --json", schema_of::<logs::LogInfo>),
    ("record", "record --json", schema_of::<record::Written>),
    ("run", "run: run.json", stamped::<Summary>),
    ("run-mechanism", "run of a mechanism: run.json", stamped::<MechanismSummary>),
    ("run-slider-crank", "run --bench slider-crank: run.json", stamped::<SliderCrankSummary>),
    ("serve", "run --serve: an event of the stream", schema_of::<Event>),
    ("shard", "sweep --shard, claims --shard", schema_of::<shard::Outcome>),
    ("sweep-file", "sweep FILE: sweep.json", schema_of::<sweep::file::Outcome<'_>>),
    ("sweep-latch", "sweep latch: sweep.json", stamped::<sweep::latch::Outcome>),
    ("sweep-step", "sweep step: sweep.json", stamped::<sweep::step::Outcome>),
    ("validate", "validate: validate.json", schema_of::<Cases>),
];

/// Arguments of `host-sim schema`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim schema\n  host-sim schema diagnose > diagnose.schema.json")]
pub struct SchemaArgs {
    /// The schema; without a name all names are listed.
    #[arg(value_name = "NAME", value_parser = PossibleValuesParser::new(ALL.map(|entry| entry.0)))]
    pub name: Option<String>,
}

/// Runs the command.
pub fn run(args: &SchemaArgs) -> Result<(), CliError> {
    let Some(name) = &args.name else {
        ALL.iter().for_each(|(name, result, _)| print_line!("{name:<18} {result}"));
        return Ok(());
    };
    for (_, result, schema) in ALL.iter().filter(|entry| entry.0 == name) {
        let mut schema = schema();
        schema.insert("title".into(), json!(format!("Result of host-sim {result}")));
        print_result!("{}", output::json(&schema)?);
    }
    Ok(())
}

fn schema_of<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize().with_transform(NullNumbers);
    SchemaGenerator::new(settings).into_root_schema_for::<T>()
}

/// Schema of a result that is written with its origin.
fn stamped<T: JsonSchema>() -> Schema {
    let mut schema = schema_of::<Stamped<'_, T>>();
    if let Some(description) = schema_of::<T>().remove("description") {
        schema.insert("description".into(), description);
    }
    schema
}

/// Allows null for every number: JSON has no infinity, so an unbounded number is written as null.
#[derive(Clone, Debug)]
struct NullNumbers;

impl Transform for NullNumbers {
    fn transform(&mut self, schema: &mut Schema) {
        if let Some(kind) = schema.get_mut("type").filter(|kind| **kind == "number") {
            *kind = json!(["number", "null"]);
        }
        transform_subschemas(self, schema);
    }
}
