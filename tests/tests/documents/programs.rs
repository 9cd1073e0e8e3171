//! The programs that the documents call: where they are, and what their command lines accept.

use clap::error::ErrorKind;
use std::path::PathBuf;

/// Ways in which documents call a program of the project, and its name in the target folder. An
/// entry comes before those that it begins with.
const CALLS: [(&str, &str); 6] = [
    ("cargo run --release -p host-sim --features probe -- ", "host-sim "),
    ("cargo run --release -p host-sim -- ", "host-sim "),
    ("cargo run --release -p host-sim", "host-sim"),
    ("cargo run --release -p model-quant -- ", "model-quant "),
    ("cargo xtask mystery", "mystery"),
    ("cargo xtask hidden-effects", "hidden_effects"),
];

/// Returns the line with each call of a program through cargo replaced by the program's name.
pub(crate) fn direct(line: &str) -> String {
    CALLS.iter().fold(line.to_owned(), |line, (call, name)| line.replace(call, name))
}

/// Returns the path of a program of another package, which is beside the tests' folder.
pub(crate) fn path(name: &str) -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let path = test.ancestors().nth(2).unwrap().join(name);
    assert!(path.exists(), "{path:?} is not built; `--test cli` beside `--test documents` builds it");
    path
}

/// Returns the definition of a program's command line; `None` for other programs.
pub(crate) fn definition(name: &str) -> Option<clap::Command> {
    match name {
        "host-sim" => Some(host_sim::program::definition()),
        "model-quant" => Some(model_quant::cli::definition()),
        _ => None,
    }
}

/// Splits a line into the words of its commands, without variables before them and without files
/// of redirections.
pub(crate) fn calls(line: &str) -> Vec<Vec<String>> {
    let words = shlex::split(&direct(line)).unwrap_or_default();
    let parts = words.split(|word| ["&&", "||", "|", "&"].contains(&word.as_str()));
    let is_variable = |word: &&String| word.split_once('=').is_some_and(|(name, _)| is_name(name));
    parts
        .map(|part| {
            let words = part.iter().skip_while(is_variable);
            words.take_while(|word| ![">", ">>", "<"].contains(&word.as_str())).cloned().collect()
        })
        .filter(|words: &Vec<String>| !words.is_empty())
        .collect()
}

fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_ascii_uppercase() || c == '_')
}

/// Returns why the programs of a line refuse it; `None` if they accept it or none is the project's.
pub(crate) fn refusal(line: &str) -> Option<clap::Error> {
    calls(line).into_iter().find_map(|words| {
        let parsed = definition(words.first()?)?.try_get_matches_from(&words);
        let is_help =
            |e: &clap::Error| matches!(e.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
        parsed.err().filter(|error| !is_help(error))
    })
}

#[test]
fn a_wrong_option_or_command_is_refused() {
    assert!(refusal("cargo run --release -p host-sim -- run --controller emulated --watch").is_none());
    assert!(refusal("A=$(b c) host-sim run --serve 0 && curl x | sed s").is_none());
    assert!(refusal("host-sim laws --json > laws.json   # comment").is_none());
    for wrong in [
        "host-sim run --controler native",
        "cargo run --release -p host-sim -- dignose log.csv",
        "true && model-quant train --epochs many",
        "host-sim update",
    ] {
        assert!(refusal(wrong).is_some(), "{wrong}");
    }
}
