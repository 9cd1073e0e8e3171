//! Tests of the import of Keras and PyTorch networks: agreement with the framework, refusal of
//! unsupported nodes and damaged files.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use model_quant::exchange::onnx_import::{Imported, Layout, OPERATORS, import};
use model_quant::exchange::proto::Model;
use model_quant::exchange::samples::Samples;
use model_quant::network::{ConvolutionShape, Padding, Shape};
use proptest::prelude::*;
use prost::Message;
use std::path::PathBuf;

fn golden(name: &str) -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("peers/exchange/golden").join(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn imported(name: &str) -> Imported {
    import(&golden(&format!("{name}.onnx"))).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn shape<const N: usize>(
    [columns, inputs, outputs]: [usize; 3],
    padding: Padding,
    convolutions: [[usize; 2]; N],
) -> Shape {
    let convolutions =
        convolutions.into_iter().map(|[kernel, outputs]| ConvolutionShape { kernel, outputs }).collect();
    Shape { columns, inputs, padding, convolutions, outputs }
}

/// Every supported network: its file, its samples if they have another name, its shape.
fn accepted() -> Vec<(&'static str, &'static str, Layout, Shape)> {
    use Layout::{ChannelsFirst, ColumnsFirst};
    use Padding::{Same, Valid};
    let asymmetric = shape([11, 3, 2], Valid, [[4, 5], [2, 7]]);
    let valid = shape([10, 3, 2], Valid, [[4, 6], [2, 5]]);
    vec![
        ("torch_shipped", "torch_shipped", ChannelsFirst, shape([8, 4, 1], Valid, [[3, 16]; 3])),
        ("torch_same", "torch_same", ChannelsFirst, shape([12, 6, 3], Same, [[5, 12], [4, 7]])),
        ("torch_asymmetric", "torch_asymmetric", ChannelsFirst, asymmetric.clone()),
        ("torchscript_asymmetric", "torch_asymmetric", ChannelsFirst, asymmetric),
        ("torch_columns_first", "torch_columns_first", ColumnsFirst, shape([7, 3, 1], Valid, [[3, 4]])),
        // A dense layer with ReLU is a convolution over all columns.
        ("torch_hidden", "torch_hidden", ChannelsFirst, shape([6, 2, 1], Valid, [[3, 8], [4, 10]])),
        (
            "keras_reference",
            "keras_reference",
            ColumnsFirst,
            shape([32, 6, 1], Same, [[5, 16], [5, 32], [3, 32]]),
        ),
        ("keras_valid", "keras_valid", ColumnsFirst, valid.clone()),
        ("keras_export_valid", "keras_valid", ColumnsFirst, valid),
        ("keras_even", "keras_even", ColumnsFirst, shape([9, 2, 3], Same, [[4, 5], [1, 3]])),
        ("keras_hidden", "keras_hidden", ColumnsFirst, shape([6, 4, 1], Valid, [[3, 8], [4, 7]])),
    ]
}

#[test]
fn imported_networks_agree_with_their_framework() {
    for (name, samples, layout, shape) in accepted() {
        let found = imported(name);
        assert_eq!((found.network.shape(), found.layout), (&shape, layout), "{name}");
        let framework = if name.starts_with("keras") { "tf2onnx 1.17" } else { "pytorch 2.15" };
        assert!(found.producer.starts_with(framework), "{}", found.producer);
        let samples = Samples::read(&golden(&format!("{samples}.safetensors")), &shape, layout).expect(name);
        assert_eq!(samples.windows.len(), 32);
        let difference = samples.difference(&found.network);
        // f32 sums of up to 1024 terms in different orders.
        assert!(difference.relative() < 2e-6, "{name}: {difference:?}");
        assert!(difference.full_scale > 0.1, "{name}: {difference:?}");
    }
}

#[test]
fn the_order_of_flattening_is_read_from_the_graph() {
    // Flattening in the wrong order gives a different network, which the check with samples
    // detects.
    let found = imported("torch_asymmetric");
    let shape = found.network.shape().clone();
    let samples =
        Samples::read(&golden("torch_asymmetric.safetensors"), &shape, found.layout).expect("samples");
    let mut layers = found.network.layers().to_vec();
    let head = layers.last_mut().expect("head");
    let (columns, channels) = (7, 7);
    let rows: Vec<&[f32]> = head.weights.chunks(2).collect();
    head.weights = (0..columns * channels)
        .flat_map(|tap| rows[(tap % channels) * columns + tap / channels].iter().copied())
        .collect();
    let other = model_quant::network::Network::new(shape, layers).expect("network");
    assert!(samples.difference(&other).relative() > 0.05);
}

#[test]
fn unsupported_networks_are_refused_with_the_name_of_the_node() {
    for (name, expected) in [
        ("torch_stride", "node `node_conv1d` (Conv): strides: found [2], expected [1]"),
        ("torch_dilation", "node `node_conv1d` (Conv): dilations: found [2], expected [1]"),
        ("torch_groups", "node `node_conv1d` (Conv): group: found 2, expected 1"),
        ("torch_max_pool", "MaxPool (node `node_max_pool1d`)"),
        ("torch_sigmoid", "Sigmoid (node `node_sigmoid`)"),
        ("torch_lstm", "LSTM (node `node_lstm__2`)"),
        (
            "torch_linear",
            "node `node_conv1d_1` (Conv): input: found Conv after `node_conv1d` (Conv), expected ReLU",
        ),
        (
            "torch_causal",
            "node `node_conv1d` (Conv): pads along the columns: found [2, 0], \
             expected [0, 0] ('valid') or [1, 1] ('same')",
        ),
        ("keras_max_pool", "MaxPool (node `"),
        ("keras_stride", "/convolution` (Conv): strides: found [1, 2], expected [1, 1]"),
        ("keras_sigmoid", "Sigmoid (node `"),
        ("keras_causal", "Pad (node `"),
        ("keras_lstm", "LSTM (node `LSTM__"),
        ("keras_dense_per_column", "Gather (node `"),
    ] {
        let error = import(&golden(&format!("{name}.onnx"))).expect_err(name).to_string();
        assert!(error.contains(expected), "{name}: {error}");
    }
}

#[test]
fn the_producer_of_a_file_is_reported_in_one_line() {
    let mut model = Model::decode(&*golden("torch_hidden.onnx")).expect("model");
    model.producer_name = "pytorch\ncompile_error!(\"a separate line\");\r\n//! ".to_owned();
    let found = import(&model.encode_to_vec()).expect("network");
    assert!(!found.producer.contains(char::is_control), "{:?}", found.producer);
    assert!(found.producer.starts_with("pytorch compile_error!"), "{:?}", found.producer);
}

#[test]
fn files_of_another_kind_and_truncated_files_are_refused() {
    assert!(import(b"").is_err());
    assert!(import(b"nothing of the kind").is_err());
    assert!(import(&golden("torch_shipped.safetensors")).is_err());
    let complete = golden("torch_asymmetric.onnx");
    let cut = (0..complete.len()).filter(|&length| import(&complete[..length]).is_ok()).count();
    // The operator versions are at the end of the file, so a shorter file is incomplete.
    assert_eq!(cut, 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// A damaged file is refused or gives some network, without a panic and without more memory
    /// than the file.
    #[test]
    fn damaged_files_do_not_panic(
        which in 0usize..5,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        length in any::<prop::sample::Index>(),
        is_cut in prop::bool::weighted(0.2),
    ) {
        let names = ["torch_hidden", "torch_same", "keras_valid", "keras_even", "torch_columns_first"];
        let mut bytes = golden(&format!("{}.onnx", names[which]));
        for (place, value) in changes {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        if is_cut {
            bytes.truncate(length.index(bytes.len()));
        }
        if let Ok(found) = import(&bytes) {
            prop_assert!(found.network.parameters().all(f32::is_finite));
        }
    }

    /// Well-formed files with changed sizes, lists, connections and operators.
    #[test]
    fn corrupted_graphs_do_not_panic(
        which in 0usize..6,
        changes in prop::collection::vec(
            (0usize..8, any::<prop::sample::Index>(), any::<prop::sample::Index>(), number()),
            1..4,
        ),
    ) {
        let names = [
            "torch_hidden",
            "torch_same",
            "keras_valid",
            "keras_even",
            "torch_columns_first",
            "torchscript_asymmetric",
        ];
        let mut model = Model::decode(&golden(&format!("{}.onnx", names[which]))[..]).expect("golden");
        for (kind, place, other, number) in changes {
            corrupt(&mut model, kind, place, other, number);
        }
        if let Ok(found) = import(&model.encode_to_vec()) {
            let shape = found.network.shape();
            let outputs = found.network.evaluate(&vec![0.5; shape.columns * shape.inputs]);
            prop_assert_eq!(outputs.len(), shape.outputs);
        }
    }
}

/// Small numbers, extreme numbers, and random ones.
fn number() -> impl Strategy<Value = i64> {
    prop_oneof![4 => -4i64..20, 1 => Just(i64::MAX), 1 => Just(i64::MIN), 1 => any::<i64>()]
}

/// Changes one size, list, connection or operator.
fn corrupt(
    model: &mut Model,
    kind: usize,
    place: prop::sample::Index,
    other: prop::sample::Index,
    number: i64,
) {
    let Some(graph) = &mut model.graph else { return };
    let (nodes, tensors) = (graph.node.len(), graph.initializer.len());
    match kind {
        0 if tensors > 0 => {
            let dims = &mut graph.initializer[place.index(tensors)].dims;
            match dims.len() {
                0 => dims.push(number),
                length => dims[other.index(length)] = number,
            }
        }
        1 if tensors > 0 => {
            // Integer lists: axes, shapes.
            let tensor = &mut graph.initializer[place.index(tensors)];
            if tensor.data_type == 7 && !tensor.raw_data.is_empty() {
                let at = other.index(tensor.raw_data.len() / 8) * 8;
                tensor.raw_data[at..at + 8].copy_from_slice(&number.to_le_bytes());
            }
        }
        2 => {
            let attributes = &mut graph.node[place.index(nodes)].attribute;
            if !attributes.is_empty() {
                let count = attributes.len();
                let attribute = &mut attributes[other.index(count)];
                attribute.i = number;
                match attribute.ints.len() {
                    0 => attribute.ints.push(number),
                    length => attribute.ints[place.index(length)] = number,
                }
            }
        }
        3 => {
            let from = graph.node[other.index(nodes)].output.first().cloned().unwrap_or_default();
            let inputs = &mut graph.node[place.index(nodes)].input;
            if !inputs.is_empty() {
                let count = inputs.len();
                inputs[other.index(count)] = from;
            }
        }
        4 => graph.node[place.index(nodes)].op_type = OPERATORS[other.index(OPERATORS.len())].to_owned(),
        5 => {
            graph.node.remove(place.index(nodes));
            if graph.node.is_empty() {
                graph.node.push(Default::default());
            }
        }
        6 => {
            let kind = graph.input[0].kind.as_mut().and_then(|kind| kind.tensor.as_mut());
            let axes = kind.and_then(|tensor| tensor.shape.as_mut()).expect("shape");
            let count = axes.dim.len();
            axes.dim[other.index(count)].size = Some(number);
        }
        _ => {
            let node = graph.node[place.index(nodes)].clone();
            graph.node.insert(other.index(nodes), node);
        }
    }
}
