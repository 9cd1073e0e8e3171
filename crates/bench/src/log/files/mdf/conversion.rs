//! Conversions of stored numbers to readings.
//!
//! Kinds and parameters: ASAM MDF 4.1, block CC. A number that a table maps to a text (such as
//! "invalid") is a missing value. A conversion that is not known is refused, so that a stored
//! number is never taken for a reading.

use super::blocks::{Block, Flaw, text};
use exmex::{Express, FlatEx};

/// Maximum depth of conversions in tables.
const MAX_DEPTH: usize = 8;
/// Maximum number of conversions of one channel.
const MAX_CONVERSIONS: usize = 10_000;
/// Maximum length of a formula, and maximum number of keys or ranges of a table.
const MAX_FORMULA: usize = 1000;
const MAX_RANGES: usize = 4096;
/// Names of the stored number in a formula.
const VARIABLES: [&str; 4] = ["X", "X1", "x", "x1"];

/// Conversion of a stored number.
#[derive(Debug)]
pub(super) enum Conversion {
    Identity,
    /// Offset and factor.
    Linear(f64, f64),
    /// Coefficients of a numerator and a denominator of second order, highest first.
    Rational([f64; 6]),
    Formula(Box<FlatEx<f64>>),
    /// Keys and values in ascending order, interpolated or the nearest.
    Table(Vec<(f64, f64)>, bool),
    /// Ranges with their conversion, else a default; `None` is a text.
    Ranges(Vec<Range>, Option<Box<Conversion>>),
}

/// Range of stored numbers.
#[derive(Debug)]
pub(super) struct Range {
    from: f64,
    to: f64,
    conversion: Option<Conversion>,
}

impl Conversion {
    /// Reads the conversion at a place; 0 is none.
    pub(super) fn read(bytes: &[u8], place: u64) -> Result<Self, Flaw> {
        Reader { bytes, left: MAX_CONVERSIONS }.conversion(place, 0)
    }

    /// Reading of a stored number, NaN if it is a text. A range contains its end if the numbers are
    /// integers.
    pub(super) fn value(&self, stored: f64, is_integer: bool) -> f64 {
        match self {
            Self::Identity => stored,
            Self::Linear(offset, factor) => offset + factor * stored,
            Self::Rational([a, b, c, d, e, f]) => {
                (a * stored * stored + b * stored + c) / (d * stored * stored + e * stored + f)
            }
            Self::Formula(formula) => {
                let arguments = [stored; 1];
                let count = formula.var_names().len().min(1);
                formula.eval(arguments.get(..count).unwrap_or_default()).unwrap_or(f64::NAN)
            }
            Self::Table(points, is_interpolated) => looked_up(points, *is_interpolated, stored),
            Self::Ranges(ranges, default) => {
                let suits = |range: &&Range| {
                    let is_below = stored < range.to || stored == range.to && (is_integer || range.is_key());
                    stored >= range.from && is_below
                };
                let found = match ranges.iter().find(suits) {
                    Some(range) => range.conversion.as_ref(),
                    None => default.as_deref(),
                };
                found.map_or(f64::NAN, |conversion| conversion.value(stored, is_integer))
            }
        }
    }

    /// Returns whether some number has a reading.
    pub(super) fn has_numbers(&self) -> bool {
        match self {
            Self::Ranges(ranges, default) => {
                let own = ranges.iter().filter_map(|range| range.conversion.as_ref());
                own.chain(default.as_deref()).any(Self::has_numbers)
            }
            _ => true,
        }
    }
}

impl Range {
    fn is_key(&self) -> bool {
        self.from.total_cmp(&self.to).is_eq()
    }
}

/// Value of a table; the nearest key counts if it is not interpolated, of two the lower one.
fn looked_up(points: &[(f64, f64)], is_interpolated: bool, stored: f64) -> f64 {
    let next = points.partition_point(|(key, _)| *key < stored);
    match (next.checked_sub(1).and_then(|before| points.get(before)), points.get(next)) {
        (None, Some((_, value))) | (Some((_, value)), None) => *value,
        (Some((from, a)), Some((to, b))) if is_interpolated => a + (b - a) * (stored - from) / (to - from),
        (Some((from, a)), Some((to, b))) => {
            if to - stored < stored - from {
                *b
            } else {
                *a
            }
        }
        (None, None) => f64::NAN,
    }
}

/// Unit of a conversion, or of the first one below it that has a unit.
pub(super) fn unit(bytes: &[u8], place: u64) -> String {
    let mut place = place;
    for _ in 0..MAX_DEPTH {
        let Some(block) = Block::read(bytes, place, b"CC").ok().filter(|_| place != 0) else { break };
        let own = text(bytes, block.link(1));
        if !own.is_empty() {
            return own;
        }
        let is_conversion = |place: &u64| *place != 0 && Block::read(bytes, *place, b"CC").is_ok();
        place = block.links_from(4).into_iter().rfind(is_conversion).unwrap_or(0);
    }
    String::new()
}

/// Conversions of a file, of which only so many are read.
struct Reader<'a> {
    bytes: &'a [u8],
    left: usize,
}

impl Reader<'_> {
    fn conversion(&mut self, place: u64, depth: usize) -> Result<Conversion, Flaw> {
        if place == 0 {
            return Ok(Conversion::Identity);
        }
        self.left = self.left.checked_sub(1).ok_or("too many conversions of one channel")?;
        if depth > MAX_DEPTH {
            return Err(format!("conversions that are nested more than {MAX_DEPTH} deep"));
        }
        let block = Block::read(self.bytes, place, b"CC")?;
        let values = values(&block)?;
        let short = || "a conversion with too few parameters".to_owned();
        let too_many = || format!("a table with more than {MAX_RANGES} ranges");
        Ok(match block.u8(0)? {
            0 => Conversion::Identity,
            1 => match values.as_slice() {
                [offset, factor, ..] => Conversion::Linear(*offset, *factor),
                _ => return Err(short()),
            },
            2 => Conversion::Rational(*values.first_chunk().ok_or_else(short)?),
            3 => formula(&text(self.bytes, block.link(4)))?,
            kind @ (4 | 5) => table(&values, kind == 4)?,
            6 if values.len() / 3 > MAX_RANGES => return Err(too_many()),
            7 if values.len() > MAX_RANGES => return Err(too_many()),
            8 if values.len() / 2 > MAX_RANGES => return Err(too_many()),
            6 => {
                let (ranges, default) = values.as_chunks::<3>();
                let linear = |value: f64| Conversion::Linear(value, 0.0);
                let range =
                    |&[from, to, value]: &[f64; 3]| Range { from, to, conversion: Some(linear(value)) };
                let default = default.first().copied().ok_or_else(short)?;
                Conversion::Ranges(ranges.iter().map(range).collect(), Some(Box::new(linear(default))))
            }
            7 => self.texts(&block, values.iter().map(|key| (*key, *key)).collect(), depth)?,
            8 => {
                self.texts(&block, values.as_chunks::<2>().0.iter().map(|[a, b]| (*a, *b)).collect(), depth)?
            }
            9..=11 => return Err("texts".into()),
            other => return Err(format!("a conversion of the unknown kind {other}")),
        })
    }

    /// Reads a table of texts, some of which may be conversions.
    fn texts(&mut self, block: &Block<'_>, keys: Vec<(f64, f64)>, depth: usize) -> Result<Conversion, Flaw> {
        let mut inner = |place: u64| match place {
            0 => Ok(None),
            place if Block::at(self.bytes, place)?.kind == b"CC" => {
                self.conversion(place, depth + 1).map(Some)
            }
            _ => Ok(None),
        };
        let places = block.links_from(4);
        let default = inner(places.get(keys.len()).copied().unwrap_or(0))?;
        let range =
            |((from, to), place): ((f64, f64), &u64)| Ok(Range { from, to, conversion: inner(*place)? });
        let ranges = keys.into_iter().zip(&places).map(range).collect::<Result<Vec<_>, Flaw>>()?;
        Ok(Conversion::Ranges(ranges, default.map(Box::new)))
    }
}

/// Parameters of a conversion, after a range of readings that some writers leave out.
fn values(block: &Block<'_>) -> Result<Vec<f64>, Flaw> {
    let count = usize::from(block.u16(6)?);
    let rest = block.data.get(8..).unwrap_or_default();
    let skipped = if rest.len() >= 8 * count + 16 { 16 } else { 0 };
    let (values, _) = rest.get(skipped..).unwrap_or_default().as_chunks::<8>();
    let values: Vec<f64> = values.iter().take(count).map(|bytes| f64::from_le_bytes(*bytes)).collect();
    if values.len() == count { Ok(values) } else { Err("a damaged conversion".into()) }
}

fn table(values: &[f64], is_interpolated: bool) -> Result<Conversion, Flaw> {
    let points: Vec<(f64, f64)> =
        values.as_chunks::<2>().0.iter().map(|[key, value]| (*key, *value)).collect();
    let is_ascending = points.windows(2).all(|pair| matches!(pair, [(a, _), (b, _)] if a < b));
    if points.is_empty() || !is_ascending {
        return Err("a table whose keys do not ascend".into());
    }
    Ok(Conversion::Table(points, is_interpolated))
}

/// Formula of one stored number.
fn formula(text: &str) -> Result<Conversion, Flaw> {
    if text.len() > MAX_FORMULA {
        return Err(format!("a conversion by a formula of more than {MAX_FORMULA} letters"));
    }
    let refuse = || format!("a conversion by the formula `{text}`, which is not known");
    let parsed = signed(&text.replace("**", "^")).map(|text| without_exponents(&text)).ok_or_else(refuse)?;
    let parsed = FlatEx::<f64>::parse(&parsed).map_err(|_| refuse())?;
    match parsed.var_names() {
        [] => Ok(Conversion::Formula(Box::new(parsed))),
        [name] if VARIABLES.contains(&name.as_str()) => Ok(Conversion::Formula(Box::new(parsed))),
        _ => Err(refuse()),
    }
}

/// Formula in which a sign at the start or after a bracket is a difference from 0, because the
/// parser applies a sign before a power. `None` if a sign follows another operator and there are
/// powers.
fn signed(text: &str) -> Option<String> {
    let has_power = text.contains('^');
    let (mut out, mut before) = (String::new(), '(');
    for (place, letter) in text.char_indices() {
        let is_exponent = matches!(before, 'e' | 'E')
            && text.get(..place).is_some_and(|text| {
                text.trim_end_matches(['e', 'E']).ends_with(|c: char| c.is_ascii_digit() || c == '.')
            });
        if matches!(letter, '-' | '+') && !is_exponent {
            match before {
                '(' | ',' => out.push('0'),
                '+' | '-' | '*' | '/' | '^' if has_power => return None,
                _ => {}
            }
        }
        out.push(letter);
        if !letter.is_whitespace() {
            before = letter;
        }
    }
    Some(out)
}

/// Formula with numbers such as `1.5e-3` in full, as the parser expects them.
fn without_exponents(text: &str) -> String {
    let is_of_number = |letter: char| letter.is_ascii_digit() || letter == '.';
    let (mut out, mut rest) = (String::new(), text);
    while let Some(start) = rest.find(is_of_number) {
        let (before, number) = rest.split_at(start);
        let digits = number.find(|letter| !is_of_number(letter)).unwrap_or(number.len());
        let exponent =
            number.get(digits..).and_then(|rest| rest.strip_prefix(['e', 'E'])).map_or(0, |rest| {
                let signed = rest.strip_prefix(['+', '-']).unwrap_or(rest);
                let count = signed.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(signed.len());
                if count == 0 { 0 } else { 1 + rest.len() - signed.len() + count }
            });
        let is_of_name = before.ends_with(|letter: char| letter.is_alphanumeric() || letter == '_');
        let (number, after) = number.split_at(if is_of_name { digits } else { digits + exponent });
        out.push_str(before);
        match number.parse::<f64>() {
            Ok(value) if !is_of_name => out.push_str(&value.to_string()),
            _ => out.push_str(number),
        }
        rest = after;
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_formula_of_one_number_is_evaluated_and_others_are_refused() {
        let value = |text: &str, x: f64| formula(text).map(|formula| formula.value(x, false));
        assert_eq!(value("X1*2+1", 3.0), Ok(7.0));
        assert_eq!(value("sqrt(X) + 1", 4.0), Ok(3.0));
        assert_eq!(value("X/(X+1)", 1.0), Ok(0.5));
        assert_eq!(value("1/X", 1e-20), Ok(1e20));
        assert_eq!(value("2^X - 1", 3.0), Ok(7.0));
        assert_eq!(value("X**2 / 2", 4.0), Ok(8.0));
        assert_eq!(value("1.5e-3*X1 + 2E+2", 2.0), Ok(200.003));
        assert_eq!(value("exp(X)", 0.0), Ok(1.0));
        assert_eq!(value("-X^2", 3.0), Ok(-9.0));
        assert_eq!(value("2 * ( -X1**2 )", 3.0), Ok(-18.0));
        assert_eq!(value("-1e-1*X*-2", 3.0), Ok(0.6000000000000001));
        for refused in ["X1+X2", "pow(X,2)", "", "X*", "Y", "2*-X^2", "2^-X"] {
            let found = value(refused, 1.0);
            assert!(
                found.as_ref().is_err_and(|e| e.contains(&format!("`{refused}`"))),
                "{refused}: {found:?}"
            );
        }
    }

    #[test]
    fn a_table_takes_the_nearest_key_or_interpolates() {
        let points = [(0.0, 10.0), (1.0, 20.0), (3.0, 0.0)];
        let nearest = [-1.0, 0.4, 0.5, 0.6, 2.5, 9.0].map(|x| looked_up(&points, false, x));
        assert_eq!(nearest, [10.0, 10.0, 10.0, 20.0, 0.0, 0.0]);
        let between = [-1.0, 0.0, 0.5, 1.0, 2.0, 9.0].map(|x| looked_up(&points, true, x));
        assert_eq!(between, [10.0, 10.0, 15.0, 20.0, 10.0, 0.0]);
    }

    #[test]
    fn a_range_contains_its_end_for_integers_only() {
        let range = |from, to, conversion| Range { from, to, conversion };
        let ranges = vec![range(0.0, 10.0, Some(Conversion::Linear(0.0, 2.0))), range(10.0, 12.0, None)];
        let conversion = Conversion::Ranges(ranges, Some(Box::new(Conversion::Identity)));
        assert_eq!((conversion.value(10.0, true), conversion.value(13.0, true)), (20.0, 13.0));
        assert!(conversion.value(10.0, false).is_nan());
        assert!(conversion.has_numbers());
    }
}
