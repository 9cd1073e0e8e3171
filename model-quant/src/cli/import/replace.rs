//! `model-quant import --bearing`: an imported network in a float checkpoint.

use super::arguments::Arguments;
use crate::cli::checkpoint::checkpoint;
use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::file_io::write_atomically;
use crate::exchange::onnx_import::Imported;
use crate::exchange::samples::{Difference, Samples};
use crate::network::checkpoint::{Checkpoint, Trained};
use crate::network::{NetworkKind, Shape};
use crate::train::freezer::weights_on_grid;
use inference::BearingMaterial;
use serde_json::json;

/// Replaces the network of the same shape in a float checkpoint.
pub(super) fn replace(
    arguments: &Arguments,
    bearing: BearingMaterial,
    imported: &Imported,
    checked: Option<&(Samples, Difference)>,
) -> Result<(), CliError> {
    let (mut checkpoint, _) = checkpoint(arguments.checkpoint.as_deref(), bearing)?;
    if checkpoint.bearing != bearing {
        let found = format!("a checkpoint of {}", checkpoint.bearing.name());
        return Err(CliError::Argument("--checkpoint", found, "one of the bearing of --bearing"));
    }
    let shape = imported.network.shape();
    let Some(kind) = NetworkKind::ALL.into_iter().find(|kind| kind.shape() == *shape) else {
        let [collision, friction] = NetworkKind::ALL.map(|kind| sizes(&kind.shape()));
        return Err(CliError::Shape {
            file: arguments.file.clone(),
            found: sizes(shape),
            expected: format!("that of a shipped network: {collision} (collision) or {friction} (friction)"),
        });
    };
    let trained = Trained { tuned: weights_on_grid(&imported.network), float: imported.network.clone() };
    match kind {
        NetworkKind::Collision => checkpoint.collision = trained,
        NetworkKind::Friction => checkpoint.friction = trained,
    }
    let replaced = kind.name();
    let bytes = checkpoint.to_bytes()?;
    let file = arguments.out.join(format!("{}.float", bearing.name()));
    write_atomically(&file, &bytes)?;
    let training_id = format!("{:016x}", Checkpoint::training_id(&bytes));
    if arguments.json {
        return print_json(&json!({
            "bearing": bearing.name(),
            "network": replaced,
            "file": file.display().to_string(),
            "training_id": training_id,
            "difference": checked.map(|(_, difference)| difference),
        }));
    }
    let agreement = checked.map_or("not checked with samples".to_owned(), |(_, difference)| {
        format!("differs from the framework by {:.1e} of the largest output", difference.relative())
    });
    print(format_args!(
        "wrote {}: the {replaced} network replaced, {agreement}; training id {training_id}",
        file.display()
    ))?;
    print(format_args!("its recipe describes the other network, not the training of the imported one"))?;
    print(format_args!("next: model-quant quantize --checkpoint {}", file.display()))
}

/// Sizes of a network in words.
fn sizes(shape: &Shape) -> String {
    let Shape { columns, inputs, outputs, .. } = shape;
    let padding = shape.padding.name();
    let convolutions: Vec<String> =
        shape.convolutions.iter().map(|c| format!("{} of {} channels", c.kernel, c.outputs)).collect();
    let convolutions = convolutions.join(", ");
    format!("{columns} columns of {inputs}, {padding} convolutions over {convolutions}, outputs: {outputs}")
}
