//! `model-quant report`: the training report.

use super::{CliError, bearings, checkpoint, parse_bearing, print, print_json};
use inference::Bearing;
use model_quant::claims::training::TrainingFacts;
use model_quant::claims::{friction, torque, training};
use model_quant::training_report::companding::Comparison;
use model_quant::training_report::facts::BearingFacts;
use model_quant::training_report::history::History;
use model_quant::training_report::page::{Contents, goal_rows, lead, report};
use model_quant::training_report::rig::RigFacts;
use model_quant::write::{check_directory, write_whole};
use std::path::PathBuf;

/// Write the training report: the paper's Figs. 10 to 13, errors against the goals, claims 12 to 15, quantisation loss
///
/// A goal that is not met is an outcome, not a failure: the exit code is 0.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant report --out out/training\n  \
                        model-quant train --bearing plastic --out out && \
                        model-quant report --checkpoint out/plastic.float --out out/training\n  \
                        model-quant train --friction rig --bearing plastic --out out && \
                        model-quant report --rig out/plastic.rig.json --out out/training")]
pub(crate) struct Arguments {
    /// Bearing: babbitt or plastic; both if not given
    #[arg(long, value_parser = parse_bearing, conflicts_with = "checkpoint")]
    bearing: Option<Bearing>,
    /// Float checkpoint; the checked-in ones if not given
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// BEARING.history.json of a training, or the output of `model-quant train --json`; may be given once a bearing. The one
    /// beside a checkpoint and those of the checked-in ones are taken without it
    #[arg(long, value_name = "FILE")]
    history: Vec<PathBuf>,
    /// BEARING.rig.json of `model-quant train --friction rig`: prediction against experiment (Fig. 11); may be given once a
    /// bearing
    #[arg(long, value_name = "FILE")]
    rig: Vec<PathBuf>,
    /// What the example `companding` printed; may be given once a bearing
    #[arg(long, value_name = "FILE")]
    companding: Vec<PathBuf>,
    /// Folder for report.html, report.json and the pictures (SVG)
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
}

/// The history of a checkpoint: one that was given, or the checked-in one.
fn history(
    given: &mut Vec<(PathBuf, History)>,
    bearing: Bearing,
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
    if let Some(beside) = arguments.checkpoint.as_ref().map(|path| path.with_extension("history.json"))
        && beside.exists()
    {
        let history = History::read(&beside)?;
        // It may have been given, too.
        if histories.iter().all(|(_, given)| given.training_id != history.training_id) {
            histories.push((beside, history));
        }
    }
    let companding: Result<Vec<_>, _> =
        arguments.companding.iter().map(|path| Comparison::read(path)).collect();
    let companding = companding?;
    let chosen =
        if arguments.checkpoint.is_some() { vec![Bearing::Babbitt] } else { bearings(arguments.bearing) };
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
    // What can be refused has been; from here on it takes its time.
    check_directory(&arguments.out)?;
    let rigs: Result<Vec<_>, _> = arguments.rig.iter().map(|path| RigFacts::read(path)).collect();
    let rigs = rigs?;
    let mut networks = Vec::new();
    for (checkpoint, training_id, history) in trainings {
        networks.push(BearingFacts::of(&checkpoint, training_id, history)?);
    }
    let mut claims = friction::judge(&torque::of_rigs()?);
    let trainings = networks.iter().filter_map(|facts| facts.history.as_ref());
    claims.push(training::judge(&trainings.flat_map(TrainingFacts::of).collect::<Vec<_>>()));
    let contents = Contents { networks, rigs, companding, claims };
    let made = report(&contents)?;
    let text = serde_json::to_string_pretty(&contents)?;
    for picture in &made.pictures {
        write_whole(&arguments.out.join(format!("{}.svg", picture.name)), picture.svg.as_bytes())?;
    }
    write_whole(&arguments.out.join("report.json"), format!("{text}\n").as_bytes())?;
    let file = arguments.out.join("report.html");
    write_whole(&file, made.page.render().as_bytes())?;
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
