//! `model-quant report`: writes the training report.

use crate::cli::checkpoint::{BearingParser, bearings, checkpoint};
use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::file_io::{check_directory, write_atomically};
use crate::report::claims::training::TrainingFacts;
use crate::report::claims::{friction, torque, training};
use crate::report::training::companding::Comparison;
use crate::report::training::facts::BearingFacts;
use crate::report::training::page::{Contents, goal_rows, lead, report};
use crate::report::training::rig::RigFacts;
use crate::train::history::History;
use inference::BearingMaterial;
use std::path::PathBuf;

/// Write the training report: the paper's Figs. 10 to 13, errors against the goals, claims 12 to
/// 15, quantisation errors
///
/// A missed goal is a result, not a failure: the exit code is 0.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant report --out out/training\n  \
                        model-quant train --bearing plastic --out out && \
                        model-quant report --checkpoint out/plastic.float --out out/training\n  \
                        model-quant train --friction rig --bearing plastic --out out && \
                        model-quant report --rig out/plastic.rig.json --out out/training")]
pub(crate) struct Arguments {
    /// Bearing material; all if not given
    #[arg(long, value_parser = BearingParser, conflicts_with = "checkpoint")]
    bearing: Option<BearingMaterial>,
    /// Float checkpoint; the shipped ones if not given
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// BEARING.history.json of a training, or the output of `model-quant train --json`; may be
    /// repeated, once for each bearing. The history next to a checkpoint and those of the shipped
    /// ones are found without it
    #[arg(long, value_name = "FILE")]
    history: Vec<PathBuf>,
    /// BEARING.rig.json of `model-quant train --friction rig`: prediction against experiment (Fig.
    /// 11); may be repeated, once for each bearing
    #[arg(long, value_name = "FILE")]
    rig: Vec<PathBuf>,
    /// Output of the example `companding`; may be repeated, once for each bearing
    #[arg(long, value_name = "FILE")]
    companding: Vec<PathBuf>,
    /// Output directory for report.html, report.json and the pictures (SVG)
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
}

/// History of a checkpoint: from the given files, else that of the shipped checkpoint.
fn history(
    given: &mut Vec<(PathBuf, History)>,
    bearing: BearingMaterial,
    training_id: u64,
) -> Result<Option<History>, CliError> {
    let id = format!("{training_id:016x}");
    if let Some(place) = given.iter().position(|(_, history)| history.training_id == id) {
        return Ok(Some(given.swap_remove(place).1));
    }
    Ok(Some(History::shipped(bearing)?).filter(|history| history.training_id == id))
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let mut histories: Vec<(PathBuf, History)> = Vec::new();
    for path in &arguments.history {
        histories.push((path.clone(), History::read(path)?));
    }
    if let Some(path) = arguments.checkpoint.as_ref().map(|path| path.with_extension("history.json"))
        && path.exists()
    {
        let history = History::read(&path)?;
        // The same history may be given as an option, too.
        if histories.iter().all(|(_, given)| given.training_id != history.training_id) {
            histories.push((path, history));
        }
    }
    let companding: Result<Vec<_>, _> =
        arguments.companding.iter().map(|path| Comparison::read(path)).collect();
    let companding = companding?;
    let chosen = if arguments.checkpoint.is_some() {
        vec![BearingMaterial::Babbitt]
    } else {
        bearings(arguments.bearing)
    };
    let mut trainings = Vec::new();
    for bearing in chosen {
        let (checkpoint, training_id) = checkpoint(arguments.checkpoint.as_deref(), bearing)?;
        let history = history(&mut histories, checkpoint.bearing, training_id)?;
        trainings.push((checkpoint, training_id, history));
    }
    if let Some((path, history)) = histories.first() {
        let found = format!("{}: training id {}", path.display(), history.training_id);
        return Err(CliError::Argument("--history", found, "the training of a checkpoint of this report"));
    }
    // All inputs are checked; the long work begins here.
    check_directory(&arguments.out)?;
    let rigs: Result<Vec<_>, _> = arguments.rig.iter().map(|path| RigFacts::read(path)).collect();
    let rigs = rigs?;
    let mut networks = Vec::new();
    for (checkpoint, training_id, history) in trainings {
        networks.push(BearingFacts::measure(&checkpoint, training_id, history)?);
    }
    let mut claims = friction::assess(&torque::measure_rigs()?);
    let trainings = networks.iter().filter_map(|facts| facts.history.as_ref());
    claims.push(training::assess(&trainings.flat_map(TrainingFacts::from_history).collect::<Vec<_>>()));
    let contents = Contents { networks, rigs, companding, claims };
    let made = report(&contents)?;
    let text = serde_json::to_string_pretty(&contents)?;
    for picture in &made.pictures {
        write_atomically(
            &arguments.out.join(format!("{}.svg", picture.name)),
            picture.drawing.svg.as_bytes(),
        )?;
    }
    write_atomically(&arguments.out.join("report.json"), format!("{text}\n").as_bytes())?;
    let file = arguments.out.join("report.html");
    write_atomically(&file, made.page.render().as_bytes())?;
    if arguments.json {
        return print_json(&contents);
    }
    for row in goal_rows(&contents) {
        if let [bearing, network, figure, found, goal, verdict] = row.as_slice() {
            print(format_args!("{bearing:8} {network:13}  {verdict:7}  {figure}: {found}, goal {goal}"))?;
        }
    }
    for claim in &contents.claims {
        print(format_args!("claim {:2}  {}: {}", claim.id, claim.verdict.name(), claim.why))?;
    }
    print(format_args!("{}\nreport: {}", lead(&contents), file.display()))
}
