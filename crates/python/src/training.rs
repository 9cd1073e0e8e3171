//! From a recipe to a signed package: training, quantisation, verification, packing.

use crate::error::{input, work};
use crate::networks::material;
use model_package::board;
use model_quant::exchange::key::{DEVELOPMENT, parse};
use model_quant::exchange::package::{Package, PackageProperties};
use model_quant::network::NetworkKind;
use model_quant::network::checkpoint::Checkpoint;
use model_quant::network::recipe::{InstructionSet, Recipe};
use model_quant::quantise::image::AlignedImage;
use model_quant::quantise::mode::{Mode, Plan};
use model_quant::train::Progress;
use model_quant::train::history;
use model_quant::train::pipeline::train_both;
use pyo3::types::PyBytes;
use pyo3::{Bound, Py, PyAny, PyResult, Python, pyfunction};
use std::ops::ControlFlow;

/// Trains both networks of a bearing material. `report` gets the network's name and the epoch
/// after every epoch; its error, like control-C, ends the training. Returns the checkpoint and its
/// history as JSON.
#[pyfunction]
pub(crate) fn train<'py>(
    py: Python<'py>,
    material_name: &str,
    rows: usize,
    epochs: usize,
    grid_epochs: usize,
    seed: u64,
    report: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyBytes>, String)> {
    let material = material(material_name)?;
    let instruction_set = InstructionSet::best();
    let recipe = Recipe { rows, epochs, grid_epochs, seed, instruction_set, ..Recipe::standard(material) };
    recipe.check().map_err(input)?;
    let mut ended = None;
    let mut inform = |network: NetworkKind, progress: Progress| {
        let outcome = Python::attach(|py| {
            py.check_signals()?;
            report.as_ref().map_or(Ok(()), |r| r.call1(py, (network.name(), progress.epoch)).map(drop))
        });
        match outcome {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                ended = Some(error);
                ControlFlow::Break(())
            }
        }
    };
    let outcome = py.detach(|| train_both(material, &recipe, None, &mut inform));
    if let Some(error) = ended {
        return Err(error);
    }
    let outcome = outcome.map_err(work)?;
    let bytes = outcome.checkpoint.to_bytes().map_err(work)?;
    let history = history::file(&outcome, Checkpoint::training_id(&bytes));
    Ok((PyBytes::new(py, &bytes), history))
}

/// Quantises a checkpoint: the model image.
#[pyfunction]
pub(crate) fn quantise<'py>(py: Python<'py>, checkpoint: &[u8], mode: &str) -> PyResult<Bound<'py, PyBytes>> {
    let names = Mode::ALL.map(Mode::name).join("`, `");
    let mode = Mode::ALL.into_iter().find(|known| known.name() == mode);
    let mode = mode.ok_or_else(|| input(format!("mode: expected one of `{names}`")))?;
    let loaded = Checkpoint::from_bytes(checkpoint).map_err(input)?;
    let plan = Plan { mode, ..Plan::default() };
    let quantised =
        py.detach(|| model_quant::quantise::quantise(&loaded, Checkpoint::training_id(checkpoint), plan));
    Ok(PyBytes::new(py, &quantised.map_err(work)?.image))
}

/// Compares a model image with the networks of its checkpoint and with the laws, on rows that no
/// training used. Returns one verdict for each network, as JSON.
#[pyfunction]
pub(crate) fn verify(py: Python<'_>, image: &[u8], checkpoint: &[u8]) -> PyResult<String> {
    let image = AlignedImage::copy(image);
    let loaded = Checkpoint::from_bytes(checkpoint).map_err(input)?;
    let verdicts = py.detach(|| {
        model_quant::evaluate::verify::verify(&loaded, Checkpoint::training_id(checkpoint), &image)
    });
    serde_json::to_string(&verdicts.map_err(input)?).map_err(work)
}

/// Packs model images, at most one for each bearing material, and signs them with a secret key, or
/// else with the published development key.
#[pyfunction]
pub(crate) fn package<'py>(
    py: Python<'py>,
    images: Vec<Vec<u8>>,
    version: u32,
    board: Option<&str>,
    key: Option<&str>,
) -> PyResult<Bound<'py, PyBytes>> {
    let names = || board::ALL.map(|known| known.name).join("`, `");
    let [default, ..] = board::ALL;
    let name = board.unwrap_or(default.name);
    let known = board::ALL.iter().find(|known| known.name == name);
    let board =
        known.ok_or_else(|| input(format!("board: found `{name}`; expected one of `{}`", names())))?;
    let key = parse(key.unwrap_or(DEVELOPMENT)).map_err(|error| input(format!("key: {error}")))?;
    let images: Vec<AlignedImage> = images.iter().map(|image| AlignedImage::copy(image)).collect();
    let properties =
        PackageProperties { board: board.code, version, may_be_older: false, revokes_older_keys: false };
    let package = Package::new(properties, &images, &key).map_err(input)?;
    Ok(PyBytes::new(py, &package.to_bytes()))
}
