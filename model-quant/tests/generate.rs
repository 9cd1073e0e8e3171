//! Tests of `model-quant generate c` on the command line: the folder, and what is refused.
//! `cargo xtask c-library --check` compiles the folder and runs its programs.
#![allow(clippy::expect_used, reason = "a test that cannot set itself up has failed")]

use std::path::Path;
use std::process::{Command, Output};

fn generate(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_model-quant"));
    command.current_dir(folder).args(["generate", "c"]).args(arguments).output().expect("model-quant")
}

#[test]
fn a_folder_has_every_platform_and_the_chosen_image() {
    let directory = tempfile::tempdir().expect("folder");
    let folder = directory.path();
    std::fs::create_dir_all(folder.join("libraries/one")).expect("platform");
    std::fs::write(folder.join("libraries/one/libpintle_model.a"), "library").expect("library");
    let arguments = ["--libraries", "libraries", "--bearing", "plastic", "--out", "out", "--json"];
    let made = generate(folder, &arguments);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let result: serde_json::Value = serde_json::from_slice(&made.stdout).expect("json");
    let files: Vec<&str> =
        result["files"].as_array().expect("files").iter().filter_map(|file| file.as_str()).collect();
    for file in ["include/pintle_image_plastic.h", "lib/one/libpintle_model.a", "include/pintle_model.h"] {
        assert!(files.contains(&file), "{file}");
    }
    assert!(files.iter().all(|file| folder.join("out").join(file).is_file()));
    assert!(!files.iter().any(|file| file.contains("babbitt")));
    // An image of an earlier call stays in the folder, but is no target of the package.
    let both = ["--libraries", "libraries", "--out", "out"];
    assert!(generate(folder, &both).status.success() && generate(folder, &arguments).status.success());
    let config = std::fs::read_to_string(folder.join("out/cmake/pintle-model-config.cmake")).expect("config");
    assert!(config.contains("IN ITEMS plastic)") && !config.contains("file(GLOB"), "{config}");
    assert!(config.contains("set(_pintle_platforms one)"), "{config}");
}

#[test]
fn a_folder_without_libraries_and_wrong_images_are_refused() {
    let directory = tempfile::tempdir().expect("folder");
    let folder = directory.path();
    let refused = |arguments: &[&str], reason: &str| {
        let output = generate(folder, arguments);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(reason), "{text}");
        assert!(!folder.join("pintle-model").exists());
    };
    refused(&["--libraries", "none"], "none: found no PLATFORM/libpintle_model.a; `cargo xtask c-library`");
    std::fs::create_dir_all(folder.join("libraries/one")).expect("platform");
    std::fs::write(folder.join("libraries/one/libpintle_model.a"), "library").expect("library");
    let image = inference::shipped(inference::BearingMaterial::Babbitt);
    std::fs::write(folder.join("a.pintle"), image).expect("image");
    std::fs::write(folder.join("short.pintle"), &image[..80]).expect("image");
    let with = |images: [&'static str; 2]| [&["--libraries", "libraries"], &images[..]].concat();
    refused(&with(["a.pintle", "short.pintle"]), "short.pintle: model image: found 80 bytes");
    refused(&with(["a.pintle", "a.pintle"]), "a second image for the babbitt bearing: a.pintle");
    refused(&with(["a.pintle", "none.pintle"]), "none.pintle: ");
}
