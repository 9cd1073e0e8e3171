//! Signals and units that the names of foreign columns indicate.

use crate::log::TIME;
use crate::signals::Channel;

/// Kind of quantity that a column may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Quantity {
    Time,
    Position,
    Speed,
    Effort,
    Load,
}

/// Kind of motion that a unit belongs to; `None` for both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MotionKind {
    Linear,
    Rotary,
}

/// Words in names, by quantity. Short ones must be the complete word.
const WORDS: &[(Quantity, &[&str])] = &[
    (Quantity::Time, &["time", "t", "zeit", "timestamp", "temps"]),
    (
        Quantity::Position,
        &[
            "position",
            "pos",
            "displacement",
            "disp",
            "stroke",
            "angle",
            "theta",
            "phi",
            "qm",
            "q",
            "x",
            "weg",
        ],
    ),
    (Quantity::Speed, &["velocity", "vel", "speed", "omega", "v", "qd", "dq", "geschwindigkeit", "drehzahl"]),
    (Quantity::Effort, &["force", "torque", "f", "effort", "tau", "kraft", "moment", "current", "strom"]),
    (Quantity::Load, &["load", "pressure", "p", "last", "druck"]),
];

/// A unit: spelling in lower case, factor to SI, quantity, kind of motion.
type Unit = (&'static str, f64, &'static [Quantity], Option<MotionKind>);

const FORCES: &[Quantity] = &[Quantity::Effort, Quantity::Load];
const LINEAR: Option<MotionKind> = Some(MotionKind::Linear);
const ROTARY: Option<MotionKind> = Some(MotionKind::Rotary);
const DEGREE: f64 = core::f64::consts::PI / 180.0;
/// Pound-force in N.
const POUND: f64 = 4.448_221_615_260_5;

const UNITS: &[Unit] = &[
    ("s", 1.0, &[Quantity::Time], None),
    ("sec", 1.0, &[Quantity::Time], None),
    ("ms", 1e-3, &[Quantity::Time], None),
    ("us", 1e-6, &[Quantity::Time], None),
    ("\u{b5}s", 1e-6, &[Quantity::Time], None),
    ("ns", 1e-9, &[Quantity::Time], None),
    ("min", 60.0, &[Quantity::Time], None),
    ("m", 1.0, &[Quantity::Position], LINEAR),
    ("mm", 1e-3, &[Quantity::Position], LINEAR),
    ("cm", 1e-2, &[Quantity::Position], LINEAR),
    ("um", 1e-6, &[Quantity::Position], LINEAR),
    ("\u{b5}m", 1e-6, &[Quantity::Position], LINEAR),
    ("in", 0.0254, &[Quantity::Position], LINEAR),
    ("inch", 0.0254, &[Quantity::Position], LINEAR),
    ("rad", 1.0, &[Quantity::Position], ROTARY),
    ("mrad", 1e-3, &[Quantity::Position], ROTARY),
    ("deg", DEGREE, &[Quantity::Position], ROTARY),
    ("\u{b0}", DEGREE, &[Quantity::Position], ROTARY),
    ("m/s", 1.0, &[Quantity::Speed], LINEAR),
    ("mm/s", 1e-3, &[Quantity::Speed], LINEAR),
    ("in/s", 0.0254, &[Quantity::Speed], LINEAR),
    ("rad/s", 1.0, &[Quantity::Speed], ROTARY),
    ("deg/s", DEGREE, &[Quantity::Speed], ROTARY),
    ("\u{b0}/s", DEGREE, &[Quantity::Speed], ROTARY),
    ("rpm", core::f64::consts::PI / 30.0, &[Quantity::Speed], ROTARY),
    ("1/min", core::f64::consts::PI / 30.0, &[Quantity::Speed], ROTARY),
    ("n", 1.0, FORCES, LINEAR),
    ("kn", 1e3, FORCES, LINEAR),
    ("lbf", POUND, FORCES, LINEAR),
    ("lb", POUND, FORCES, LINEAR),
    ("kip", 1e3 * POUND, FORCES, LINEAR),
    ("kgf", 9.806_65, FORCES, LINEAR),
    ("nm", 1.0, &[Quantity::Effort], ROTARY),
    ("knm", 1e3, &[Quantity::Effort], ROTARY),
    ("mnm", 1e-3, &[Quantity::Effort], ROTARY),
    ("ncm", 1e-2, &[Quantity::Effort], ROTARY),
];

/// Meaning of a column's name.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Meaning {
    /// Channel or time whose name it is.
    pub(super) own: Option<&'static str>,
    pub(super) quantity: Option<Quantity>,
    pub(super) kind: Option<MotionKind>,
    /// Factor to SI, if the name has a known unit.
    pub(super) scale: Option<f64>,
    /// True if a word of the name indicates the quantity, not its unit alone.
    pub(super) is_named: bool,
}

/// Returns what a column's name indicates.
pub(super) fn meaning(name: &str) -> Meaning {
    let channel = Channel::from_name(name).map(Channel::name);
    if let Some(own) = channel.or((name == TIME).then_some(TIME)) {
        return Meaning { own: Some(own), scale: Some(1.0), ..Meaning::default() };
    }
    let lower = name.trim().to_lowercase();
    let (words, unit) = split_unit(&lower);
    let is_separator = |letter: char| !letter.is_alphanumeric();
    let is_word = |known: &&str| {
        words.split(is_separator).any(|word| word.trim_end_matches(|c: char| c.is_ascii_digit()) == *known)
    };
    let by_word = WORDS.iter().find(|(_, known)| known.iter().any(is_word));
    let found = unit.and_then(|unit| UNITS.iter().find(|(spelling, ..)| *spelling == unit));
    let quantity = match (by_word, found) {
        // A unit contradicts a word of another quantity: `p_mm` is a position.
        (Some((word, _)), Some((_, _, quantities, _))) if !quantities.contains(word) => {
            quantities.first().copied()
        }
        (Some((word, _)), _) => Some(*word),
        (None, Some((_, _, quantities, _))) if quantities.len() == 1 => quantities.first().copied(),
        _ => None,
    };
    let is_named = by_word.is_some_and(|(word, _)| Some(*word) == quantity);
    let (kind, scale) = (found.and_then(|unit| unit.3), found.map(|unit| unit.1));
    Meaning { own: None, quantity, kind, scale, is_named }
}

/// Returns whether a name is that of a pressure.
pub(super) fn is_pressure(name: &str) -> bool {
    let lower = name.to_lowercase();
    let mut words = lower.split(|letter: char| !letter.is_alphabetic());
    words.any(|word| matches!(word, "p" | "pa" | "pb" | "pressure" | "druck"))
}

/// Splits a name in lower case into its words and its unit: `disp_in`, `weg [mm]`, `time (s)`.
fn split_unit(name: &str) -> (&str, Option<String>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((words, rest)) = name.split_once(open) {
            let unit = rest.split(close).next().unwrap_or_default();
            return (words, Some(unit.replace([' ', '\u{b7}', '*'], "")));
        }
    }
    // `vel_in_s`, `v_mm_s`: a unit per second.
    if let Some((words, unit)) = name.strip_suffix("_s").and_then(|name| name.rsplit_once('_')) {
        let unit = format!("{unit}/s");
        if UNITS.iter().any(|(spelling, ..)| *spelling == unit) {
            return (words, Some(unit));
        }
    }
    let is_separator = |letter: char| letter == '_' || letter.is_whitespace();
    match name.rsplit_once(is_separator) {
        Some((words, unit)) => (words, Some(unit.to_owned())),
        None => (name, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_give_quantity_unit_and_kind_of_motion() {
        let inch = Some(0.0254);
        for (name, quantity, kind, scale) in [
            ("time", Quantity::Time, None, None),
            ("Zeit [ms]", Quantity::Time, None, Some(1e-3)),
            ("disp_in", Quantity::Position, LINEAR, inch),
            ("vel_in_s", Quantity::Speed, LINEAR, inch),
            ("F_kip", Quantity::Effort, LINEAR, Some(1e3 * POUND)),
            ("Kraft (kN)", Quantity::Effort, LINEAR, Some(1e3)),
            ("motor torque [N m]", Quantity::Effort, ROTARY, Some(1.0)),
            ("data.qm", Quantity::Position, None, None),
            ("omega_rad_s", Quantity::Speed, ROTARY, Some(1.0)),
            ("x1", Quantity::Position, None, None),
            ("p_mm", Quantity::Position, LINEAR, Some(1e-3)),
            ("load_N", Quantity::Load, LINEAR, Some(1.0)),
        ] {
            let found = meaning(name);
            assert_eq!((found.quantity, found.kind), (Some(quantity), kind), "{name}");
            match (found.scale, scale) {
                (Some(found), Some(scale)) => assert!((found / scale - 1.0).abs() < 1e-12, "{name} {found}"),
                (found, scale) => assert_eq!(found, scale, "{name}"),
            }
        }
        assert_eq!(meaning("drive_force_n").own, Some("drive_force_n"));
        for name in ["", "a1_lb", "room temperature", "index"] {
            assert_eq!(meaning(name).quantity, None, "{name}");
        }
    }
}
