//! Mechanisms that are refused.

use super::text;
use bench::Bench;

#[test]
fn a_flawed_mechanism_is_refused_with_every_flaw_and_its_line() {
    let error = Bench::parse(
        "x.toml",
        r#"plant = "mechanism"
run = { duration_s = 1.0, gravity_m_s2 = 9.81 }
body = [
    { name = "crank", mass_kg = 1, from_m = [0, 0], to_m = [0, 0] },
    { name = "crank", mass_kg = 1, at_m = [0, 0] },
]
[[joint]]
kind = "clearance"
first = "ground"
second = "rod"
at_m = [0, 0]
axis_rad = 1.0
clearance_m = 1e-3
contact = "dry"
[[joint]]
kind = "hinge"
first = "ground"
second = "crank"
at_m = [0, 1, 2]
[[spring]]
first = "ground"
second = "ground"
from_m = [0, 0]
"#,
    )
    .unwrap_err()
    .to_string();
    for expected in [
        "line 2: run.gravity_m_s2 is 9.81; expected two numbers, [x, y], -1000000 to 1000000 m/s2",
        "line 4: body.0.to_m is equal to from_m; expected the other end of the bar",
        "line 5: body.1.name is `crank`; expected a name that neither another body nor the ground has",
        "line 5: body.1.inertia_kg_m2 is missing; expected a number, which a body with `at_m` needs",
        "line 10: joint.0.second is `rod`; expected one of ground, crank, crank",
        "line 12: joint.0.axis_rad is 1; expected none: `clearance` does not use it",
        "line 7: joint.0.bearing_radius_m is missing; expected a number, which `clearance` needs",
        "line 14: joint.0.contact is `dry`; expected the name of a `[[contact]]`",
        "line 16: joint.1.kind is `hinge`; expected one of revolute, prismatic,",
        "line 19: joint.1.at_m is an array; expected two numbers",
        "line 22: spring.0.second is `ground`; expected another body than `first`",
        "spring.0.to_m is missing; expected both points",
    ] {
        assert!(error.contains(expected), "{expected}\n{error}");
    }
}

#[test]
fn what_a_mechanism_cannot_satisfy_or_does_not_use_is_refused() {
    let four_bar = text("../../examples/four-bar.toml");
    let refused = |from: &str, to: &str| {
        assert!(four_bar.contains(from), "{from}");
        Bench::parse("x.toml", &four_bar.replacen(from, to, 1)).unwrap_err().to_string()
    };
    // A bar has the direction of its ends; a journal begins within its clearance.
    let error = refused("name = \"coupler\",", "name = \"coupler\", angle_rad = 0.3,");
    assert!(error.contains("body.1.angle_rad is 0.3; expected no angle"), "{error}");
    let error = refused("kind = \"clearance\",", "kind = \"clearance\", offset_m = [0.01, 0],");
    assert!(error.contains("offset_m is a distance of 0.01 m; expected a distance of at most"), "{error}");
    // Two drives of one pin, the one faster than the other.
    let line = four_bar.lines().find(|line| line.contains("drive_speed")).unwrap();
    let (before, after) = line.split_once("drive_speed = ").unwrap();
    let twice = format!("{line}\n{before}drive_speed = 1{after}");
    let error = refused(line, &twice);
    assert!(error.contains("joint is joints and drives that contradict each other"), "{error}");
}
