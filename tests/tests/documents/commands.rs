//! Every command of the documents runs, or is parsed where it cannot run in a test.

use super::markdown::{self, Document, Part, documents, is_shell};
use super::programs::{self, direct, refusal};
use clap::error::ErrorKind;
use rayon::prelude::*;
use std::path::Path;
use std::process::{Command, Output};
use std::time::Instant;

/// Page whose commands are the examples in the help of every command: they are parsed.
const REFERENCE: &str = "docs/commands.md";

/// Commands that are not run, by a part of their line, and why. Those of `host-sim` and
/// `model-quant` are parsed.
const NOT_RUN: [(&str, &str); 15] = [
    ("--controller attached", "needs a board"),
    ("host-sim flash", "needs the image of a board, or the board"),
    ("dfu-util", "needs a board"),
    ("rust-objcopy", "needs a program of another project"),
    ("cargo xtask", "builds or measures for minutes; a test of `xtask` parses it"),
    ("cargo build", "compiles for minutes"),
    ("--serve", "serves until control-C"),
    ("curl", "needs a running server"),
    ("hq ", "needs a cluster"),
    ("examples/scale-out", "needs a cluster"),
    ("model-quant generate c", "needs libraries that `cargo xtask c-library` links"),
    ("shaft.fmu", "stands for a file of the reader"),
    ("bench.mf4", "stands for a file of the reader"),
    ("bench.tdms", "stands for a file of the reader"),
    ("bench.mat", "stands for a file of the reader"),
];

/// Commands that start the emulator.
const EMULATED: [&str; 3] = ["--controller emulated", "host-sim link", "host-sim update"];

/// Limit of one command, s.
const TIMEOUT_S: &str = "120";

/// Outcome of the commands of a document.
#[derive(Default)]
struct Tally {
    run: usize,
    parsed: usize,
    /// Commands of cargo or of programs that are not the project's.
    left: usize,
    /// Entries of [`NOT_RUN`] that applied.
    reasons: Vec<usize>,
    failures: Vec<String>,
}

/// Commands of one code block and the output that the document shows for them.
fn blocks(document: &Document) -> Vec<(Vec<markdown::Command>, Option<String>)> {
    let mut found: Vec<(Vec<markdown::Command>, Option<String>)> = vec![];
    let mut is_output_next = false;
    for part in document.parts() {
        match part {
            Part::Block(language, content) if is_shell(&language) => {
                found.push((markdown::commands(&language, &content), None));
                is_output_next = true;
            }
            Part::Block(language, content) => {
                if let (true, "text", Some(last)) = (is_output_next, language.as_str(), found.last_mut()) {
                    last.1 = Some(content);
                }
                is_output_next = false;
            }
            Part::Heading(_) => is_output_next = false,
            _ => {}
        }
    }
    found
}

/// Number in [`NOT_RUN`] of the reason why a command is not run.
fn reason(line: &str) -> Option<usize> {
    let line = direct(line);
    NOT_RUN.iter().position(|(part, _)| line.contains(part))
}

fn is_run(document: &Document, line: &str) -> bool {
    let needs_emulator = EMULATED.iter().any(|part| direct(line).contains(part));
    let has_emulator = cfg!(feature = "emulated");
    document.path != Path::new(REFERENCE) && reason(line).is_none() && (has_emulator || !needs_emulator)
}

/// Returns a folder with what the commands of a page expect at the root of the project.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let examples = markdown::root().join("examples");
    let copied = Command::new("cp").arg("-r").arg(examples).arg(folder.path()).status().unwrap();
    assert!(copied.success());
    std::fs::create_dir(folder.path().join("bin")).unwrap();
    let link = |name: &str, path: &Path| {
        std::os::unix::fs::symlink(path, folder.path().join("bin").join(name)).unwrap();
    };
    link("mystery", Path::new(env!("CARGO_BIN_EXE_mystery")));
    for name in ["host-sim", "model-quant"] {
        link(name, &programs::path(name));
    }
    folder
}

fn run(folder: &Path, line: &str) -> Output {
    let search = format!("{}:{}", folder.join("bin").display(), std::env::var("PATH").unwrap());
    let mut shell = Command::new("timeout");
    shell.args([TIMEOUT_S, "sh", "-e", "-c", &direct(line)]).current_dir(folder);
    shell.env("PATH", search).stdin(std::process::Stdio::null()).output().unwrap()
}

/// Text with every sequence of blanks and line ends as one blank.
fn joined(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Part of the shown output that the real one does not have; a line `...` stands for any text.
fn missing_output<'a>(shown: &'a str, real: &str) -> Option<&'a str> {
    let real = joined(real);
    shown.split("...\n").find(|part| !real.contains(&joined(part)))
}

/// Runs or parses the commands of a document in their order.
fn try_document(document: &Document) -> Tally {
    let mut tally = Tally::default();
    let folder = folder();
    for (commands, shown) in blocks(document) {
        let (mut real, mut all_ran) = (String::new(), !commands.is_empty());
        for command in commands {
            let at = format!("{}: {}", document.path.display(), command.line);
            if let Some(error) = refusal(&command.line) {
                tally.failures.push(format!("{at}\n{error}"));
                continue;
            }
            if !is_run(document, &command.line) {
                all_ran = false;
                tally.reasons.extend(reason(&command.line));
                let calls = programs::calls(&command.line);
                let is_parsed = calls.iter().any(|words| programs::definition(&words[0]).is_some());
                *if is_parsed { &mut tally.parsed } else { &mut tally.left } += 1;
                continue;
            }
            let start = Instant::now();
            let output = run(folder.path(), &command.line);
            println!("{:6.1} s  {at}", start.elapsed().as_secs_f64());
            let printed = String::from_utf8_lossy(&output.stdout).into_owned();
            if output.status.success() {
                tally.run += 1;
            } else {
                let error = String::from_utf8_lossy(&output.stderr);
                tally.failures.push(format!("{at}\n{}: {error}", output.status));
            }
            if let Some(part) = missing_output(&command.output, &printed) {
                tally.failures.push(format!("{at}\nshown:\n{part}\nprinted:\n{printed}"));
            }
            real.push_str(&printed);
        }
        let missing = shown.as_deref().filter(|_| all_ran).and_then(|shown| missing_output(shown, &real));
        if let Some(part) = missing {
            tally.failures.push(format!("{}\nshown:\n{part}\nprinted:\n{real}", document.path.display()));
        }
    }
    tally
}

#[test]
fn every_command_runs_or_is_accepted() {
    let start = Instant::now();
    let tallies: Vec<Tally> = documents().par_iter().with_max_len(1).map(try_document).collect();
    let count = |of: fn(&Tally) -> usize| tallies.iter().map(of).sum::<usize>();
    let (run, parsed, left) = (count(|t| t.run), count(|t| t.parsed), count(|t| t.left));
    let seconds = start.elapsed().as_secs_f64();
    println!("{run} commands ran in {seconds:.0} s, {parsed} were parsed, {left} are of cargo or others");
    let failures: Vec<&String> = tallies.iter().flat_map(|tally| &tally.failures).collect();
    let texts: Vec<&str> = failures.iter().map(|failure| failure.as_str()).collect();
    assert!(failures.is_empty(), "{} failures:\n{}", texts.len(), texts.join("\n\n"));
    assert!(run > 30, "only {run} commands ran");
    for (number, (part, why)) in NOT_RUN.iter().enumerate() {
        let is_used = tallies.iter().any(|tally| tally.reasons.contains(&number));
        assert!(is_used, "no command contains `{part}` ({why}): delete the entry");
    }
}

#[test]
fn options_in_sentences_and_tables_exist() {
    let mut wrong = vec![];
    let mut count = 0;
    for document in documents() {
        for part in document.parts() {
            let Part::Code(code) = part else { continue };
            // Brackets enclose what may be left out, and dots stand for more.
            let line = code.replace(['[', ']'], "").replace("...", "");
            count += usize::from(refusal(&line).is_none());
            let is_wrong = |error: &clap::Error| {
                matches!(error.kind(), ErrorKind::UnknownArgument | ErrorKind::InvalidSubcommand)
            };
            wrong.extend(
                refusal(&line).filter(is_wrong).map(|error| (document.path.clone(), code, error.to_string())),
            );
        }
    }
    assert!(wrong.is_empty() && count > 30, "{count}: {wrong:#?}");
}

#[test]
fn shown_output_must_be_that_of_the_command() {
    assert_eq!(missing_output("a  b\n...\nc\n", "x a b y\nz c"), None);
    assert_eq!(missing_output("a\n...\nd\n", "a b c"), Some("d\n"));
}

#[test]
fn a_command_that_fails_is_a_failure() {
    let failing = "# A\n\n```sh\nhost-sim check no-such-log.csv --bench bench-b\n```\n";
    let refused = "# A\n\n```sh\nhost-sim run --controler native\n```\n";
    let different = "# A\n\n```sh\nhost-sim laws\n```\n\n```text\nno such law\n```\n";
    for text in [failing, refused, different] {
        let tally = try_document(&Document { path: "docs/x.md".into(), text: text.into() });
        assert_eq!(tally.failures.len(), 1, "{text}");
    }
}
