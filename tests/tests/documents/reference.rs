//! Pages that are generated from code: `docs/commands.md` from the definitions of the command
//! lines, `docs/laws.md` from the catalogue of laws. `WRITE_REFERENCE=1` writes them.

use super::markdown::root;
use super::programs;
use clap::Arg;
use std::fmt::Write as _;
use std::process::Command;

const COMMANDS: &str = "# Commands

Every command and option of the programs `host-sim` and `model-quant`. This page is generated from
the definitions of their command lines, and a test checks it. `--help` prints the same. `cargo xtask
--help` lists the commands of the workspace.

Exit codes: 0 done, 1 the work failed or a check found a difference, 2 the input is wrong.
";

const LAWS: &str = "# Laws

The laws of contact and friction that a bench description may name. This page is generated from the
catalogue of laws, as `host-sim laws` prints it, and a test checks it. `e` is the coefficient of
restitution; `crates/contact/README.md` has the other symbols and the equations in which a factor
stands. [How to choose or add a law](how-to-law.md).
";

/// Prose in lines of at most 100 columns.
fn wrapped(text: &str) -> String {
    let mut lines: Vec<String> = vec![];
    for word in text.split_whitespace() {
        match lines.last_mut().filter(|line| line.chars().count() + 1 + word.chars().count() <= 100) {
            Some(line) => {
                line.push(' ');
                line.push_str(word);
            }
            None => lines.push(word.into()),
        }
    }
    lines.join("\n")
}

/// Text for Markdown outside of code: no tags, and no ends of cells.
fn escaped(text: &str) -> String {
    let parts = text.split('`').enumerate().map(|(number, part)| match number % 2 {
        0 => part.replace('<', "&lt;").replace('|', "\\|").replace('*', "\\*"),
        _ => part.replace('|', "\\|"),
    });
    parts.collect::<Vec<_>>().join("`").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Names of an argument with its value.
fn spelled(argument: &Arg) -> String {
    let names = argument.get_value_names().unwrap_or_default().iter().map(|name| format!("<{name}>"));
    let value = if argument.get_action().takes_values() {
        names.collect::<Vec<_>>().join(" ")
    } else {
        String::new()
    };
    let short = argument.get_short().map(|short| format!("-{short}"));
    let long = argument.get_long().map(|long| format!("--{long}"));
    let name = short.into_iter().chain(long).collect::<Vec<_>>().join(", ");
    format!("`{}`", [name, value].join(" ").trim().replace('|', "\\|"))
}

/// Row of the table of arguments.
fn row(argument: &Arg) -> String {
    let help = argument.get_long_help().or(argument.get_help()).map(ToString::to_string).unwrap_or_default();
    let mut meaning = escaped(help.trim_end_matches('.')) + ".";
    let values = argument.get_possible_values();
    if !values.is_empty() && argument.get_action().takes_values() {
        let value = |value: &clap::builder::PossibleValue| {
            let name = format!("`{}`", value.get_name());
            let help = value.get_help().map(|help| escaped(help.to_string().trim_end_matches('.')));
            help.map_or(name.clone(), |help| format!("{name}: {help}"))
        };
        let _ = write!(meaning, " Values: {}.", values.iter().map(value).collect::<Vec<_>>().join("; "));
    }
    let defaults: Vec<String> =
        argument.get_default_values().iter().map(|value| format!("`{}`", value.to_string_lossy())).collect();
    let default = if argument.is_required_set() { "required".into() } else { defaults.join(" ") };
    let default = if argument.get_action().takes_values() { default } else { String::new() };
    format!("| {} | {default} | {meaning} |\n", spelled(argument))
}

/// Text after a command's options: prose and examples.
fn write_after(page: &mut String, text: &str) {
    let lines = |paragraph: &str| paragraph.lines().map(|line| line.trim().to_owned()).collect::<Vec<_>>();
    for paragraph in text.split("\n\n") {
        match paragraph.strip_prefix("Examples:\n") {
            Some(examples) => {
                let _ = write!(page, "\n```sh\n{}\n```\n", lines(examples).join("\n"));
            }
            None if paragraph.starts_with("Exit codes") => {}
            None => {
                let _ = write!(page, "\n{}\n", wrapped(&escaped(paragraph)));
            }
        }
    }
}

/// Writes a command and its subcommands.
fn write_command(page: &mut String, command: &mut clap::Command, name: &str, level: &str) {
    let about = command.get_long_about().or(command.get_about()).map(ToString::to_string).unwrap_or_default();
    let _ = write!(page, "\n{level} `{name}`\n");
    for paragraph in about.split("\n\n") {
        let end = if paragraph.trim_end().ends_with(['.', ':']) { "" } else { "." };
        let _ = write!(page, "\n{}{end}\n", wrapped(&escaped(paragraph)));
    }
    let usage = command.render_usage().to_string();
    let _ =
        write!(page, "\n```text\n{}\n```\n", usage.trim_start_matches("Usage: ").replace("\n       ", "\n"));
    let is_program = !name.contains(' ');
    let rows: String = command
        .get_arguments()
        .filter(|argument| !argument.is_hide_set() && (is_program || !argument.is_global_set()))
        .filter(|argument| !["help", "version"].contains(&argument.get_id().as_str()))
        .map(row)
        .collect();
    if !rows.is_empty() {
        let _ = write!(page, "\n| argument | default | meaning |\n|---|---|---|\n{rows}");
    }
    if let Some(after) = command.get_after_long_help().or(command.get_after_help()) {
        write_after(page, &after.to_string());
    }
    let deeper = if is_program { "###" } else { "####" };
    for subcommand in command.get_subcommands_mut().filter(|c| !c.is_hide_set() && c.get_name() != "help") {
        let name = format!("{name} {}", subcommand.get_name());
        write_command(page, subcommand, &name, deeper);
    }
}

/// Standard output of `host-sim`.
fn host_sim(arguments: &[&str]) -> String {
    let output = Command::new(programs::path("host-sim")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}");
    String::from_utf8(output.stdout).unwrap()
}

fn commands() -> String {
    let mut page = String::from(COMMANDS);
    for name in ["host-sim", "model-quant"] {
        let mut definition = programs::definition(name).unwrap();
        definition.build();
        write_command(&mut page, &mut definition, name, "##");
    }
    page.push_str("\n## Results in JSON\n\nThe schemas are those that `host-sim schema NAME` prints.\n\n");
    page.push_str("| schema | result of |\n|---|---|\n");
    for line in host_sim(&["schema"]).lines() {
        let (name, of) = line.split_once(' ').unwrap();
        let _ = writeln!(page, "| [{name}](schema/{name}.json) | `{}` |", of.trim().replace(": ", "`: `"));
    }
    page
}

fn laws() -> String {
    let mut page = String::from(LAWS);
    let list: serde_json::Value = serde_json::from_str(&host_sim(&["laws", "--json"])).unwrap();
    let laws = list["laws"].as_array().unwrap();
    for group in laws.chunk_by(|a, b| a["field"] == b["field"]) {
        let _ = write!(
            page,
            "\n## `{}`\n\n| law | definition | range | source |\n|---|---|---|---|\n",
            text(&group[0], "field")
        );
        for law in group {
            let only = law["only_on"].as_str().map(|plants| format!(" Sticks and slides, on {plants}."));
            let cell =
                |name: &str| text(law, name).replace('|', "\\|").replace('*', "\\*").replace('<', "&lt;");
            let _ = writeln!(
                page,
                "| `{}` | {} | {}{} | {} |",
                text(law, "name"),
                cell("description"),
                cell("range"),
                only.map(|only| format!(".{only}")).unwrap_or_default(),
                cell("source")
            );
        }
    }
    page
}

fn text<'a>(law: &'a serde_json::Value, name: &str) -> &'a str {
    law[name].as_str().unwrap()
}

fn check(name: &str, page: &str) {
    let path = root().join("docs").join(name);
    if std::env::var_os("WRITE_REFERENCE").is_some() {
        bench::atomic::write(&path, page.as_bytes()).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(found == page, "docs/{name} differs from the program: WRITE_REFERENCE=1 writes it");
}

#[test]
fn the_page_of_commands_is_the_definition_of_the_command_lines() {
    check("commands.md", &commands());
}

#[test]
fn the_page_of_laws_is_the_catalogue() {
    check("laws.md", &laws());
}
