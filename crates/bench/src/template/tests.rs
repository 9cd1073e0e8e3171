//! Templates of recorded and of foreign logs, filled in as a user would.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use super::*;
use crate::reading::FILL_IN;
use crate::simulate::record;
use crate::{Bench, MeasuredLog};
use toml::{Table, Value};

fn raw(text: &str) -> RawLog {
    RawLog::from_bytes("a.csv", text.as_bytes().to_vec()).unwrap()
}

/// Replaces every open value by that of another description.
fn filled_in(template: &Template, known: &Table) -> String {
    let mut table: Table = toml::from_str(&template.toml).unwrap();
    for name in &template.to_fill_in {
        let (section, field) = name.split_once('.').unwrap();
        let value = known[section].as_table().unwrap()[field].clone();
        let place = &mut table[section].as_table_mut().unwrap()[field];
        assert_eq!(*place, Value::String(FILL_IN.into()), "{name}");
        *place = value;
    }
    table.to_string()
}

#[test]
fn the_filled_in_template_of_a_recorded_log_describes_the_bench_that_recorded_it() {
    for name in ["bench-b", "friction-rig"] {
        let mut bench = Bench::open(name).unwrap();
        bench.set_cycles(3);
        let log = record(&bench, 4).unwrap();
        let template = template(&raw(&log.to_csv()), None).unwrap();
        assert_eq!(template.plant, bench.plant_name());
        let known: Table = toml::from_str(&bench.to_toml().unwrap()).unwrap();
        let described = Bench::parse("template", &filled_in(&template, &known)).unwrap();
        assert!(
            (described.period_s() / bench.period_s() - 1.0).abs() < 0.02,
            "{name} {}",
            described.period_s()
        );
        assert!((described.stroke() / bench.stroke() - 1.0).abs() < 0.02, "{name} {}", described.stroke());
        assert!((described.sample_rate_hz() / bench.sample_rate_hz() - 1.0).abs() < 1e-3, "{name}");
        let read = MeasuredLog::parse("a.csv", &log.to_csv(), &described.log_format()).unwrap();
        assert_eq!(read.channels.len(), log.channels.len());
        assert!(!template.toml.contains("[columns]"), "{}", template.toml);
    }
}

#[test]
fn an_open_template_is_refused_with_the_list_of_what_is_missing() {
    let template = template(&raw("time,disp_in,F_kip\n0,0.1,1\n0.001,0.2,2\n0.002,0.1,1\n"), None).unwrap();
    let error = Bench::parse("template", &template.toml).unwrap_err().to_string();
    for name in &template.to_fill_in {
        assert!(error.contains(&format!("{name} is not filled in")), "{name}: {error}");
    }
    assert!(template.to_fill_in.contains(&"axis.inertia".into()), "{:?}", template.to_fill_in);
    let columns: Table = toml::from_str(&template.toml).unwrap();
    assert_eq!(columns["columns"]["position_m"]["scale"].as_float(), Some(0.0254));
    assert_eq!(columns["columns"]["position_m"]["from"].as_str(), Some("disp_in"));
}

#[test]
fn a_foreign_log_with_semicolons_and_decimal_commas_is_read_with_its_template() {
    let rows: String = (0..900)
        .map(|i| {
            let t = f64::from(i) * 10.0;
            let x = 20.0 * (t / 1000.0 * 4.0).sin();
            format!("{t:.1};{x:.3};{:.3}\n", 5.0 * x.signum()).replace('.', ",")
        })
        .collect();
    let text = format!("Zeit [ms];Weg [mm];Kraft [N]\n{rows}");
    let template = template(&raw(&text), None).unwrap();
    let known = toml::from_str("[axis]\ninertia = 1.0").unwrap();
    assert_eq!(template.to_fill_in, ["axis.inertia"], "{}", template.toml);
    let bench = Bench::parse("template", &filled_in(&template, &known)).unwrap();
    let log = MeasuredLog::parse("a.csv", &text, &bench.log_format()).unwrap();
    assert_eq!(log.time_s[1], 0.01);
    assert!((bench.stroke() - 0.04).abs() < 1e-4 && (bench.sample_rate_hz() - 100.0).abs() < 0.1);
    assert!(crate::simulate::Inputs::new(&bench, &log).is_ok());
}

#[test]
fn a_log_without_a_header_lists_its_columns_and_asks_for_their_signals() {
    let rows: String = (0..50).map(|i| format!("{}.000\t3.4\t{}\n", 10 * i, i % 7)).collect();
    let template = template(&raw(&rows), Some(TemplatePlant::Axis(AxisKind::Linear))).unwrap();
    let open: Vec<&str> = template.to_fill_in.iter().map(String::as_str).collect();
    for name in ["columns.t_s.scale", "columns.position_m.from", "columns.drive_force_n.from", "axis.inertia"]
    {
        assert!(open.contains(&name), "{open:?}");
    }
    assert!(template.toml.contains("header = false") && template.toml.contains("(no header)"));
    assert!(template.toml.contains("# 0.1 over the scale of t_s"), "{}", template.toml);
    assert_eq!(template.columns[0].signal, Some("t_s"));
}

#[test]
fn comments_of_a_template_are_at_most_100_columns_wide() {
    let log = record(&Bench::open("bench-b").unwrap(), 1).unwrap();
    for (name, plant) in TemplatePlant::ALL {
        let template = template(&raw(&log.to_csv()), Some(*plant)).unwrap();
        let is_wide = |line: &&str| line.starts_with('#') && line.chars().count() > 100;
        assert_eq!(template.toml.lines().find(is_wide), None, "{name}");
    }
}

/// Two groups of equal length: the second one begins later, and states a delay in seconds.
#[test]
fn a_template_has_the_columns_of_one_time() {
    let column = |index: usize, name: &str, unit: &str, group: &str, values: [f64; 3]| RawColumn {
        index,
        name: name.into(),
        unit: unit.into(),
        group: group.into(),
        time: None,
        values: values.to_vec(),
    };
    let mut log = raw("t_s,x\n0,0\n1,1\n");
    log.columns = vec![
        column(0, "delay", "s", "a", [0.5, 0.5, 0.5]),
        column(1, "a/time", "s", "a", [0.0, 0.1, 0.2]),
        column(2, "b/time", "s", "b", [5.0, 5.1, 5.2]),
        column(3, "b/position", "mm", "b", [1.0, 2.0, 3.0]),
        column(4, "a/position", "mm", "a", [1.0, 2.0, 3.0]),
        column(5, "force", "N", "a", [1.0, 2.0, 3.0]),
    ];
    let template = template(&log, None).unwrap();
    let signal = |index: usize| template.columns[index].signal;
    assert_eq!((signal(0), signal(1), signal(2), signal(3)), (None, Some("t_s"), None, None));
    assert_eq!((signal(4), signal(5)), (Some("position_m"), Some("drive_force_n")));
    assert_eq!(time_of(&log, &log.columns[3]).map(|(time, _)| time.index), Some(2));
}
