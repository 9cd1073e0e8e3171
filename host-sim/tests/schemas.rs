//! JSON schemas of the results: the published files are those of the program, and real results
//! satisfy them.
//!
//! `WRITE_SCHEMA=1 cargo test -p host-sim --test schemas` writes the files.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use boon::{Compiler, Schemas};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/schema");

fn host_sim(directory: &Path, arguments: &[&str]) -> Vec<u8> {
    let program = env!("CARGO_BIN_EXE_host-sim");
    let output = Command::new(program).current_dir(directory).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

fn names() -> Vec<String> {
    let list = String::from_utf8(host_sim(Path::new("."), &["schema"])).unwrap();
    list.lines().filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect()
}

/// Returns why a result does not satisfy a schema of the program; empty if it does.
fn violations(name: &str, result: &Value) -> String {
    let schema: Value = serde_json::from_slice(&host_sim(Path::new("."), &["schema", name])).unwrap();
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler.add_resource("schema.json", schema).unwrap();
    let schema = compiler.compile("schema.json", &mut schemas).unwrap();
    schemas.validate(result, schema).err().map_or_else(String::new, |error| format!("{error:#}"))
}

#[test]
fn the_published_schemas_are_those_of_the_program() {
    let folder = Path::new(FOLDER);
    let mut expected: Vec<String> = names().iter().map(|name| format!("{name}.json")).collect();
    expected.sort();
    for (file, name) in expected.iter().zip(expected.iter().map(|file| file.trim_end_matches(".json"))) {
        let schema = String::from_utf8(host_sim(Path::new("."), &["schema", name])).unwrap();
        let path = folder.join(file);
        if std::env::var_os("WRITE_SCHEMA").is_some() {
            bench::atomic::write(&path, schema.as_bytes()).unwrap();
        }
        let published = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(published == schema, "{file} differs; WRITE_SCHEMA=1 writes it");
    }
    let entries = std::fs::read_dir(folder).unwrap();
    let mut found: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    found.sort();
    assert_eq!(found, expected);
}

#[test]
fn real_results_satisfy_their_schemas() {
    let folder = tempfile::tempdir().unwrap();
    let example = include_str!("../../examples/servo-axis.toml");
    let (axis, _) = example.split_once("[columns]").unwrap();
    std::fs::write(folder.path().join("axis.toml"), axis).unwrap();
    let sweep = "bench = \"bench-b\"\nbearings = [\"babbitt\"]\nforce = \"law\"\nsampling = \"grid\"\n\
                 [[parameters]]\npath = \"bearing.radial_clearance_m\"\nvalues = [1e-4, 5e-4]\n";
    std::fs::write(folder.path().join("sweep.toml"), sweep).unwrap();
    for (name, arguments) in [
        ("record", "record --bench axis.toml --out log.csv --json"),
        ("describe", "describe log.csv --json"),
        ("check", "check log.csv --bench axis.toml --json"),
        ("evaluate", "evaluate log.csv --bench axis.toml --json"),
        ("diagnose", "diagnose log.csv --bench axis.toml --json"),
        ("run", "run --json"),
        ("run-mechanism", "run --bench four-bar --json"),
        ("run-slider-crank", "run --bench slider-crank --json"),
        ("claims", "claims --runs 1 --json"),
        ("laws", "laws --json"),
        ("life", "life --bearing plastic --cycles 1e3 --json"),
        ("validate", "validate --json"),
        ("sweep-file", "sweep sweep.toml --json"),
        ("sweep-latch", "sweep latch --json"),
        ("accuracy-worlds", "accuracy --worlds 1 --bearing plastic --json"),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let result: Value = serde_json::from_slice(&host_sim(folder.path(), &arguments)).unwrap();
        assert_eq!(violations(name, &result), "", "{name}");
    }
}

#[test]
fn a_result_with_a_missing_field_does_not_satisfy_its_schema() {
    let mut laws: Value = serde_json::from_slice(&host_sim(Path::new("."), &["laws", "--json"])).unwrap();
    assert_eq!(violations("laws", &laws), "");
    laws["laws"][0].as_object_mut().unwrap().remove("name");
    assert!(violations("laws", &laws).contains("name"));
}
