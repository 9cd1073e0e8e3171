//! Comparison of other runtimes with the shipped images, from checked-in results: neither Python
//! nor the runtimes are needed.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use inference::kernel::Portable;
use inference::{BearingMaterial, Model, Valid, WINDOW, Windowed, shipped};
use model_quant::evaluate::peers::{
    CHECKED_IN, RANDOM_WINDOWS, ROW_WINDOWS, Results, ResultsError, generate_windows, to_bytes,
};

fn results() -> [Results; 2] {
    CHECKED_IN.map(|(bytes, exact)| Results::from_bytes(bytes, exact).expect("results"))
}

#[test]
fn the_checked_in_windows_belong_to_the_shipped_images() {
    let stored: &[u8] = include_bytes!("../peers/windows.bin");
    assert!(
        stored == to_bytes(&generate_windows().expect("windows")),
        "run `model-quant verify --windows` and peers.py"
    );
}

#[test]
fn onnxruntime_gives_the_same_sums_bit_for_bit() {
    let [onnxruntime, _] = results();
    let all = generate_windows().expect("windows");
    assert!(onnxruntime.name.starts_with("ONNX Runtime"));
    for (network, (_, found)) in all.iter().zip(&onnxruntime.networks) {
        assert_eq!(&network.sums, found, "{} {}", network.bearing.name(), network.network);
        assert_eq!(found.len(), RANDOM_WINDOWS + ROW_WINDOWS);
        let image = shipped(network.bearing);
        let verdict = onnxruntime.compare(&all, network.bearing, network.network, image).expect("same image");
        assert_eq!((verdict.different, verdict.largest_n), (0, 0.0));
    }
}

#[test]
fn litert_differs_by_its_rounding_alone() {
    let [_, litert] = results();
    let all = generate_windows().expect("windows");
    for network in &all {
        let name = format!("{} {}", network.bearing.name(), network.network);
        let verdict = litert
            .compare(&all, network.bearing, network.network, shipped(network.bearing))
            .expect("same image");
        assert!(verdict.mean_n < 0.5 && verdict.largest_n < 10.0, "{name}: {verdict:?}");
    }
}

#[test]
fn a_single_changed_sum_is_detected() {
    let [mut onnxruntime, _] = results();
    let all = generate_windows().expect("windows");
    let changed = all
        .iter()
        .position(|found| found.bearing == BearingMaterial::Plastic && found.network == "friction")
        .expect("friction network");
    onnxruntime.networks[changed].1[RANDOM_WINDOWS + 7] += 1;
    let compare = |network| {
        onnxruntime
            .compare(&all, BearingMaterial::Plastic, network, shipped(BearingMaterial::Plastic))
            .expect("same image")
    };
    assert_eq!(compare("collision").different, 0);
    assert_eq!((compare("friction").different, compare("friction").largest_counts), (1, 1));
}

#[test]
fn the_stream_gives_the_sums_of_the_complete_window() {
    for network in generate_windows().expect("windows") {
        let model: Model = Model::load(shipped(network.bearing)).expect("image");
        macro_rules! evaluate {
            ($network:expr, $inputs:literal) => {{
                let mut complete = Windowed::<_, i16, $inputs, WINDOW, Valid, Portable>::new($network);
                let (columns, _) = network.features.as_chunks::<$inputs>();
                let (windows, _) = columns.as_chunks::<WINDOW>();
                windows.iter().map(|window| complete.evaluate(window).0.0[0]).collect::<Vec<i32>>()
            }};
        }
        let found = match network.network {
            "collision" => evaluate!(*model.collision(), 8),
            _ => evaluate!(*model.friction(), 4),
        };
        assert_eq!(found, network.sums);
    }
}

#[test]
fn other_files_are_refused() {
    let [(good, _), _] = CHECKED_IN;
    let mut bytes = good.to_vec();
    bytes.push(0);
    let expected = good.len();
    assert_eq!(
        Results::from_bytes(&bytes, true),
        Err(ResultsError::Length { found: expected + 1, expected })
    );
    // Two networks of two materials.
    let expected = 4;
    let found = expected as u32 + 1;
    bytes[12] = found as u8;
    assert_eq!(Results::from_bytes(&bytes, true), Err(ResultsError::Networks { found, expected }));
    for length in [0, 7, 11, 15] {
        assert_eq!(Results::from_bytes(&good[..length], true), Err(ResultsError::Magic));
    }
    assert!(Results::from_bytes(&good[..200], true).is_err());
}
