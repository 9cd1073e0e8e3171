//! Page that a script of the caller fills, with the styles, colours and drawing library of the
//! other pages. It fetches data from its own server alone.

use crate::page::{STYLE, escape};
use crate::plot::{self, sha256};
use crate::scheme;

/// Page, and the policy that must be sent with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScriptPage {
    /// The page.
    pub html: String,
    /// Value of the header Content-Security-Policy: the styles and the script of this page run, no
    /// others; requests go to the page's own server alone.
    pub policy: String,
}

impl ScriptPage {
    /// Creates a page. The style follows those of all pages, the script follows uPlot. The body is
    /// HTML and is inserted unchanged.
    pub fn new(title: &str, style: &str, body: &str, script: &str) -> Self {
        let style = format!("{}{}{STYLE}{style}", scheme::style(), plot::LIBRARY_STYLE);
        let script = format!("{}\n{script}", plot::library());
        let policy = format!(
            "default-src 'none'; style-src '{}'; script-src '{}'; connect-src 'self'; img-src data:; \
             base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
            sha256(&style),
            sha256(&script),
        );
        // A browser would ask for an icon that is not given.
        let html = format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" \
             content=\"width=device-width\"><link rel=\"icon\" href=\"data:,\"><title>{}</title>\n\
             <style>{style}</style></head>\n<body>\n{body}\n<script>{script}</script></body></html>\n",
            escape(title)
        );
        Self { html, policy }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_policy_allows_exactly_the_style_and_the_script_of_the_page() {
        let page = ScriptPage::new("a < b", "p{margin:0}", "<p id=\"x\"></p>", "x();");
        for (element, directive) in [("style", "style-src"), ("script", "script-src")] {
            let rest = page.html.split_once(&format!("<{element}>")).unwrap().1;
            let code = rest.split_once(&format!("</{element}>")).unwrap().0;
            assert!(page.policy.contains(&format!("{directive} '{}'", sha256(code))), "{}", page.policy);
        }
        assert!(page.html.contains("<title>a &lt; b</title>") && page.html.contains("<p id=\"x\"></p>"));
        assert!(page.html.contains("x();</script>") && page.html.contains("p{margin:0}</style>"));
        assert!(!page.html.contains("://") && !page.policy.contains("unsafe"), "{}", page.policy);
    }
}
