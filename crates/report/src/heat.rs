//! Tables of numbers as coloured cells with one colour scale.
//!
//! The colour shows a cell's magnitude relative to a limit, or its sign: see [`Scale`].

use crate::figure::{COLOURS, Drawing};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Meaning of the colours.
#[derive(Clone, Copy, Debug)]
pub enum Scale {
    /// White at 0, blue up to this magnitude, orange beyond it, strongest at twice the limit. A
    /// reader sees which cells are within the limit and by how much.
    Limit(f64),
    /// Blue for negative and orange for positive values, strongest at this magnitude.
    Sign(f64),
}

/// Table to be drawn.
#[derive(Clone, Debug)]
pub struct Heat<'a> {
    /// Title.
    pub title: &'a str,
    /// Meaning of the columns, with unit.
    pub x: &'a str,
    /// Meaning of the rows, with unit.
    pub y: &'a str,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Names of the rows, the uppermost first.
    pub rows: Vec<String>,
    /// Values by row; `None` leaves a cell empty.
    pub values: Vec<Vec<Option<f64>>>,
    /// Meaning of the colours.
    pub scale: Scale,
    /// Number of decimals.
    pub decimals: usize,
    /// Width and height in pixels.
    pub size: (u32, u32),
}

/// Space in pixels left of, above, right of and below the cells.
const MARGINS: [i32; 4] = [74, 34, 14, 44];
/// Width in pixels of a character of a row's name, and of what else is left of the cells.
const CHARACTER: f64 = 6.6;
const LEFT_OF_NAMES: i32 = 32;

/// Ink of a cell: on every colour it contrasts more than white. It is not the black that a page
/// replaces in a dark scheme, because cells keep their colours.
const DARK: RGBColor = RGBColor(17, 17, 17);

/// Strongest colour of a cell. It is not quite a colour of a series, which a page replaces too.
const STRONGEST: f64 = 0.99;

/// Draws a table. The error describes a failure to draw.
pub fn draw(heat: &Heat) -> Result<Drawing, String> {
    let mut svg = String::new();
    let failed = |e: &dyn std::fmt::Display| format!("chart `{}`: {e}", heat.title);
    {
        let area = SVGBackend::with_string(&mut svg, heat.size).into_drawing_area();
        area.fill(&WHITE).map_err(|e| failed(&e))?;
        let [left, top, right, bottom] = MARGINS;
        let longest = heat.rows.iter().map(|name| name.chars().count()).max().unwrap_or_default();
        let left = left.max(LEFT_OF_NAMES + (CHARACTER * longest as f64) as i32);
        let (width, height) = (heat.size.0 as i32, heat.size.1 as i32);
        let place = |from: i32, to: i32, index: usize, count: usize| {
            from + ((to - from) as f64 * index as f64 / count.max(1) as f64).round() as i32
        };
        let x = |index| place(left, width - right, index, heat.columns.len());
        let y = |index| place(top, height - bottom, index, heat.rows.len());
        let text = |words: &str, at: (i32, i32), size: i32, horizontal: HPos, colour: &RGBColor| {
            let style = ("sans-serif", size).into_text_style(&area).color(colour);
            let style = style.pos(Pos::new(horizontal, VPos::Center));
            area.draw(&Text::new(words.to_owned(), at, style)).map_err(|e| failed(&e))
        };
        text(heat.title, (width / 2, 16), 17, HPos::Center, &BLACK)?;
        text(heat.x, ((left + width - right) / 2, height - 10), 13, HPos::Center, &BLACK)?;
        let upright = ("sans-serif", 13).into_text_style(&area).transform(FontTransform::Rotate270);
        let upright = upright.pos(Pos::new(HPos::Center, VPos::Center));
        let middle = (top + height - bottom) / 2;
        area.draw(&Text::new(heat.y.to_owned(), (12, middle), upright)).map_err(|e| failed(&e))?;
        for (index, name) in heat.columns.iter().enumerate() {
            text(name, ((x(index) + x(index + 1)) / 2, height - bottom + 14), 13, HPos::Center, &BLACK)?;
        }
        for (index, name) in heat.rows.iter().enumerate() {
            text(name, (left - 8, (y(index) + y(index + 1)) / 2), 13, HPos::Right, &BLACK)?;
        }
        for (row, values) in heat.values.iter().enumerate() {
            for (column, value) in values.iter().enumerate() {
                let Some(value) = value else { continue };
                let corners = [(x(column) + 1, y(row) + 1), (x(column + 1) - 1, y(row + 1) - 1)];
                let colour = colour(*value, heat.scale);
                area.draw(&Rectangle::new(corners, colour.filled())).map_err(|e| failed(&e))?;
                let middle = ((x(column) + x(column + 1)) / 2, (y(row) + y(row + 1)) / 2);
                text(&format!("{value:.*}", heat.decimals), middle, 13, HPos::Center, &DARK)?;
            }
        }
        area.present().map_err(|e| failed(&e))?;
    }
    Ok(svg.into())
}

/// Returns the colour of a cell.
fn colour(value: f64, scale: Scale) -> RGBColor {
    let [blue, orange, ..] = COLOURS;
    let (full, strength) = match scale {
        Scale::Limit(limit) => {
            let share = value.abs() / limit;
            if share <= 1.0 { (blue, 0.75 * share) } else { (orange, 0.4 + 0.6 * (share - 1.0)) }
        }
        Scale::Sign(max) => {
            (if value < 0.0 { blue } else { orange }, 0.1 + 0.75 * (value.abs() / max).min(1.0))
        }
    };
    // A value that is not finite has the strongest colour.
    let strength = if strength.is_finite() { strength.min(STRONGEST) } else { STRONGEST };
    let mix = |channel: u8| (255.0 + (f64::from(channel) - 255.0) * strength).round() as u8;
    RGBColor(mix(full.0), mix(full.1), mix(full.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_has_its_number_and_empty_ones_stay_empty() {
        let heat = Heat {
            title: "error",
            x: "load, kN",
            y: "clearance, mm",
            columns: vec!["-1".into(), "1".into()],
            rows: vec!["0.1".into(), "1".into()],
            values: vec![vec![Some(0.25), None], vec![Some(-7.5), Some(f64::NAN)]],
            scale: Scale::Limit(2.0),
            decimals: 2,
            size: (300, 200),
        };
        let svg = draw(&heat).unwrap().svg;
        assert!(svg.contains("0.25") && svg.contains("-7.50") && svg.contains("load, kN"), "{svg}");
        assert_eq!(svg.matches("<rect").count(), 1 + 3, "the background and three cells");
    }

    #[test]
    fn values_beyond_the_limit_have_another_colour() {
        let colour = |value| colour(value, Scale::Limit(1.0));
        assert_eq!(colour(0.0), RGBColor(255, 255, 255));
        let (inside, outside) = (colour(1.0), colour(-1.001));
        assert!(inside.2 > inside.0 && outside.0 > outside.2, "{inside:?} {outside:?}");
        assert_eq!(colour(9.0), colour(f64::NAN));
    }

    #[test]
    fn the_colour_of_a_signed_scale_shows_the_sign_and_its_strength_the_size() {
        let colour = |value| colour(value, Scale::Sign(40.0));
        for size in [2.0, 20.0, 40.0, 60.0] {
            let (down, up) = (colour(-size), colour(size));
            assert!(down.2 > down.0 && up.0 > up.2, "{size}: {down:?} {up:?}");
        }
        assert!(colour(-30.0).0 < colour(-10.0).0 && colour(40.0) == colour(60.0));
    }
}
