//! Columns of several rates on one time.

use super::{LogError, RawColumn, TIME};
use crate::log::files::{MAX_ROWS, MAX_VALUES};

/// Column with its times.
#[derive(Clone, Copy, Debug)]
pub struct Timed<'a> {
    /// Column.
    pub column: &'a RawColumn,
    /// Time of each row.
    pub times: &'a [f64],
    /// Seconds in a unit of the times.
    pub scale: f64,
}

impl Timed<'_> {
    /// Times in s and readings of the rows that have a time, readings NaN where missing.
    fn points(&self) -> Vec<(f64, f64)> {
        let rows = self.times.iter().zip(&self.column.values);
        let rows = rows.map(|(time, value)| (self.scale * time, *value));
        rows.filter(|(time_s, _)| time_s.is_finite()).collect()
    }
}

/// Returns the time `t_s` at a rate in Hz, over the stretch that all columns share, and the columns
/// interpolated linearly at these times. Between a row with a reading and one without, the reading
/// is missing. Rows without a time are passed over.
///
/// # Errors
///
/// Times do not ascend, a column has fewer than two readings, the columns share no stretch, or it
/// has more rows than a log may have.
pub fn resample(source: &str, columns: &[Timed<'_>], rate_hz: f64) -> Result<Vec<RawColumn>, LogError> {
    let ends = columns.iter().map(|timed| ends(source, timed)).collect::<Result<Vec<_>, _>>()?;
    let (start_s, end_s) = shared(source, &ends)?;
    // A rounding of the last time must not lose its row.
    let rows = ((end_s - start_s) * rate_hz + 1e-6).floor() + 1.0;
    let max_rows = MAX_ROWS.min(MAX_VALUES / (columns.len() + 1));
    if rows > max_rows as f64 {
        return Err(LogError::content(
            source,
            format!("{rows:.0} rows of {} columns at this rate", columns.len()),
            format!("at most {max_rows} rows; choose columns or a lower rate"),
        ));
    }
    let time_s: Vec<f64> = (0..rows as usize).map(|row| start_s + row as f64 / rate_hz).collect();
    let own = |index: usize, name: &str, unit: &str, values: Vec<f64>| RawColumn {
        index,
        name: name.into(),
        unit: unit.into(),
        group: String::new(),
        time: Some(0),
        values,
    };
    let sampled = |(index, timed): (usize, &Timed<'_>)| {
        own(index + 1, &timed.column.name, &timed.column.unit, interpolated(&timed.points(), &time_s))
    };
    let columns: Vec<RawColumn> = columns.iter().enumerate().map(sampled).collect();
    Ok(std::iter::once(own(0, TIME, "s", time_s.clone())).chain(columns).collect())
}

/// First and last time of a column's readings, with its name.
fn ends<'a>(source: &str, timed: &Timed<'a>) -> Result<(f64, f64, &'a str), LogError> {
    let name = timed.column.name.as_str();
    let points = timed.points();
    let falls = |pair: &[(f64, f64)]| matches!(pair, [(before, _), (after, _)] if after <= before);
    if points.windows(2).any(falls) {
        let found = format!("times of `{name}` that do not ascend");
        return Err(LogError::content(source, found, "times that ascend strictly"));
    }
    let mut times = points.iter().filter(|(_, value)| value.is_finite()).map(|(time_s, _)| *time_s);
    let ends = times.next().zip(times.next_back());
    let few = || LogError::content(source, format!("fewer than 2 readings of `{name}`"), "at least 2");
    ends.map(|(first, last)| (first, last, name)).ok_or_else(few)
}

/// First and last time that all columns have.
fn shared(source: &str, ends: &[(f64, f64, &str)]) -> Result<(f64, f64), LogError> {
    let latest = ends.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let earliest = ends.iter().min_by(|a, b| a.1.total_cmp(&b.1));
    match latest.zip(earliest) {
        Some(((start_s, ..), (_, end_s, _))) if end_s > start_s => Ok((*start_s, *end_s)),
        Some(((start_s, _, late), (_, end_s, early))) => {
            let found = format!("`{late}` from {start_s} s on and `{early}` until {end_s} s");
            Err(LogError::content(source, found, "columns with a common stretch of time"))
        }
        None => Err(LogError::content(source, "no columns with times", "at least one")),
    }
}

/// Linear interpolation between points that ascend, at times that ascend and lie between the ends.
fn interpolated(points: &[(f64, f64)], time_s: &[f64]) -> Vec<f64> {
    let mut next = 1;
    let value = |&t: &f64| {
        while points.get(next).is_some_and(|(at, _)| *at < t) && next + 1 < points.len() {
            next += 1;
        }
        match (points.get(next - 1), points.get(next)) {
            (Some((from, a)), _) if t <= *from => *a,
            (_, Some((to, b))) if t >= *to => *b,
            (Some((from, a)), Some((to, b))) => a + (b - a) * (t - from) / (to - from),
            _ => f64::NAN,
        }
    };
    time_s.iter().map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str, values: &[f64]) -> RawColumn {
        let (name, unit, group) = (name.into(), String::new(), String::new());
        RawColumn { index: 0, name, unit, group, time: None, values: values.to_vec() }
    }

    #[test]
    fn columns_of_two_rates_share_one_time() {
        let (fast, slow) = (column("fast", &[f64::NAN, 1.0, 2.0, 3.0, 4.0]), column("slow", &[10.0, 20.0]));
        let timed = [
            Timed { column: &fast, times: &[0.0, 100.0, 200.0, 300.0, 400.0], scale: 1e-3 },
            Timed { column: &slow, times: &[0.1, 0.4], scale: 1.0 },
        ];
        let found = resample("a", &timed, 20.0).unwrap();
        assert_eq!(found.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["t_s", "fast", "slow"]);
        let near = |values: &[f64], expected: &[f64]| {
            assert_eq!(values.len(), expected.len(), "{values:?}");
            values.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-9, "{values:?}"));
        };
        near(&found[0].values, &[0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4]);
        near(&found[1].values, &[1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0]);
        near(
            &found[2].values,
            &[10.0, 11.6666666667, 13.3333333333, 15.0, 16.6666666667, 18.3333333333, 20.0],
        );
    }

    #[test]
    fn a_missing_reading_is_not_bridged() {
        let gap = column("gap", &[0.0, 1.0, f64::NAN, 3.0, 4.0]);
        let timed = [Timed { column: &gap, times: &[0.0, 0.1, 0.2, 0.3, 0.4], scale: 1.0 }];
        let found = resample("a", &timed, 20.0).unwrap();
        let missing: Vec<bool> = found[1].values.iter().map(|value| value.is_nan()).collect();
        assert_eq!(missing, [false, false, false, true, true, true, false, false, false]);
        assert_eq!((found[1].values[2], found[1].values[6]), (1.0, 3.0));
    }

    #[test]
    fn times_that_fall_and_columns_apart_are_refused() {
        let one = column("one", &[1.0, 2.0, 3.0]);
        let refused = |times: [&[f64]; 2]| {
            let timed = times.map(|times| Timed { column: &one, times, scale: 1.0 });
            resample("a", &timed, 10.0).unwrap_err().to_string()
        };
        assert!(refused([&[0.0, 2.0, 1.0], &[0.0, 1.0, 2.0]]).contains("times of `one` that do not ascend"));
        assert!(
            refused([&[0.0, 1.0, 2.0], &[3.0, 4.0, 5.0]]).contains("`one` from 3 s on and `one` until 2 s")
        );
        assert!(refused([&[0.0, 1e9, 2e9], &[0.0, 1e9, 2e9]]).contains("rows of 2 columns at this rate"));
    }
}
