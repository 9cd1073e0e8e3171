//! `model-quant quantize`: model images and cards from float checkpoints.

use crate::cli::checkpoint::{BearingParser, bearings, checkpoint};
use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::file_io::{check_directory, write_atomically};
use crate::evaluate::bench_loop;
use crate::evaluate::layers::{LAYER_ROWS, LayerError, layer_errors};
use crate::evaluate::limits;
use crate::evaluate::test_set::TEST_ROWS;
use crate::evaluate::verdict::{BANDS_N, Verdict};
use crate::evaluate::verify::add_held_out_errors;
use crate::evaluate::verify::verify;
use crate::network::checkpoint::Checkpoint;
use crate::quantise::image::AnyModel;
use crate::quantise::mode::{Mode, Packing, Plan};
use crate::quantise::{QuantiseError, Quantised, quantise};
use crate::report::card::{Facts, card};
use inference::{BearingMaterial, shipped as shipped_image};
use report::text_table;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Quantise float checkpoints to model images and write their model cards
///
/// Weights have one grid for each output channel. Activations are scaled by their largest values
/// over 16384 seeded calibration rows; the friction network gets the forces of the quantised
/// collision network. Without options this gives the shipped images byte for byte; `--check`
/// compares them.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant quantize --checkpoint model-quant/models/babbitt.float \
                        --out crates/inference/models\n  \
                        model-quant quantize --bearing plastic --mode w8a8 --packing flash \
                        --max-error-n 100 --out compact\n  \
                        model-quant quantize --compare\n  \
                        model-quant quantize --layers --mode w8a8\n  \
                        model-quant quantize --check")]
pub(crate) struct Arguments {
    /// Bearing material; all if not given
    #[arg(long, value_parser = BearingParser, conflicts_with = "checkpoint")]
    bearing: Option<BearingMaterial>,
    /// Float checkpoint; the shipped ones if not given
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Widths of weights and activations
    #[arg(long, value_enum, default_value_t)]
    mode: Mode,
    /// Storage of 8-bit weights for 16-bit activations
    #[arg(long, value_enum, default_value_t)]
    packing: Packing,
    /// Refuse images whose mean absolute difference from the float networks over all test rows, in
    /// the normal or the friction force, exceeds this many N: exit 1, nothing written
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    max_error_n: Option<f64>,
    /// Output directory for BEARING.pintle and BEARING.md
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// bench-loop.json of `host-sim accuracy` for the model cards; default: that of the shipped
    /// images. Measurements with other images are left out
    #[arg(long, value_name = "FILE")]
    bench_loop: Option<PathBuf>,
    /// Compare every mode with the float networks; write nothing
    #[arg(long, conflicts_with_all = ["mode", "packing", "max_error_n", "out", "check", "layers"])]
    compare: bool,
    /// Print the error of every quantisation step in N; write nothing
    #[arg(long, conflicts_with_all = ["max_error_n", "out", "check"])]
    layers: bool,
    /// Compare with the shipped images; write nothing
    #[arg(long, conflicts_with_all = ["checkpoint", "out", "mode", "packing", "max_error_n"])]
    check: bool,
    /// Print a summary as JSON
    #[arg(long)]
    json: bool,
}

/// An image with its checkpoint, before it is written.
struct QuantisedBearing {
    checkpoint: Checkpoint,
    training_id: u64,
    quantised: Quantised,
}

impl QuantisedBearing {
    fn name(&self) -> &'static str {
        self.checkpoint.bearing.name()
    }

    fn checksum(&self) -> u32 {
        self.quantised.image.last_chunk::<4>().map_or(0, |sum| u32::from_le_bytes(*sum))
    }

    fn verify(&self) -> Result<[Verdict; 2], CliError> {
        let verdicts = verify(&self.checkpoint, self.training_id, &self.quantised.image);
        Ok(verdicts.map_err(QuantiseError::from)?)
    }

    fn layers(&self, plan: Plan) -> Result<Vec<LayerError>, CliError> {
        let errors = layer_errors(&self.checkpoint, &self.quantised, plan);
        Ok(errors.map_err(QuantiseError::from)?)
    }
}

fn prepare(arguments: &Arguments, plan: Plan) -> Result<Vec<QuantisedBearing>, CliError> {
    let chosen = if arguments.checkpoint.is_some() {
        vec![BearingMaterial::Babbitt]
    } else {
        bearings(arguments.bearing)
    };
    (chosen.into_iter())
        .map(|bearing| {
            let (checkpoint, training_id) = checkpoint(arguments.checkpoint.as_deref(), bearing)?;
            let quantised = quantise(&checkpoint, training_id, plan)?;
            Ok(QuantisedBearing { checkpoint, training_id, quantised })
        })
        .collect()
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let plan = Plan { mode: arguments.mode, packing: arguments.packing };
    if plan.mode == Mode::W16a16 && plan.packing == Packing::Flash {
        let expected = "speed: weights of more than 8 bits have only one form of storage";
        return Err(CliError::Argument("--packing", "flash with --mode w16a16".to_owned(), expected));
    }
    if let Some(limit) = arguments.max_error_n
        && !(limit >= 0.0 && limit.is_finite())
    {
        return Err(CliError::Argument("--max-error-n", limit.to_string(), "a number of N, 0 or above"));
    }
    if arguments.compare {
        return compare(arguments);
    }
    let ready = prepare(arguments, plan)?;
    if arguments.layers {
        return layers(arguments, &ready, plan);
    }
    if arguments.check {
        return summarise(arguments, &ready, &[]);
    }
    check_directory(&arguments.out)?;
    let verdicts: Vec<[Verdict; 2]> = ready.iter().map(QuantisedBearing::verify).collect::<Result<_, _>>()?;
    if let Some(limit_n) = arguments.max_error_n {
        let is_refused = |error_n: f64| error_n > limit_n || error_n.is_nan();
        if let Some(verdict) = verdicts.iter().flatten().find(|v| is_refused(v.mae_quantisation_n)) {
            return Err(CliError::Refused(format!(
                "{} {}: mean absolute difference between image and float networks is {:.2} N over \
                 {TEST_ROWS} test rows, expected at most {limit_n} N (--max-error-n); nothing written",
                verdict.bearing, verdict.network, verdict.mae_quantisation_n
            )));
        }
    }
    let measured = arguments.bench_loop.as_deref().map_or_else(bench_loop::shipped, bench_loop::read)?;
    for (ready, verdicts) in ready.iter().zip(&verdicts) {
        let image: &[u8] = &ready.quantised.image;
        let model = AnyModel::load(image).map_err(QuantiseError::from)?;
        let header = model.header();
        let text = card(&Facts {
            checkpoint: &ready.checkpoint,
            plan,
            header: &header,
            image,
            verdicts: &add_held_out_errors(verdicts.clone(), &ready.checkpoint, model)?,
            layers: &ready.layers(plan)?,
            limits: &limits::measure(model)?,
            bench_loop: bench_loop::for_image(&measured, ready.checksum()),
        });
        write_atomically(&arguments.out.join(format!("{}.md", ready.name())), text.as_bytes())?;
        write_atomically(&arguments.out.join(format!("{}.pintle", ready.name())), image)?;
    }
    summarise(arguments, &ready, &verdicts)
}

fn summarise(
    arguments: &Arguments,
    ready: &[QuantisedBearing],
    verdicts: &[[Verdict; 2]],
) -> Result<(), CliError> {
    let mut summaries = Vec::new();
    let mut different = Vec::new();
    for (index, ready) in ready.iter().enumerate() {
        let (name, bytes, crc) = (ready.name(), ready.quantised.image.len(), ready.checksum());
        let equals_checked_in = *ready.quantised.image == *shipped_image(ready.checkpoint.bearing);
        if !equals_checked_in {
            different.push(name);
        }
        let errors = verdicts.get(index).map(|[a, b]| [a.mae_quantisation_n, b.mae_quantisation_n]);
        if !arguments.json {
            let action = if arguments.check { "quantised" } else { "wrote" };
            let equal = if equals_checked_in { "equal to" } else { "different from" };
            let error = errors.map_or(String::new(), |[collision, friction]| {
                format!(
                    ", difference from the float networks {collision:.2} N normal \
                     and {friction:.2} N friction"
                )
            });
            print(format_args!(
                "{action} {name}: {}, packed for {}, {bytes} bytes of flash, CRC-32 {crc:08x}{error}, \
                 {equal} the checked-in image",
                arguments.mode.name(),
                arguments.packing.name()
            ))?;
        }
        let file = arguments.out.join(format!("{name}.pintle"));
        summaries.push(json!({
            "bearing": name,
            "file": (!arguments.check).then(|| file.display().to_string()),
            "mode": arguments.mode,
            "packing": arguments.packing,
            "bytes": bytes,
            "crc": format!("{crc:08x}"),
            "training_id": format!("{:016x}", ready.training_id),
            "mae_quantisation_n": errors,
            "equals_checked_in": equals_checked_in,
        }));
    }
    if arguments.json {
        print_json(&summaries)?;
    }
    if arguments.check && !different.is_empty() {
        return Err(CliError::Differs(format!(
            "checked-in image of {}: quantising its checkpoint gives other bytes",
            different.join(" and ")
        )));
    }
    Ok(())
}

/// Appends the headings of the bands of the force.
fn with_bands(start: &[&str]) -> Vec<String> {
    let bands = BANDS_N.iter().map(|up_to| format!("to {up_to} N"));
    start.iter().map(|&heading| heading.to_owned()).chain(bands).chain(["above".into()]).collect()
}

fn compare(arguments: &Arguments) -> Result<(), CliError> {
    let mut figures: Vec<Value> = Vec::new();
    let mut rows = Vec::new();
    for mode in Mode::ALL {
        let fast = prepare(arguments, Plan { mode, packing: Packing::Speed })?;
        let small = match mode {
            Mode::W16a16 => prepare(arguments, Plan { mode, packing: Packing::Speed })?,
            Mode::W8a16 | Mode::W8a8 => prepare(arguments, Plan { mode, packing: Packing::Flash })?,
        };
        for (fast, small) in fast.iter().zip(&small) {
            let (bytes, flash_bytes) = (fast.quantised.image.len(), small.quantised.image.len());
            for verdict in fast.verify()? {
                figures.push(json!({
                    "mode": mode,
                    "bytes_speed": bytes,
                    "bytes_flash": flash_bytes,
                    "verdict": verdict,
                }));
                let start = [
                    verdict.bearing.to_string(),
                    verdict.network.to_string(),
                    mode.name().into(),
                    bytes.to_string(),
                    flash_bytes.to_string(),
                    format!("{:.2}", verdict.mae_quantisation_n),
                ];
                let bands = verdict.bands.iter().map(|band| {
                    format!("{:.2} / {:.0}", band.mae_quantisation_n, band.largest_quantisation_n)
                });
                rows.push(start.into_iter().chain(bands).collect::<Vec<_>>());
            }
        }
    }
    if arguments.json {
        return print_json(&figures);
    }
    let header = with_bands(&["bearing", "network", "mode", "flash B", "small B", "all N"]);
    print(format_args!(
        "difference between image and float networks over {TEST_ROWS} test rows, mean / largest in N, \
         by normal force\n{}",
        text_table(header, rows, 3)
    ))?;
    print(format_args!(
        "(flash: packed for speed; small: packed for flash, the same estimates; \
         instructions: `cargo xtask insn`)"
    ))
}

fn layers(arguments: &Arguments, ready: &[QuantisedBearing], plan: Plan) -> Result<(), CliError> {
    let mut figures: Vec<Value> = Vec::new();
    for ready in ready {
        let errors = ready.layers(plan)?;
        figures.push(
            json!({ "bearing": ready.name(), "mode": plan.mode, "rows": LAYER_ROWS, "layers": errors }),
        );
        if arguments.json {
            continue;
        }
        print(format_args!(
            "{} {}: change of the force by each quantisation step alone over {LAYER_ROWS} test rows, \
             mean / largest in N",
            ready.name(),
            plan.mode.name()
        ))?;
        let rows = errors.iter().map(|error| {
            let start = [error.network.to_string(), error.quantised.clone(), format!("{:.2}", error.mae_n)];
            let bands = error.bands.iter().map(|band| format!("{:.2} / {:.1}", band.mae_n, band.largest_n));
            start.into_iter().chain(bands).collect::<Vec<_>>()
        });
        let header = with_bands(&["network", "in fixed point", "all N"]);
        print(format_args!("{}", text_table(header, rows, 2)))?;
    }
    if arguments.json { print_json(&figures) } else { Ok(()) }
}
