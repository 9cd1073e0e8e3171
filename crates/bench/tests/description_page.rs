//! `docs/description.md` equals the entries of the sections. `WRITE_DESCRIPTION=1 cargo test -p
//! bench --test description_page` writes it.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bench::schema::{FieldEntry, FieldKind, SectionEntry, Shape};
use bench::{Bench, Channel, PRESETS, Role};
use std::fmt::Write as _;
use std::path::Path;

const HEAD: &str = "# Bench description

Every field of a bench description (TOML). This page is generated from the sections in
`crates/bench/src/description`, and a test checks it. `host-sim describe LOG` writes a commented
template for a log; the files in `examples` and `crates/bench/presets` are complete descriptions.

* All values are in SI units. The unit is the suffix of a name, or is given here.
* Unknown fields and values outside their range are refused. One message lists every wrong and every
  missing field with its line; exit code 2. A value `\"?\"` counts as not filled in.
* The ranges are far beyond any machine: they protect the model from overflow and endless runs. A
  few depend on other fields; their meaning says so.
* Units of an axis are those of a linear or a rotary axis: `N or N m`.

The first entry is always `plant`, the name of the plant. It determines the sections.
";

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// Prose in lines of at most 100 columns.
fn wrapped(text: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= 100 => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines.join("\n")
}

/// Values that a field allows: names, or a range.
fn values(field: &FieldEntry) -> String {
    match field.kind {
        FieldKind::Name(names) => {
            names().iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
        }
        FieldKind::Number | FieldKind::NumberPerChannel if field.range.is_none() => "number".into(),
        FieldKind::Number | FieldKind::NumberPerChannel | FieldKind::Integer => {
            let expected = field.expected();
            let range = expected.split_once(", ").map_or(expected.as_str(), |(_, range)| range).to_owned();
            let range = range.strip_suffix(field.unit()).unwrap_or(&range).trim_end().to_owned();
            if matches!(field.kind, FieldKind::Integer) { format!("integer, {range}") } else { range }
        }
        FieldKind::Pair => {
            let expected = field.expected();
            let range = expected.strip_prefix("two numbers, [x, y], ").map(|range| {
                let range = range.strip_suffix(field.unit()).unwrap_or(range).trim_end();
                format!(", each {range}")
            });
            format!("`[x, y]`{}", range.unwrap_or_default())
        }
        FieldKind::Text => "text".into(),
        other => other.describe(),
    }
}

fn row(section: &SectionEntry, field: &FieldEntry) -> String {
    let default = match (field.is_required(), section.default_of(field)) {
        (true, _) => "required".into(),
        (false, Some(default)) => format!("`{default}`"),
        (false, None) => "none".into(),
    };
    let channel = if matches!(field.kind, FieldKind::NumberPerChannel) { ".<channel>" } else { "" };
    format!(
        "| `{}{channel}` | {} | {} | {default} | {} |\n",
        field.name,
        field.unit(),
        cell(&values(field)),
        cell(&field.meaning())
    )
}

fn write_section(page: &mut String, section: &SectionEntry, level: &str) {
    let (name, required) = (section.name, if section.is_required { "required" } else { "optional" });
    let heading = match section.shape {
        Shape::Table => format!("`[{name}]`"),
        Shape::PerChannel => format!("`[{name}]`, `<channel> = {{ ... }}`"),
        Shape::PerSignal => format!("`[{name}]`, `t_s = {{ ... }}`, `<channel> = \"expression\"`"),
        Shape::PerParameter => format!("`[{name}]`, `\"section.field\" = number`"),
        Shape::Effects | Shape::Entries => format!("`[[{name}]]`"),
    };
    let meaning = wrapped(&format!("{} ({required}).", section.meaning.trim_end_matches('.')));
    let _ = write!(page, "\n{level} {heading}\n\n{meaning}\n");
    if !section.fields.is_empty() {
        page.push_str("\n| field | unit | values | default | meaning |\n|---|---|---|---|---|\n");
        section.fields.iter().for_each(|field| page.push_str(&row(section, field)));
    }
}

/// Names of a plant's parameters that may be declared uncertain: those of its sections.
fn parameters(plant: &str) -> Vec<String> {
    let mut bench = preset(plant);
    let sections =
        Bench::sections(plant).unwrap().into_iter().filter(|section| section.shape == Shape::Table);
    let names = sections.flat_map(|section| {
        section.fields.iter().map(move |field| format!("{}.{}", section.name, field.name))
    });
    names.filter(|name| bench.parameter_mut(name).is_some()).collect()
}

fn preset(plant: &str) -> Bench {
    let benches = PRESETS.iter().map(|(name, _)| Bench::open(name).unwrap());
    benches.into_iter().find(|bench| bench.plant_name() == plant).unwrap()
}

fn page() -> String {
    let mut page = String::from(HEAD);
    let is_common = |section: &SectionEntry| {
        Bench::PLANTS
            .iter()
            .all(|plant| Bench::sections(plant).unwrap().iter().any(|other| other.name == section.name))
    };
    for plant in Bench::PLANTS {
        let _ = write!(page, "\n## `plant = \"{plant}\"`\n");
        for section in Bench::sections(plant).unwrap().iter().filter(|section| !is_common(section)) {
            write_section(&mut page, section, "###");
        }
        let names = parameters(plant);
        if !names.is_empty() {
            let list = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
            let list = wrapped(&format!("Parameters for `[uncertain]`: {list}."));
            let _ = write!(page, "\n{list}\n");
        }
    }
    page.push_str("\n## Sections of every plant with a log\n");
    for section in Bench::sections(Bench::PLANTS[0]).unwrap().iter().filter(|section| is_common(section)) {
        write_section(&mut page, section, "###");
    }
    page.push_str(
        "\n`[uncertain]` also accepts `sensors.<channel>.offset`, `.gain` and `.delay_s`. Of a \
         mechanism it\naccepts `body.<name>.mass_kg` and `.inertia_kg_m2`; `joint.<name>.clearance_m`, \
         `.backlash_m` and\n`.drive_speed`; `contact.<name>.youngs_modulus_pa`, `.coefficient`, \
         `.restitution` and\n`.coulomb_coefficient`, where the description has the number. The name of a \
         joint is that of its two\nbodies, such as `crank_coupler`. The effects and their parameters are \
         in [effects.md](effects.md).\n\n## Channels\n\n\
         | channel | unit | role | meaning |\n|---|---|---|---|\n",
    );
    for channel in Channel::ALL {
        let role = if channel.role() == Role::Input { "input" } else { "output" };
        let _ = writeln!(page, "| `{channel}` | {} | {role} | {} |", channel.unit(), channel.meaning());
    }
    page.push_str(
        "\nWith `drive.simulates = \"motion\"`, position and speed of an axis are outputs. Its effort or \
         voltage\nis the input, or an output beside an input that comes before it: order, voltage, \
         effort.\n",
    );
    page
}

#[test]
fn the_page_is_the_entries_of_the_sections() {
    let page = page();
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/description.md"));
    if std::env::var_os("WRITE_DESCRIPTION").is_some() {
        bench::atomic::write(path, page.as_bytes()).unwrap();
    }
    let found = std::fs::read_to_string(path).unwrap_or_default();
    assert!(found == page, "docs/description.md differs from the sections: WRITE_DESCRIPTION=1 writes it");
}

#[test]
fn every_field_of_every_preset_is_in_the_sections_of_its_plant() {
    for (name, text) in PRESETS {
        let bench = Bench::open(name).unwrap();
        let sections = Bench::sections(bench.plant_name()).unwrap();
        let table: toml::Table = toml::from_str(text).unwrap();
        for (section, value) in table.iter().filter(|(section, _)| *section != "plant") {
            let entry = sections.iter().find(|entry| entry.name == section).unwrap();
            if entry.shape == Shape::Table {
                let names = value.as_table().unwrap().keys();
                names.for_each(|field| {
                    assert!(entry.fields.iter().any(|e| e.name == field), "{section}.{field}")
                });
            }
        }
    }
}

#[test]
fn every_section_and_every_field_has_a_meaning() {
    for plant in Bench::PLANTS {
        for section in Bench::sections(plant).unwrap() {
            assert!(section.meaning.ends_with('.'), "{}: {}", section.name, section.meaning);
            for field in section.fields {
                let meaning = field.meaning();
                assert!(meaning.len() > 4 && meaning.ends_with('.'), "{}: {meaning}", field.name);
            }
        }
    }
}
