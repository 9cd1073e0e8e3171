//! `model-quant dataset friction`: writes the friction set of a bearing and a picture of its
//! cleaning.

use crate::cli::checkpoint::BearingParser;
use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::cleaning_chart::comparison;
use crate::data::file_io::{check_directory, write_atomically};
use crate::data::friction::{CHANNELS, COLUMNS, DRAWS, FrictionSet, Group, SAMPLES, torque_errors};
use crate::data::friction_source::{from_logs, from_rig, truth_of_rig};
use crate::data::sink::{Format, FormattedRows, Sink, publish};
use crate::data::split::Split;
use inference::BearingMaterial;
use serde_json::json;
use std::path::PathBuf;

/// The friction set of a bearing: groups of the friction rig or measured logs, cleaned, scaled and
/// sampled
///
/// The rig has 20 groups (loads of 0, 100, 150, 200 and 240 kN up and down, both rotation
/// directions), 12/4/4 for training, validation and test. Outliers are replaced by the median
/// around them, and a Gaussian-weighted moving average reduces the noise. `_z` columns are (x -
/// mean)/deviation with mean and deviation of the training groups. Each group gives 5 draws of 2048
/// samples. With --logs every file is a group; --bench defines the names of its columns (`[log]`
/// and `[columns]` of a description).
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant dataset friction --bearing plastic --out sets\n  \
                        model-quant dataset friction --out sets --logs day1.csv day2.csv day3.csv \
                        --bench my-rig.toml\n\n\
                        A log needs t_s, load_force_n, spindle_speed_rad_s and friction_torque_nm and at \
                        least 2048 samples.")]
pub(crate) struct Arguments {
    /// Bearing material
    #[arg(long, value_parser = BearingParser, default_value = "babbitt")]
    bearing: BearingMaterial,
    /// Measured logs in place of the rig, one group a file, at least 3
    #[arg(long, value_name = "FILE", num_args = 1..)]
    logs: Vec<PathBuf>,
    /// Bench description of the rig or of the logs' columns; default: the bearing's preset
    #[arg(long, value_name = "PRESET or FILE")]
    bench: Option<String>,
    /// Standard deviation of the averaging weights in ms; a larger one reduces the noise and rounds
    /// the break-away peak
    #[arg(long, value_name = "MS", default_value_t = 10.0)]
    smoothing_ms: f64,
    /// Seed of noise, split and samples
    #[arg(long, default_value_t = 2)]
    seed: u64,
    /// File format
    #[arg(long, value_enum, default_value_t = Format::Csv)]
    format: Format,
    /// Output directory for the three files, a card, NAME.json, and the picture of the cleaning,
    /// NAME-cleaning.svg
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let smoothing_s = 1e-3 * arguments.smoothing_ms;
    if !(1e-3..=10.0).contains(&smoothing_s) {
        let found = arguments.smoothing_ms.to_string();
        return Err(CliError::Argument("--smoothing-ms", found, "1 to 10000"));
    }
    check_directory(&arguments.out)?;
    let preset = format!("friction-rig-{}", arguments.bearing.name());
    let description = arguments.bench.as_deref().unwrap_or(&preset);
    let measured = !arguments.logs.is_empty();
    let (set, errors) = if measured {
        (FrictionSet::new(from_logs(description, &arguments.logs)?, smoothing_s, arguments.seed)?, None)
    } else {
        let logs = from_rig(description, arguments.bearing, arguments.seed)?;
        let set = FrictionSet::new(logs, smoothing_s, arguments.seed)?;
        let errors = torque_errors(&set.groups, &truth_of_rig(description, arguments.seed)?);
        (set, Some(errors))
    };
    let name = format!("friction-{}", arguments.bearing.name());
    let mut files = Vec::new();
    for split in Split::ALL {
        let file = format!("{name}-{}.{}", split.name(), arguments.format.ending());
        let path = arguments.out.join(file);
        let mut sink =
            Sink::create(&path, arguments.format, &COLUMNS.map(str::to_owned), |column| column < 2)?;
        sink.write(&[FormattedRows::new(set.columns(split), arguments.format)])?;
        files.push(sink.complete()?);
    }
    let shown = shown(&set);
    let picture = shown.map(comparison).transpose()?;
    let card = card(arguments, description, &set, errors, shown);
    let mut files = publish(files)?;
    for (ending, text) in
        [(".json", Some(format!("{}\n", serde_json::to_string_pretty(&card)?))), ("-cleaning.svg", picture)]
    {
        if let Some(text) = text {
            let path = arguments.out.join(format!("{name}{ending}"));
            write_atomically(&path, text.as_bytes())?;
            files.push(path);
        }
    }
    if arguments.json {
        let mut summary = card;
        summary["files"] = json!(files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>());
        return print_json(&summary);
    }
    let counts = Split::ALL.map(|split| count(&set, split));
    let [training, validation, test] = counts;
    print(format_args!(
        "{name}, seed {}: {} groups, {training} training, {validation} validation, {test} test, \
         {DRAWS} x {SAMPLES} samples of each",
        arguments.seed,
        set.groups.len()
    ))?;
    print(format_args!("outliers of the torque replaced: {}", outliers(&set)))?;
    if let Some([raw, clean]) = errors {
        print(format_args!(
            "torque against the same log without noise and outliers: {raw:.2} N m rms as logged, \
             {clean:.2} N m cleaned"
        ))?;
    }
    for (channel, scale) in CHANNELS.iter().zip(&set.scales) {
        print(format_args!("{channel}: mean {:.6}, deviation {:.6}", scale.mean, scale.deviation))?;
    }
    files.iter().try_for_each(|file| print(format_args!("wrote {}", file.display())))
}

/// Group for the picture: the first with the highest load.
fn shown(set: &FrictionSet) -> Option<&Group> {
    let load =
        |group: &Group| group.clean.first().and_then(|load| load.last()).map_or(0.0, |load| load.abs());
    let highest = set.groups.iter().map(load).fold(0.0, f64::max);
    set.groups.iter().find(|group| load(group) >= 0.99 * highest)
}

fn count(set: &FrictionSet, split: Split) -> usize {
    set.groups.iter().filter(|group| group.split == split).count()
}

fn outliers(set: &FrictionSet) -> usize {
    set.groups.iter().map(|group| group.outliers).sum()
}

fn card(
    arguments: &Arguments,
    description: &str,
    set: &FrictionSet,
    errors: Option<[f64; 2]>,
    shown: Option<&Group>,
) -> serde_json::Value {
    let groups: Vec<_> = (set.groups.iter())
        .map(|group| {
            json!({
                "source": group.source, "part": group.split, "samples": group.time_s.len(),
                "outliers": group.outliers,
            })
        })
        .collect();
    let scales: serde_json::Map<_, _> = CHANNELS
        .iter()
        .zip(&set.scales)
        .map(|(channel, scale)| (channel.name().to_owned(), json!(scale)))
        .collect();
    json!({
        "set": "friction",
        "bearing": arguments.bearing.name(),
        "measured": !arguments.logs.is_empty(),
        "bench": description,
        "seed": arguments.seed,
        "smoothing_ms": arguments.smoothing_ms,
        "series": Split::ALL.map(|split| (split.name(), DRAWS * count(set, split)))
            .into_iter().collect::<std::collections::BTreeMap<_, _>>(),
        "samples_per_series": SAMPLES,
        "outliers": outliers(set),
        "torque_error_rms_nm": errors.map(|[raw, clean]| json!({ "as_logged": raw, "cleaned": clean })),
        "scales": scales,
        "picture_of": shown.map(|group| group.source.clone()),
        "groups": groups,
    })
}
