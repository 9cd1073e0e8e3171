//! Tests that the output of `model-quant import` compiles, passes its self-test, and gives the
//! interpreter's sums in the engine.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]
#![allow(unreachable_pub, reason = "the written sources are made for a module of a crate")]

use inference::chain::Sums;
use inference::image::{CRC_LENGTH, HEADER_LENGTH, LayerShape, SHAPE_LENGTH};
use inference::{BearingMaterial, Model, Streaming, shipped};
use model_quant::data::draw::{Draw, Purpose};
use model_quant::exchange::input_scale::InputScale;
use model_quant::exchange::interpreter::Interpreter;
use model_quant::exchange::onnx_import::import;
use model_quant::exchange::samples::Samples;
use model_quant::network::Padding;
use std::path::PathBuf;
use std::process::Command;

#[path = "exchange/keras_hidden.rs"]
mod keras_hidden;
#[path = "exchange/keras_valid.rs"]
mod keras_valid;
#[path = "exchange/torch_hidden.rs"]
mod torch_hidden;
#[path = "exchange/torch_same.rs"]
mod torch_same;

fn at(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn read(path: &str) -> Vec<u8> {
    std::fs::read(at(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// A window of random 16-bit values; every fourth window has only the extreme values.
fn window(draw: &mut Draw, index: u64, length: usize) -> Vec<i16> {
    let ends = [i16::MIN, i16::MAX, 0, -i16::MAX];
    let value = |draw: &mut Draw| (draw.unit() * 65536.0 - 32768.0).floor() as i16;
    (0..length)
        .map(|_| if index.is_multiple_of(4) { ends[(draw.unit() * 4.0) as usize % 4] } else { value(draw) })
        .collect()
}

/// Compares the engine's network of a module with the interpreter, and its counts with the scaling.
macro_rules! agrees {
    ($module:ident, $padding:expr, $streams:expr) => {{
        use $module::{COLUMNS, FULL_SCALE, INPUTS, Window, counts, load, self_test, values};
        let name = stringify!($module);
        let network = load().expect(name);
        assert!(self_test(network), "{name}");
        let layers = read(&format!("tests/exchange/{name}.layers"));
        let interpreter = Interpreter::new(&layers, $padding).expect(name);
        let mut engine = Window::new(network);
        let mut clipped_windows = 0;
        for index in 0..400 {
            let window = window(&mut Draw::new(11, Purpose::PeerWindows, index), index, COLUMNS * INPUTS);
            let expected = interpreter.run(&window);
            let columns: &[[i16; INPUTS]; COLUMNS] =
                window.as_chunks::<INPUTS>().0.try_into().expect("columns");
            let (Sums(sums), clipped) = engine.evaluate(columns);
            assert_eq!((sums.as_slice(), clipped as usize), (&expected.sums[..], expected.clipped), "{name}");
            clipped_windows += usize::from(clipped > 0);
            if $streams {
                let mut stream = Streaming::<_, i16, INPUTS>::new(network);
                let last = columns.iter().fold(Sums::default(), |_, column| stream.push(column).0);
                assert_eq!(last, Sums(sums), "{name}");
            }
        }
        assert!(clipped_windows > 0, "{name}: no window reaches full scale");

        let onnx = import(&read(&format!("peers/exchange/golden/{name}.onnx"))).expect(name);
        let file = read(&format!("peers/exchange/golden/{name}.safetensors"));
        let samples = Samples::read(&file, onnx.network.shape(), onnx.layout).expect(name);
        let scale = InputScale::from_samples(&samples, INPUTS);
        assert_eq!(scale.full_scales(), FULL_SCALE);
        let mut largest = 0.0_f32;
        for (window, outputs) in samples.windows.iter().zip(&samples.outputs) {
            let columns: &[[f32; INPUTS]; COLUMNS] =
                window.as_chunks::<INPUTS>().0.try_into().expect("columns");
            let columns = columns.map(|column| counts(&column));
            assert_eq!(columns.as_flattened(), scale.counts(window).0, "{name}");
            let Sums(sums) = engine.evaluate(&columns).0;
            for (found, expected) in values(&sums).iter().zip(outputs) {
                largest = largest.max((found - expected).abs());
            }
        }
        largest
    }};
}

#[test]
fn generated_sources_give_the_sums_of_the_interpreter_in_the_engine() {
    // Largest difference from the framework's outputs, whose magnitude is 2 to 6.
    let same = agrees!(torch_same, Padding::Same, false);
    let eight = agrees!(keras_valid, Padding::Valid, true);
    let wide = agrees!(torch_hidden, Padding::Valid, true);
    let packed = agrees!(keras_hidden, Padding::Valid, true);
    assert!(same < 0.04 && eight < 0.05 && packed < 0.05 && wide < 2e-4, "{same} {eight} {packed} {wide}");
}

#[test]
fn importing_again_writes_the_same_files() {
    let directory = tempfile::tempdir().expect("directory");
    for (name, options) in [
        ("torch_same", &[][..]),
        ("keras_valid", &["--mode", "w8a8"]),
        ("torch_hidden", &["--mode", "w16a16"]),
        ("keras_hidden", &["--packing", "flash"]),
    ] {
        let golden = |extension: &str| at(&format!("peers/exchange/golden/{name}.{extension}"));
        let output = Command::new(env!("CARGO_BIN_EXE_model-quant"))
            .args(["import".as_ref(), golden("onnx").as_os_str(), "--samples".as_ref()])
            .args([golden("safetensors").as_os_str(), "--out".as_ref(), directory.path().as_os_str()])
            .args(options)
            .output()
            .expect("model-quant");
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        for extension in ["layers", "rs", "md"] {
            let file = format!("{name}.{extension}");
            let written = std::fs::read(directory.path().join(&file)).expect("written");
            assert!(
                written == read(&format!("tests/exchange/{file}")),
                "{file} differs from the checked-in one"
            );
        }
    }
}

/// Layers of both networks of a shipped image.
fn networks(image: &[u8]) -> [&[u8]; 2] {
    let layers = &image[HEADER_LENGTH..image.len() - CRC_LENGTH];
    let mut length = 0;
    for _ in 0..4 {
        let shape = layers[length..].first_chunk::<SHAPE_LENGTH>().and_then(LayerShape::from_bytes);
        length += shape.expect("shape").length();
    }
    let (collision, friction) = layers.split_at(length);
    [collision, friction]
}

#[test]
fn the_interpreter_agrees_with_the_engine_on_the_shipped_networks() {
    for bearing in BearingMaterial::ALL {
        let image = shipped(bearing);
        let model: Model = Model::load(image).expect("image");
        let [collision, friction] =
            networks(image).map(|bytes| Interpreter::new(bytes, Padding::Valid).expect("layers"));
        assert_eq!(collision.scale(), model.collision().scale().to_f64());
        for index in 0..100 {
            let mut draw = Draw::new(12, Purpose::PeerWindows, index);
            let wide = window(&mut draw, index, 8 * 8);
            let mut stream = Streaming::<_, i16, 8>::new(*model.collision());
            let last =
                wide.as_chunks::<8>().0.iter().fold(Sums::default(), |_, column| stream.push(column).0);
            assert_eq!(collision.run(&wide).sums, last.0);
            let narrow = window(&mut draw, index, 8 * 4);
            let mut stream = Streaming::<_, i16, 4>::new(*model.friction());
            let last =
                narrow.as_chunks::<4>().0.iter().fold(Sums::default(), |_, column| stream.push(column).0);
            assert_eq!(friction.run(&narrow).sums, last.0);
        }
    }
}

#[test]
fn bytes_other_than_layers_are_refused() {
    let layers = read("tests/exchange/torch_same.layers");
    // A cut at the end of a layer leaves a shorter network; any other cut is refused.
    let accepted =
        (1..layers.len()).filter(|&length| Interpreter::new(&layers[..length], Padding::Same).is_ok());
    assert_eq!(accepted.count(), 2);
    assert!(Interpreter::new(&layers[..layers.len() - 1], Padding::Same).is_err());
    assert!(Interpreter::new(&[0; 64], Padding::Same).is_err());
}
