//! `docs/effects.md` equals the catalogue. `WRITE_EFFECTS=1 cargo test -p bench --test
//! effects_table` writes it.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bench::effects::{CATALOGUE, EffectKind, EffectParameter, Measure, Plant};
use std::path::Path;

const HEAD: &str = "# Effects

Deviations from a bench's nominal model, by the names that `[[effects]]` of a description and a
diagnosis use. This page is generated from the catalogue (`bench::effects::CATALOGUE`), and a test
checks it. The head of each effect's file in `crates/bench/src/effects` gives the equation, its
source and its appearance in a log.

```toml
[[effects]]
name = \"stribeck-friction\"
coefficient_rise = 0.05
speed_m_s = 0.01

[[effects]]
name = \"sensor-delay\"
channel = \"journal_y_m\"
delay_s = 4e-4

[[effects]]                     # of a mechanism
name = \"clearance-wear\"
of = \"crank_coupler\"
clearance_increase_m = 1e-5
```

* **Parameters**: name, unit, bounds and prior. The prior is one standard deviation over real
  benches; it is wide and matters only where a log contains no information. A size is 0 by default,
  and at 0 the effect changes no bit of the result. A shape has a default. Offset and drift of a
  sensor are in the unit of its channel, their priors in multiples of its noise. On an axis, many
  priors are multiples of what the log shows: its rms effort, the load with this effort, half its
  stroke and its rms speed at the friction radius, its drag (rms effort over rms speed), its
  stiffness (rms effort over half the stroke), its load gain (rms effort over rms load), and its
  inertia (rms effort over the acceleration that rms speed and half stroke imply). Such a parameter
  is found alike in a log in other units. On a mechanism these are the quantities of the
  drive whose torque the log measures, and 1 in SI units without one.
* **Plants**: planar (transmission bench), two-plane (the same with `[two_plane]`), rotary (friction
  rig), linear (axis), mechanism (one with `[[measured]]`). On other plants the effect is refused.
  An effect on a part of a mechanism names it by `of`: a body, or a joint by its two bodies, such as
  `crank_coupler`; a second joint of the same bodies is `crank_coupler_again_2`.
* **Shows in**: the channel of the transmission bench that shows it best. On an axis that is the
  effort, for a sensor effect the sensor's own channel.
* **Confounded with**: effects that look alike on some trajectories, so that a diagnosis may name
  several.

Some effects are invisible without certain conditions. `misalignment` needs the bench in two planes
with a `support_stiffness_nm_rad`, because a shaft without further supports follows its bearing.
`load-dependent-friction` of an axis needs a varying load to be distinguished from `coulomb-level`.
`breakaway` needs standstills, and `fork-backlash` a load that lets the fork change sides.
`thermal-friction-drift` needs a log about as long as the time constant, and `sensor-saturation`
readings beyond the limit.

| effect | meaning | parameters on a transmission bench | parameters on an axis | parameters on a \
mechanism | plants | shows in | confounded with |
|---|---|---|---|---|---|---|---|
";

fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

fn parameter(p: &EffectParameter) -> String {
    let unit = if p.unit == "1" { String::new() } else { format!(" {}", p.unit) };
    let default = if p.is_size { String::new() } else { format!(", default {}", number(p.default)) };
    let (min, max, prior) = (number(p.min), number(p.max), number(p.prior));
    let measure = match p.measure {
        Measure::Unit => "",
        Measure::Effort => " efforts",
        Measure::Distance => " half strokes",
        Measure::Speed => " rms speeds",
        Measure::Load => " loads",
        Measure::Drag => " drags",
        Measure::Stiffness => " stiffnesses",
        Measure::LoadGain => " load gains",
        Measure::Inertia => " inertias",
    };
    let prior = match (p.is_factor, measure) {
        (true, "") => format!("a factor of {prior}"),
        (true, _) => format!("a factor of {prior} around {}{measure}", number(p.centre)),
        (false, _) => format!("{prior}{measure}"),
    };
    format!("`{}`{unit}: {min} to {max}{default}, prior {prior}", p.name)
}

fn row(kind: &EffectKind) -> String {
    let list = |plants: &[Plant]| match plants.iter().find_map(|plant| kind.action(*plant)) {
        Some(action) => action.parameters.iter().map(parameter).collect::<Vec<_>>().join("; "),
        None => "refused".into(),
    };
    let plant = |p: Plant| match p {
        Plant::Planar => "planar",
        Plant::TwoPlane => "two-plane",
        Plant::Rotary => "rotary",
        Plant::Linear => "linear",
        Plant::Mechanism => "mechanism",
    };
    let channel = if kind.is_per_channel() { " (with a `channel`)" } else { "" };
    format!(
        "| `{}`{channel} | {} | {} | {} | {} | {} | {} | {} |\n",
        kind.name,
        kind.summary,
        list(&[Plant::Planar, Plant::TwoPlane]),
        list(&[Plant::Rotary, Plant::Linear]),
        list(&[Plant::Mechanism]),
        kind.plants().map(plant).collect::<Vec<_>>().join(", "),
        kind.shows_in.map_or("its channel".into(), |c| format!("`{c}`")),
        kind.confounded().iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", "),
    )
}

#[test]
fn the_page_is_the_catalogue() {
    let page = CATALOGUE.iter().fold(String::from(HEAD), |page, kind| page + &row(kind));
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/effects.md"));
    if std::env::var_os("WRITE_EFFECTS").is_some() {
        bench::atomic::write(path, page.as_bytes()).unwrap();
    }
    let found = std::fs::read_to_string(path).unwrap();
    assert!(found == page, "docs/effects.md differs from the catalogue: WRITE_EFFECTS=1 writes it");
}
