//! `docs/effects.md` is the catalogue. `WRITE_EFFECTS=1 cargo test -p bench --test effects_table` writes it anew.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bench::effects::{CATALOGUE, EffectKind, EffectParameter, Plant};
use std::path::Path;

const HEAD: &str = "# Effects

What may be missing from a bench's nominal model, by the names that `[[effects]]` of a description and a diagnosis use. This page
is written from the catalogue (`bench::effects::CATALOGUE`) and checked against it by a test; the equation of each effect,
its source and what it looks like in a log stand at the head of its file in `crates/bench/src/effects`.

```toml
[[effects]]
name = \"stribeck-friction\"
coefficient_rise = 0.05
speed_m_s = 0.01

[[effects]]
name = \"sensor-delay\"
channel = \"journal_y_m\"
delay_s = 4e-4
```

* **Parameters**: name in its unit, bounds, prior (one standard deviation of what real benches show; wide, it only holds what a
  log does not tell). A size is 0 unless given, and at 0 the effect is gone to the last bit; a shape has a default. Offset and drift of
  a sensor are in the unit of its channel, their priors in its noise.
* **Plants**: planar (transmission bench), two-plane (the same with `[two_plane]`), rotary (friction rig), linear (axis). Elsewhere the
  effect is refused.
* **Shows in**: the channel of the transmission bench that shows it best. On an axis that is the effort, of a sensor effect its own.
* **Confounded with**: what looks alike on some trajectories, so that a diagnosis may name several.

What a bench cannot show at all: `misalignment` needs the bench in two planes and there a `support_stiffness_nm_rad`, for a shaft that nothing
else holds follows its bearing; `load-dependent-friction` of an axis needs a load that varies to be told from
`coulomb-level`; `breakaway` needs rests; `fork-backlash` a load that lets the fork change sides; `thermal-friction-drift` a log about as
long as the time constant; `sensor-saturation` readings beyond the limit.

| effect | what it is | parameters on a transmission bench | parameters on an axis | plants | shows in | confounded with |
|---|---|---|---|---|---|---|
";

fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

fn parameter(p: &EffectParameter) -> String {
    let unit = if p.unit == "1" { String::new() } else { format!(" {}", p.unit) };
    let default = if p.is_size { String::new() } else { format!(", {} unless given", number(p.default)) };
    let (least, most, prior) = (number(p.least), number(p.most), number(p.prior));
    let factor = if p.is_factor { "a factor of " } else { "" };
    format!("`{}`{unit}: {least} to {most}{default}, prior {factor}{prior}", p.name)
}

fn row(kind: &EffectKind) -> String {
    let list = |parameters: &[EffectParameter], on: &[Plant]| {
        if kind.plants.iter().any(|p| on.contains(p)) {
            parameters.iter().map(parameter).collect::<Vec<_>>().join("; ")
        } else {
            "refused".into()
        }
    };
    let plant = |p: &Plant| match p {
        Plant::Planar => "planar",
        Plant::TwoPlane => "two-plane",
        Plant::Rotary => "rotary",
        Plant::Linear => "linear",
    };
    let channel = if kind.per_channel { " (with a `channel`)" } else { "" };
    format!(
        "| `{}`{channel} | {} | {} | {} | {} | {} | {} |\n",
        kind.name,
        kind.summary,
        list(kind.transmission, &[Plant::Planar, Plant::TwoPlane]),
        list(kind.axis, &[Plant::Rotary, Plant::Linear]),
        kind.plants.iter().map(plant).collect::<Vec<_>>().join(", "),
        kind.shows_in.map_or("its channel".into(), |c| format!("`{c}`")),
        kind.confounded_with.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", "),
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
    assert!(found == page, "docs/effects.md differs from the catalogue: WRITE_EFFECTS=1 writes it anew");
}
