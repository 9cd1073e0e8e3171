//! `model-quant verify`: compares images with laws, float networks and other runtimes.

use crate::cli::checkpoint::{BearingParser, bearings, checkpoint};
use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::file_io::write_atomically;
use crate::evaluate::errors::{Errors, FRICTION_RADIUS_M};
use crate::evaluate::goals::Goal;
use crate::evaluate::peers::{CHECKED_IN, Results, generate_windows, to_bytes};
use crate::evaluate::test_set::TEST_ROWS;
use crate::evaluate::verdict::Verdict;
use crate::evaluate::verify::add_held_out_errors;
use crate::evaluate::verify::verify;
use crate::quantise::image::{AlignedImage, AnyModel};
use inference::{BearingMaterial, shipped as shipped_image};
use std::path::{Path, PathBuf};

/// Compare model images with the laws, their float networks and other runtimes
///
/// The laws and float networks are compared on rows that no training used and on the contacts of
/// held-out bench runs; goals are reported as met or not met. Other runtimes: the checked-in
/// results of ONNX Runtime (the same fixed-point arithmetic, so a difference is an error) and of
/// LiteRT, formerly TFLite (16-bit activations and 8-bit weights, different rounding), on the
/// windows of model-quant/peers for the shipped images. With `--emulated` also the results of a
/// controller, which must be equal.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant verify\n  model-quant verify --emulated sums.bin\n  \
                        model-quant verify --image new/babbitt.pintle --checkpoint new/babbitt.float \
                        --json\n  \
                        model-quant verify --windows model-quant/peers/windows.bin")]
pub(crate) struct Arguments {
    /// Bearing material; all if not given
    #[arg(long, value_parser = BearingParser, conflicts_with = "image")]
    bearing: Option<BearingMaterial>,
    /// Model image; the shipped ones if not given
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// Float checkpoint of the image; the shipped one of its bearing if not given
    #[arg(long, value_name = "FILE", requires = "image")]
    checkpoint: Option<PathBuf>,
    /// Results file of an emulated or real controller for the windows of model-quant/peers
    #[arg(long, value_name = "RESULTS")]
    emulated: Option<PathBuf>,
    /// Only write the windows of the shipped images for other runtimes
    #[arg(long, value_name = "FILE", conflicts_with_all = ["image", "bearing", "emulated", "out", "json"])]
    windows: Option<PathBuf>,
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
    /// Also write the figures as JSON to a file
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let all = generate_windows()?;
    if let Some(path) = &arguments.windows {
        write_atomically(path, &to_bytes(&all))?;
        return print(format_args!("wrote {}: windows of {} networks", path.display(), all.len()));
    }
    let peers = peers(arguments.emulated.as_deref())?;
    let mut verdicts = Vec::new();
    let mut add = |checkpoint: Option<&Path>, bearing, image: &[u8], name: &Path| {
        for mut verdict in check(checkpoint, bearing, image, name)? {
            let compared =
                peers.iter().filter_map(|peer| peer.compare(&all, bearing, verdict.network, image));
            verdict.peers = compared.collect();
            let is_compared = all.iter().any(|windows| windows.bearing == bearing);
            if arguments.emulated.is_some() && is_compared && verdict.peers.len() < peers.len() {
                let found = format!("sums for another image, not {}", name.display());
                return Err(CliError::Argument(
                    "--emulated",
                    found,
                    "sums for this image; see model-quant/peers/README.md",
                ));
            }
            verdicts.push(verdict);
        }
        Ok::<(), CliError>(())
    };
    if let Some(path) = &arguments.image {
        let image =
            AlignedImage::read(path).map_err(|source| CliError::Read { path: path.clone(), source })?;
        let refused = |source| CliError::Image { path: path.clone(), source };
        let bearing = AnyModel::load(&image).map_err(refused)?.header().bearing;
        add(arguments.checkpoint.as_deref(), bearing, &image, path)?;
    } else {
        for bearing in bearings(arguments.bearing) {
            let name = PathBuf::from(format!("shipped image of {}", bearing.name()));
            add(None, bearing, shipped_image(bearing), &name)?;
        }
    }
    if let Some(path) = &arguments.out {
        write_atomically(path, serde_json::to_string_pretty(&verdicts)?.as_bytes())?;
    }
    if arguments.json {
        print_json(&verdicts)?;
    } else {
        table(&verdicts)?;
        if arguments.emulated.is_none() {
            print(format_args!(
                "(not compared with a controller: `cargo xtask verify` runs the emulated core and passes \
                 its sums to --emulated)"
            ))?;
        }
    }
    let different = verdicts.iter().find_map(|verdict| {
        let peer = verdict.peers.iter().find(|peer| peer.must_be_equal && peer.different > 0)?;
        Some(format!(
            "{} {}: {} has different sums for {} of {} windows, expected equal sums",
            verdict.bearing, verdict.network, peer.peer, peer.different, peer.windows
        ))
    });
    different.map_or(Ok(()), |message| Err(CliError::Differs(message)))
}

/// Loads the checked-in results and those of a controller.
fn peers(emulated: Option<&Path>) -> Result<Vec<Results>, CliError> {
    let refused = |path: &Path| {
        let path = path.to_path_buf();
        move |source| CliError::Results { path, source }
    };
    let mut peers = Vec::new();
    for (bytes, must_be_equal) in CHECKED_IN {
        peers.push(
            Results::from_bytes(bytes, must_be_equal).map_err(refused(Path::new("model-quant/peers")))?,
        );
    }
    if let Some(path) = emulated {
        let bytes =
            std::fs::read(path).map_err(|source| CliError::Read { path: path.to_path_buf(), source })?;
        peers.push(Results::from_bytes(&bytes, true).map_err(refused(path))?);
    }
    Ok(peers)
}

fn table(verdicts: &[Verdict]) -> Result<(), CliError> {
    print(format_args!(
        "bearing  network    against                          \
         rows  different    mean N  largest N      R^2  median %    95 %"
    ))?;
    for verdict in verdicts {
        let row = |against: &str,
                   rows: usize,
                   different: Option<usize>,
                   [mean, largest]: [f64; 2],
                   columns: String| {
            let different = different.map_or("-".to_owned(), |count| count.to_string());
            print(format_args!(
                "{:8} {:9}  {against:28}  {rows:7}  {different:>9}  {mean:8.2}  {largest:9.1}{columns}",
                verdict.bearing, verdict.network
            ))
        };
        let figures = format!(
            "  {:.6}  {:7.2}  {:7.2}",
            verdict.r2_quantised,
            100.0 * verdict.working_error_median,
            100.0 * verdict.working_error_p95
        );
        row("law", verdict.rows, None, [verdict.mae_n, verdict.largest_n], figures)?;
        let quantisation = [verdict.mae_quantisation_n, verdict.largest_quantisation_n];
        let figures = format!("  ({:.6} of them against the law)", verdict.r2_float);
        row("float networks", verdict.rows, None, quantisation, figures)?;
        for peer in &verdict.peers {
            let figures = format!("  (sums: {} counts at most)", peer.largest_counts);
            row(&peer.peer, peer.windows, Some(peer.different), [peer.mean_n, peer.largest_n], figures)?;
        }
        if let Some(held_out) = &verdict.held_out {
            let Errors { rows, r2, mae_n, largest_n, .. } = held_out.image;
            let figures = format!("  {r2:.6}");
            row(&format!("law, {} held-out runs", held_out.runs), rows, None, [mae_n, largest_n], figures)?;
        }
        for goal in &verdict.goals {
            let met = if goal.met { "met" } else { "not met" };
            let Goal { figure, value, relation, limit, .. } = goal;
            print(format_args!(
                "{:8} {:9}  {met}: {figure} {value:.6} {relation} {limit}",
                verdict.bearing, verdict.network
            ))?;
        }
        if let Some(mae_nm) = verdict.mae_nm {
            print(format_args!(
                "{:8} {:9}  mean absolute error {mae_nm:.3} N m on a radius of {FRICTION_RADIUS_M} m",
                verdict.bearing, verdict.network
            ))?;
        }
        print(format_args!(
            "{:8} {:9}  largest output without contact {} N; checksum {}",
            verdict.bearing,
            verdict.network,
            verdict.zero_contact_output,
            if verdict.image_crc_ok { "ok" } else { "wrong" }
        ))?;
        if !verdict.image_matches_checkpoint {
            print(format_args!(
                "{:8} {:9}  the image was made from another checkpoint (--checkpoint) \
                 than the float networks above",
                verdict.bearing, verdict.network
            ))?;
        }
    }
    print(format_args!(
        "(law and float networks: {TEST_ROWS} test rows; \
         relative errors at 1 to 14 kN and rate ratios up to 2;"
    ))?;
    print(format_args!(
        "other runtimes: newtons over the windows from test rows, differences over all windows)"
    ))
}

fn check(
    file: Option<&Path>,
    bearing: BearingMaterial,
    image: &[u8],
    name: &Path,
) -> Result<[Verdict; 2], CliError> {
    let (checkpoint, training_id) = checkpoint(file, bearing)?;
    if checkpoint.bearing != bearing {
        let found = format!("a checkpoint of {}", checkpoint.bearing.name());
        return Err(CliError::Argument("--checkpoint", found, "one of the image's bearing"));
    }
    let refused = |source| CliError::Image { path: name.to_path_buf(), source };
    let verdicts = verify(&checkpoint, training_id, image).map_err(refused)?;
    Ok(add_held_out_errors(verdicts, &checkpoint, AnyModel::load(image).map_err(refused)?)?)
}
