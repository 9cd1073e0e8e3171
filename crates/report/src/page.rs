//! Self-contained HTML page: text, tables and inline pictures; nothing is fetched from elsewhere.
//!
//! In a browser that runs scripts, charts zoom, show values and hide series. Without scripts, and
//! in print, the page shows their pictures.

use crate::figure::Drawing;
use crate::plot::{self, Columns};
use crate::scheme;

/// Page under construction. Text is escaped; pictures are SVG and are inserted unchanged.
#[derive(Clone, Debug)]
pub struct Page {
    title: String,
    body: String,
    columns: Columns,
    pictures: usize,
    is_animated: bool,
}

/// Style of all pages.
pub(crate) const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;max-width:1080px;margin:2rem auto;\
padding:0 1rem;color:var(--text);background:var(--paper)}\
h1{font-size:1.6rem;margin-bottom:.2rem}h2{font-size:1.15rem;margin-top:2rem;\
border-bottom:1px solid var(--rule)}\
p.lead{font-size:1.1rem}p.note{color:var(--quiet);font-size:.92rem}\
.table{overflow-x:auto}table{border-collapse:collapse;margin:.8rem 0}\
th,td{padding:.25rem .8rem;border-bottom:1px solid var(--rule);text-align:left}\
td{vertical-align:top}td.n{text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums}\
th{background:var(--head)}\
figure{margin:1rem 0;overflow-x:auto}figcaption{color:var(--quiet);font-size:.9rem}\
svg{max-width:100%;height:auto}.plot{display:none}\
.tools{display:flex;gap:1rem;align-items:baseline;min-height:1.6em}\
button{font:inherit;font-size:.85rem;color:var(--quiet);background:var(--head);\
border:1px solid var(--rule);border-radius:3px;cursor:pointer}\
output{font-size:.85rem;color:var(--quiet);font-variant-numeric:tabular-nums}\
.u-legend{text-align:left;margin:0 0 0 3rem}\
.u-legend th,.u-legend td{border:0;background:none}.u-legend .u-series>*{padding:0 .3rem}\
.u-title{font-size:1rem}.controls input{flex:1;min-width:0}.tools[hidden]{display:none}\
.u-select{background:var(--select)}\
@media screen{.live>svg{display:none}.live>.plot{display:block}}@media print{.tools{display:none}}\
.pair{display:flex;flex-wrap:wrap;gap:.2rem 1rem}\
.pair figure{flex:1 1 400px;min-width:0;max-width:516px;margin:.5rem 0}\
@media screen and (max-width:700px){figure>svg{min-width:720px}.pair svg{min-width:0}}";

/// Button that a script makes visible.
const SAVE: &str = "<div class=\"tools\"><button type=\"button\" id=\"save-all\" hidden>Save all pictures \
                    (SVG in a ZIP file)</button></div>\n";

/// Button, slider and time of an animation.
const CONTROLS: &str = "<div class=\"tools controls\" hidden><button type=\"button\">Play</button>\
                        <input type=\"range\" min=\"0\" value=\"0\" step=\"1\" aria-label=\"Time\">\
                        <output></output></div>";

/// Maximum number of words in a cell that counts as a number: `1.5 to 2.5 N m`.
const NUMBER_WORDS: usize = 5;

impl Page {
    /// Creates an empty page.
    pub fn new(title: &str) -> Self {
        Self {
            title: title.into(),
            body: String::new(),
            columns: Columns::default(),
            pictures: 0,
            is_animated: false,
        }
    }

    /// Appends the introductory sentence.
    pub fn lead(&mut self, text: &str) -> &mut Self {
        self.push(&format!("<p class=\"lead\">{}</p>\n", escape(text)))
    }

    /// Appends a heading.
    pub fn section(&mut self, title: &str) -> &mut Self {
        self.push(&format!("<h2>{}</h2>\n", escape(title)))
    }

    /// Appends a paragraph.
    pub fn text(&mut self, text: &str) -> &mut Self {
        self.push(&format!("<p>{}</p>\n", escape(text)))
    }

    /// Appends a note in small print.
    pub fn note(&mut self, text: &str) -> &mut Self {
        self.push(&format!("<p class=\"note\">{}</p>\n", escape(text)))
    }

    /// Appends a list of sentences.
    pub fn list(&mut self, items: &[&str]) -> &mut Self {
        let items: String = items.iter().map(|item| format!("<li>{}</li>\n", escape(item))).collect();
        self.push(&format!("<ul>\n{items}</ul>\n"))
    }

    /// Appends a table. Cells with a number, at most with a unit or an interval, are aligned as
    /// numbers.
    pub fn table<S: AsRef<str>>(&mut self, header: &[&str], rows: &[Vec<S>]) -> &mut Self {
        let mut out = String::from("<div class=\"table\"><table><tr>");
        for cell in header {
            out.push_str(&format!("<th>{}</th>", escape(cell)));
        }
        out.push_str("</tr>\n");
        for row in rows {
            out.push_str("<tr>");
            for cell in row {
                let text = cell.as_ref();
                let number = text.split(' ').next().is_some_and(|word| word.parse::<f64>().is_ok())
                    && text.split(' ').count() <= NUMBER_WORDS;
                out.push_str(&format!(
                    "<td{}>{}</td>",
                    if number { " class=\"n\"" } else { "" },
                    escape(text)
                ));
            }
            out.push_str("</tr>\n");
        }
        out.push_str("</table></div>\n");
        self.push(&out)
    }

    /// Appends a picture with a caption.
    pub fn figure(&mut self, drawing: &Drawing, caption: &str) -> &mut Self {
        let chart = drawing.plot.as_ref().map(|plot| self.columns.describe(plot));
        let chart = chart.map(|json| format!(" data-chart=\"{}\"", escape(&json))).unwrap_or_default();
        self.pictures += 1;
        let svg = &drawing.svg;
        self.push(&format!("<figure{chart}>{svg}<figcaption>{}</figcaption></figure>\n", escape(caption)))
    }

    /// Appends a picture that a script animates.
    ///
    /// `frames` is a JSON object: `times` in s, and for each time `bodies`, the place and the angle
    /// in degrees of every element with `data-body`, and `forces`, both ends of every element with
    /// `data-force`.
    pub fn animation(&mut self, svg: &str, frames: &str, caption: &str) -> &mut Self {
        self.is_animated = true;
        let (frames, caption) = (escape(frames), escape(caption));
        self.push(&format!(
            "<figure data-frames=\"{frames}\"><div>{svg}</div>{CONTROLS}<figcaption>{caption}</figcaption>\
             </figure>\n"
        ))
    }

    /// Appends pictures, side by side if the window is wide enough.
    pub fn figures(&mut self, pictures: &[(Drawing, &str)]) -> &mut Self {
        self.push("<div class=\"pair\">\n");
        for (drawing, caption) in pictures {
            self.figure(drawing, caption);
        }
        self.push("</div>\n")
    }

    /// Returns the page as HTML.
    pub fn render(&self) -> String {
        let title = escape(&self.title);
        let has_scripts = self.is_animated || !self.columns.is_empty();
        let library_style = if self.columns.is_empty() { "" } else { plot::LIBRARY_STYLE };
        let scripts = if has_scripts { self.columns.render() } else { String::new() };
        let save = if self.pictures > 0 { SAVE } else { "" };
        format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" \
             content=\"width=device-width\"><meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\
             <title>{title}</title>\n<style>{}{library_style}{STYLE}</style></head>\n<body>\n\
             <h1>{title}</h1>\n{save}{}{}</body></html>\n",
            plot::policy(),
            scheme::style(),
            self.body,
            scripts,
        )
    }

    fn push(&mut self, html: &str) -> &mut Self {
        self.body.push_str(html);
        self
    }
}

/// Escapes text for HTML.
pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped_and_nothing_is_fetched() {
        let mut page = Page::new("a < b");
        page.lead("x & y")
            .table(&["k"], &[vec!["<script>"]])
            .figure(&Drawing::from(String::from("<svg></svg>")), "c");
        let html = page.render();
        assert!(html.contains("a &lt; b") && html.contains("x &amp; y") && html.contains("&lt;script&gt;"));
        assert!(!html.contains("://"), "a page must not reach outside");
    }

    #[test]
    fn a_number_is_set_as_one_and_a_sentence_that_begins_with_one_is_not() {
        let mut page = Page::new("numbers");
        page.table(
            &["a", "b", "c"],
            &[vec!["1.5 to 2.5 N", "35 isolated readings, a loose contact at least", "x"]],
        );
        let html = page.render();
        assert!(html.contains("<td class=\"n\">1.5 to 2.5 N</td>"));
        assert!(html.contains("<td>35 isolated") && html.contains("<td>x"));
    }
}
