//! Tests of the export: reimport bit for bit, agreement with another runtime, refused inputs.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::BearingMaterial;
use model_quant::data::draw::{Draw, Purpose};
use model_quant::exchange::onnx_export;
use model_quant::exchange::onnx_import::{Layout, import};
use model_quant::exchange::proto::Model;
use model_quant::exchange::safetensors_export::to_bytes;
use model_quant::exchange::samples::Samples;
use model_quant::exchange::weight_order::from_convolution;
use model_quant::network::NetworkKind;
use model_quant::network::checkpoint::Checkpoint;
use model_quant::network::shipped::shipped_checkpoint;
use model_quant::network::{ConvolutionShape, Network, Padding, Shape};
use proptest::prelude::*;
use prost::Message;
use safetensors::SafeTensors;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn golden(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("peers/exchange/golden").join(name)
}

fn read(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn model_quant(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_model-quant")).args(arguments).output().expect("model-quant")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn as_str(path: &Path) -> &str {
    path.to_str().expect("path")
}

fn shape() -> impl Strategy<Value = Shape> {
    let convolution =
        (1usize..5, 1usize..6).prop_map(|(kernel, outputs)| ConvolutionShape { kernel, outputs });
    let convolutions = prop::collection::vec(convolution, 1..4);
    // A kernel above 1 makes the padding visible.
    (13usize..20, 1usize..5, any::<bool>(), convolutions, 1usize..4).prop_map(
        |(columns, inputs, same, mut convolutions, outputs)| {
            convolutions[0].kernel += 1;
            let padding = if same { Padding::Same } else { Padding::Valid };
            Shape { columns, inputs, padding, convolutions, outputs }
        },
    )
}

proptest! {
    #[test]
    fn exported_networks_are_imported_bit_for_bit(shape in shape(), seed in any::<u64>()) {
        let network = Network::start(shape, &mut Draw::new(seed, Purpose::Weights, 0));
        let found = import(&onnx_export::to_bytes(&network, "any", &[])).expect("import");
        prop_assert_eq!(found.layout, Layout::ChannelsFirst);
        prop_assert_eq!(found.network.shape(), network.shape());
        let bits = |network: &Network| network.parameters().map(f32::to_bits).collect::<Vec<_>>();
        prop_assert_eq!(bits(&found.network), bits(&network));
    }
}

/// Network of the checked-in exported file: PyTorch's with 'same' padding.
fn exported() -> Network {
    import(&read(&golden("torch_same.onnx"))).expect("golden").network
}

/// ONNX Runtime evaluated this file; `peers/exchange/README.md` describes how.
#[test]
fn an_exported_file_gives_the_same_numbers_in_onnx_runtime() {
    let network = exported();
    let plain = |bytes: &[u8]| {
        let mut model = Model::decode(bytes).expect("onnx");
        model.producer_version = String::new();
        model
    };
    let written = onnx_export::to_bytes(&network, "exported-same", &[]);
    assert!(plain(&written) == plain(&read(&golden("exported-same.onnx"))), "the exported file has changed");
    let file = read(&golden("exported-same-onnxruntime.safetensors"));
    let samples = Samples::read(&file, network.shape(), Layout::ChannelsFirst).expect("samples");
    let difference = samples.difference(&network);
    assert!(difference.relative() < 2e-6 && samples.windows.len() == 32, "{difference:?}");
}

/// Writes the file of the test above for ONNX Runtime.
#[test]
#[ignore = "writes a golden file"]
fn write_the_exported_file() {
    let bytes = onnx_export::to_bytes(&exported(), "exported-same", &[]);
    std::fs::write(golden("exported-same.onnx"), bytes).expect("written");
}

#[test]
fn safetensors_have_every_weight_and_the_origin_of_the_training() {
    let bytes = shipped_checkpoint(BearingMaterial::Plastic);
    let checkpoint = Checkpoint::from_bytes(bytes).expect("checkpoint");
    let training_id = Checkpoint::training_id(bytes);
    let file = to_bytes(&checkpoint, training_id).expect("safetensors");
    assert_eq!(file, to_bytes(&checkpoint, training_id).expect("again"), "the same bytes every time");
    let tensors = SafeTensors::deserialize(&file).expect("file");
    assert_eq!(tensors.len(), 2 * 2 * 8);
    for which in NetworkKind::ALL {
        let found = checkpoint.trained(which);
        for (prefix, network) in
            [(which.name().to_owned(), &found.float), (format!("{}_on_grid", which.name()), &found.tuned)]
        {
            let sizes = network.shape().layers();
            for (index, (layer, size)) in network.layers().iter().zip(&sizes).enumerate() {
                let name = if index == 3 { "head".to_owned() } else { format!("convolution_{}", index + 1) };
                let values = |what: &str| -> Vec<f32> {
                    let tensor = tensors.tensor(&format!("{prefix}.{name}.{what}")).expect("tensor");
                    tensor.data().as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect()
                };
                assert_eq!(values("bias"), layer.biases);
                let weights = from_convolution(&values("weight"), size.inputs, size.kernel, size.outputs);
                assert_eq!(weights, layer.weights);
            }
        }
    }
    let (_, metadata) = SafeTensors::read_metadata(&file).expect("metadata");
    let entry = metadata.metadata().as_ref().and_then(|entries| entries.get("model-quant")).expect("entry");
    let entry: serde_json::Value = serde_json::from_str(entry).expect("json");
    assert_eq!(entry["training_id"], format!("{training_id:016x}"));
    assert_eq!(entry["bearing"], "plastic");
    for which in NetworkKind::ALL {
        let inputs = entry[which.name()]["inputs"].as_array().expect("inputs");
        assert_eq!(inputs.len(), checkpoint.trained(which).float.shape().inputs);
    }
}

#[test]
fn exported_networks_can_be_imported_and_replace_those_of_a_checkpoint() {
    let directory = tempfile::tempdir().expect("directory");
    let out = as_str(directory.path());
    let exported = model_quant(&["export", "--bearing", "babbitt", "--out", out]);
    assert!(exported.status.success(), "{}", text(&exported.stderr));
    let checkpoint =
        Checkpoint::from_bytes(shipped_checkpoint(BearingMaterial::Babbitt)).expect("checkpoint");
    let [onnx, samples] = ["babbitt-friction.onnx", "babbitt-friction-samples.safetensors"]
        .map(|name| directory.path().join(name));
    assert_eq!(import(&read(&onnx)).expect("import").network, checkpoint.friction.float);
    // Into the other bearing's checkpoint.
    let arguments = [
        "import",
        as_str(&onnx),
        "--samples",
        as_str(&samples),
        "--bearing",
        "plastic",
        "--out",
        out,
        "--json",
    ];
    let imported = model_quant(&arguments);
    assert!(imported.status.success(), "{}", text(&imported.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&imported.stdout).expect("json");
    assert_eq!((&summary["network"], &summary["difference"]["largest"]), (&"friction".into(), &0.0.into()));
    let replaced =
        Checkpoint::from_bytes(&read(&directory.path().join("plastic.float"))).expect("checkpoint");
    assert_eq!(replaced.friction.float, checkpoint.friction.float);
    let before = Checkpoint::from_bytes(shipped_checkpoint(BearingMaterial::Plastic)).expect("checkpoint");
    assert_eq!(replaced.collision, before.collision);
}

#[test]
fn commands_refuse_what_is_wrong_by_name_and_write_nothing() {
    let directory = tempfile::tempdir().expect("directory");
    let out = directory.path().join("out");
    let [same, same_samples, other_samples, pool] =
        ["torch_same.onnx", "torch_same.safetensors", "torch_hidden.safetensors", "torch_max_pool.onnx"]
            .map(golden);
    let off = directory.path().join("off.safetensors");
    let network = exported();
    let mut samples =
        Samples::read(&read(&same_samples), network.shape(), Layout::ChannelsFirst).expect("samples");
    samples.outputs[7][2] += 0.01;
    std::fs::write(&off, samples.to_bytes(network.shape(), Layout::ChannelsFirst).expect("bytes"))
        .expect("written");
    let [same, same_samples, other_samples, pool, off] =
        [&same, &same_samples, &other_samples, &pool, &off].map(|p| as_str(p));
    for (arguments, code, expected) in [
        (vec![pool], 2, "MaxPool (node `node_max_pool1d`)"),
        (vec!["/nowhere/a.onnx"], 2, "/nowhere/a.onnx"),
        (vec![same_samples], 2, "no ONNX file"),
        (vec![same, "--samples", same], 2, "no safetensors file"),
        (
            vec![same, "--samples", other_samples],
            2,
            "tensor `inputs`: axes: found [32, 2, 6], expected [samples, 6, 12]",
        ),
        (vec![same, "--samples", off], 1, "sample 7, output 2"),
        (vec![same, "--samples", same_samples, "--full-scale", "1,2"], 2, "--full-scale"),
        (vec![same, "--samples", same_samples, "--name", "1x"], 2, "--name: found 1x"),
        (vec![same, "--samples", same_samples, "--tolerance", "NaN"], 2, "--tolerance: found NaN"),
        (vec![same, "--samples", same_samples, "--bearing", "babbitt"], 2, "that of a shipped network"),
        (vec![same, "--mode", "w16a16", "--packing", "flash"], 2, "one form of storage"),
    ] {
        let mut all = vec!["import"];
        all.extend(&arguments);
        all.extend(["--out", as_str(&out)]);
        let output = model_quant(&all);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    assert!(!out.exists(), "nothing was written");
    // Without samples the command only describes the network.
    let described = model_quant(&["import", same, "--json", "--out", as_str(&out)]);
    let summary: serde_json::Value = serde_json::from_slice(&described.stdout).expect("json");
    assert_eq!((&summary["shape"]["columns"], &summary["layout"]), (&12.into(), &"channels-first".into()));
    assert!(!out.exists());
}

#[test]
fn help_has_examples() {
    for command in ["import", "export"] {
        let output = model_quant(&[command, "--help"]);
        let help = text(&output.stdout);
        assert!(help.contains("Examples") && help.contains(&format!("model-quant {command} ")), "{help}");
    }
}
