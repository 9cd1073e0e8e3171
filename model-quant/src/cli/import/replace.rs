//! `model-quant import --bearing`: an imported network in a float checkpoint.

use super::Arguments;
use crate::cli::{CliError, checkpoint, print, print_json};
use inference::Bearing;
use model_quant::checkpoint::Checkpoint;
use model_quant::exchange::recognise::Imported;
use model_quant::exchange::samples::{Difference, Samples};
use model_quant::round::weights_on_grid;
use model_quant::shapes;
use model_quant::train::Trained;
use model_quant::write::write_whole;
use serde_json::json;

/// Puts the network in place of the one of its shape in a float checkpoint.
pub(super) fn replace(
    arguments: &Arguments,
    bearing: Bearing,
    imported: &Imported,
    checked: Option<&(Samples, Difference)>,
) -> Result<(), CliError> {
    let (mut checkpoint, _) = checkpoint(arguments.checkpoint.as_deref(), bearing)?;
    if checkpoint.bearing != bearing {
        let found = format!("a checkpoint of {}", checkpoint.bearing.name());
        return Err(CliError::Argument("--checkpoint", found, "one of the bearing of --bearing"));
    }
    let shape = imported.network.shape();
    let replaced = if *shape == shapes::collision() {
        "collision"
    } else if *shape == shapes::friction() {
        "friction"
    } else {
        let expected = "that of a shipped network: 8 columns of 8 (collision) or 4 values (friction), three 'valid' \
                        convolutions of 16 channels over 3 columns, 1 output";
        return Err(CliError::Argument(
            "--bearing with a network of shape",
            serde_json::to_string(shape)?,
            expected,
        ));
    };
    let trained = Trained { tuned: weights_on_grid(&imported.network), float: imported.network.clone() };
    match replaced {
        "collision" => checkpoint.collision = trained,
        _ => checkpoint.friction = trained,
    }
    let bytes = checkpoint.to_bytes()?;
    let file = arguments.out.join(format!("{}.float", bearing.name()));
    write_whole(&file, &bytes)?;
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
    let off = checked.map_or("not checked with samples".to_owned(), |(_, difference)| {
        format!("off the framework by {:.1e} of the largest output", difference.relative())
    });
    print(format_args!(
        "wrote {}: the {replaced} network replaced, {off}; training id {training_id}",
        file.display()
    ))?;
    print(format_args!(
        "its recipe is that of the other network; nothing in it tells how the imported one was trained"
    ))?;
    print(format_args!("next: model-quant quantize --checkpoint {}", file.display()))
}
