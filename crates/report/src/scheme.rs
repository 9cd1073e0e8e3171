//! Colours of a page in a light and in a dark scheme.
//!
//! Charts are written with the fixed colours of the light scheme, so that they are legible as files
//! of their own. Inside a page a rule for each of these colours replaces it by a variable. The dark
//! values apply on screens only: printing stays light.

use std::fmt::Write as _;

/// A colour with its values in both schemes.
struct Colour {
    /// Name of the variable.
    name: &'static str,
    /// Colour that charts are written with; empty for a colour of the page alone.
    written: &'static str,
    light: &'static str,
    dark: &'static str,
}

const fn colour(
    name: &'static str,
    written: &'static str,
    light: &'static str,
    dark: &'static str,
) -> Colour {
    Colour { name, written, light, dark }
}

const COLOURS: [Colour; 15] = [
    colour("paper", "", "#ffffff", "#14191f"),
    colour("text", "", "#1c2733", "#dde4ea"),
    colour("quiet", "", "#56636f", "#9fadb9"),
    colour("rule", "", "#d5dce3", "#3a4652"),
    colour("head", "", "#f2f5f7", "#1f2831"),
    colour("select", "", "#56636f33", "#9fadb933"),
    // Text, axes and, nearly transparent, the grid.
    colour("ink", "#000000", "#000000", "#dde4ea"),
    colour("series-1", "#0072b2", "#0072b2", "#3d94d6"),
    colour("series-2", "#d55e00", "#d55e00", "#f08a3c"),
    colour("series-3", "#009e73", "#008f68", "#2fbf93"),
    colour("series-4", "#cc79a7", "#b8578c", "#e08fbb"),
    colour("series-5", "#e69f00", "#b07800", "#e6b13d"),
    colour("series-6", "#56b4e9", "#3a8dc0", "#a5dbf8"),
    // Bars of less weight; the number is beside the bar.
    colour("pale", "#9ec4dc", "#9ec4dc", "#33617f"),
    colour("grey", "#96a0aa", "#808a94", "#96a0aa"),
];

/// Returns the variables of both schemes, and the rules that apply them to charts.
pub(crate) fn style() -> String {
    let values = |value: fn(&Colour) -> &str| {
        COLOURS.iter().map(|colour| format!("--{}:{};", colour.name, value(colour))).collect::<String>()
    };
    let (light, dark) = (values(|colour| colour.light), values(|colour| colour.dark));
    let mut out = format!(
        ":root{{color-scheme:light;{light}}}\n\
         @media screen and (prefers-color-scheme:dark){{:root{{color-scheme:dark;{dark}}}}}\n\
         svg{{fill:var(--ink)}}svg>rect:first-child{{fill:var(--paper)}}\n"
    );
    for Colour { name, written, .. } in COLOURS.iter().filter(|colour| !colour.written.is_empty()) {
        for property in ["fill", "stroke"] {
            let _ = write!(out, "svg [{property}=\"{written}\" i]{{{property}:var(--{name})}}");
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Chart, Series, Style, lines};
    use crate::page::Page;

    /// Relative luminance of a colour (WCAG 2.2).
    fn luminance(colour: &str) -> f64 {
        let channel = |at: usize| {
            let value = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap()) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
    }

    fn contrast(a: &str, b: &str) -> f64 {
        let (a, b) = (luminance(a) + 0.05, luminance(b) + 0.05);
        a.max(b) / a.min(b)
    }

    #[test]
    fn text_and_series_contrast_with_the_paper_in_both_schemes() {
        let of = |name: &str| COLOURS.iter().find(|colour| colour.name == name).unwrap();
        for value in [|colour: &Colour| colour.light, |colour: &Colour| colour.dark] {
            for (name, background, least) in [
                ("text", "paper", 7.0),
                ("text", "head", 7.0),
                ("quiet", "paper", 4.5),
                ("ink", "paper", 7.0),
                ("grey", "paper", 3.0),
                ("pale", "paper", 1.5),
            ] {
                let found = contrast(value(of(name)), value(of(background)));
                assert!(found >= least, "{name} on {background}: {found:.2}");
            }
            for series in COLOURS.iter().filter(|colour| colour.name.starts_with("series")) {
                let found = contrast(value(series), value(of("paper")));
                assert!(found >= 3.0, "{}: {found:.2}", series.name);
            }
        }
    }

    #[test]
    fn no_text_and_no_line_of_a_page_has_a_colour_outside_the_variables() {
        let styles = [Style::Line, Style::Wide, Style::Points, Style::Both, Style::Area, Style::Line];
        let line = |style| Series::new("s", [0.0, 1.0, 2.0], [0.0, 1.0, 0.5]).styled(style);
        let chart = Chart { title: "t", x: "x", y: "y", size: (500, 300) };
        let mut page = Page::new("p");
        page.lead("l").text("t").note("n").table(&["a"], &[vec!["1"]]);
        page.figure(&lines(&chart, &styles.map(line)).unwrap(), "c");
        let html = page.render();
        let (head, body) = html.split_once("</style>").unwrap();
        for property in ["fill", "stroke"] {
            let attribute = format!(" {property}=\"");
            let values = body.split(&attribute).skip(1);
            for value in values.map(|rest| rest.split('"').next().unwrap()).filter(|value| *value != "none") {
                let rule = format!("[{property}=\"{}\" i]", value.to_lowercase());
                let is_paper = value == "#FFFFFF";
                assert!(is_paper || head.contains(&rule), "{property} {value}");
            }
        }
        // The background is the only white, and the first element.
        assert_eq!(body.matches("#FFFFFF").count(), 1);
        let first = body.split_once("<svg").unwrap().1.split_once('>').unwrap().1.trim_start();
        assert!(
            first.starts_with("<rect") && first.split('>').next().unwrap().contains("#FFFFFF"),
            "{first}"
        );
        // Outside the variables the style has no colour.
        let rules = head.lines().filter(|line| !line.contains("--paper:")).collect::<String>();
        let is_fixed = |part: &&str| part.starts_with(|c: char| c.is_ascii_hexdigit());
        let fixed: Vec<&str> = rules.split(":#").skip(1).filter(is_fixed).collect();
        assert!(fixed.is_empty(), "{fixed:?}");
        assert_eq!(html.matches("prefers-color-scheme").count(), 1);
    }
}
