//! Folder for engineers who work in C: header, images as C arrays, static libraries, CMake package,
//! example.
//!
//! The files beside this one are its templates; `@NAME@` and the like stand for what depends on the
//! images. The header is that of the crate `c-interface`, whose library does the work.

mod library;

use inference::{Header, Model};
pub(crate) use library::{Libraries, LibrariesError, PackageFile};
use std::fmt::Write;

/// Number of words in a line of an array.
const WORDS_IN_A_LINE: usize = 8;

/// Templates that depend on the first bearing's name and on the version only.
const TEMPLATES: [(&str, &str); 11] = [
    ("include/pintle_model.h", include_str!("../../../../crates/c-interface/include/pintle_model.h")),
    ("cmake/pintle-model-config.cmake", include_str!("cmake/pintle-model-config.cmake")),
    ("cmake/pintle-model-config-version.cmake", include_str!("cmake/pintle-model-config-version.cmake")),
    ("example/CMakeLists.txt", include_str!("example/CMakeLists.txt")),
    ("example/cortex-m4.cmake", include_str!("example/cortex-m4.cmake")),
    ("example/main.c", include_str!("example/main.c")),
    ("example/print.h", include_str!("example/print.h")),
    ("example/host/print.c", include_str!("example/host/print.c")),
    ("example/cortex-m4/print.c", include_str!("example/cortex-m4/print.c")),
    ("example/cortex-m4/startup.c", include_str!("example/cortex-m4/startup.c")),
    ("example/cortex-m4/stm32f405.ld", include_str!("example/cortex-m4/stm32f405.ld")),
];

/// Returns the files of a folder for some images with their models, in a fixed order. The example
/// uses the first.
pub(crate) fn files(images: &[(&[u8], Model<'_>)], libraries: Libraries) -> Vec<PackageFile> {
    let mut files: Vec<PackageFile> = Vec::new();
    let mut names = Vec::new();
    for (image, model) in images {
        let name = model.header().bearing.name();
        let fill = |template| fill_image(template, image, &model.header(), model.checksum()).into_bytes();
        files.push((format!("include/pintle_image_{name}.h"), fill(include_str!("image.h"))));
        files.push((format!("src/pintle_image_{name}.c"), fill(include_str!("image.c"))));
        names.push(name);
    }
    let fill = |template: &str| {
        let version = env!("CARGO_PKG_VERSION");
        let text = template.replace("@NAME@", names.first().unwrap_or(&"")).replace("@VERSION@", version);
        text.replace("@NAMES@", &names.join(" and "))
            .replace("@BEARINGS@", &names.join(" "))
            .replace("@PLATFORMS@", &libraries.platforms().join(", "))
            .replace("@LIBRARIES@", &libraries.platforms().join(" "))
    };
    files.push(("README.md".into(), fill(include_str!("README.md")).into_bytes()));
    files.extend(TEMPLATES.iter().map(|(path, text)| ((*path).to_owned(), fill(text).into_bytes())));
    files.extend(libraries.into_files());
    files
}

/// Fills the template of an image's header or source.
fn fill_image(template: &str, image: &[u8], header: &Header, checksum: u32) -> String {
    let name = header.bearing.name();
    let clearance = header.radial_clearance_m();
    // `{:e}` writes the shortest digits that give the same number, as C reads them.
    let number = |value: f32| format!("{value:e}");
    let replacements = [
        ("@NAME@", name.to_owned()),
        ("@UPPER@", name.to_uppercase()),
        ("@SIZE@", image.len().to_string()),
        ("@CHECKSUM@", format!("{checksum:#010x}")),
        ("@CLEARANCE_LOW@", number(clearance.low)),
        ("@CLEARANCE_HIGH@", number(clearance.high)),
        ("@DEFORMATION@", number(header.deformation_m().high)),
        ("@RATIO@", number(header.rate_ratio().high)),
        ("@SLIDING@", number(header.sliding_speed_m_s().high)),
        ("@FORCE@", number(header.normal_force_n().high)),
        ("@FLOOR@", number(header.latch_floor_m_s())),
        ("@WORDS@", array_words(image)),
    ];
    replacements.iter().fold(template.to_owned(), |text, (mark, value)| text.replace(mark, value))
}

/// Formats an image, whose length is divisible by 4, as the words of an array.
fn array_words(image: &[u8]) -> String {
    let mut text = String::new();
    for line in image.as_chunks::<4>().0.chunks(WORDS_IN_A_LINE) {
        let line: Vec<String> =
            line.iter().map(|word| format!("{:#010x},", u32::from_le_bytes(*word))).collect();
        // Writing to a string does not fail.
        let _ = writeln!(text, "    {}", line.join(" "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use inference::{BearingMaterial, shipped};

    #[test]
    fn the_array_has_the_bytes_of_the_image_and_no_mark_remains() {
        let image = shipped(BearingMaterial::Plastic);
        let library = ("riscv".to_owned(), b"library".to_vec());
        let model = Model::load(image).expect("model");
        let files = files(&[(image, model)], Libraries::from([library]));
        let text = |path: &str| {
            let (_, bytes) = files.iter().find(|(name, _)| name == path).expect(path);
            String::from_utf8(bytes.clone()).expect("text")
        };
        let source = text("src/pintle_image_plastic.c");
        let array = source.split_once("= {\n").expect("array").1.trim_end_matches("};\n");
        let bytes: Vec<u8> = array
            .split(',')
            .filter_map(|word| u32::from_str_radix(word.trim().strip_prefix("0x")?, 16).ok())
            .flat_map(u32::to_le_bytes)
            .collect();
        assert_eq!(bytes, image);
        let header = text("include/pintle_image_plastic.h");
        assert!(header.contains(&format!("#define PINTLE_IMAGE_PLASTIC_SIZE {}\n", image.len())));
        for (path, bytes) in &files {
            assert!(!bytes.contains(&b'@'), "{path}");
        }
        assert_eq!(text("lib/riscv/libpintle_model.a"), "library");
        assert!(
            text("README.md").contains("riscv") && text("example/main.c").contains("pintle_image_plastic")
        );
    }
}
